// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * Mouse, pen and fingers on the stage, as drags, zooms and hovering.
 *
 * A drag that is lost in any way ends: by a cancelled pointer, a window that loses the focus, or
 * a connection that is lost.
 *
 * @typedef {{ x: number, y: number }} Place in CSS pixels of the stage
 * @typedef {{ button: number, shift: boolean, isTouch: boolean }} Press
 * @typedef {object} Drag
 * @property {(place: Place, across: number, down: number) => void} move with the way in pixels
 *   since the last time
 * @property {() => void} [end]
 * @property {(steps: number) => void} [deepen] moves away from the viewer, or with negative steps
 *   towards the viewer
 * @typedef {object} Handlers
 * @property {(place: Place, press: Press) => Drag | null} press
 * @property {(place: Place | null) => void} hover
 * @property {(place: Place, factor: number) => void} zoom
 * @property {(place: Place, across: number, down: number) => void} pan
 */

import { listen, state } from '../state.js';

/** The factor of the zoom for each pixel of a wheel. */
const WHEEL = 0.0015;
/** Pixels of a wheel, or of a second finger, for a step of depth. */
const STEP = 60;

/** The drag that goes on. @type {Drag | null} */
let drag = null;

/** Whether the pointer leads the hand, whose depth keys may change too. */
export const isLeading = () => drag?.deepen !== undefined;

/** Moves the hand that the pointer leads away from the viewer, or with negative steps towards the
 * viewer. @param {number} steps */
export const deepen = (steps) => drag?.deepen?.(steps);

/** @param {HTMLElement} element @param {Handlers} handlers */
export function createPointer(element, handlers) {
  element.style.touchAction = 'none';
  /** @type {Map<number, Place>} */
  const pressed = new Map();
  let leader = -1;

  /** @param {MouseEvent} event @returns {Place} */
  const placeOf = (event) => {
    const { left, top } = element.getBoundingClientRect();
    return { x: event.clientX - left, y: event.clientY - top };
  };

  function end() {
    const ended = drag;
    drag = null;
    leader = -1;
    ended?.end?.();
  }

  /** Two fingers: where they are, and how far apart. */
  function pinch() {
    const [a, b] = [...pressed.values()];
    return { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, apart: Math.hypot(a.x - b.x, a.y - b.y) };
  }

  element.addEventListener('pointerdown', (event) => {
    element.setPointerCapture(event.pointerId);
    const place = placeOf(event);
    pressed.set(event.pointerId, place);
    if (pressed.size === 1) {
      leader = event.pointerId;
      handlers.hover(null);
      const { button, shiftKey: shift, pointerType } = event;
      drag = handlers.press(place, { button, shift, isTouch: pointerType === 'touch' });
    } else if (!drag?.deepen) {
      // The second finger begins a pinch.
      end();
    }
  });

  element.addEventListener('pointermove', (event) => {
    const place = placeOf(event);
    const last = pressed.get(event.pointerId);
    if (!last) {
      handlers.hover(place);
      return;
    }
    if (pressed.size >= 2 && !drag) {
      const before = pinch();
      pressed.set(event.pointerId, place);
      const after = pinch();
      handlers.pan(after, after.x - before.x, after.y - before.y);
      if (after.apart > 0) handlers.zoom(after, before.apart / after.apart);
      return;
    }
    pressed.set(event.pointerId, place);
    if (event.pointerId === leader) drag?.move(place, place.x - last.x, place.y - last.y);
    else drag?.deepen?.((last.y - place.y) / STEP);
  });

  const lift = (/** @type {PointerEvent} */ event) => {
    pressed.delete(event.pointerId);
    if (event.pointerId === leader) end();
  };
  element.addEventListener('pointerup', lift);
  element.addEventListener('pointercancel', lift);
  element.addEventListener('lostpointercapture', lift);
  element.addEventListener('pointerleave', () => handlers.hover(null));
  element.addEventListener('contextmenu', (event) => event.preventDefault());
  element.addEventListener('wheel', (event) => {
    event.preventDefault();
    const pixels = event.deltaY * (event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 30 : 1);
    if (drag?.deepen) drag.deepen(-pixels / STEP);
    else handlers.zoom(placeOf(event), Math.exp(pixels * WHEEL));
  }, { passive: false });
  window.addEventListener('blur', end);
  listen(['connection'], () => {
    if (state.connection !== 'live') end();
  });
}
