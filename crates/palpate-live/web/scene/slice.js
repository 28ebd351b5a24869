// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * The plane that cuts the scene: laid by a view, moved along its normal and turned by handles.
 *
 * @typedef {import('./vectors.js').Vector} Vector
 * @typedef {import('./camera.js').Frame} Frame
 * @typedef {import('./camera.js').Lens} Lens
 * @typedef {'move' | 'turn across' | 'turn above'} Handle
 */

import { along, cross, dot, scale, subtract, turn } from './vectors.js';

/** Where the handles are: along the axes and the normal, over the reach of the plane. */
const TURNS_AT = 0.72;
const MOVES_AT = 0.16;
/** The angle by which a turn is tried [rad], to see which way its handle moves. */
const LIFT = 0.05;

/** Planes along two axes, by their names. @type {Record<string, { right: Vector, up: Vector }>} */
export const PLANES = {
  xy: { right: [1, 0, 0], up: [0, 1, 0] },
  xz: { right: [1, 0, 0], up: [0, 0, -1] },
  yz: { right: [0, 0, -1], up: [0, 1, 0] },
};

export const slice = {
  /** @type {Frame} */
  frame: { origin: [0, 0, 0], right: [1, 0, 0], up: [0, 1, 0] },
  /** How far the plane is drawn from its origin along either axis [m]. */
  reach: 1,
};

/** @type {Set<() => void>} */
const listeners = new Set();

/** Calls `listener` after each change of the plane. @param {() => void} listener */
export function listenSlice(listener) {
  listeners.add(listener);
  return () => listeners.delete(listener);
}

/** @param {Partial<typeof slice>} change */
export function setSlice(change) {
  Object.assign(slice, change);
  listeners.forEach((listener) => listener());
}

/** The plane's unit normal. */
export const normalOf = ({ right, up } = slice.frame) => cross(right, up);

/** Moves the plane along its normal. @param {number} distance [m] */
export function moveSlice(distance) {
  const { frame } = slice;
  setSlice({ frame: { ...frame, origin: along(frame.origin, normalOf(), distance) } });
}

/** Turns the plane about one of its axes. @param {'right' | 'up'} axis
 * @param {number} angle [rad] */
export function turnSlice(axis, angle) {
  const { frame } = slice;
  const about = frame[axis];
  setSlice({
    frame: { ...frame, right: turn(frame.right, about, angle), up: turn(frame.up, about, angle) },
  });
}

/** Where the handles are. @returns {{ handle: Handle, point: Vector }[]} */
export function handles() {
  const { frame: { origin, right, up }, reach } = slice;
  return [
    { handle: 'move', point: along(origin, normalOf(), MOVES_AT * reach) },
    { handle: 'turn across', point: along(origin, right, TURNS_AT * reach) },
    { handle: 'turn above', point: along(origin, up, TURNS_AT * reach) },
  ];
}

/** The four corners of what is drawn of the plane. */
export function corners() {
  const { frame: { origin, right, up }, reach } = slice;
  return [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(([x, y]) =>
    along(along(origin, right, x * reach), up, y * reach));
}

/** Where the ray through a place of the page meets the plane, or null where it does not.
 * @param {Lens} lens @param {number} x @param {number} y @returns {Vector | null} */
export function meet(lens, x, y) {
  const { frame: { origin, right, up }, reach } = slice;
  const { eye, forward } = lens.basis;
  const ray = subtract(lens.at(x, y, along(eye, forward, 1)), eye);
  const t = dot(subtract(origin, eye), normalOf()) / dot(ray, normalOf());
  if (!(t > 0 && Number.isFinite(t))) return null;
  const point = along(eye, ray, t);
  const from = subtract(point, origin);
  return Math.max(Math.abs(dot(from, right)), Math.abs(dot(from, up))) > reach ? null : point;
}

/** Follows a handle that is dragged. @param {Handle} handle @param {Lens} lens
 * @param {number} x @param {number} y @param {number} across @param {number} down by how many
 *   pixels it moved */
export function dragHandle(handle, lens, x, y, across, down) {
  const { frame, reach } = slice;
  const normal = normalOf();
  const here = lens.project(frame.origin);
  const there = lens.project(along(frame.origin, normal, MOVES_AT * reach));
  if (!here || !there) return;
  if (handle === 'move') {
    // Along the normal as it is seen; where it points at the viewer, up and down.
    const [dx, dy] = [there.x - here.x, there.y - here.y];
    const seen = Math.hypot(dx, dy);
    const pixels = seen > 6 ? (across * dx + down * dy) / seen : -down;
    moveSlice((pixels * MOVES_AT * reach) / Math.max(seen, 24));
    return;
  }
  const arm = scale(handle === 'turn across' ? frame.right : frame.up, TURNS_AT * reach);
  const tip = lens.project(along(frame.origin, arm, 1));
  const lifted = lens.project(along(along(frame.origin, arm, 1), normal, LIFT * TURNS_AT * reach));
  if (!tip || !lifted) return;
  const [dx, dy] = [lifted.x - tip.x, lifted.y - tip.y];
  const seen = Math.max(Math.hypot(dx, dy), 3);
  const angle = ((across * dx + down * dy) / seen) * (LIFT / seen);
  turnSlice(handle === 'turn across' ? 'up' : 'right', handle === 'turn across' ? -angle : angle);
}
