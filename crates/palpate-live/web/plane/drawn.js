// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * The toys as they are drawn: elements with their verdicts, paths of local searches, circles,
 * witnesses of two bodies, and an element that moves.
 *
 * @typedef {import('../scene/ink.js').Context} Context
 * @typedef {import('../scene/ink.js').Inks} Inks
 * @typedef {import('../scene/camera.js').Lens} Lens
 * @typedef {import('../scene/texts.js').Texts} Texts
 */

import { short } from '../panels/numbers.js';
import { arrow, dot, polyline, ring } from '../scene/ink.js';
import { COLORS, mark } from '../scene/marks.js';
import { RANK } from '../scene/overlay.js';
import { length } from '../scene/units.js';
import { inSpace } from '../scene/vectors.js';
import { LETTERS, handles, middleOfElement } from './handles.js';
import { toys } from './toys.js';

const { hit: HIT, normal: FREE, path: PATH } = COLORS;
const OPEN = '#7a6a00';
const VERDICT = RANK.verdict;
/** The size of a handle in pixels, and how far beside it its letter is. */
const HANDLE = 16;
const BESIDE = 18;
const NOT_DECIDED = { color: OPEN, word: 'not decided' };

/** The colour and word of a proven bound of the least distance.
 * @param {{ lower?: number, upper?: number } | null | undefined} certified */
export function verdictOf(certified) {
  if (!certified) return { color: OPEN, word: '' };
  if ((certified.upper ?? Infinity) <= 0) return { color: HIT, word: 'hit' };
  if ((certified.lower ?? -Infinity) > 0) return { color: FREE, word: 'no hit' };
  return NOT_DECIDED;
}

/** The colour and words of an answer whether something touches: null if that is not decided.
 * @param {boolean | null} touches */
export function touchOf(touches) {
  if (touches === null) return NOT_DECIDED;
  return touches ? { color: HIT, word: 'it touches' } : { color: FREE, word: 'it touches nothing' };
}

/** Between two bodies a local search makes the larger of both distances small; the separation is
 * twice the least. */
export const SEPARATION = 2;

/** What rounding may put between a local search and a proof: a length [m], and a share of it. */
const ROUNDING = { length: 1e-9, share: 1e-3 };

/** Whether a local search found what is proven: both are rounded, and the proof ends within its
 * own bounds. @param {number} value @param {{ lower: number, upper: number }} certified */
export const isFound = (value, { lower, upper }) =>
  value - upper <= upper - lower + ROUNDING.length + ROUNDING.share * Math.abs(upper);

/** Whether a local search between two bodies found what it looks for: a point in both, by projections in
 * turns, where the bodies overlap; else the separation.
 * @param {{ method: string, value: number }} local @param {{ lower: number, upper: number }} certified */
export const isFoundOfPair = ({ method, value }, certified) =>
  (method === 'alternating_projection' && certified.upper <= 0 ? value <= 0 : isFound(SEPARATION * value, certified));

/** @param {Context} context @param {Lens} lens @param {Texts} texts @param {Inks} inks */
function paintElement(context, lens, texts, inks) {
  const project = (/** @type {number[]} */ point) => lens.project(inSpace(point));
  const { certified, local, enclosing } = toys.results.element ?? {};
  const { color, word } = verdictOf(certified);
  mark('element');
  if (enclosing?.centre) {
    const radius = enclosing.radius / lens.pixel([0, 0, 0]);
    const place = project(enclosing.centre);
    mark('enclosing');
    ring(context, place, radius, enclosing.excludes ? FREE : inks.muted, 1, inks.halo);
    if (place) {
      texts.add(`circle ${enclosing.excludes ? 'excludes' : 'does not exclude'}`, place.x,
        place.y - radius - 10, { rank: VERDICT });
    }
  }
  outline(context, lens, toys.corners, color, inks);
  const path = (local?.path ?? []).map(project);
  const shown = toys.at === null ? path : path.slice(0, toys.at + 1);
  if (shown.length > 0) mark('path');
  polyline(context, shown, PATH, 1, 'transparent');
  for (const place of shown) dot(context, place, 2.5, PATH, 'transparent');
  dot(context, shown[shown.length - 1] ?? null, 5, PATH, inks.halo);
  if (certified) dot(context, project(certified.best), 5, color, inks.halo);
  const low = Math.max(...toys.corners.map((corner) => project(corner)?.y ?? 0));
  const middle = project(middleOfElement());
  toys.corners.forEach((corner, index) => {
    const place = project(corner);
    if (!place || !middle) return;
    const [across, down] = [place.x - middle.x, place.y - middle.y];
    const by = BESIDE / (Math.hypot(across, down) || 1);
    texts.add(LETTERS[index], place.x + by * across, place.y + by * down, { rank: VERDICT, color });
  });
  if (word && middle) {
    const bounds = `${length(certified.lower)} to ${length(certified.upper)}`;
    texts.add(`${word}: ${bounds}`, middle.x, low + 18, { rank: VERDICT, color });
  }
}

/** @param {Context} context @param {Lens} lens @param {number[][]} corners
 * @param {string} color @param {Inks} inks @param {boolean} [isGhost] without handles */
function outline(context, lens, corners, color, inks, isGhost = false) {
  const places = corners.map((corner) => lens.project(inSpace(corner)));
  polyline(context, places, color, isGhost ? 1.5 : 2.5, inks.halo, corners.length > 2);
  if (isGhost) return;
  for (const place of places) dot(context, place, 7, '#ffffff', color);
  if (corners.length > 1) dot(context, lens.project(inSpace(middleOfElement())), 5, '#ffffff', color);
}

/** @param {Context} context @param {Lens} lens @param {Texts} texts @param {Inks} inks */
function paintBall(context, lens, texts, inks) {
  mark('circle');
  const { centre, radius } = toys.ball;
  const answer = toys.results.ball;
  const { color, word } = touchOf(answer?.touches ?? null);
  const place = lens.project(inSpace(centre));
  const reach = radius / lens.pixel([0, 0, 0]);
  ring(context, place, reach, color, 2.5, inks.halo);
  dot(context, place, 6, '#ffffff', color);
  if (!place) return;
  dot(context, { x: place.x + reach * Math.SQRT1_2, y: place.y - reach * Math.SQRT1_2 }, 6,
    '#ffffff', color);
  const below = place.y + reach + 14;
  if (answer) texts.add(`${word}, f ${length(answer.value)}`, place.x, below, { rank: VERDICT, color });
}

/** @param {Context} context @param {Lens} lens @param {Texts} texts @param {Inks} inks */
function paintPair(context, lens, texts, inks) {
  const project = (/** @type {number[]} */ point) => lens.project(inSpace(point));
  const { certified, penetration, contact, local } = toys.results.pair ?? {};
  const colors = toys.pair.starts.map((_, number) => {
    const one = local?.[number];
    if (!certified || typeof one?.value !== 'number') return OPEN;
    const found = isFoundOfPair(one, certified);
    mark(found ? 'found' : 'missed');
    return found ? FREE : PATH;
  });
  (local ?? []).forEach((/** @type {any} */ { path, best }, /** @type {number} */ number) => {
    const places = path.map(project);
    if (places.length > 1) mark('path');
    polyline(context, places, colors[number] ?? PATH, 1.5, inks.halo);
    for (const place of places) dot(context, place, 2.5, colors[number] ?? PATH, 'transparent');
    dot(context, project(best), 6, colors[number] ?? PATH, inks.halo);
  });
  toys.pair.starts.forEach((start, number) => {
    const place = project(start);
    dot(context, place, 6, '#ffffff', colors[number]);
    if (place) texts.add(String(number + 1), place.x + 14, place.y, { rank: VERDICT + 0.5, color: colors[number] });
  });
  const { color, word } = verdictOf(certified);
  const [a, b] = contact ? [contact.point_a, contact.point_b].map(project) : [];
  if (a && b) {
    mark('witness');
    polyline(context, [a, b], color, 2, inks.halo);
    dot(context, a, 5, color, inks.halo);
    dot(context, b, 5, color, inks.halo);
    const bounds = `${length(certified.lower)} to ${length(certified.upper)}`;
    const [x, y] = [(a.x + b.x) / 2, Math.min(a.y, b.y) - 14];
    texts.add(penetration ? `${word}, minus the largest ball in both: ${bounds}` : `${word}: ${bounds}`, x, y, { rank: VERDICT, color });
    if (penetration) texts.add(`penetration, the shortest way out: ${wayOut(penetration)}`, x, y - 18, { rank: VERDICT, color });
  }
}

/** How far a body must move to leave the other. @param {{ lower: number, upper: number | null }} penetration */
export const wayOut = ({ lower, upper }) =>
  (upper === null ? `at least ${length(lower)}` : `${length(lower)} to ${length(upper)}`);

/** @param {Context} context @param {Lens} lens @param {Texts} texts @param {Inks} inks */
function paintSweep(context, lens, texts, inks) {
  mark('motion');
  const answer = toys.results.sweep;
  const { by, corners } = toys;
  const moved = (/** @type {number} */ t) => corners.map(([x, y]) => [x + t * by[0], y + t * by[1]]);
  const from = middleOfElement();
  const places = [from, [from[0] + by[0], from[1] + by[1]]].map((p) => lens.project(inSpace(p)));
  if (!toys.shown.element) outline(context, lens, corners, inks.ink, inks);
  outline(context, lens, moved(1), inks.muted, inks, true);
  arrow(context, places[0], places[1], inks.ink, 2, inks.halo);
  dot(context, places[1], 6, '#ffffff', inks.ink);
  if (!answer || !places[1]) return;
  const { touches, upper, contact } = answer;
  const { color, word } = touchOf(touches);
  if (touches) outline(context, lens, moved(upper), color, inks, true);
  if (contact) {
    mark('touch');
    dot(context, lens.project(inSpace(contact.point_a)), 5, color, inks.halo);
  }
  const text = touches ? `${word} at ${short(upper, 5)} s` : word;
  texts.add(text, places[1].x, places[1].y + 18, { rank: VERDICT, color });
}

/** @param {Context} context @param {Lens} lens @param {Texts} texts @param {Inks} inks */
export function paintToys(context, lens, texts, inks) {
  const { shown, corners } = toys;
  for (const { point } of handles()) {
    const place = lens.project(inSpace(point));
    if (place) texts.taken.push({ ...place, wide: HANDLE, high: HANDLE });
  }
  if (shown.sweep && corners.length > 0) paintSweep(context, lens, texts, inks);
  if (shown.element && corners.length > 0) paintElement(context, lens, texts, inks);
  if (shown.ball) paintBall(context, lens, texts, inks);
  if (shown.pair) paintPair(context, lens, texts, inks);
}
