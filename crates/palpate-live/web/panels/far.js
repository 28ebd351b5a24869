// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * A body that reaches so far that the others can hardly be seen beside it: the page says so once.
 *
 * @typedef {import('../scene/setting.js').Box} Box
 */

import { centreOf, setting } from '../scene/setting.js';
import { norm, subtract } from '../scene/vectors.js';
import { select } from '../state.js';
import { count } from './numbers.js';
import { tell } from './page.js';

/** The most times that a scene may be as large as its smallest body, so that both are seen. */
const MOST = 1e4;

/** @param {Box} box */
const sizeOf = ({ low, high }) => norm(subtract(high, low));

/** About where most bodies are: the median of their centres; of two, that nearer to zero.
 * @param {Box[]} boxes */
function among(boxes) {
  const centres = boxes.map(centreOf);
  return [0, 1, 2].map((axis) => {
    const sorted = centres.map((centre) => centre[axis]).sort((a, b) => a - b);
    const [one, other] = [Math.floor, Math.ceil].map((round) => sorted[round((sorted.length - 1) / 2)]);
    return Math.abs(one) < Math.abs(other) ? one : other;
  });
}

/** The body that reaches farthest from the others, and how many times the scene is as large as its
 * smallest body; null where those are few. */
function farthest() {
  const { bodies, size, isBounded } = setting();
  const bounded = bodies.flatMap(({ box }, body) => (box ? [{ body, box }] : []));
  const sizes = bounded.map(({ box }) => sizeOf(box)).filter((each) => each > 0);
  const times = size / Math.min(...sizes);
  if (!isBounded || bounded.length < 2 || !(times > MOST)) return null;
  const middle = among(bounded.map(({ box }) => box));
  const reach = (/** @type {Box} */ { low, high }) => Math.max(norm(subtract(low, middle)), norm(subtract(high, middle)));
  const { body } = bounded.reduce((most, one) => (reach(one.box) > reach(most.box) ? one : most));
  return { body, name: bodies[body].name, times };
}

/** The name of the body that was told of last. */
let told = '';

/** Tells of a body that reaches far, if the newest scene has one. */
export function watchFar() {
  const found = farthest();
  if (found && found.name !== told) {
    const times = count(Number(found.times.toPrecision(2)));
    tell(`${found.name} reaches so far that the scene is ${times} times as large as its smallest body, which a picture `
      + 'of the whole does not show.', 'word',
    [{ name: 'Select it', run: () => select(`/bodies/${found.body}`) }]);
  }
  told = found?.name ?? '';
}
