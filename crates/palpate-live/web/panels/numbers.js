// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/** Numbers as the page writes them. */

import { boxOf } from '../scene/setting.js';
import { norm, subtract } from '../scene/vectors.js';

/** A number with three digits, as `%.3g` writes it, and a true minus sign.
 * @param {number | null | undefined} value @param {number} [digits] */
export function short(value, digits = 3) {
  if (value === null || value === undefined || Number.isNaN(value)) return '–';
  if (!Number.isFinite(value)) return value > 0 ? '∞' : '−∞';
  return String(Number(value.toPrecision(digits))).replace('-', '−');
}

/** A number for a field that is typed into. @param {number} value */
export function typed(value) {
  return String(Number(value.toPrecision(9)));
}

/** A count with thin gaps. @param {number} value */
export function count(value) {
  return Math.round(value).toString().replace(/\B(?=(\d{3})+$)/g, '\u202f');
}

/** A time in the unit that suits it. @param {number | null | undefined} seconds */
export function time(seconds) {
  if (seconds === null || seconds === undefined || !Number.isFinite(seconds)) return '–';
  const size = Math.abs(seconds);
  if (size < 1e-3) return `${short(seconds * 1e6)} µs`;
  if (size < 1) return `${short(seconds * 1e3)} ms`;
  return `${short(seconds)} s`;
}

/** A time of the servo [s], so fine that one tick is told from the next.
 * @param {number} seconds @param {number} [rate] ticks a second [Hz] */
export function servoTime(seconds, rate = 1000) {
  return `${seconds.toFixed(Math.max(0, Math.ceil(Math.log10(rate))))} s`;
}

/** The size of the scene [m]: the diagonal of its bounds; 1 if it has none.
 * @param {any} bounds */
export function extent(bounds) {
  const box = boxOf(bounds);
  return (box && norm(subtract(box.high, box.low))) || 1;
}
