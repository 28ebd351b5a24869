// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * Numbers on isolines. The program answers a coarse grid of the plane; crossings of the lines are
 * found along a few rows and columns of it, and those are shown that do not overlap.
 *
 * @typedef {import('../wire.js').Wire} Wire
 * @typedef {import('./panels.js').View} View
 * @typedef {import('./vectors.js').Vector} Vector
 * @typedef {import('./camera.js').Frame} Frame
 * @typedef {{ point: Vector, text: string, rank: number }} Label
 */

import { state } from '../state.js';
import { label } from './ink.js';
import { asking, newest } from './newest.js';
import { slice } from './slice.js';
import { HIGH, widthOf } from './texts.js';
import { add, along } from './vectors.js';
import { level } from './units.js';

const CELLS = 64;
/** Rows and columns that are searched, as parts of the grid. */
const SCANS = [0.5, 0.25, 0.75, 0.375, 0.625, 0.12, 0.88];
/** Labels of the same level keep this far apart in pixels. */
const APART = 190;
/** How long the picture stands still before labels are searched [ms]. */
const STILL = 180;
/** Labels of a view at most. */
const MOST = 60;

/** The window of the plane that a view shows.
 * @param {View} view @param {import('./camera.js').Flat} flat
 * @returns {{ frame: Frame, width: number, height: number }} */
export function windowOf(view, flat) {
  if (!view.isFlat) return { frame: slice.frame, width: 2 * slice.reach, height: 2 * slice.reach };
  const { frame, centre, height } = flat;
  const { rect } = view.lens;
  const origin = along(along(frame.origin, frame.right, centre[0]), frame.up, centre[1]);
  return { frame: { ...frame, origin }, width: (height * rect.width) / rect.height, height };
}

/** The values of the scene in a window of a plane.
 * @param {ReturnType<typeof asking>} questions @param {View} view @param {import('./camera.js').Flat} flat
 * @param {number} columns @param {number} rows */
export async function askSlice(questions, view, flat, columns, rows) {
  const { frame, width, height } = windowOf(view, flat);
  const isPlane = state.scene?.dimension === 2;
  const origin = add(frame.origin, view.shift).slice(0, isPlane ? 2 : 3);
  const axes = isPlane ? {} : { right: frame.right, up: frame.up };
  const body = view.isWhole ? {} : { body: view.only };
  const grid = await questions.ask({ do: 'slice', origin, ...axes, width, height, columns, rows, ...body });
  /** @param {number} column @param {number} row */
  const place = (column, row) => {
    const across = grid.first[0] + (column * (grid.last[0] - grid.first[0])) / (columns - 1);
    const above = grid.first[1] + (row * (grid.last[1] - grid.first[1])) / (rows - 1);
    return along(along(frame.origin, frame.right, across), frame.up, above);
  };
  return { values: /** @type {Float32Array} */ (grid.values), place, columns, rows };
}

/** Where lines cross the rows and columns of a grid.
 * @param {Awaited<ReturnType<typeof askSlice>>} grid @param {number} spacing @returns {Label[]} */
function crossings({ values, place, columns, rows }, spacing) {
  /** @type {Label[]} */
  const found = [];
  const sign = state.view.positiveInside ? -1 : 1;
  SCANS.forEach((part, rank) => {
    for (const isRow of [true, false]) {
      const count = isRow ? columns : rows;
      const line = Math.round(part * ((isRow ? rows : columns) - 1));
      const at = (/** @type {number} */ i) =>
        values[isRow ? line * columns + i : i * columns + line] / spacing;
      for (let i = 0; i + 1 < count; i += 1) {
        const [a, b] = [at(i), at(i + 1)];
        const between = Math.ceil(Math.min(a, b));
        if (between > Math.max(a, b) || a === b || !Number.isFinite(a + b)) continue;
        const t = i + (between - a) / (b - a);
        found.push({
          point: isRow ? place(t, line) : place(line, t),
          text: between === 0 ? '0' : level(sign * between * spacing, spacing),
          rank: rank + (between % 5 === 0 ? 0 : 2),
        });
      }
    }
  });
  return found.sort((a, b) => a.rank - b.rank);
}

export class Labels {
  /** @param {Wire} wire @param {() => void} changed */
  constructor(wire, changed) {
    this.questions = asking(wire);
    this.changed = changed;
    /** Of each view. @type {Label[][]} */
    this.labels = [];
    this.timer = 0;
    this.ask = newest(this.search.bind(this), this.questions.giveUp);
  }

  /** Asks again, once the picture stands still. @param {View[]} views
   * @param {import('./camera.js').Flat} flat */
  renew(views, flat) {
    clearTimeout(this.timer);
    this.timer = window.setTimeout(() => this.ask({ views, flat }), STILL);
  }

  /** @param {{ views: View[], flat: import('./camera.js').Flat }} asked */
  async search({ views, flat }) {
    /** @type {Label[][]} */
    const labels = [];
    for (const view of views) {
      labels.push(view.hasLines
        ? crossings(await askSlice(this.questions, view, flat, CELLS, CELLS), view.spacing) : []);
    }
    this.labels = labels;
    this.changed();
  }

  /** Paints the numbers into what other texts left free. @param {View} view
   * @param {number} index @param {import('./texts.js').Texts} texts
   * @param {import('./ink.js').Inks} inks */
  paint(view, index, texts, inks) {
    /** @type {{ x: number, y: number, text: string }[]} */
    const placed = [];
    for (const { point, text } of this.labels[index] ?? []) {
      const place = view.lens.project(point);
      if (!place || placed.length >= MOST) continue;
      const { x, y } = place;
      const wide = widthOf(texts.context, text);
      const isNew = placed.every((other) =>
        other.text !== text || Math.hypot(other.x - x, other.y - y) > APART);
      if (!isNew || !texts.isFree(x, y, wide)) continue;
      placed.push({ x, y, text });
      texts.taken.push({ x, y, wide, high: HIGH });
      label(texts.context, text, x, y, inks);
    }
  }
}
