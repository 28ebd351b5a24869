// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * The scene as the picture needs it: its box, its bodies and their colours.
 *
 * @typedef {import('./vectors.js').Vector} Vector
 * @typedef {{ low: Vector, high: Vector }} Box
 * @typedef {{ name: string, color: string, promise: string, box: Box | null }} Body
 * @typedef {{ dimension: number, box: Box, isBounded: boolean, centre: Vector, size: number,
 *   bodies: Body[] }} Setting
 */

import { inSpace, middle, norm, scale, subtract } from './vectors.js';
import { state } from '../state.js';

/** Half of the edge of the box of a scene that has no bounds [m]. */
const ENDLESS = 1;

/** A box as the program sends it. @param {any} bounds @returns {Box | null} */
export function boxOf(bounds) {
  const [low, high] = Array.isArray(bounds) ? bounds : [bounds?.min, bounds?.max];
  if (!Array.isArray(low) || !Array.isArray(high)) return null;
  const box = { low: inSpace(low), high: inSpace(high) };
  return [...box.low, ...box.high].every(Number.isFinite) ? box : null;
}

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
    name: String(body.name ?? ''),
    color: String(body.color ?? '#8a93a0'),
    promise: String(body.promise ?? ''),
    box: boxOf(body.bounds),
  }));
  const size = norm(subtract(box.high, box.low)) || ENDLESS;
  return { dimension, box, isBounded: known !== null, centre: centreOf(box), size, bodies };
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

/** Red, green and blue from 0 to 1 of `#rrggbb`, of numbers from 0 to 255 or of parts of one.
 * @param {any} color @returns {number[]} */
export function rgb(color) {
  const digits = /^#?([0-9a-f]{6})$/i.exec(color)?.[1];
  if (digits) return [0, 2, 4].map((at) => parseInt(digits.slice(at, at + 2), 16) / 255);
  const numbers = String(color).match(/[\d.]+/g)?.slice(0, 3).map(Number);
  if (numbers?.length !== 3) return [0.54, 0.58, 0.63];
  return Math.max(...numbers) > 1 ? scale(numbers, 1 / 255) : numbers;
}

/** The places of two bodies that are compared: added to a point of the picture. Equal shapes
 * that stand side by side are laid onto each other; others stay where they are.
 * @param {Setting} current @param {number[]} compared @returns {Vector[]} */
export function shifts(current, compared) {
  const [a, b] = compared.map((body) => current.bodies[body]?.box ?? null);
  if (!a || !b) return [[0, 0, 0], [0, 0, 0]];
  const difference = subtract(subtract(a.high, a.low), subtract(b.high, b.low));
  const isAlike = norm(difference) < 0.02 * norm(subtract(a.high, a.low));
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
