// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * The keys of the page, in one table, which the help shows too.
 *
 * `where` says when a key counts:
 * - `anywhere`: always;
 * - `untyped`: not while a text field holds what was typed and not entered yet;
 * - `outside`: not while a text field or a `<select>` has the focus;
 * - `moveless`: nor while a slider, tree or tab list has it;
 * - `free`: only while no control has it.
 *
 * @typedef {'anywhere' | 'untyped' | 'outside' | 'moveless' | 'free'} Where
 * @typedef {{ keys: string[], shown: string, text: string, where: Where, does: string,
 *   control?: boolean }} Key
 */

import { TYPED, isDraft, watchDraft } from './draft.js';
import { endKeys, takeKey } from './placing.js';
import { deepen, isLeading } from './pointer.js';
import { axesSeen, letGo, nudge, push } from './steer.js';
import { state } from '../state.js';

/** @type {Key[]} */
export const KEYS = [
  { keys: ['Escape'], shown: 'Esc', text: 'stop all forces, wherever the focus is; a field drops what was typed, a window closes', where: 'anywhere', does: 'stop' },
  { keys: ['r', 'R'], shown: 'R', text: 'release: forces again after a stop', where: 'outside', does: 'release' },
  { keys: ['p', 'P'], shown: 'P', text: 'hold the time, or go on', where: 'outside', does: 'hold' },
  { keys: [' '], shown: 'Space', text: 'the same, when no control has the focus', where: 'free', does: 'hold' },
  { keys: ['s', 'S'], shown: 'S', text: 'slow motion, 0.25×', where: 'outside', does: 'slow' },
  { keys: ['.'], shown: '.', text: 'one step while held', where: 'outside', does: 'step' },
  { keys: [','], shown: ',', text: 'back through what was', where: 'outside', does: 'back' },
  { keys: ['Home'], shown: 'Home', text: 'follow the present again', where: 'moveless', does: 'follow' },
  { keys: ['1'], shown: '1', text: '3D view', where: 'outside', does: 'space' },
  { keys: ['2'], shown: '2', text: 'slice', where: 'outside', does: 'slice' },
  { keys: ['3'], shown: '3', text: 'plane', where: 'outside', does: 'plane' },
  { keys: ['4'], shown: '4', text: 'compare two bodies', where: 'outside', does: 'compare' },
  { keys: ['f', 'F'], shown: 'F', text: 'show the whole scene', where: 'outside', does: 'fit' },
  { keys: ['m', 'M'], shown: 'M', text: 'the arrow and Page keys move the selected body or shape; again: turn it, scale it, move the hand', where: 'outside', does: 'place' },
  { keys: ['l', 'L'], shown: 'L', text: 'let go of the hand, which keys hold where they led it', where: 'outside', does: 'letGo' },
  { keys: ['z', 'Z'], shown: 'Ctrl Z', text: 'undo; in a field only drop what was typed', where: 'untyped', does: 'undo', control: true },
  { keys: ['y', 'Y'], shown: 'Ctrl Y', text: 'redo', where: 'untyped', does: 'redo', control: true },
  { keys: ['s', 'S'], shown: 'Ctrl S', text: 'save the scene; with Shift as another file', where: 'anywhere', does: 'save', control: true },
  { keys: ['?', 'F1'], shown: '? or F1', text: 'this help', where: 'outside', does: 'help' },
];

/** Keys that move the hand: to the right, up, away. @type {Record<string, number[]>} */
const MOVES = {
  ArrowLeft: [-1, 0, 0], ArrowRight: [1, 0, 0], ArrowDown: [0, -1, 0], ArrowUp: [0, 1, 0],
  PageDown: [0, 0, 1], PageUp: [0, 0, -1],
};

/** What the table does not hold, for the help. */
export const MOVE_HELP = [
  { shown: '← → ↑ ↓', text: 'move the hand a step, and on while they are held; it stays there, and presses on. While looking back ← and → go from frame to frame' },
  { shown: 'Page ↑ Page ↓', text: 'move the hand nearer and away, in depth' },
  { shown: 'Shift', text: 'with these: a quarter of the speed; a fifth of a step of what is selected' },
];

const CHOSEN = `${TYPED}, select`;
const WITH_ARROWS = `${CHOSEN}, input[type=range], [role=tree], [role=tablist]`;
/** In what a key of each kind does not count. @type {Record<Where, string>} */
const ELSEWHERE = {
  anywhere: ':not(*)',
  untyped: ':not(*)',
  outside: CHOSEN,
  moveless: WITH_ARROWS,
  free: `${WITH_ARROWS}, input, button, a, summary`,
};

/** @param {EventTarget | null} target @param {Where} where */
function counts(target, where) {
  if (!(target instanceof Element)) return true;
  // A field marked invalid keeps Ctrl Z for itself.
  if (where === 'untyped' && (isDraft(target) || target.matches('[aria-invalid=true]'))) return false;
  return !target.closest(ELSEWHERE[where]);
}

/** A speed while Shift is down, over that without. */
const SLOW = 0.25;
/** How long a key is down before the hand moves on after its first step [ms]. */
const REPEAT_AFTER = 250;

/** Leaves a field, so that the key that releases is not typed into it. In a window, which closes, focus
 * goes back to where it was. @param {EventTarget | null} target */
function leaveField(target) {
  if (target instanceof HTMLElement && target.matches(CHOSEN) && !target.closest('dialog')) target.blur();
}

/** Listens for keys. @param {Record<string, (event: KeyboardEvent) => void>} actions one for each `does` */
export function listenKeys(actions) {
  /** Keys that are down, and since when. @type {Map<string, number>} */
  const held = new Map();
  let isEscapeDown = false;
  let isSlow = false;
  let isRunning = false;

  const run = () => {
    if (held.size === 0 || state.lookingAt !== null) {
      isRunning = false;
      return;
    }
    const moving = [...held].filter(([, since]) => performance.now() - since > REPEAT_AFTER).map(([key]) => key);
    const speeds = [0, 1, 2].map((axis) =>
      (isSlow ? SLOW : 1) * moving.reduce((sum, key) => sum + MOVES[key][axis], 0));
    if (moving.length > 0) push(speeds, axesSeen());
    requestAnimationFrame(run);
  };

  watchDraft();
  // In the capturing phase, so that nothing can keep Escape to itself.
  addEventListener('keydown', (event) => {
    isSlow = event.shiftKey;
    isEscapeDown ||= event.key === 'Escape';
    const isControl = event.ctrlKey || event.metaKey;
    const isSaveAs = isControl && event.shiftKey && event.key.toLowerCase() === 's';
    const isRedo = isControl && event.shiftKey && event.key.toLowerCase() === 'z';
    const key = KEYS.find((one) =>
      one.keys.includes(event.key) && Boolean(one.control) === isControl && counts(event.target, one.where));
    if (key && !event.altKey) {
      if (key.does !== 'stop') event.preventDefault();
      actions[isRedo ? 'redo' : isSaveAs ? 'saveAs' : key.does]?.(event);
      return;
    }
    if (!(event.key in MOVES) || isControl || event.altKey) return;
    if (!counts(event.target, 'moveless')) return;
    event.preventDefault();
    if (state.lookingAt !== null) {
      if (event.key === 'ArrowLeft') actions.back?.(event);
      if (event.key === 'ArrowRight') actions.forth?.(event);
      return;
    }
    // A hand that the pointer leads is moved by keys in depth alone.
    if (isLeading()) {
      const [, , away] = MOVES[event.key];
      deepen(away * (isSlow ? SLOW : 1));
      return;
    }
    if (takeKey(MOVES[event.key], event)) return;
    if (state.touch.input !== 'keys') actions.useKeys?.(event);
    if (held.has(event.key)) return;
    held.set(event.key, performance.now());
    nudge(MOVES[event.key].map((way) => way * (isSlow ? SLOW : 1)), axesSeen());
    if (!isRunning) {
      isRunning = true;
      requestAnimationFrame(run);
    }
  }, { capture: true });
  // After all others: the field has dropped what was typed.
  addEventListener('keydown', ({ key, target }) => key === 'Escape' && leaveField(target));
  addEventListener('keyup', (event) => {
    isSlow = event.shiftKey;
    // The open list of a choice, and windows of the system, keep the press and leave the release.
    if (event.key === 'Escape' && !isEscapeDown) {
      actions.stop?.(event);
      leaveField(event.target);
    }
    if (event.key === 'Escape') isEscapeDown = false;
    held.delete(event.key);
    if (event.key in MOVES) endKeys();
  }, { capture: true });
  addEventListener('blur', () => {
    held.clear();
    isEscapeDown = false;
  });
}
