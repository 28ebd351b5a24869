// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * What a press on the stage takes hold of: a toy, a handle of the slice or of the selected part, the
 * hand, the surface, or, beside them all, the camera.
 *
 * @typedef {import('../input/pointer.js').Place} Place
 * @typedef {import('../input/pointer.js').Press} Press
 * @typedef {import('../input/pointer.js').Drag} Drag
 * @typedef {import('./panels.js').View} View
 * @typedef {import('./vectors.js').Vector} Vector
 * @typedef {object} Stage
 * @property {{ orbit: import('./camera.js').Orbit, flat: import('./camera.js').Flat }} cameras
 * @property {ReturnType<typeof import('../input/hand.js').createHand>} hand
 * @property {(place: Place) => View | undefined} view
 * @property {(view: View, place: Place) => Promise<{ point: Vector } | null>} pick
 * @property {(key: string) => boolean} hides whether a mark lies behind a body
 * @property {(view: View, place: Place) => void} click
 * @property {() => void} changed
 * @property {(target: Vector | null) => void} show
 */

import { ledPlace } from '../input/hand.js';
import { fallDrag } from '../plane/falling.js';
import { toyDrag } from '../plane/handles.js';
import { state } from '../state.js';
import { handDrag, laterDrag, orbitDrag, panDrag, sliceDrag } from './drags.js';
import { gripAt } from './grips.js';
import { MIDDLE, keyOfPoint } from './overlay.js';
import { handles } from './slice.js';

/** How near a press must be in pixels, of a mouse or pen and of a finger. */
export const REACH = { mouse: 16, touch: 28 };
/** A press that moves less than this is a click, in pixels. */
const CLICK = 5;
/** A press on a body that lasts longer than this touches it [ms]. */
const HOLD = 220;

/** A drag that begins once the pointer has moved, or, if `holds`, rested pressed for a while;
 * before, a click. @param {Place} place @param {() => Drag | null} begin @param {() => void} click
 * @param {boolean} holds @returns {Drag} */
function clickOrDrag(place, begin, click, holds) {
  /** @type {Drag | null} */
  let drag = null;
  let isBegun = false;
  /** @type {Drag} */
  const either = {
    move(next, across, down) {
      if (!isBegun && Math.hypot(next.x - place.x, next.y - place.y) > CLICK) start();
      drag?.move(next, across, down);
    },
    end() {
      clearTimeout(timer);
      if (isBegun) drag?.end?.();
      else click();
    },
    get deepen() {
      return drag?.deepen?.bind(drag);
    },
  };
  const start = () => {
    isBegun = true;
    clearTimeout(timer);
    drag = begin();
  };
  const timer = holds ? setTimeout(start, HOLD) : undefined;
  return either;
}

/** @param {Stage} stage @returns {(place: Place, press: Press) => Drag | null} */
export function createPress({ cameras, hand, view, pick, hides, click, changed, show }) {
  return (place, { button, shift, isTouch }) => {
    const pressed = view(place);
    if (!pressed) return null;
    const { lens, isFlat, isWhole } = pressed;
    const live = () => view(place) ?? pressed;
    const camera = isFlat ? cameras.flat : cameras.orbit;
    if (button === 1 || shift || (button === 2 && isFlat)) return panDrag(camera, lens.rect, changed);
    if (button === 2) return orbitDrag(cameras.orbit, changed);
    const reach = isTouch ? REACH.touch : REACH.mouse;
    const apart = (/** @type {Vector} */ point) => {
      const seen = lens.project(point);
      return seen ? Math.hypot(seen.x - place.x, seen.y - place.y) : Infinity;
    };
    if (isFlat && isWhole && state.scene?.dimension === 2) {
      const toy = toyDrag(() => live().lens, place, reach);
      if (toy) return toy;
    }
    const ball = isWhole ? fallDrag(() => live().lens, place, reach) : null;
    if (ball) return ball;
    if (state.view.mode === 'slice' && !isFlat) {
      const found = handles().find(({ point }) => apart(point) < reach);
      if (found) return sliceDrag(found.handle, () => live().lens);
    }
    const led = ledPlace();
    const holds = (state.frame?.points ?? []).map(({ device }, number) =>
      ({ apart: apart(device), isHidden: hides(keyOfPoint(number)) }));
    if (led && holds.length > 1 && state.touch.point === null) holds.push({ apart: apart(led), isHidden: hides(MIDDLE) });
    const nearest = (/** @type {typeof holds} */ some) => Math.min(...some.map((hold) => hold.apart));
    const toHand = nearest(holds.filter(({ isHidden }) => !isHidden));
    const grip = isWhole ? gripAt(() => live().lens, isFlat, place, reach) : null;
    const away = () => (isFlat ? panDrag(camera, lens.rect, changed) : orbitDrag(cameras.orbit, changed));
    const clicks = () => click(live(), place);
    // The hand is held where it is nearer than a handle.
    if (grip && grip.apart < toHand) return clickOrDrag(place, grip.begin, clicks, false);
    if (!led || !isWhole) return clickOrDrag(place, away, clicks, false);
    const lead = (/** @type {Vector} */ through, /** @type {boolean} */ pushes) =>
      handDrag(live, place, through, pushes, hand, show);
    if (toHand < reach) return lead(led, false);
    if (isFlat) {
      const there = lens.at(place.x, place.y, led);
      return clickOrDrag(place, () => lead(there, false), clicks, true);
    }
    // A body in front of the hand is touched; beside the body, the hand is held that is behind it.
    const beside = () => (nearest(holds) < reach ? lead(led, false) : away());
    const hit = pick(pressed, place);
    return clickOrDrag(place, () => laterDrag(hit.then((found) => (found ? lead(found.point, true) : beside()))),
      clicks, true);
  };
}
