// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * Whether the program is heard. A connection that is open says nothing: a program that is stopped
 * or hangs keeps it. A frame whose beat went on is a sign of life; one that is repeated is none, nor
 * is one whose servo ticks on while the program reads no connection, and so no STOP.
 */

import { changed, state } from './state.js';

/** The longest time without a sign of life [ms]: the beat goes on about every 100 ms. A longer one
 * shows old numbers as new ones. */
const LONGEST = 500;
/** The same while the page is hidden and gets one frame a second [ms]. */
const LONGEST_HIDDEN = 2500;
/** Between two looks at the clock [ms]. */
const LOOK = 100;

let heardAt = performance.now();
let lookedAt = heardAt;
let wasLate = false;
/** Whether this connection's frames have a beat. A program without one is heard by each frame. */
let hasBeat = false;
let beat = 0;

function show() {
  document.documentElement.classList.toggle('old', state.unheard !== null || state.connection !== 'live');
  changed('heard');
}

/** Takes a sign of life. */
function takeSign() {
  heardAt = performance.now();
  if (state.unheard === null) return;
  state.unheard = null;
  show();
}

/** Takes a frame, which may be a sign of life. @param {import('./wire.js').Frame} frame */
export function hear(frame) {
  hasBeat ||= frame.beat !== 0;
  const isNew = !hasBeat || frame.beat !== beat;
  ({ beat } = frame);
  if (isNew) takeSign();
}

/** Counts anew: the connection, or what the page may expect, is another one. */
export function countAnew() {
  hasBeat = false;
  takeSign();
  show();
}

function look() {
  const now = performance.now();
  // A page that was busy has not read yet what came meanwhile: it looks once more.
  const isLate = now - lookedAt > 2.5 * LOOK && !wasLate;
  lookedAt = now;
  wasLate = isLate;
  if (state.connection !== 'live' || isLate) return;
  const silence = now - heardAt;
  if (silence <= (document.hidden ? LONGEST_HIDDEN : LONGEST)) return;
  state.unheard = silence;
  show();
}

/** Starts to look whether the program is heard. */
export function startHearing() {
  setInterval(look, LOOK);
  document.addEventListener('visibilitychange', countAnew);
}

/** In words: for how long the program was not heard; empty while it is. */
export function unheardInWords() {
  return state.unheard === null ? '' : `not heard for ${(state.unheard / 1000).toFixed(1)} s`;
}
