// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * Texts of the overlay that do not overlap: those that matter most take their places first, one
 * whose place is taken moves aside with a line to where it belongs, and one that finds no place
 * is left out.
 *
 * @typedef {import('./ink.js').Context} Context
 * @typedef {import('./ink.js').Inks} Inks
 * @typedef {import('./camera.js').Rect} Rect
 * @typedef {{ x: number, y: number, wide: number, high: number }} Taken a place with a text: its
 *   middle and its size in pixels
 * @typedef {{ text: string, x: number, y: number, rank: number, color: string, isFixed: boolean }}
 *   Text one of a low rank takes its place first; one that is fixed is there or nowhere
 */

import { FONT, label, polyline } from './ink.js';

/** The height of a text in pixels, and the room between two. */
export const HIGH = 16;
const ROOM = { across: 5, above: 1 };
/** How far from its place a text has a line to it, in pixels. */
const LINED = 22;
/** Texts that are tried at most. */
const MOST = 160;

/** Where a text is tried: steps of its own size, to its place and around it. */
const TRIES = [[0, 0], [0, -1.1], [0, 1.1], [0.6, -1.1], [-0.6, -1.1], [0.6, 1.1], [-0.6, 1.1], [0.75, 0],
  [-0.75, 0], [0, -2.2], [0, 2.2], [0.8, -2.2], [-0.8, -2.2], [0.8, 2.2], [-0.8, 2.2], [0, -3.4], [0, 3.4],
  [1.3, 0], [-1.3, 0], [1.2, -3.4], [-1.2, -3.4], [1.2, 3.4], [-1.2, 3.4]];

/** The widths of texts in pixels: to measure is slow. @type {Map<string, number>} */
const widths = new Map();

/** @param {Context} context @param {string} text */
export function widthOf(context, text) {
  let width = widths.get(text);
  if (width === undefined) {
    context.font = FONT;
    width = context.measureText(text).width;
    if (widths.size > 2000) widths.clear();
    widths.set(text, width);
  }
  return width;
}

export class Texts {
  /** @param {Context} context @param {Rect} rect within which they are @param {Inks} inks
   * @param {Taken[]} taken where no text may be */
  constructor(context, rect, inks, taken) {
    this.context = context;
    this.rect = rect;
    this.inks = inks;
    this.taken = [...taken];
    /** @type {Text[]} */
    this.waiting = [];
  }

  /** @param {string} text @param {number} x @param {number} y of its middle
   * @param {{ rank: number, color?: string, isFixed?: boolean }} how */
  add(text, x, y, { rank, color = this.inks.ink, isFixed = false }) {
    this.waiting.push({ text, x, y, rank, color, isFixed });
  }

  /** @param {number} x @param {number} y @param {number} wide @param {number} high */
  isFree(x, y, wide, high = HIGH) {
    const { rect, taken } = this;
    const isInside = x - wide / 2 > rect.x + 4 && x + wide / 2 < rect.x + rect.width - 4
      && y - high / 2 > rect.y + 2 && y + high / 2 < rect.y + rect.height - 2;
    return isInside && taken.every((other) => Math.abs(other.x - x) > (other.wide + wide) / 2 + ROOM.across
      || Math.abs(other.y - y) > (other.high + high) / 2 + ROOM.above);
  }

  /** Paints what was added. */
  paint() {
    const { context, inks, waiting } = this;
    const placed = [];
    for (const one of waiting.sort((a, b) => a.rank - b.rank).slice(0, MOST)) {
      const wide = widthOf(context, one.text);
      const tries = one.isFixed ? TRIES.slice(0, 1) : TRIES;
      const way = tries.find(([across, above]) =>
        this.isFree(one.x + across * (wide + 8), one.y + above * HIGH, wide));
      if (!way) continue;
      const [x, y] = [one.x + way[0] * (wide + 8), one.y + way[1] * HIGH];
      this.taken.push({ x, y, wide, high: HIGH });
      placed.push({ ...one, x, y, from: { x: one.x, y: one.y }, wide });
    }
    for (const { x, y, from, wide } of placed) {
      if (Math.hypot(x - from.x, y - from.y) < LINED) continue;
      const near = {
        x: Math.min(Math.max(from.x, x - wide / 2), x + wide / 2),
        y: Math.min(Math.max(from.y, y - HIGH / 2 + 2), y + HIGH / 2 - 2),
      };
      polyline(context, [from, near], inks.muted, 1, inks.halo);
    }
    for (const { text, x, y, color } of placed) label(context, text, x, y, inks, 'center', color);
    this.waiting = [];
  }
}
