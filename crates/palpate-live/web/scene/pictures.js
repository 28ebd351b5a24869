// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * The scene layer where the page cannot draw: pictures of space that the program makes, and maps
 * of planes coloured here from slices. One question at a time, the newest wins.
 *
 * @typedef {import('../wire.js').Wire} Wire
 * @typedef {import('./colors.js').Color} Color
 * @typedef {import('./panels.js').View} View
 * @typedef {import('./setting.js').Setting} Setting
 * @typedef {Pick<import('./setting.js').Body, 'color' | 'promises'>} Body
 */

import { FIELD_OF_VIEW } from './camera.js';
import { MAP_COLORS, MAP_NUMBERS, colorsInUse, direction, mix } from './colors.js';
import { MAPS } from './glsl.js';
import { askSlice } from './labels.js';
import { asking, newest } from './newest.js';
import { along, clamp, cross, norm, subtract } from './vectors.js';

/** Values along the longer side of a map. */
const CELLS = 320;
/** Pixels of a picture at most, and of the coarse one that comes before a slow one. */
const MOST_PIXELS = 640 * 400;
const FEW_PIXELS = 80 * 50;
/** A picture that takes longer is slow [ms]. */
const SLOW = 1000;

/** The names of the colours of promises, by the numbers that bodies have. */
const PROMISES = /** @type {const} */ (['exact', 'bound', 'lipschitz']);

/** How much a line covers of a pixel at so many pixels from its middle.
 * @param {number} pixels @param {number} width */
const line = (pixels, width) => clamp(0.5 * width + 0.5 - pixels, 0, 1);

/** The colour of a value: what `mapped` does in the programs, where a card draws.
 * @param {number} map @param {Record<string, any>} shown the numbers of the panel
 * @param {ReturnType<typeof colorsInUse>} colors
 * @param {{ value: number, other: number, slope: number[], pixel: number, body: Body }} at `other` is the
 *   value of the other body, `slope` the gradient across, above and towards the viewer, `pixel` the
 *   change of the value over a pixel @returns {Color} */
function colorOf(map, shown, colors, { value, other, slope, pixel, body }) {
  const { spacing, range, sineFactor, asInMemoir, positiveInside, isolines, channels } = shown;
  const { ink, flat, steep, equal, less, more } = colors;
  const { surface, rim } = MAP_COLORS;
  const isInside = value < 0;
  const zeroLine = line(Math.abs(value) / pixel, 2);
  if (map === MAPS.difference) {
    const change = (value - other) / range;
    const color = mix(equal, change < 0 ? less : more, 1 - Math.exp(-MAP_NUMBERS.contrast * Math.abs(change)));
    return mix(color, ink, 0.8 * zeroLine);
  }
  const wave = Math.cos((MAP_NUMBERS.waves * sineFactor * value) / range);
  let color = colors.outside;
  if (map === MAPS.inside && isInside) color = mix(body.color, colors.pale, MAP_NUMBERS.pale);
  if (map === MAPS.distance && asInMemoir) {
    const shade = 1 - MAP_NUMBERS.wave * (1 - wave);
    const side = isInside ? MAP_COLORS.memoirInside : MAP_COLORS.memoirOutside;
    return mix(side.map((part) => shade * part), surface, zeroLine);
  }
  if (map === MAPS.distance) {
    const far = 1 - Math.exp((-MAP_NUMBERS.fade * Math.abs(value)) / range);
    const band = Math.abs(Math.floor(value / spacing)) % 2 === 0 ? 1 : MAP_NUMBERS.band;
    color = isInside ? mix(colors.insideNear, colors.insideFar, far)
      : mix(colors.outsideNear, colors.outsideFar, far);
    color = color.map((part) => band * part);
  }
  if (map === MAPS.gradient) {
    const gradient = slope.slice(0, 2).map((part) => (positiveInside ? -part : part));
    color = asInMemoir ? [...gradient, wave].map((part, index) => channels[index] * (0.5 + 0.5 * part))
      : direction(gradient, colors);
  }
  if (map === MAPS.promise) {
    const length = norm(slope);
    color = mix(colors[PROMISES[body.promises[isInside ? 1 : 0]]], flat, 1 - length);
    color = mix(color, steep, 2 * (length - MAP_NUMBERS.steepest));
  }
  const nearest = Math.round(value / spacing);
  if (isolines && nearest !== 0) {
    const covered = line(Math.abs(value - nearest * spacing) / pixel, 1);
    const fade = clamp(spacing / pixel / 5 - 0.4, 0, 1);
    const strong = nearest % 5 === 0 ? 0.6 : 0.34;
    const lines = map === MAPS.gradient ? colors.gradientLine
      : isInside ? colors.insideLine : colors.outsideLine;
    color = mix(color, lines, covered * fade * strong);
  }
  if (map !== MAPS.distance) return mix(color, ink, zeroLine);
  return mix(mix(color, rim, 0.7 * line(Math.abs(value) / pixel, 4.5)), surface, zeroLine);
}

export class Pictures {
  /** @param {Wire} wire @param {HTMLCanvasElement} canvas @param {() => void} changed */
  constructor(wire, canvas, changed) {
    this.questions = asking(wire);
    this.canvas = canvas;
    this.changed = changed;
    /** How long the last picture took [ms]. */
    this.lastTime = Infinity;
    this.ask = newest(this.fetch.bind(this), this.questions.giveUp);
  }

  /** Takes the size of the canvas on the page. */
  resize() {
    this.canvas.width = this.canvas.clientWidth;
    this.canvas.height = this.canvas.clientHeight;
  }

  /** @param {{ views: View[], flat: import('./camera.js').Flat, setting: Setting }} asked */
  async fetch({ views, flat, setting }) {
    const isSlow = this.lastTime > SLOW && views.some(({ isFlat }) => !isFlat);
    if (isSlow) await this.draw({ views, flat, setting }, FEW_PIXELS);
    const begin = performance.now();
    await this.draw({ views, flat, setting }, MOST_PIXELS);
    this.lastTime = performance.now() - begin;
  }

  /** @param {{ views: View[], flat: import('./camera.js').Flat, setting: Setting }} asked
   * @param {number} pixels of a picture, at most */
  async draw({ views, flat, setting }, pixels) {
    /** @type {[ImageBitmap, View][]} */
    const made = [];
    for (const view of views) {
      made.push([await (view.isFlat ? this.map(view, flat, setting) : this.picture(view, pixels)), view]);
    }
    const context = this.canvas.getContext('2d');
    context?.clearRect(0, 0, this.canvas.width, this.canvas.height);
    for (const [image, { lens: { rect } }] of made) {
      context?.drawImage(image, rect.x, rect.y, rect.width, rect.height);
      image.close();
    }
    this.changed();
  }

  /** @param {View} view @param {number} pixels at most */
  async picture({ lens: { rect, basis } }, pixels) {
    const { eye, forward } = basis;
    const part = Math.min(1, Math.sqrt(pixels / (rect.width * rect.height)));
    const { png } = await this.questions.ask({
      do: 'picture',
      eye,
      target: [0, 1, 2].map((axis) => eye[axis] + forward[axis]),
      field_of_view: FIELD_OF_VIEW,
      width: Math.round(rect.width * part),
      height: Math.round(rect.height * part),
    });
    return createImageBitmap(png);
  }

  /** @param {View} view @param {import('./camera.js').Flat} flat @param {Setting} setting */
  async map(view, flat, setting) {
    const { lens: { rect }, panel } = view;
    const part = CELLS / Math.max(rect.width, rect.height);
    const [columns, rows] = [rect.width, rect.height].map((side) => Math.max(2, Math.round(side * part)));
    const ask = (/** @type {Partial<View>} */ other) =>
      askSlice(this.questions, { ...view, ...other }, flat, columns, rows);
    const { values, place } = await ask({});
    const between = norm(subtract(place(1, 0), place(0, 0)));
    const others = panel.map === MAPS.difference ? (await ask(view.other)).values : values;
    // In space the length of the gradient needs values before the plane.
    const isLengthSeen = panel.map === MAPS.promise && setting.dimension === 3;
    const forth = along(view.shift, cross(flat.frame.right, flat.frame.up), between);
    const before = isLengthSeen ? (await ask({ shift: forth })).values : values;
    const colors = colorsInUse();
    // A slice of the whole scene does not tell its bodies apart.
    const whole = { color: setting.bodies[0]?.color ?? colors.outside, promises: setting.promises };
    const body = setting.bodies[view.only] ?? whole;
    /** The slope along a row or a column. @param {number} at @param {number} step from one value to the
     * next @param {number} number @param {number} count */
    const slopeAlong = (at, step, number, count) => {
      const [back, on] = [Math.min(number, 1), Math.min(count - 1 - number, 1)];
      return (values[at + on * step] - values[at - back * step]) / ((back + on) * between);
    };
    const image = new ImageData(columns, rows);
    for (let row = 0; row < rows; row += 1) {
      for (let column = 0; column < columns; column += 1) {
        const at = row * columns + column;
        const slope = [slopeAlong(at, 1, column, columns), slopeAlong(at, columns, row, rows),
          (before[at] - values[at]) / between];
        const pixel = between * Math.max(Math.hypot(slope[0], slope[1]), 0.2);
        const color = colorOf(panel.map, panel.values, colors,
          { value: values[at], other: others[at], slope, pixel, body });
        // Rows of a slice go up, those of a picture down.
        image.data.set([...color.map((c) => 255 * c), 255], 4 * ((rows - 1 - row) * columns + column));
      }
    }
    return createImageBitmap(image);
  }
}
