// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * The colours of the maps, once for the programs of the card, for maps that the page colours
 * without one, and for the legend.
 *
 * @typedef {number[]} Color red, green and blue from 0 to 1
 */

import { along, clamp, dot, norm, scale } from './vectors.js';

/** Colours of both themes. */
export const MAP_COLORS = {
  /** The surface on distances, and what is around it. */
  surface: [1, 1, 1],
  rim: [0.09, 0.1, 0.12],
  /** The outline of the selected body. */
  chosen: [0.98, 0.72, 0.1],
  memoirInside: [0.35, 0.6, 0.9],
  memoirOutside: [0.9, 0.6, 0.3],
};

/** Colours of a light theme. */
const LIGHT = {
  /** The surface on other maps. */
  ink: [0.09, 0.1, 0.12],
  /** What a body's own colour is mixed with. */
  pale: [1, 1, 1],
  /** Outside all bodies; inside one it is the body's own. */
  outside: [0.965, 0.965, 0.955],
  /** Distances, near the surface and far from it. */
  insideNear: [0.706, 0.827, 0.925],
  insideFar: [0.29, 0.52, 0.75],
  outsideNear: [0.976, 0.8, 0.58],
  outsideFar: [1, 0.976, 0.94],
  insideLine: [0.05, 0.17, 0.3],
  outsideLine: [0.37, 0.21, 0.02],
  gradientLine: [0.1, 0.1, 0.1],
  /** Promises, and slopes that differ from 1. */
  exact: [0.72, 0.88, 0.76],
  bound: [0.74, 0.83, 0.95],
  lipschitz: [0.97, 0.86, 0.66],
  flat: [0.3, 0.3, 0.62],
  steep: [0.78, 0.16, 0.1],
  /** The difference of two bodies. */
  equal: [0.97, 0.97, 0.97],
  less: [0.13, 0.4, 0.67],
  more: [0.7, 0.09, 0.17],
  /** The middle of the wheel of directions, in Oklab. */
  wheel: [0.69, 0, 0],
};

/** The same of a dark theme. @type {typeof LIGHT} */
const DARK = {
  ink: [0.91, 0.92, 0.94],
  pale: [0.07, 0.08, 0.1],
  outside: [0.13, 0.14, 0.16],
  insideNear: [0.16, 0.31, 0.46],
  insideFar: [0.08, 0.15, 0.25],
  outsideNear: [0.41, 0.26, 0.11],
  outsideFar: [0.14, 0.12, 0.1],
  insideLine: [0.72, 0.86, 0.98],
  outsideLine: [0.98, 0.85, 0.66],
  gradientLine: [0.95, 0.95, 0.95],
  exact: [0.12, 0.3, 0.18],
  bound: [0.13, 0.24, 0.4],
  lipschitz: [0.38, 0.27, 0.08],
  flat: [0.46, 0.44, 0.82],
  steep: [0.86, 0.27, 0.19],
  equal: [0.14, 0.14, 0.15],
  less: [0.3, 0.6, 0.88],
  more: [0.9, 0.33, 0.36],
  wheel: [0.5, 0, 0],
};

/** The names of the colours that a theme has, in the order in which the programs take them. */
export const THEMED = /** @type {(keyof typeof LIGHT)[]} */ (Object.keys(LIGHT));

/** Whether the theme in use is dark. */
export function isDark() {
  const chosen = document.documentElement.dataset.theme;
  return chosen ? chosen === 'dark' : matchMedia('(prefers-color-scheme: dark)').matches;
}

/** The colours of the theme in use. */
export const colorsInUse = () => (isDark() ? DARK : LIGHT);

/** How the colours depend on the values. */
export const MAP_NUMBERS = {
  /** Paleness in the colour of a body. */
  pale: 0.25,
  /** How fast distances and differences reach their last colour, over the range of the map. */
  fade: 1.6,
  contrast: 4,
  /** Every second band between isolines is darker. */
  band: 0.965,
  /** The angle of the memoir's sine at the end of the range [rad], and what it changes. */
  waves: 60,
  wave: 0.25,
  /** A slope that is larger breaks the promise by more than rounding. */
  steepest: 1.02,
};

/** The wheel of directions of palpate-plot in Oklab, from its middle: lightness to the right, yellow up. */
export const WHEEL = { right: [0.12, -0.0579555, 0], up: [0, 0.0155291, 0.12] };

/** From Oklab to cube roots, and from their cubes to linear sRGB, row by row. */
export const OKLAB = {
  roots: [[1, 0.3963377774, 0.2158037573], [1, -0.1055613458, -0.0638541728], [1, -0.0894841775, -1.291485548]],
  linear: [[4.0767416621, -3.3077115913, 0.2309699292], [-1.2684380046, 2.6097574011, -0.3413193965],
    [-0.0041960863, -0.7034186147, 1.707614701]],
};

/** Two colours mixed. @param {Color} a @param {Color} b @param {number} t @returns {Color} */
export const mix = (a, b, t) => a.map((part, index) => part + clamp(t, 0, 1) * (b[index] - part));

/** @param {Color} color */
export const css = (color) => `rgb(${color.map((part) => Math.round(255 * part)).join(' ')})`;

/** @param {number[]} lab @returns {Color} */
function fromOklab(lab) {
  const cubes = OKLAB.roots.map((row) => dot(row, lab) ** 3);
  return OKLAB.linear.map((row) => clamp(dot(row, cubes), 0, 1))
    .map((part) => (part <= 0.0031308 ? 12.92 * part : 1.055 * part ** (1 / 2.4) - 0.055));
}

/** The colour of a gradient in the plane. @param {number[]} gradient @param {typeof LIGHT} colors of the theme
 * @returns {Color} */
export function direction([across, above], { wheel }) {
  const beyond = Math.max(norm([across, above, 0]), 1);
  const { right, up } = WHEEL;
  return fromOklab(scale(along(along(wheel, right, across / beyond), up, above / beyond), 1 / beyond));
}
