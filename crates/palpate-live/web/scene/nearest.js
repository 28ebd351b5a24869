// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * Which body is nearest, by samples of each body.
 *
 * @typedef {import('../wire.js').Grid} Grid
 */

/** The number that a half float stands for. @param {number} half */
function fromHalf(half) {
  const sign = half & 0x8000 ? -1 : 1;
  const exponent = (half >> 10) & 31;
  const part = (half & 1023) / 1024;
  if (exponent === 0) return sign * part * 2 ** -14;
  if (exponent === 31) return part ? NaN : sign * Infinity;
  return sign * (1 + part) * 2 ** (exponent - 15);
}

/** The numbers that half floats stand for: to find each anew is slow. @type {Float32Array | null} */
let halves = null;

export class Nearest {
  /** @param {Grid} like a grid of as many places */
  constructor(like) {
    const count = like.values.length;
    this.least = new Float32Array(count).fill(Infinity);
    /** At each place the number of the nearest body, and by how much it is nearer than the next. */
    this.grid = { ...like, half: false, values: new Float32Array(2 * count) };
    /** Bodies so far. */
    this.count = 0;
  }

  /** Takes the samples of the next body. @param {Grid} grid */
  take({ values, half }) {
    halves ??= Float32Array.from({ length: 65536 }, (_, bits) => fromHalf(bits));
    const { least, grid: { values: pairs }, count } = this;
    for (let at = 0; at < least.length; at += 1) {
      const value = half ? halves[values[at]] : values[at];
      const nearer = least[at] - value;
      if (nearer > 0) {
        least[at] = value;
        pairs[2 * at] = count;
        pairs[2 * at + 1] = nearer;
      } else {
        pairs[2 * at + 1] = Math.min(pairs[2 * at + 1], -nearer);
      }
    }
    this.count += 1;
  }
}
