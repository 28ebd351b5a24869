// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * Cameras, and lenses: a camera over a rectangle of the page. A lens knows where a point is
 * seen, and which points are seen at a place.
 *
 * @typedef {import('./vectors.js').Vector} Vector
 * @typedef {{ x: number, y: number, width: number, height: number }} Rect in CSS pixels
 * @typedef {{ origin: Vector, right: Vector, up: Vector }} Frame a plane in space
 * @typedef {{ eye: Vector, right: Vector, up: Vector, forward: Vector }} Basis
 * @typedef {object} Lens
 * @property {Rect} rect
 * @property {(point: Vector) => { x: number, y: number, depth: number } | null} project
 * @property {(x: number, y: number, through: Vector) => Vector} at the point seen at a place, on
 *   the plane through a point that is parallel to the screen
 * @property {(point: Vector) => number} pixel the size of a pixel at a point [m]
 * @property {(point: Vector) => Vector} towards the unit vector from a point to the viewer
 * @property {Basis} basis
 */

import { add, along, clamp, cross, dot, scale, subtract } from './vectors.js';

/** Of the height of the picture [rad]. */
export const FIELD_OF_VIEW = (38 * Math.PI) / 180;
const TANGENT = Math.tan(FIELD_OF_VIEW / 2);
/** The least height of a picture over the size of the scene. Values in single precision are off
 * by 2e-7 of that size: nearer by, normals from differences are noise. */
const NEAREST = { orbit: 0.02, flat: 0.002 };
const FARTHEST = 20;

/** A camera that looks at a point from all around it. y is up. */
export class Orbit {
  constructor() {
    /** @type {Vector} */
    this.target = [0, 0, 0];
    this.yaw = 0.6;
    this.pitch = 0.42;
    this.distance = 1;
    this.size = 1;
  }

  /** @returns {Basis} */
  basis() {
    const [sin, cos] = [Math.sin(this.yaw), Math.cos(this.yaw)];
    const [rise, level] = [Math.sin(this.pitch), Math.cos(this.pitch)];
    const forward = [-sin * level, -rise, -cos * level];
    const right = [cos, 0, -sin];
    const eye = along(this.target, forward, -this.distance);
    return { eye, right, up: cross(right, forward), forward };
  }

  /** The height of what is seen at the target [m]. */
  get height() {
    return 2 * TANGENT * this.distance;
  }

  set height(height) {
    this.distance = clamp(height, NEAREST.orbit * this.size, FARTHEST * this.size) / (2 * TANGENT);
  }

  /** @param {number} across @param {number} down the angles [rad] */
  turn(across, down) {
    this.yaw -= across;
    this.pitch = clamp(this.pitch + down, -Math.PI / 2, Math.PI / 2);
  }

  /** Moves what is seen by pixels. @param {number} x @param {number} y @param {Rect} rect */
  pan(x, y, rect) {
    const { right, up } = this.basis();
    const pixel = this.height / rect.height;
    this.target = along(along(this.target, right, -x * pixel), up, y * pixel);
  }

  /** Zooms, and keeps what is seen at a place where it is.
   * @param {number} factor @param {number} x @param {number} y @param {Rect} rect */
  zoom(factor, x, y, rect) {
    const before = this.lens(rect).at(x, y, this.target);
    this.height *= factor;
    const after = this.lens(rect).at(x, y, this.target);
    this.target = add(this.target, subtract(before, after));
  }

  /** @param {Rect} rect @returns {Lens} */
  lens(rect) {
    const basis = this.basis();
    const { eye, right, up, forward } = basis;
    const focal = rect.height / 2 / TANGENT;
    const [middleX, middleY] = [rect.x + rect.width / 2, rect.y + rect.height / 2];
    return {
      rect,
      basis,
      project(point) {
        const from = subtract(point, eye);
        const depth = dot(from, forward);
        if (depth <= 0) return null;
        const [x, y] = [dot(from, right), dot(from, up)].map((part) => (part / depth) * focal);
        return { x: middleX + x, y: middleY - y, depth };
      },
      at(x, y, through) {
        const depth = dot(subtract(through, eye), forward);
        const ray = along(along(forward, right, (x - middleX) / focal), up, (middleY - y) / focal);
        return along(eye, ray, depth);
      },
      pixel: (point) => Math.max(dot(subtract(point, eye), forward), 0) / focal,
      towards: (point) => scale(subtract(eye, point), 1 / Math.hypot(...subtract(eye, point))),
    };
  }
}

/** A camera that looks straight at a plane. */
export class Flat {
  constructor() {
    /** @type {Frame} */
    this.frame = { origin: [0, 0, 0], right: [1, 0, 0], up: [0, 1, 0] };
    /** What is seen in the middle, in the plane [m]. */
    this.centre = [0, 0];
    this.seen = 1;
    this.size = 1;
  }

  /** The height of what is seen [m]. */
  get height() {
    return this.seen;
  }

  set height(height) {
    this.seen = clamp(height, NEAREST.flat * this.size, FARTHEST * this.size);
  }

  /** @param {number} x @param {number} y @param {Rect} rect */
  pan(x, y, rect) {
    const pixel = this.seen / rect.height;
    this.centre = [this.centre[0] - x * pixel, this.centre[1] + y * pixel];
  }

  /** @param {number} factor @param {number} x @param {number} y @param {Rect} rect */
  zoom(factor, x, y, rect) {
    const before = this.seen / rect.height;
    this.height *= factor;
    const change = before - this.seen / rect.height;
    this.centre = [
      this.centre[0] + (x - rect.x - rect.width / 2) * change,
      this.centre[1] - (y - rect.y - rect.height / 2) * change,
    ];
  }

  /** @param {Rect} rect @returns {Lens} */
  lens(rect) {
    const { origin, right, up } = this.frame;
    const forward = cross(up, right);
    const pixel = this.seen / rect.height;
    const [middleX, middleY] = [rect.x + rect.width / 2, rect.y + rect.height / 2];
    const centre = along(along(origin, right, this.centre[0]), up, this.centre[1]);
    const away = 10 * this.size;
    const eye = along(centre, forward, -away);
    return {
      rect,
      basis: { eye, right, up, forward },
      project(point) {
        const from = subtract(point, centre);
        return {
          x: middleX + dot(from, right) / pixel,
          y: middleY - dot(from, up) / pixel,
          depth: dot(from, forward) + away,
        };
      },
      at(x, y, through) {
        const depth = dot(subtract(through, centre), forward);
        const [across, above] = [(x - middleX) * pixel, (middleY - y) * pixel];
        return along(along(along(centre, right, across), up, above), forward, depth);
      },
      pixel: () => pixel,
      towards: () => scale(forward, -1),
    };
  }
}
