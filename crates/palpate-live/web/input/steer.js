// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * The hand as keys and gamepads lead it: a target that moves at a speed.
 *
 * @typedef {{ right: number[], up: number[], away: number[] }} Axes unit vectors in space
 */

import { extent } from '../panels/numbers.js';
import { page } from '../panels/page.js';
import { state } from '../state.js';
import { ledPlace } from './hand.js';
import { isLeading } from './pointer.js';

/** The time that the hand takes across the scene at full speed [s]. */
const CROSSING = 3;
/** The longest time between two frames that counts [s]: after a pause the hand does not jump. */
const LONGEST = 0.05;

/** Where keys or a gamepad lead the hand; null while they do not. @type {number[] | null} */
let target = null;
let last = 0;

/** Moves the hand on for a frame. `speeds` are from −1 to 1: to the right, up, and away.
 * @param {number[]} speeds @param {Axes} axes */
export function push(speeds, axes) {
  const now = performance.now();
  const seconds = Math.min((now - last) / 1000, LONGEST);
  last = now;
  target = isLeading() ? null : target ?? ledPlace()?.slice() ?? null;
  if (!target || !state.scene) return;
  const reach = (extent(state.scene.bounds) / CROSSING) * seconds;
  const ways = [axes.right, axes.up, axes.away];
  for (const axis of [0, 1, 2]) {
    target[axis] += reach * ways.reduce((sum, way, index) => sum + way[axis] * speeds[index], 0);
  }
  page.stage?.hand.lead([...target]);
}

/** Lets go of the hand, unless the pointer has taken it. */
export function letGo() {
  if (target && !isLeading()) page.stage?.hand.release();
  target = null;
}

/** The axes of the picture. @returns {Axes} */
export function axesSeen() {
  return page.stage?.axes() ?? { right: [1, 0, 0], up: [0, 1, 0], away: [0, 0, -1] };
}
