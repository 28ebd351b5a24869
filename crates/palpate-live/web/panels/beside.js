// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/** Where new parts go, so that they can be seen: beside what is there. */

import { SCENE, frameIn, placed } from '../scene/frames.js';
import { boxOf, centreOf } from '../scene/setting.js';
import { inSpace, mean } from '../scene/vectors.js';
import { state } from '../state.js';
import { listOf, makerOf, onOne } from './nodes.js';
import { extent } from './numbers.js';

/** Keys that are lengths from end to end; other lengths are radii. */
const WHOLE = /size|height|length|width|thickness/;
/** Named shapes are followed so deep. */
const DEEPEST = 20;

/** How far a shape reaches of which nothing is known, over the size of the scene. */
const UNKNOWN = 0.15;
/** From the scene to a body beside it, over the body's size, and to an endless one below it, over the
 * scene's. */
const APART = { beside: 1.3, below: 0.25 };

/** @param {number[]} place */
const inThreeDigits = (place) => place.map((part) => Number(part.toPrecision(3)));

/** About where a shape is in its own coordinates, and how far it reaches from there [m].
 * @param {any} shape @returns {{ centre: number[], reach: number }} */
export function aboutShape(shape, depth = 0) {
  const dimension = state.scene?.dimension ?? 3;
  const none = { centre: Array(dimension).fill(0), reach: UNKNOWN * extent(state.scene?.bounds) };
  if (depth > DEEPEST) return none;
  if (typeof shape === 'string' || typeof shape?.shape === 'string') {
    return aboutShape(state.scene?.scene.shapes?.[shape.shape ?? shape] ?? {}, depth + 1);
  }
  const list = listOf(shape);
  if (list) return aboutShape(shape[list][0], depth + 1);
  if (shape?.of !== undefined) {
    const { centre, reach } = aboutShape(shape.of, depth + 1);
    const frame = frameIn(SCENE, shape) ?? SCENE;
    return { centre: placed(frame, inSpace(centre)).slice(0, dimension), reach: frame.scale * reach };
  }
  const maker = makerOf(shape);
  if (!maker || onOne().includes(maker)) return none;
  const entry = state.welcome?.catalogue?.find((/** @type {any} */ one) => one.name === maker && one.dimension === dimension);
  const lengths = (entry?.parameters ?? []).filter((/** @type {any} */ one) => one.unit === 'm')
    .flatMap((/** @type {any} */ { key }) => [shape[maker]?.[key]].flat(9)
      .filter((value) => typeof value === 'number').map((value) => Math.abs(value) * (WHOLE.test(key) ? 0.5 : 1)));
  const reach = Math.max(0, ...lengths);
  const points = entry?.origin.startsWith('given by its points') ? pointsIn(Object.values(shape[maker]), dimension) : [];
  const centre = points.length > 0 ? mean(points.map(inSpace)).slice(0, dimension) : none.centre;
  return reach > 0 ? { centre, reach } : none;
}

/** The points in the numbers of a primitive. @param {any} value @param {number} dimension
 * @returns {number[][]} */
function pointsIn(value, dimension) {
  if (!Array.isArray(value)) return [];
  const isPoint = value.length === dimension && typeof value[0] === 'number';
  return isPoint ? [value] : value.flatMap((inner) => pointsIn(inner, dimension));
}

/** A shape that is moved. @param {any} shape @param {number[]} by [m] */
export function moved(shape, by) {
  return { translate: inThreeDigits(by), of: shape };
}

/** Where the next operand goes: on the edge of the first, each time on another side.
 * @param {any[]} operands */
export function besideOperands(operands) {
  const { centre, reach } = aboutShape(operands[0]);
  const turn = operands.length - 1;
  const axis = Math.floor(turn / 2) % centre.length;
  return centre.map((place, index) => (index === axis ? place + (turn % 2 === 0 ? reach : -reach) : place));
}

/** Where a body of this size goes: to the right of the scene; without end, below it.
 * @param {number} size from the middle to the edge [m] @param {boolean} isBounded */
export function besideBodies(size, isBounded) {
  const dimension = state.scene?.dimension ?? 3;
  const box = boxOf(state.scene?.bounds);
  if (!box || !state.scene?.scene.bodies.length) return Array(dimension).fill(0);
  const place = centreOf(box);
  if (isBounded) place[0] = box.high[0] + APART.beside * size;
  else place[1] = box.low[1] - size - APART.below * extent(state.scene.bounds);
  return inThreeDigits(place.slice(0, dimension));
}
