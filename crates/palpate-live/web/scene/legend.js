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
import { MAP_COLORS, colorsInUse, css, direction } from './colors.js';
import { MAPS } from './glsl.js';
import { arrow, label, stroke } from './ink.js';
import { AXIS_COLORS, COLORS, isLegendOpen, mark } from './marks.js';
import { level, roundUp } from './units.js';
import { AXES, along, dot } from './vectors.js';

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
  }, inks.ink, 1.5, inks.paper);
  label(context, level(metres, metres), right - wide / 2, y - 10, inks);
}

/** The directions of the axes, above on the left. @param {Context} context @param {View} view
 * @param {Inks} inks */
export function paintAxes(context, { lens, isFlat }, inks) {
  const { rect, basis } = lens;
  const middle = { x: rect.x + 40, y: rect.y + 44 };
  const { right, up, forward } = basis;
  const ends = AXES.map((axis, number) => {
    const [x, y, depth] = [right, up, forward].map((way) => dot(axis, way));
    const [name, color] = ['xyz'[number], AXIS_COLORS[number]];
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
export function paintLegend(context, { lens: { rect }, hasLines, spacing, panel }, top, inks) {
  if (!isLegendOpen()) return top;
  const { map, asInMemoir } = state.view;
  const colors = colorsInUse();
  const right = rect.x + rect.width - MARGIN;
  let y = top + 6;
  /** @param {string} text @param {import('./colors.js').Color} from @param {import('./colors.js').Color} [to] */
  const entry = (text, from, to = from) => {
    const fill = context.createLinearGradient(right - 14, 0, right, 0);
    fill.addColorStop(0, css(from));
    fill.addColorStop(1, css(to));
    context.fillStyle = fill;
    context.strokeStyle = inks.muted;
    context.lineWidth = 1;
    context.fillRect(right - 14, y - 6, 14, 12);
    context.strokeRect(right - 14, y - 6, 14, 12);
    label(context, text, right - 20, y, inks, 'right');
    y += 18;
  };
  if (panel.map === MAPS.difference) {
    entry('the first is less', colors.less);
    entry('the first is more', colors.more);
    return y;
  }
  if (map === 'distance' && asInMemoir) {
    entry('inside', MAP_COLORS.memoirInside);
    entry('outside', MAP_COLORS.memoirOutside);
  } else if (map === 'distance') {
    entry('inside', colors.insideNear, colors.insideFar);
    entry('outside', colors.outsideNear, colors.outsideFar);
  } else if (map === 'promise') {
    entry('exact', colors.exact);
    entry('bound', colors.bound);
    entry('Lipschitz', colors.lipschitz);
    entry('slope below 1', colors.flat);
    entry('slope above 1', colors.steep);
  } else if (map === 'gradient' && !asInMemoir) {
    paintWheel(context, right - 30, y + 26, colors);
    label(context, 'where ∇f points', right - 62, y + 26, inks, 'right');
    y += 68;
  } else if (map === 'gradient') {
    entry('red: ∇f to the right', [1, 0, 0]);
    entry('green: ∇f up', [0, 1, 0]);
    entry('blue: cosine of f', [0, 0, 1]);
  }
  if (!hasLines) return y;
  label(context, `lines every ${level(spacing, spacing)}`, right, y, inks, 'right');
  return y + 14;
}

/** The wheel of directions. @param {Context} context @param {number} x @param {number} y
 * @param {ReturnType<typeof colorsInUse>} colors */
function paintWheel(context, x, y, colors) {
  const parts = 48;
  for (let i = 0; i < parts; i += 1) {
    const angle = (2 * Math.PI * (i + 0.5)) / parts;
    context.fillStyle = css(direction([Math.cos(angle), Math.sin(angle)], colors));
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
      arrow(context, lens.project(origin), lens.project(far), COLORS.moves, 2.5, inks.halo);
    }
    context.beginPath();
    context.arc(place.x, place.y, 7, 0, 2 * Math.PI);
    context.fillStyle = handle === 'move' ? COLORS.moves : COLORS.turns;
    context.fill();
    context.strokeStyle = '#ffffff';
    context.lineWidth = 2;
    context.stroke();
  }
}
