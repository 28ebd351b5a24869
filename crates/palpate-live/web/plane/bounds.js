// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/** Where the toys are that are out, so that all of them can be seen. */

import { inSpace } from '../scene/vectors.js';
import { fall } from './fall.js';
import { toys } from './toys.js';

/** Balls that hold the toys of a scene: a point is one without a radius.
 * @param {number} dimension @returns {[number[], number][]} */
function balls(dimension) {
  const { shown, corners, by, ball, pair } = toys;
  /** @type {[number[], number][]} */
  const found = [];
  const add = (/** @type {number[]} */ centre, radius = 0) => found.push([centre, radius]);
  if (fall.isShown) [fall.centre, ...(fall.answer?.path ?? [])].forEach((centre) => add(centre, fall.radius));
  if (dimension === 3) return found;
  if (shown.element || shown.sweep) corners.forEach((corner) => add(corner));
  if (shown.sweep) corners.forEach(([x, y]) => add([x + by[0], y + by[1]]));
  if (shown.ball) add(ball.centre, ball.radius);
  if (shown.pair) pair.starts.forEach((start) => add(start));
  return found;
}

/** The box of the toys that are out and of the falling ball with its way; null without any.
 * @param {number} dimension of the scene @returns {import('../scene/setting.js').Box | null} */
export function boundsOfToys(dimension) {
  const all = balls(dimension).filter(([centre]) => centre.length === dimension);
  if (all.length === 0) return null;
  const ends = (/** @type {1 | -1} */ side) => inSpace(Array.from({ length: dimension }, (_, axis) =>
    side * all.reduce((most, [centre, radius]) => Math.max(most, side * centre[axis] + radius), -Infinity)));
  return { low: ends(-1), high: ends(1) };
}
