// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * Marks that lie over the picture, and the legend that explains those that are to be seen: what
 * paints a mark names it, and the legend comes last.
 *
 * @typedef {import('./ink.js').Context} Context
 * @typedef {import('./ink.js').Inks} Inks
 * @typedef {(context: Context, x: number, y: number, inks: Inks) => void} Icon paints into a
 *   field of 20 by 12 pixels around a place
 */

import { FONT, arrow, dot, label, polyline, ring, spring } from './ink.js';

/** The colours of marks. */
export const COLORS = {
  force: '#d1480a', normal: '#007355', contact: '#9e2f78', path: '#e02020', hit: '#b3261e',
  ball: '#c9730a', selected: '#e0a000', moves: '#007355', turns: '#743aa6',
  proof: 'rgba(158, 47, 120, 0.7)', guide: '#00838f',
};

/** The colours of the axes of the scene. */
export const AXIS_COLORS = ['#c0392b', '#1a7d3c', '#2563b0'];

/** How opaque a hand is that is lifted. */
export const LIFTED = 0.55;
/** How opaque marks are that lie behind a body. */
const HIDDEN = 0.4;

/** A line across. @param {string} color @param {number} width @returns {Icon} */
const line = (color, width) => (context, x, y) =>
  polyline(context, [{ x: x - 9, y }, { x: x + 9, y }], color, width, 'transparent');

/** @param {string} color @param {number} width @returns {Icon} */
const pointer = (color, width) => (context, x, y, inks) =>
  arrow(context, { x: x - 9, y }, { x: x + 9, y }, color, width, inks.halo);

/** @param {string} color @returns {Icon} */
const square = (color) => (context, x, y) => {
  context.strokeStyle = color;
  context.lineWidth = 1;
  context.strokeRect(x - 7, y - 5, 14, 10);
};

/** @type {Record<string, [string, Icon]>} */
const MARKS = {
  free: ['device point, free', (context, x, y, inks) => dot(context, { x, y }, 4, '#1b5fb0', inks.halo)],
  lifted: ['lifted hand, which feels nothing', (context, x, y, inks) => {
    context.globalAlpha = LIFTED;
    ring(context, { x, y }, 5, '#1b5fb0', 1.5, inks.halo);
    context.globalAlpha = 1;
  }],
  hidden: ['faded: behind a body', (context, x, y, inks) => {
    context.globalAlpha = HIDDEN;
    dot(context, { x, y }, 5, '#1b5fb0', inks.halo);
    context.globalAlpha = 1;
  }],
  off: ['hollow: off the plane', (context, x, y, inks) => ring(context, { x, y }, 5, '#1b5fb0', 1.5, inks.halo)],
  device: ['device point in a body', (context, x, y, inks) => ring(context, { x, y }, 4, '#1b5fb0', 1.5, inks.halo)],
  proxy: ['proxy on the surface', (context, x, y, inks) => dot(context, { x, y }, 5, '#1b5fb0', inks.halo)],
  spring: ['spring to the goal', (context, x, y, inks) =>
    spring(context, { x: x - 9, y }, { x: x + 9, y }, inks.ink, inks.halo)],
  force: ['force on the hand', pointer(COLORS.force, 3)],
  normal: ['normal at the touch', pointer(COLORS.normal, 1.5)],
  guide: ['guide, which pulls the hand', line(COLORS.guide, 1.5)],
  contact: ['contact of bodies', (context, x, y, inks) => dot(context, { x, y }, 4, COLORS.contact, inks.halo)],
  contactNormal: ['its normal', pointer(COLORS.contact, 1.5)],
  proof: ['box that is ruled out', square(COLORS.proof)],
  bounds: ['box and ball around a body', (context, x, y, inks) => {
    square(inks.muted)(context, x, y, inks);
    ring(context, { x, y }, 6, inks.muted, 1, 'transparent');
  }],
  handles: ['moves, turns, scales the selection', (context, x, y, inks) => {
    arrow(context, { x: x - 3, y }, { x: x + 9, y }, AXIS_COLORS[0], 2, inks.halo);
    dot(context, { x: x - 5, y }, 4, inks.halo, inks.ink);
  }],
  moves: ['moves the plane', (context, x, y) => dot(context, { x, y }, 5, COLORS.moves, '#ffffff')],
  turns: ['turns the plane', (context, x, y) => dot(context, { x, y }, 5, COLORS.turns, '#ffffff')],
  selected: ['selected body', square(COLORS.selected)],
  probe: ['nearest surface, safe ball', (context, x, y, inks) => {
    ring(context, { x, y }, 5, COLORS.normal, 1, 'transparent');
    dot(context, { x, y }, 1.5, inks.ink, 'transparent');
  }],
  element: ['element with handles', (context, x, y, inks) => {
    line(inks.muted, 2)(context, x, y, inks);
    dot(context, { x: x - 7, y }, 3, '#ffffff', inks.muted);
    dot(context, { x: x + 7, y }, 3, '#ffffff', inks.muted);
  }],
  enclosing: ['enclosing circle', (context, x, y, inks) => ring(context, { x, y }, 5, inks.muted, 1, inks.halo)],
  path: ['path of a descent', (context, x, y, inks) => {
    line(COLORS.path, 1)(context, x, y, inks);
    for (const across of [-8, -3, 2, 7]) dot(context, { x: x + across, y }, 2, COLORS.path, 'transparent');
  }],
  found: ['start that found the minimum', (context, x, y, inks) => dot(context, { x, y }, 5, COLORS.normal, inks.halo)],
  missed: ['start that missed it', (context, x, y, inks) => dot(context, { x, y }, 5, COLORS.path, inks.halo)],
  witness: ['proven separation', (context, x, y, inks) => {
    line(COLORS.hit, 2)(context, x, y, inks);
    for (const across of [-8, 8]) dot(context, { x: x + across, y }, 3, COLORS.hit, inks.halo);
  }],
  circle: ['circle that is asked about', (context, x, y, inks) => ring(context, { x, y }, 5, inks.muted, 2.5, inks.halo)],
  motion: ['motion in 1 s', (context, x, y, inks) => pointer(inks.ink, 2)(context, x, y, inks)],
  touch: ['where it touches first', (context, x, y, inks) => dot(context, { x, y }, 5, COLORS.hit, inks.halo)],
  ball: ['falling ball', (context, x, y, inks) => dot(context, { x, y }, 5, COLORS.ball, inks.halo)],
  fall: ['its path', line(COLORS.ball, 1.5)],
  bounce: ['bounce, with its normal', pointer(COLORS.normal, 1.5)],
};

const KEY = 'palpate-legend';
/** The legend covers too much of smaller pictures, in pixels. */
const ROOM = { width: 220, height: 280 };

const legend = {
  /** What a person chose, also the last time. */
  chosen: localStorage.getItem(KEY),
  hasRoom: true,
};

/** Whether the legend is unfolded. */
export const isLegendOpen = () => (legend.chosen === null ? legend.hasRoom : legend.chosen === 'open');

/** Folds the legend or unfolds it, from now on. @param {boolean} isOpen */
export function openLegend(isOpen) {
  legend.chosen = isOpen ? 'open' : 'folded';
  localStorage.setItem(KEY, legend.chosen);
}

/** Takes the size of the pictures; gives whether that folds the legend or unfolds it.
 * @param {{ width: number, height: number }} picture */
export function fitLegend({ width, height }) {
  const before = isLegendOpen();
  legend.hasRoom = width >= ROOM.width && height >= ROOM.height;
  return isLegendOpen() !== before;
}

/** @type {Set<string>} */
const seen = new Set();

/** Names a mark that is painted. @param {keyof typeof MARKS} name */
export const mark = (name) => void seen.add(name);

/** Paints a mark, faded if it lies behind a body. @param {Context} context @param {boolean} isHidden
 * @param {() => void} paint */
export function veiled(context, isHidden, paint) {
  if (isHidden) mark('hidden');
  context.globalAlpha = isHidden ? HIDDEN : 1;
  paint();
  context.globalAlpha = 1;
}

/** Begins a picture. */
export const clearMarks = () => seen.clear();

const ROW = 16;

/** Paints the legend of the marks that were named: its right upper corner is given.
 * @param {Context} context @param {number} right @param {number} top @param {number} bottom what
 *   it must not reach beyond @param {Inks} inks
 * @returns {{ x: number, y: number, wide: number, high: number } | null} where it is */
export function paintMarks(context, right, top, bottom, inks) {
  const entries = Object.keys(MARKS).filter((name) => seen.has(name))
    .slice(0, Math.max(0, Math.floor((bottom - top) / ROW))).map((name) => MARKS[name]);
  if (!isLegendOpen() || entries.length === 0) return null;
  context.font = FONT;
  const wide = 30 + Math.max(...entries.map(([text]) => context.measureText(text).width));
  const high = ROW * entries.length;
  context.globalAlpha = 0.75;
  context.fillStyle = inks.paper;
  context.fillRect(right - wide - 4, top - 2, wide + 8, high + 4);
  context.globalAlpha = 1;
  entries.forEach(([text, icon], row) => {
    const y = top + ROW * (row + 0.5);
    icon(context, right - 10, y, inks);
    label(context, text, right - 26, y, inks, 'right');
  });
  return { x: right - wide / 2, y: top + high / 2, wide, high };
}
