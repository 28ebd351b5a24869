// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * Arrow keys that move, turn and scale the selected part in place of the hand.
 *
 * @typedef {import('../scene/placement.js').Part} Part
 * @typedef {import('../scene/vectors.js').Vector} Vector
 * @typedef {import('../panels/edits.js').Change} Change
 */

import { edit, settled } from '../panels/edits.js';
import { extent } from '../panels/numbers.js';
import { dismiss, tell } from '../panels/page.js';
import { keyed } from '../scene/grips.js';
import { movedPart, scaledPart, selectedPart, turnedPart } from '../scene/placement.js';
import { roundUp } from '../scene/units.js';
import { AXES, dot, scale } from '../scene/vectors.js';
import { state } from '../state.js';
import { axesSeen } from './steer.js';

/** Steps of a key: a part of the scene's size, degrees, and a part of the part's size. */
const STEP = { move: 0.01, turn: 5, scale: 0.05 };
/** Steps with Shift, over those without. */
const FINE = 0.2;

/** What the keys do, in turn, and in words. */
const KINDS = /** @type {const} */ ([
  [null, () => 'Arrow keys move the hand.'],
  ['move', (/** @type {string} */ name) => `Arrow keys move “${name}”; M: they turn it.`],
  ['turn', (/** @type {string} */ name) => `Arrow keys turn “${name}”; M: they scale it.`],
  ['scale', (/** @type {string} */ name) => `Arrow keys scale “${name}”; M: they move the hand.`],
]);

/** The message that was told last. */
let told = 0;

/** Goes on to what the arrow keys do next. */
export function nextKind() {
  const part = selectedPart();
  const at = part ? (KINDS.findIndex(([kind]) => kind === keyed.kind) + 1) % KINDS.length : 0;
  const [kind, words] = KINDS[at];
  keyed.kind = kind;
  dismiss(told);
  const text = part ? words(part.name) : 'Select a body or a shape first: then M lets the arrow keys move, turn and scale it.';
  told = tell(text);
}

/** The axis of a part that is seen most along a key's way, and its sign; no two keys share one.
 * @param {Part} part @param {Vector} way of the key: right, up, away */
function axisOf({ frame }, way) {
  const seen = axesSeen();
  const isPlane = state.scene?.dimension === 2;
  const free = [0, 1, 2].slice(0, isPlane ? 2 : 3);
  for (const [index, direction] of [seen.right, seen.up, seen.away].entries()) {
    const along = (/** @type {number} */ axis) => dot(frame.axes[axis], direction);
    const [best] = [...free].sort((a, b) => Math.abs(along(b)) - Math.abs(along(a)));
    if (best === undefined) return null;
    if (way[index] !== 0) return { axis: best, sign: Math.sign(along(best)) * way[index] };
    free.splice(free.indexOf(best), 1);
  }
  return null;
}

/** The edit of a step of a key. @param {Part} part @param {Vector} way @param {number} fine
 * @returns {Change[]} */
function stepOf(part, way, fine) {
  const step = roundUp(STEP.move * extent(state.scene?.bounds)) * fine;
  const sign = way[0] + way[1] - way[2];
  if (keyed.kind === 'scale') return scaledPart(part, (1 + STEP.scale * fine) ** sign, step / 100);
  if (keyed.kind === 'turn') {
    // To the right about the axis that is seen upwards, upwards about that to the left.
    const about = state.scene?.dimension === 2 ? { axis: 2, sign: -sign }
      : axisOf(part, [-way[1], way[0], -way[2]]);
    return about ? turnedPart(part, AXES[about.axis], about.sign * STEP.turn * fine, step / 100) : [];
  }
  const along = axisOf(part, way);
  return along ? movedPart(part, scale(AXES[along.axis], (along.sign * step) / part.frame.scale), step / 10) : [];
}

/** The steps of before. */
let steps = Promise.resolve();
let waiting = 0;
/** What the last step changed. @type {Change[]} */
let last = [];

/** Does work on the scene that the edits of before leave. @param {() => void} work */
function later(work) {
  waiting += 1;
  steps = steps.then(settled).then(() => {
    waiting -= 1;
    work();
  });
}

/** Takes a key that moves along `way`: right, up, away. Whether the selected part takes it.
 * @param {Vector} way @param {{ shiftKey: boolean, repeat: boolean }} event */
export function takeKey(way, { shiftKey, repeat }) {
  if (!keyed.kind || !selectedPart()) return false;
  // What the program has no time for is left out, so that nothing moves once the key is up.
  if (repeat && waiting > 0) return true;
  later(() => {
    const part = selectedPart();
    const changes = part ? stepOf(part, way, shiftKey ? FINE : 1) : [];
    if (changes.length === 0) return;
    last = changes;
    edit(changes, true);
  });
  return true;
}

/** Ends what keys did: it is one step to undo. */
export function endKeys() {
  later(() => {
    if (last.length > 0) edit(last);
    last = [];
  });
}
