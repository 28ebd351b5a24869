// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * A gamepad leads the hand and shakes with the force; a telephone shakes at events.
 */

import { axesSeen, isSteering, letGo, push } from './steer.js';
import { listen, state } from '../state.js';

/** Sticks that are nearer to their middle rest. */
const DEAD = 0.12;
/** How long a rumble is [ms]; it is renewed before it ends. */
const RUMBLE = 100;
const RENEW = 80;
/** The level above which a small motor turns at all. */
const LEAST_LEVEL = 0.02;

/** @returns {Gamepad | null} */
export function firstPad() {
  return [...(navigator.getGamepads?.() ?? [])].find((pad) => pad?.connected) ?? null;
}

/** @param {number} value */
function alive(value) {
  const size = Math.abs(value);
  return size < DEAD ? 0 : (Math.sign(value) * (size - DEAD)) / (1 - DEAD);
}

/** The force as a part of the largest; of a program that is not heard nothing is felt. */
export function level() {
  if (state.connection !== 'live' || state.unheard !== null) return 0;
  const largest = state.scene?.device?.max_force ?? 10;
  return Math.min((state.frame?.force ?? 0) / largest, 1);
}

/** Starts to read gamepads and to shake what can shake. */
export function startGamepad() {
  let isLeading = false;
  let rumbled = 0;

  const read = () => {
    requestAnimationFrame(read);
    isLeading &&= isSteering();
    const pad = firstPad();
    if (!pad) {
      if (isLeading) letGo();
      isLeading = false;
      return;
    }
    rumble(pad);
    if (state.touch.input !== 'gamepad' || state.lookingAt !== null) return;
    const depth = (pad.buttons[7]?.value ?? 0) - (pad.buttons[6]?.value ?? 0);
    const speeds = [alive(pad.axes[0] ?? 0), -alive(pad.axes[1] ?? 0), depth];
    const isMoved = speeds.some((speed) => speed !== 0);
    // The hand stays held at rest until the pad is left: a press goes on pressing.
    if (isMoved || isLeading) push(speeds, axesSeen());
    isLeading ||= isMoved;
    if (isLeading && pad.buttons[1]?.pressed) {
      letGo();
      isLeading = false;
    }
  };

  const rumble = (/** @type {Gamepad} */ pad) => {
    const now = performance.now();
    if (!state.touch.rumble || now - rumbled < RENEW) return;
    const strong = state.frame?.stopped ? 0 : level();
    const weak = state.frame?.points.some((point) => point.slipping) ? 0.3 : 0;
    if (Math.max(strong, weak) < LEAST_LEVEL) return;
    rumbled = now;
    void pad.vibrationActuator?.playEffect('dual-rumble', {
      duration: RUMBLE, strongMagnitude: strong, weakMagnitude: weak,
    });
  };

  // A browser refuses to shake before the page was touched, and says so in its console.
  const shake = (/** @type {number} */ time) => {
    if (state.touch.vibration && navigator.userActivation?.hasBeenActive) navigator.vibrate?.(time);
  };
  let heard = 0;
  listen(['events'], () => {
    const fresh = state.events.filter((event) => event.number > heard);
    heard = fresh[fresh.length - 1]?.number ?? heard;
    if (fresh.some((event) => /touch|pop/i.test(event.kind))) shake(25);
    else if (fresh.some((event) => /slip/i.test(event.kind))) shake(8);
  });
  requestAnimationFrame(read);
  listen(['touch'], () => {
    if (state.touch.input !== 'gamepad' && isLeading) {
      letGo();
      isLeading = false;
    }
  });
}
