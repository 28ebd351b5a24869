// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * Strokes of the overlay: each with a halo, so that it is seen on every map.
 *
 * @typedef {CanvasRenderingContext2D} Context
 * @typedef {{ x: number, y: number }} Place
 * @typedef {{ ink: string, halo: string, paper: string, muted: string }} Inks `halo` is around marks, `paper`
 *   around and behind texts
 */

/** Twelve colours that are told apart, as palpate-plot numbers points and bodies. */
const NUMBERED = ['#1b5fb0', '#a82a1a', '#1a7d3c', '#743aa6', '#00a0a8', '#d63c8c', '#8c8000',
  '#14146e', '#6b4420', '#5cb8f0', '#83888f', '#6a0a48'];

/** @param {number} number */
export const numbered = (number) => NUMBERED[number % NUMBERED.length];

export const FONT = '12px Inter, system-ui, sans-serif';
const TAU = 2 * Math.PI;

/** Strokes what `path` lays, with a halo below. @param {Context} context
 * @param {() => void} path @param {string} color @param {number} width @param {string} halo */
export function stroke(context, path, color, width, halo) {
  context.beginPath();
  path();
  context.lineCap = 'round';
  context.lineJoin = 'round';
  context.strokeStyle = halo;
  context.lineWidth = width + 2.5;
  context.stroke();
  context.strokeStyle = color;
  context.lineWidth = width;
  context.stroke();
}

/** @param {Context} context @param {(Place | null)[]} places @param {string} color
 * @param {number} width @param {string} halo @param {boolean} [isClosed] */
export function polyline(context, places, color, width, halo, isClosed = false) {
  const seen = /** @type {Place[]} */ (places.filter(Boolean));
  if (seen.length < 2) return;
  stroke(context, () => {
    context.moveTo(seen[0].x, seen[0].y);
    for (const { x, y } of seen.slice(1)) context.lineTo(x, y);
    if (isClosed) context.closePath();
  }, color, width, halo);
}

/** @param {Context} context @param {Place | null} place @param {number} radius
 * @param {string} color @param {string} halo */
export function dot(context, place, radius, color, halo) {
  if (!place) return;
  context.beginPath();
  context.arc(place.x, place.y, radius, 0, TAU);
  context.fillStyle = color;
  context.fill();
  context.strokeStyle = halo;
  context.lineWidth = 1.5;
  context.stroke();
}

/** @param {Context} context @param {Place | null} place @param {number} radius
 * @param {string} color @param {number} width @param {string} halo */
export function ring(context, place, radius, color, width, halo) {
  if (!place || !(radius > 0) || radius > 1e5) return;
  stroke(context, () => context.arc(place.x, place.y, radius, 0, TAU), color, width, halo);
}

/** @param {Context} context @param {Place | null} from @param {Place | null} to
 * @param {string} color @param {number} width @param {string} halo */
export function arrow(context, from, to, color, width, halo) {
  if (!from || !to) return;
  const [dx, dy] = [to.x - from.x, to.y - from.y];
  const length = Math.hypot(dx, dy);
  if (length < 2) return;
  const head = Math.min(4 + 2 * width, 0.7 * length);
  const [ux, uy] = [(dx / length) * head, (dy / length) * head];
  stroke(context, () => {
    context.moveTo(from.x, from.y);
    context.lineTo(to.x, to.y);
    context.moveTo(to.x - ux - 0.5 * uy, to.y - uy + 0.5 * ux);
    context.lineTo(to.x, to.y);
    context.lineTo(to.x - ux + 0.5 * uy, to.y - uy - 0.5 * ux);
  }, color, width, halo);
}

/** A spring between two places: the longer, the flatter. @param {Context} context
 * @param {Place | null} from @param {Place | null} to @param {string} color @param {string} halo */
export function spring(context, from, to, color, halo) {
  if (!from || !to) return;
  const [dx, dy] = [to.x - from.x, to.y - from.y];
  const length = Math.hypot(dx, dy);
  if (length < 3) return;
  const turns = Math.min(8, Math.max(2, Math.round(length / 9)));
  const wide = Math.max(2, 7 - length / 40);
  const [nx, ny] = [(-dy / length) * wide, (dx / length) * wide];
  stroke(context, () => {
    context.moveTo(from.x, from.y);
    for (let i = 1; i < 2 * turns; i += 1) {
      const t = 0.1 + (0.8 * i) / (2 * turns);
      const side = i % 2 === 0 ? 1 : -1;
      context.lineTo(from.x + t * dx + side * nx, from.y + t * dy + side * ny);
    }
    context.lineTo(to.x, to.y);
  }, color, 1.5, halo);
}

/** @param {Context} context @param {string} text @param {number} x @param {number} y
 * @param {Inks} inks @param {CanvasTextAlign} [align] @param {string} [color] */
export function label(context, text, x, y, inks, align = 'center', color = inks.ink) {
  context.font = FONT;
  context.textAlign = align;
  context.textBaseline = 'middle';
  context.lineJoin = 'round';
  context.strokeStyle = color === inks.ink ? inks.paper : inks.halo;
  context.lineWidth = 3.5;
  context.strokeText(text, x, y);
  context.fillStyle = color;
  context.fillText(text, x, y);
}
