// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * Frames: where the coordinates of a part of the scene lie, after what moves, turns and scales it.
 *
 * @typedef {import('./vectors.js').Vector} Vector
 * @typedef {{ origin: Vector, axes: Vector[], scale: number }} Frame its axes are unit vectors
 * @typedef {{ axis: number[], angle: number }} Turn by degrees about an axis
 */

import { AXES, add, along, cross, dot, inSpace, norm, scale, toDecimals, turn, unit } from './vectors.js';

const DEGREE = Math.PI / 180;
/** The frame of the scene itself. @type {Frame} */
export const SCENE = { origin: [0, 0, 0], axes: AXES, scale: 1 };
/** Operators below which a frame is bent, or has another dimension. */
const BENT = ['bend', 'bend_degrees', 'twist', 'twist_degrees', 'extrude', 'revolve'];

/** A direction of a frame in the scene, with the frame's scale. @param {Frame} frame
 * @param {Vector} way @returns {Vector} */
const carried = ({ axes, scale: factor }, way) =>
  scale(axes.reduce((sum, axis, at) => along(sum, axis, way[at]), [0, 0, 0]), factor);

/** A point of a frame in the scene. @param {Frame} frame @param {Vector} point */
export const placed = (frame, point) => add(frame.origin, carried(frame, point));

/** A way of the scene in a frame. @param {Frame} frame @param {Vector} way @returns {Vector} */
export const within = ({ axes, scale: factor }, way) => axes.map((axis) => dot(axis, way) / factor);

/** @param {any} rotation */
const isQuaternion = (rotation) => typeof rotation?.[0] === 'number';

/** The images of the axes under the turn of a pose, or of a shape.
 * @param {{ rotate_degrees?: number | Turn, rotation?: any }} holder @returns {Vector[]} */
function axesOf({ rotate_degrees: turned, rotation }) {
  if (isQuaternion(rotation)) {
    const about = rotation.slice(0, 3);
    return AXES.map((axis) => turn(axis, unit(about), 2 * Math.atan2(norm(about), rotation[3])));
  }
  if (rotation) {
    return [0, 1, 2].map((column) =>
      [0, 1, 2].map((row) => rotation[row]?.[column] ?? Number(row === column)));
  }
  const { axis: about, angle } = typeof turned === 'object' ? turned : { axis: AXES[2], angle: turned ?? 0 };
  return AXES.map((axis) => turn(axis, unit(about), angle * DEGREE));
}

/** The frame of what a pose places, or of what a shape holds under `of`; null where it is bent, or
 * stretched along one axis more than along another. @param {Frame} frame @param {any} holder
 * @returns {Frame | null} */
export function frameIn(frame, holder) {
  const [factor, ...others] = [holder.scale ?? 1].flat();
  if (BENT.some((key) => key in holder) || others.some((other) => other !== factor)) return null;
  return {
    origin: placed(frame, inSpace(holder.translate ?? holder.translation ?? [0, 0, 0])),
    axes: axesOf(holder).map((axis) => unit(carried(frame, axis))),
    scale: frame.scale * factor,
  };
}

/** @param {number[]} axis @param {number} degrees */
const quaternion = (axis, degrees) =>
  [...scale(unit(axis), Math.sin((degrees * DEGREE) / 2)), Math.cos((degrees * DEGREE) / 2)];

/** The turn `b`, and then `a`. @param {number[]} a @param {number[]} b */
function product(a, b) {
  const vector = add(add(scale(b, a[3]), scale(a, b[3])), cross(a, b));
  return [...vector, a[3] * b[3] - dot(a, b)];
}

/** A quaternion as an axis and an angle of at most half a turn; the axis points along the axis of
 * the scene that it is nearest to. @param {number[]} quaternion @param {number[]} fallback the axis
 * of no turn @returns {Turn} */
function turnOf(quaternion, fallback) {
  const way = unit(quaternion.slice(0, 3));
  const sine = norm(quaternion.slice(0, 3));
  if (sine < 1e-9) return { axis: fallback, angle: 0 };
  const longest = way.reduce((most, part) => (Math.abs(part) > Math.abs(most) ? part : most), 0);
  const sign = Math.sign(longest);
  let angle = (2 * Math.atan2(sine, quaternion[3])) / DEGREE;
  if (angle > 180) angle -= 360;
  return { axis: way.map((part) => toDecimals(sign * part, 5)), angle: toDecimals(sign * angle, 1) };
}

/** The turn of a pose or a shape after it was turned further, in the form that it has.
 * @param {any} holder @param {Vector} axis @param {number} degrees @param {number} dimension */
export function turnedBy({ rotate_degrees: turned, rotation }, axis, degrees, dimension) {
  if (isQuaternion(rotation)) {
    return { rotation: product(quaternion(axis, degrees), rotation).map((part) => toDecimals(part, 9)) };
  }
  if (rotation) {
    const columns = axesOf({ rotation }).map((column) => turn(column, axis, degrees * DEGREE));
    const rows = Array.from({ length: dimension }, (_, row) =>
      columns.slice(0, dimension).map((column) => toDecimals(column[row], 9)));
    return { rotation: rows };
  }
  if (dimension === 2) return { rotate_degrees: toDecimals((turned ?? 0) + degrees, 1) };
  const before = quaternion(turned?.axis ?? axis, turned?.angle ?? 0);
  return { rotate_degrees: turnOf(product(quaternion(axis, degrees), before), turned?.axis ?? axis) };
}
