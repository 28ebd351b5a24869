// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * The hand that the page leads: the newest target, sent no more often than the program takes it.
 *
 * @typedef {import('../wire.js').Wire} Wire
 * @typedef {import('../scene/vectors.js').Vector} Vector
 */

import { mean } from '../scene/vectors.js';
import { state } from '../state.js';

/** The least time between two targets [ms]. The program takes 120 messages a second, and probes,
 * slices and edits want their share. */
const PAUSE = 1000 / 80;

/** The middle of the device points, or null without any. @returns {Vector | null} */
export function handOf() {
  const points = state.frame?.points ?? [];
  return points.length > 0 ? mean(points.map(({ device }) => device)) : null;
}

/** Where the hand is led from: the point that leads, or the middle of all. @returns {Vector | null} */
export function ledPlace() {
  return state.frame?.points[state.touch.point ?? -1]?.device ?? handOf();
}

/** The hand, of which a page has one: pointer, keys and gamepads lead it. @param {Wire} wire */
export function createHand(wire) {
  /** @type {Vector | null} */
  let target = null;
  let sentAt = -Infinity;
  let timer = 0;
  /** Where the hand was led last. @type {Vector} */
  let last = [0, 0, 0];
  let isHeld = false;
  /** From where a hand comes that is not held yet. @type {Vector | null} */
  let from = null;

  function send(held = true) {
    timer = 0;
    if (held && !target) return;
    last = target ?? last;
    target = null;
    sentAt = performance.now();
    const { point } = state.touch;
    const dimension = state.scene?.dimension ?? 3;
    const place = { target: last.slice(0, dimension), ...(point === null ? {} : { point }) };
    wire.send({ do: 'hand', ...place, ...(from ? { from: from.slice(0, dimension) } : {}), held });
    from = null;
  }

  return {
    /** Leads the hand to a point; a hand that is not held comes from `begin`, if that is given.
     * @param {Vector} point @param {Vector | null} [begin] */
    lead(point, begin = null) {
      if (!isHeld) from = begin;
      isHeld = true;
      target = point;
      const wait = sentAt + PAUSE - performance.now();
      if (wait <= 0) send();
      else if (timer === 0) timer = window.setTimeout(() => send(), wait);
    },

    isHeld: () => isHeld,

    /** Lets go of the hand, where it was led last. */
    release() {
      if (!isHeld) return;
      isHeld = false;
      clearTimeout(timer);
      send(false);
    },
  };
}
