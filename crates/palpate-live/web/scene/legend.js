// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * What explains the picture: the scale bar, the axes, and the colours of the map.
 *
 * @typedef {import('./ink.js').Context} Context
 * @typedef {import('./ink.js').Inks} Inks
 * @typedef {import('./panels.js').View} View
 */

import { state } from '../state.js';
import { MAPS } from './glsl.js';
import { arrow, label, stroke } from './ink.js';
import { isLegendOpen, mark } from './marks.js';
import { level, roundUp } from './units.js';
import { along } from './vectors.js';

/** The axes of the scene, with their colours. */
export const AXES = [
  { name: 'x', color: '#c0392b', axis: [1, 0, 0] },
  { name: 'y', color: '#1a7d3c', axis: [0, 1, 0] },
  { name: 'z', color: '#2563b0', axis: [0, 0, 1] },
];
export const MARGIN = 14;

/** A bar of a round length, below on the right. @param {Context} context @param {View} view
 * @param {import('./vectors.js').Vector} at where its scale holds @param {Inks} inks */
export function paintScale(context, { lens }, at, inks) {
  const pixel = lens.pixel(at);
  if (!(pixel > 0)) return;
  const metres = roundUp(70 * pixel);
  const wide = metres / pixel;
  const right = lens.rect.x + lens.rect.width - MARGIN;
  const y = lens.rect.y + lens.rect.height - MARGIN;
  stroke(context, () => {
    context.moveTo(right - wide, y - 4);
    context.lineTo(right - wide, y);
    context.lineTo(right, y);
    context.lineTo(right, y - 4);
  }, inks.ink, 1.5, inks.halo);
  label(context, level(metres, metres), right - wide / 2, y - 10, inks);
}

/** The directions of the axes, above on the left. @param {Context} context @param {View} view
 * @param {Inks} inks */
export function paintAxes(context, { lens, isFlat }, inks) {
  const { rect, basis } = lens;
  const middle = { x: rect.x + 40, y: rect.y + 44 };
  const { right, up, forward } = basis;
  const ends = AXES.map(({ name, color, axis }) => {
    const [x, y, depth] = [right, up, forward].map((b) =>
      axis[0] * b[0] + axis[1] * b[1] + axis[2] * b[2]);
    return { name, color, depth, x: middle.x + 24 * x, y: middle.y - 24 * y, flat: Math.hypot(x, y) };
  }).sort((a, b) => b.depth - a.depth);
  for (const { name, color, x, y, flat } of ends) {
    if (flat < 0.12 && isFlat) continue;
    arrow(context, middle, { x, y }, color, 2, inks.halo);
    const [out, down] = [x - middle.x, y - middle.y];
    label(context, name, middle.x + 1.42 * out, middle.y + 1.42 * down, inks, 'center', color);
  }
}

/** The colours of the map, above on the right. @param {Context} context @param {View} view
 * @param {number} top where it begins @param {Inks} inks @returns {number} where it ends below */
export function paintLegend(context, { lens: { rect }, hasPlane, hasLines, spacing, panel }, top, inks) {
  if (!hasPlane || !isLegendOpen()) return top;
  const { map, asInMemoir } = state.view;
  const right = rect.x + rect.width - MARGIN;
  let y = top + 6;
  /** @param {string} color @param {string} text */
  const entry = (color, text) => {
    context.fillStyle = color;
    context.strokeStyle = inks.muted;
    context.lineWidth = 1;
    context.fillRect(right - 14, y - 6, 14, 12);
    context.strokeRect(right - 14, y - 6, 14, 12);
    label(context, text, right - 20, y, inks, 'right');
    y += 18;
  };
  if (panel.map === MAPS.difference) {
    entry('#2166ac', 'the first is less');
    entry('#b2182b', 'the first is more');
    return y;
  }
  if (map === 'distance') {
    entry(asInMemoir ? '#5999e6' : '#79a9d5', 'inside');
    entry(asInMemoir ? '#e6994d' : '#f9d2a2', 'outside');
  } else if (map === 'promise') {
    entry('#b8e0c2', 'exact');
    entry('#bdd4f2', 'bound');
    entry('#f7dba8', 'Lipschitz');
    entry('#4d4d9e', 'slope below 1');
    entry('#c7291a', 'slope above 1');
  } else if (map === 'gradient' && !asInMemoir) {
    paintWheel(context, right - 30, y + 26);
    label(context, 'where ∇f points', right - 62, y + 26, inks, 'right');
    y += 68;
  } else if (map === 'gradient') {
    entry('#e04040', 'red: ∇f to the right');
    entry('#40c040', 'green: ∇f up');
    entry('#4060e0', 'blue: cosine of f');
  }
  if (!hasLines) return y;
  label(context, `lines every ${level(spacing, spacing)}`, right, y, inks, 'right');
  return y + 14;
}

/** The wheel of directions. @param {Context} context @param {number} x @param {number} y */
function paintWheel(context, x, y) {
  const parts = 48;
  for (let i = 0; i < parts; i += 1) {
    const angle = (2 * Math.PI * (i + 0.5)) / parts;
    const [across, above] = [Math.cos(angle), Math.sin(angle)];
    const a = -0.0579555 * across + 0.0155291 * above;
    context.fillStyle = `oklab(${0.69 + 0.12 * across} ${a} ${0.12 * above})`;
    context.beginPath();
    context.moveTo(x, y);
    context.arc(x, y, 26, -angle - Math.PI / parts, -angle + Math.PI / parts);
    context.fill();
  }
}

/** The title of a panel, below. @param {Context} context @param {View} view @param {Inks} inks */
export function paintTitle(context, { lens: { rect }, title }, inks) {
  if (title) label(context, title, rect.x + rect.width / 2, rect.y + rect.height - MARGIN - 24, inks);
}

/** A plane in space, as its outline. @param {Context} context @param {View} view
 * @param {import('./vectors.js').Vector[]} corners @param {Inks} inks */
export function paintOutline(context, { lens }, corners, inks) {
  const places = corners.map(lens.project);
  if (places.some((place) => !place)) return;
  stroke(context, () => {
    places.forEach((place, index) => {
      if (index === 0) context.moveTo(place?.x ?? 0, place?.y ?? 0);
      else context.lineTo(place?.x ?? 0, place?.y ?? 0);
    });
    context.closePath();
  }, inks.muted, 1, 'transparent');
}

/** The handles of a plane. @param {Context} context @param {View} view
 * @param {{ handle: string, point: import('./vectors.js').Vector }[]} handles
 * @param {import('./vectors.js').Vector} origin @param {Inks} inks */
export function paintHandles(context, { lens }, handles, origin, inks) {
  for (const { handle, point } of handles) {
    const place = lens.project(point);
    if (!place) continue;
    mark(handle === 'move' ? 'moves' : 'turns');
    if (handle === 'move') {
      const far = along(origin, [0, 1, 2].map((i) => point[i] - origin[i]), 1.6);
      arrow(context, lens.project(origin), lens.project(far), '#007355', 2.5, inks.halo);
    }
    context.beginPath();
    context.arc(place.x, place.y, 7, 0, 2 * Math.PI);
    context.fillStyle = handle === 'move' ? '#007355' : '#743aa6';
    context.fill();
    context.strokeStyle = '#ffffff';
    context.lineWidth = 2;
    context.stroke();
  }
}
