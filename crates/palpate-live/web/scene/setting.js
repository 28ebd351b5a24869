// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * The scene as the picture needs it: its box, its bodies and their colours.
 *
 * @typedef {import('./vectors.js').Vector} Vector
 * @typedef {{ low: Vector, high: Vector }} Box
 * @typedef {import('./colors.js').Color} Color
 * @typedef {[number, number]} Promises what is promised outside and inside: 0 exact, 1 bound,
 *   2 Lipschitz
 * @typedef {{ name: string, color: Color, promises: Promises, box: Box | null }} Body
 * @typedef {{ dimension: number, box: Box, isBounded: boolean, centre: Vector, size: number,
 *   promises: Promises, bodies: Body[] }} Setting `promises` are of all bodies together
 */

import { inSpace, middle, norm, scale, subtract } from './vectors.js';
import { state } from '../state.js';

/** Half of the edge of the box of a scene that has no bounds [m]. */
const ENDLESS = 1;
/** Sizes of shapes that are alike differ by less than this share of them. */
const ALIKE = 0.02;

/** A box as the program sends it: its least and its greatest corner.
 * @param {{ min: number[], max: number[] } | null | undefined} bounds @returns {Box | null} */
export const boxOf = (bounds) => (bounds ? { low: inSpace(bounds.min), high: inSpace(bounds.max) } : null);

/** The number of a body by its name; −1 of none. @param {string | null} name @returns {number} */
export const numberOf = (name) =>
  (state.scene?.bodies ?? []).findIndex((/** @type {Body} */ body) => body.name === name);

/** @param {string} words such as “exact outside, bound inside” @returns {Promises} */
function promisesOf(words) {
  const [outside, inside] = words.split(',').map((part) =>
    Math.max(0, ['exact', 'bound', 'Lipschitz'].findIndex((word) => part.includes(word))));
  return [outside, inside];
}

/** Whether a point is in a box. @param {Box} box @param {Vector} point */
export const isWithin = ({ low, high }, point) =>
  point.every((part, axis) => part >= low[axis] && part <= high[axis]);

/** @param {Box} box */
export const centreOf = (box) => middle(box.low, box.high);

/** The eight corners, or the four of a flat box. @param {Box} box @returns {Vector[]} */
export function cornersOf({ low, high }) {
  const depths = low[2] === high[2] ? [low[2]] : [low[2], high[2]];
  return depths.flatMap((z) => [
    [low[0], low[1], z], [high[0], low[1], z], [high[0], high[1], z], [low[0], high[1], z],
  ]);
}

/** The newest scene. @returns {Setting} */
export function setting() {
  const message = state.scene;
  const dimension = message?.dimension ?? 3;
  const known = boxOf(message?.bounds);
  const depth = dimension === 2 ? 0 : ENDLESS;
  const box = known ?? { low: [-ENDLESS, -ENDLESS, -depth], high: [ENDLESS, ENDLESS, depth] };
  const bodies = (message?.bodies ?? []).map((/** @type {any} */ body) => ({
    name: body.name,
    color: scale(body.color, 1 / 255),
    promises: promisesOf(body.promise),
    box: boxOf(body.bounds),
  }));
  const size = norm(subtract(box.high, box.low)) || ENDLESS;
  const promises = promisesOf(message?.promise ?? 'exact outside, exact inside');
  return { dimension, box, isBounded: known !== null, centre: centreOf(box), size, promises, bodies };
}

/** The box around boxes. @param {Box[]} boxes @returns {Box} */
function around(boxes) {
  const axes = [0, 1, 2];
  const low = axes.map((axis) => Math.min(...boxes.map((box) => box.low[axis])));
  const high = axes.map((axis) => Math.max(...boxes.map((box) => box.high[axis])));
  return { low, high };
}

/** The setting whose box holds another box too. @param {Setting} current @param {Box | null} other
 * @returns {Setting} */
export function holding(current, other) {
  if (!other) return current;
  const box = around([current.box, other]);
  return { ...current, box, centre: centreOf(box) };
}

/** The places of two bodies that are compared: added to a point of the picture. Equal shapes
 * that stand side by side are laid onto each other; others stay where they are.
 * @param {Setting} current @param {number[]} compared @returns {Vector[]} */
export function shifts(current, compared) {
  const [a, b] = compared.map((body) => current.bodies[body]?.box ?? null);
  if (!a || !b) return [[0, 0, 0], [0, 0, 0]];
  const difference = subtract(subtract(a.high, a.low), subtract(b.high, b.low));
  const isAlike = norm(difference) < ALIKE * norm(subtract(a.high, a.low));
  return isAlike ? [centreOf(a), centreOf(b)] : [[0, 0, 0], [0, 0, 0]];
}

/** The setting of two bodies that are compared, where they are shown.
 * @param {Setting} current @param {number[]} bodies @returns {Setting} */
export function comparison(current, bodies) {
  const places = shifts(current, bodies);
  const boxes = bodies.map((body, index) => {
    const { low, high } = current.bodies[body]?.box ?? current.box;
    return { low: subtract(low, places[index]), high: subtract(high, places[index]) };
  });
  const box = around(boxes);
  return { ...current, box, centre: centreOf(box), size: norm(subtract(box.high, box.low)) || ENDLESS };
}
