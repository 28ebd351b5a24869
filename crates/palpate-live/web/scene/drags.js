// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * What a press on the stage drags: the camera, the plane of the slice or the hand.
 *
 * @typedef {import('../input/pointer.js').Drag} Drag
 * @typedef {import('../input/pointer.js').Place} Place
 * @typedef {import('./camera.js').Lens} Lens
 * @typedef {import('./panels.js').View} View
 * @typedef {import('./vectors.js').Vector} Vector
 */

import { dragHandle } from './slice.js';
import { along, scale } from './vectors.js';

/** An angle for each pixel [rad]. */
const TURN = 0.0075;
/** How far a press on the surface pushes inwards for each pixel of the drag, in pixels. */
const PUSH = 0.5;
/** The hand is set down on the line of sight, this share of the way from the pressed point to the eye. */
const NEAR = 0.1;
/** A step of depth in pixels of the place. */
const DEPTH = 10;

/** @param {import('./camera.js').Orbit} orbit @param {() => void} changed @returns {Drag} */
export const orbitDrag = (orbit, changed) => ({
  move(_place, across, down) {
    orbit.turn(across * TURN, down * TURN);
    changed();
  },
});

/** @param {import('./camera.js').Orbit | import('./camera.js').Flat} camera
 * @param {import('./camera.js').Rect} rect @param {() => void} changed @returns {Drag} */
export const panDrag = (camera, rect, changed) => ({
  move(_place, across, down) {
    camera.pan(across, down, rect);
    changed();
  },
});

/** @param {import('./slice.js').Handle} handle @param {() => Lens} lens @returns {Drag} */
export const sliceDrag = (handle, lens) => ({
  move(place, across, down) {
    dragHandle(handle, lens(), place.x, place.y, across, down);
  },
});

/** Leads the hand on the plane through a point that is parallel to the screen.
 * @param {() => View} view @param {Place} place where the pointer was pressed
 * @param {Vector} through @param {boolean} pushes whether the drag pushes away from the viewer,
 *   as on a surface
 * @param {{ lead: (target: Vector, begin?: Vector | null) => void, release: () => void }} hand
 * @param {(target: Vector | null) => void} show @returns {Drag} */
export function handDrag(view, place, through, pushes, hand, show) {
  let here = place;
  let depth = 0;
  // The hand does not jump when it is pressed beside its middle.
  const seen = view().lens.project(through);
  const [offX, offY] = pushes || !seen ? [0, 0] : [seen.x - place.x, seen.y - place.y];
  const lead = () => {
    const { lens, isFlat } = view();
    const plain = lens.at(here.x + offX, here.y + offY, through);
    const pixel = lens.pixel(through);
    const pressed = pushes && !isFlat
      ? PUSH * Math.hypot(here.x - place.x, here.y - place.y) : 0;
    const inwards = isFlat ? [0, 0, 0] : scale(lens.towards(plain), -1);
    const target = along(plain, inwards, (pressed + DEPTH * depth) * pixel);
    // A hand elsewhere is set down on the line of sight, on which nothing is in between.
    const { eye } = lens.basis;
    const begin = pushes && !isFlat ? [0, 1, 2].map((axis) => plain[axis] + NEAR * (eye[axis] - plain[axis])) : null;
    hand.lead(target, begin);
    show(target);
  };
  // A hand that keys hold may be elsewhere: the pointer takes hold of it anew.
  hand.release();
  lead();
  return {
    move(next) {
      here = next;
      lead();
    },
    deepen(steps) {
      depth += steps;
      lead();
    },
    end() {
      hand.release();
      show(null);
    },
  };
}

/** A drag that is known only later: what moved meanwhile is made up for. Depth is changed from
 * then on. @param {Promise<Drag | null>} promise @returns {Drag} */
export function laterDrag(promise) {
  /** @type {Drag | null} */
  let drag = null;
  let isEnded = false;
  /** @type {Place | null} */
  let last = null;
  let [wayX, wayY] = [0, 0];
  /** @type {Drag} */
  const later = {
    move(place, across, down) {
      if (drag) {
        drag.move(place, across, down);
        return;
      }
      last = place;
      wayX += across;
      wayY += down;
    },
    end() {
      isEnded = true;
      drag?.end?.();
    },
  };
  promise.then((found) => {
    if (!found) return;
    drag = found;
    if (last) drag.move(last, wayX, wayY);
    if (isEnded) drag.end?.();
    else later.deepen = found.deepen?.bind(found);
  });
  return later;
}
