// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * Vectors of three numbers. A point in the plane has a third coordinate of zero.
 *
 * @typedef {number[]} Vector
 */

/** The axes of the scene. @type {Vector[]} */
export const AXES = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];

/** @param {Vector} a @param {Vector} b @returns {Vector} */
export const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];

/** @param {Vector} a @param {Vector} b @returns {Vector} */
export const subtract = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];

/** @param {Vector} a @param {number} factor @returns {Vector} */
export const scale = (a, factor) => [a[0] * factor, a[1] * factor, a[2] * factor];

/** a + factor·b. @param {Vector} a @param {Vector} b @param {number} factor @returns {Vector} */
export const along = (a, b, factor) => add(a, scale(b, factor));

/** @param {Vector} a @param {Vector} b */
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

/** @param {Vector} a @param {Vector} b @returns {Vector} */
export const cross = (a, b) => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];

/** @param {Vector} a */
export const norm = (a) => Math.hypot(a[0], a[1], a[2]);

/** The unit vector along `a`, or zero. @param {Vector} a @returns {Vector} */
export const unit = (a) => scale(a, 1 / (norm(a) || 1));

/** @param {Vector} a @param {Vector} b @returns {Vector} */
export const middle = (a, b) => scale(add(a, b), 0.5);

/** The mean of points, or zero. @param {Vector[]} points @returns {Vector} */
export const mean = (points) => scale(points.reduce(add, [0, 0, 0]), 1 / (points.length || 1));

/** `a` turned about the unit vector `axis` by `angle` [rad].
 * @param {Vector} a @param {Vector} axis @param {number} angle @returns {Vector} */
export function turn(a, axis, angle) {
  const cosine = Math.cos(angle);
  const turned = along(scale(a, cosine), cross(axis, a), Math.sin(angle));
  return along(turned, axis, dot(axis, a) * (1 - cosine));
}

/** A point with three coordinates. @param {number[]} point @returns {Vector} */
export const inSpace = (point) => [point[0], point[1], point[2] ?? 0];

/** The function that moves points as a pose does. @param {{ rotation: number[][], translation: number[] }} pose
 * @returns {(point: Vector) => Vector} */
export const placedBy = ({ rotation, translation }) => (point) =>
  add(inSpace(rotation.map((row) => dot(inSpace(row), point))), inSpace(translation));

/** A number to so many decimal places; zero has no sign. @param {number} value @param {number} decimals */
export const toDecimals = (value, decimals) => Number(value.toFixed(decimals)) + 0;

/** A point to the decimal place that is just below a pixel: what a pointer means, and no more.
 * @param {number[]} point @param {number} pixel its size [m] */
export function rounded(point, pixel) {
  const decimals = Math.min(Math.max(Math.ceil(-Math.log10(pixel)), 0), 12);
  return point.map((part) => toDecimals(part, decimals));
}

/** @param {number} value @param {number} low @param {number} high */
export const clamp = (value, low, high) => Math.min(Math.max(value, low), high);
