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
import { along, norm, subtract } from '../scene/vectors.js';
import { listen, state } from '../state.js';
import { ledPlace } from './hand.js';
import { isLeading } from './pointer.js';

/** The time that the hand takes across the scene at full speed [s]. */
const CROSSING = 3;
/** How far one key press moves the hand, over the scene's size. */
const NUDGE = 1 / 250;
/** How far ahead of the device the target may be, so that a reversed key lifts the hand off a body at once,
 * over the scene's size. */
const FARTHEST = 1 / 20;
/** The longest time between two frames that counts [s]: after a pause the hand does not jump. */
const LONGEST = 0.05;

/** Where keys or a gamepad lead the hand; null while they do not. @type {number[] | null} */
let target = null;
let last = 0;

/** Moves the hand by so much of the scene's size: to the right, up, and away.
 * @param {number[]} parts @param {Axes} axes */
function move(parts, axes) {
  const { scene } = state;
  const at = ledPlace();
  if (isLeading() || !at || !scene) return;
  const size = extent(scene.bounds);
  const ways = [axes.right, axes.up, axes.away].slice(0, scene.dimension);
  const from = page.stage?.hand.isHeld() ? target ?? at : at;
  const next = ways.reduce((place, way, index) => along(place, way, size * parts[index]), from);
  const way = subtract(next, at);
  target = along(at, way, Math.min(1, (FARTHEST * size) / (norm(way) || 1)));
  page.stage?.lead(target);
}

/** Moves the hand by a step. @param {number[]} ways to the right, up, and away @param {Axes} axes */
export function nudge(ways, axes) {
  move(ways.map((way) => NUDGE * way), axes);
}

/** Moves the hand on for a frame. `speeds` are from −1 to 1: to the right, up, and away.
 * @param {number[]} speeds @param {Axes} axes */
export function push(speeds, axes) {
  const now = performance.now();
  const seconds = Math.min((now - last) / 1000, LONGEST);
  last = now;
  move(speeds.map((speed) => (speed * seconds) / CROSSING), axes);
}

/** Whether keys or a gamepad hold the hand. */
export const isSteering = () => target !== null && !isLeading() && (page.stage?.hand.isHeld() ?? false);

/** Lets go of the hand, unless the pointer has taken it. */
export function letGo() {
  if (isSteering()) page.stage?.lead(null);
  target = null;
}

/** Lets go of the hand where it cannot be led on: in another scene, and without a program. */
export function startSteering() {
  let opened = 0;
  listen(['scene', 'connection'], () => {
    if (state.connection !== 'live' || state.opened !== opened) letGo();
    opened = state.opened;
  });
}

/** The axes of the picture. @returns {Axes} */
export function axesSeen() {
  return page.stage?.axes() ?? { right: [1, 0, 0], up: [0, 1, 0], away: [0, 0, -1] };
}
