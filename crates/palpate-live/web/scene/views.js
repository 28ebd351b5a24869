// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * Names of views: of the scene, along the axes, and steps of the zoom.
 *
 * @typedef {import('./camera.js').Orbit} Orbit
 * @typedef {import('./camera.js').Flat} Flat
 * @typedef {import('./camera.js').Frame} Frame
 * @typedef {import('./setting.js').Setting} Setting
 */

import { state } from '../state.js';
import { FIELD_OF_VIEW } from './camera.js';
import { cornersOf, isWithin } from './setting.js';
import { PLANES, setSlice, slice } from './slice.js';
import { cross, dot, inSpace, subtract } from './vectors.js';

/** A step of the zoom. */
const STEP = 0.8;
/** The picture over the scene's box in it. */
const MARGIN = 1.08;
/** How far a plane is drawn from its origin, over the size of the scene. */
const REACH = 0.5;

/** The plane that is seen along an axis. @type {Record<string, string>} */
const ALONG = { x: 'yz', y: 'xz', z: 'xy' };

export class Views {
  /** @param {Orbit} orbit @param {Flat} flat */
  constructor(orbit, flat) {
    this.orbit = orbit;
    this.flat = flat;
    this.aspect = 1.5;
  }

  /** @param {string} name of a view, or `reset`, `x`, `y`, `z`, `in`, `out`
   * @param {Setting} setting @param {Setting} all with what else there is to see */
  show(name, setting, all) {
    const { orbit, flat } = this;
    if (name === 'in' || name === 'out') {
      const factor = name === 'in' ? STEP : 1 / STEP;
      orbit.height *= factor;
      flat.height *= factor;
      return;
    }
    const view = state.scene?.scene?.views?.find((/** @type {any} */ each) => each.name === name);
    if (view) this.showView(view, setting);
    else if (ALONG[name]) this.lookAlong(ALONG[name], setting);
    else this.reset(setting, all);
  }

  /** @param {Setting} setting @param {Setting} [all] with what else there is to see */
  reset(setting, all = setting) {
    const { orbit, flat } = this;
    orbit.size = setting.size;
    flat.size = setting.size;
    orbit.yaw = 0.6;
    orbit.pitch = 0.42;
    this.fitOrbit(all);
    this.lay(PLANES.xy, setting);
    this.fit(all);
  }

  /** Lays the plane through the middle of the scene. @param {{ right: number[], up: number[] }} axes
   * @param {Setting} setting */
  lay(axes, setting) {
    const origin = setting.dimension === 2 ? [0, 0, 0] : setting.centre;
    setSlice({ frame: { ...axes, origin }, reach: REACH * setting.size });
  }

  /** Fits the scene's box into the map of the plane. @param {Setting} setting */
  fit(setting) {
    const { flat } = this;
    const { frame } = slice;
    flat.frame = frame;
    const [width, height] = extents(setting, [frame.right, frame.up]);
    const from = subtract(setting.centre, frame.origin);
    flat.centre = [dot(from, frame.right), dot(from, frame.up)];
    flat.height = Math.max(height, width / this.aspect) * 1.2;
  }

  /** @param {string} plane @param {Setting} setting */
  lookAlong(plane, setting) {
    this.lay(PLANES[plane], setting);
    this.face();
    this.fitOrbit(setting);
    this.fit(setting);
  }

  /** Fits the scene's box into the picture of space. @param {Setting} setting */
  fitOrbit(setting) {
    const { orbit } = this;
    const { right, up, forward } = orbit.basis();
    orbit.target = setting.centre;
    // What is nearer is larger: for each corner there is a least height at the target with which it is seen.
    orbit.height = Math.max(...cornersOf(setting.box).map((corner) => {
      const [across, above, behind] = [right, up, forward].map((way) => dot(subtract(corner, setting.centre), way));
      const half = Math.max(Math.abs(across) / this.aspect, Math.abs(above)) * MARGIN;
      return 2 * (half - behind * Math.tan(FIELD_OF_VIEW / 2));
    }));
  }

  /** Shows the whole scene, where the viewer of space is in its box. @param {Setting} setting */
  stepOut(setting) {
    if (isWithin(setting.box, this.orbit.basis().eye)) this.fitOrbit(setting);
  }

  /** Turns the camera towards the plane. */
  face() {
    const normal = cross(slice.frame.right, slice.frame.up);
    this.orbit.pitch = Math.asin(Math.max(-1, Math.min(1, normal[1])));
    const isLevel = Math.hypot(normal[0], normal[2]) > 1e-6;
    this.orbit.yaw = isLevel ? Math.atan2(normal[0], normal[2]) : 0;
  }

  /** A view of the scene file. @param {any} view @param {Setting} setting */
  showView(view, setting) {
    const isFree = typeof view.plane === 'object';
    const axes = isFree ? { right: view.plane.right, up: view.plane.up } : PLANES[view.plane ?? 'xy'];
    const normal = cross(axes.right, axes.up);
    const origin = isFree
      ? inSpace(view.plane.origin)
      : normal.map((part) => Math.abs(part) * (view.at ?? 0));
    setSlice({ frame: { ...axes, origin }, reach: REACH * setting.size });
    this.fit(setting);
    // Centres are along the axes of the plane's name, also where the picture looks against one.
    if (view.center) {
      const point = isFree ? null : centreIn(view.plane ?? 'xy', view.center);
      this.flat.centre = point
        ? [dot(subtract(point, origin), axes.right), dot(subtract(point, origin), axes.up)]
        : view.center;
    }
    if (view.width || view.height) {
      this.flat.height = Math.max(view.height ?? 0, (view.width ?? 0) / this.aspect);
    }
    const { frame } = slice;
    this.face();
    this.orbit.target = [0, 1, 2].map((axis) => frame.origin[axis]
      + this.flat.centre[0] * frame.right[axis] + this.flat.centre[1] * frame.up[axis]);
    this.orbit.height = this.flat.height;
  }
}

/** How far the scene's box reaches along directions [m].
 * @param {Setting} setting @param {number[][]} axes */
function extents({ box: { low, high } }, axes) {
  const edges = subtract(high, low);
  return axes.map((axis) => Math.abs(axis[0] * edges[0]) + Math.abs(axis[1] * edges[1]) + Math.abs(axis[2] * edges[2]));
}

/** @param {string} plane @param {number[]} centre */
function centreIn(plane, [first, second]) {
  if (plane === 'xz') return [first, 0, second];
  return plane === 'yz' ? [0, first, second] : [first, second, 0];
}
