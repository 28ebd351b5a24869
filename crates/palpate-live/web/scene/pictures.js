// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * The scene layer where the page cannot draw: pictures of space that the program makes, and maps
 * of planes coloured here from slices. One question at a time, the newest wins.
 *
 * @typedef {import('../wire.js').Wire} Wire
 * @typedef {import('./panels.js').View} View
 * @typedef {import('./setting.js').Setting} Setting
 */

import { FIELD_OF_VIEW } from './camera.js';
import { MAPS } from './glsl.js';
import { askSlice } from './labels.js';
import { asking, newest } from './newest.js';
import { rgb } from './setting.js';
import { clamp, dot } from './vectors.js';

/** Values along the longer side of a map. */
const CELLS = 320;
/** Pixels of a picture at most. */
const MOST_PIXELS = 640 * 400;

/** Two colours mixed. @param {number[]} a @param {number[]} b @param {number} t */
const mix = (a, b, t) => a.map((part, i) => part + clamp(t, 0, 1) * (b[i] - part));

/** The colour of a value, from 0 to 1: the maps of the programs, without their lines.
 * @param {number} value @param {number[]} slope the gradient in the plane
 * @param {Record<string, any>} shown @param {number} map @param {number[]} tint of the body */
function colourOf(value, slope, { spacing, range }, map, tint) {
  const far = 1 - Math.exp((-1.6 * Math.abs(value)) / range);
  if (map === MAPS.inside) return value < 0 ? mix(tint, [1, 1, 1], 0.25) : [0.965, 0.965, 0.955];
  if (map === MAPS.gradient) {
    const [x, y] = slope.map((part) => part / Math.max(1, Math.hypot(...slope)));
    return [0.6 - 0.05 * x + 0.25 * y, 0.6 + 0.2 * x + 0.05 * y, 0.6 + 0.1 * x - 0.35 * y];
  }
  if (map === MAPS.promise) {
    const length = Math.hypot(...slope);
    return length > 1.02
      ? mix([0.72, 0.88, 0.76], [0.78, 0.16, 0.1], 2 * (length - 1.02))
      : mix([0.3, 0.3, 0.62], [0.72, 0.88, 0.76], length);
  }
  const band = Math.abs(Math.floor(value / spacing)) % 2 === 0 ? 1 : 0.95;
  const colour = value < 0
    ? mix([0.706, 0.827, 0.925], [0.29, 0.52, 0.75], far)
    : mix([0.976, 0.8, 0.58], [1, 0.976, 0.94], far);
  return colour.map((part) => part * band);
}

export class Pictures {
  /** @param {Wire} wire @param {HTMLCanvasElement} canvas @param {() => void} changed */
  constructor(wire, canvas, changed) {
    this.questions = asking(wire);
    this.canvas = canvas;
    this.changed = changed;
    this.ask = newest(this.fetch.bind(this), this.questions.giveUp);
  }

  /** Takes the size of the canvas on the page. */
  resize() {
    this.canvas.width = this.canvas.clientWidth;
    this.canvas.height = this.canvas.clientHeight;
  }

  /** @param {{ views: View[], flat: import('./camera.js').Flat, setting: Setting }} asked */
  async fetch({ views, flat, setting }) {
    for (const view of views) {
      if (view.isFlat) await this.map(view, flat, setting);
      else await this.picture(view);
    }
    this.changed();
  }

  /** @param {View} view */
  async picture({ lens: { rect, basis } }) {
    const { eye, forward } = basis;
    const part = Math.min(1, Math.sqrt(MOST_PIXELS / (rect.width * rect.height)));
    const { png } = await this.questions.ask({
      do: 'picture',
      eye,
      target: [0, 1, 2].map((axis) => eye[axis] + forward[axis]),
      field_of_view: FIELD_OF_VIEW,
      width: Math.round(rect.width * part),
      height: Math.round(rect.height * part),
    });
    const image = await createImageBitmap(png);
    this.canvas.getContext('2d')?.drawImage(image, rect.x, rect.y, rect.width, rect.height);
    image.close();
  }

  /** @param {View} view @param {import('./camera.js').Flat} flat @param {Setting} setting */
  async map(view, flat, setting) {
    const { rect } = view.lens;
    const part = CELLS / Math.max(rect.width, rect.height);
    const [columns, rows] = [rect.width, rect.height].map((side) => Math.max(2, Math.round(side * part)));
    const { values, place } = await askSlice(this.questions, view, flat, columns, rows);
    const step = [place(0, 0), place(1, 0)].map((point) => dot(point, flat.frame.right));
    const between = Math.abs(step[1] - step[0]) || 1;
    const tint = rgb(setting.bodies[Math.max(view.only, 0)]?.color);
    const image = new ImageData(columns, rows);
    for (let row = 0; row < rows; row += 1) {
      for (let column = 0; column < columns; column += 1) {
        const at = row * columns + column;
        const right = column + 1 < columns ? at + 1 : at;
        const above = row + 1 < rows ? at + columns : at;
        const slope = [right, above].map((next) => (values[next] - values[at]) / between);
        const colour = colourOf(values[at], slope, view.panel.values, view.panel.map, tint);
        // Rows of a slice go up, those of a picture down.
        image.data.set([...colour.map((c) => 255 * c), 255], 4 * ((rows - 1 - row) * columns + column));
      }
    }
    const bitmap = await createImageBitmap(image);
    this.canvas.getContext('2d')?.drawImage(bitmap, rect.x, rect.y, rect.width, rect.height);
    bitmap.close();
  }
}
