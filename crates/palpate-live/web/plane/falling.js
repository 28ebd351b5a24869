// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * The falling ball as it is drawn, and its handle.
 *
 * @typedef {import('../scene/ink.js').Context} Context
 * @typedef {import('../scene/ink.js').Inks} Inks
 * @typedef {import('../scene/ink.js').Place} Place
 * @typedef {import('../scene/camera.js').Lens} Lens
 * @typedef {import('../input/pointer.js').Drag} Drag
 */

import { arrow, dot, polyline, ring } from '../scene/ink.js';
import { COLORS, mark, veiled } from '../scene/marks.js';
import { along, inSpace, rounded } from '../scene/vectors.js';
import { fall, lasts, moment, placeAt, setFall } from './fall.js';

const { ball: BALL, normal: GREEN } = COLORS;
/** Balls that are left behind on the way. */
const GHOSTS = 24;
/** Points of the path that are painted at most. */
const MOST_POINTS = 1500;
/** The length of a normal in pixels. */
const NORMAL = 30;

/** A ball that is lit from above. @param {Context} context @param {Place | null} place
 * @param {number} radius in pixels @param {Inks} inks */
function paintBall(context, place, radius, inks) {
  if (!place || !(radius > 0)) return;
  const light = context.createRadialGradient(place.x - 0.3 * radius, place.y - 0.4 * radius, 0.1 * radius,
    place.x, place.y, Math.max(radius, 3));
  light.addColorStop(0, '#ffe2b8');
  light.addColorStop(1, BALL);
  context.beginPath();
  context.arc(place.x, place.y, Math.max(radius, 3), 0, 2 * Math.PI);
  context.fillStyle = light;
  context.fill();
  context.strokeStyle = inks.halo;
  context.lineWidth = 1.5;
  context.stroke();
}

/** @param {Context} context @param {Lens} lens @param {import('../scene/texts.js').Texts} texts @param {Inks} inks
 * @param {boolean} isHidden whether the ball is behind a body */
export function paintFall(context, lens, texts, inks, isHidden) {
  if (!fall.isShown || fall.centre.length === 0) return;
  const { answer, radius } = fall;
  const begin = inSpace(fall.centre);
  const wide = (/** @type {number[]} */ point) => radius / lens.pixel(inSpace(point));
  mark('ball');
  if (answer) {
    mark('fall');
    const every = Math.ceil(answer.path.length / MOST_POINTS);
    const path = answer.path.filter((_, index) => index % every === 0);
    polyline(context, path.map((point) => lens.project(inSpace(point))), BALL, 1.5, inks.halo);
    const now = moment();
    context.globalAlpha = 0.35;
    for (let ghost = 1; ghost < GHOSTS; ghost += 1) {
      const time = (ghost / GHOSTS) * lasts();
      const place = time < now ? placeAt(time) : null;
      if (place) ring(context, lens.project(inSpace(place)), wide(place), BALL, 1, 'transparent');
    }
    context.globalAlpha = 1;
    for (const { centre, normal, time } of answer.bounces) {
      mark('bounce');
      const touched = along(inSpace(centre), inSpace(normal), -radius);
      const tip = along(touched, inSpace(normal), NORMAL * lens.pixel(touched));
      context.globalAlpha = time <= now ? 1 : 0.45;
      arrow(context, lens.project(touched), lens.project(tip), GREEN, 1.5, inks.halo);
      dot(context, lens.project(touched), 3, GREEN, inks.halo);
    }
    const place = placeAt(now);
    context.globalAlpha = 1;
    if (place) veiled(context, isHidden, () => paintBall(context, lens.project(inSpace(place)), wide(place), inks));
  }
  const from = lens.project(begin);
  ring(context, from, wide(begin), BALL, 2, inks.halo);
  if (from) texts.taken.push({ ...from, wide: 2 * wide(begin), high: 2 * wide(begin) });
  dot(context, from, 5, '#ffffff', BALL);
}

/** The drag of the ball where it begins, if that is near a place; or null.
 * @param {() => Lens} lens @param {Place} place @param {number} reach in pixels
 * @returns {Drag | null} */
export function fallDrag(lens, place, reach) {
  if (!fall.isShown || fall.centre.length === 0) return null;
  const begin = inSpace(fall.centre);
  const seen = lens().project(begin);
  if (!seen) return null;
  const [offX, offY] = [seen.x - place.x, seen.y - place.y];
  if (Math.hypot(offX, offY) > Math.max(reach, fall.radius / lens().pixel(begin))) return null;
  return {
    move({ x, y }) {
      const to = rounded(lens().at(x + offX, y + offY, begin), lens().pixel(begin));
      setFall({ centre: to.slice(0, fall.centre.length) });
    },
  };
}
