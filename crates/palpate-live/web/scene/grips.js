// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * Handles of the selected body or shape: arrows that move it along the axes that its numbers count
 * along, a middle that moves it parallel to the screen, rings that turn it, a square that scales it.
 *
 * @typedef {import('./camera.js').Lens} Lens
 * @typedef {import('./ink.js').Context} Context
 * @typedef {import('./ink.js').Inks} Inks
 * @typedef {import('./placement.js').Part} Part
 * @typedef {import('./vectors.js').Vector} Vector
 * @typedef {import('../input/pointer.js').Drag} Drag
 * @typedef {import('../input/pointer.js').Place} Place
 * @typedef {'move' | 'free' | 'turn' | 'scale'} Kind
 * @typedef {{ kind: Kind, axis: number, knob: Vector, ring: Vector[] }} Grip `axis` is −1 without one
 */

import { edit } from '../panels/edits.js';
import { state } from '../state.js';
import { placed, within } from './frames.js';
import { arrow, dot, polyline } from './ink.js';
import { AXIS_COLORS, mark } from './marks.js';
import { RANK } from './overlay.js';
import { movedPart, scaledPart, selectedPart, turnedPart } from './placement.js';
import { length } from './units.js';
import { AXES, add, along, cross, dot as product, scale, subtract, unit } from './vectors.js';

/** How far arrows, rings and the square reach from the middle, in pixels: fingers tell them apart. */
const ARROW = 60;
const RING = 92;
const SQUARE = 136;
/** An arrow that is seen shorter than this cannot be dragged along, in pixels. */
const SHORTEST = 24;
/** Parts of a ring. */
const PARTS = 64;
/** A ring that is seen flatter than this is one line: the cosine between its axis and the view. */
const EDGE_ON = 0.2;
const KNOB = 7;
/** The tip of an arrow, over how far its knob is from the middle. */
const TIP = 1.35;
/** Where no text lies over an arrow, as parts of its length. */
const ON_ARROW = [0.25, 0.5, 0.75, 1];

/** What is dragged, and what the drag says. @type {{ kind: Kind, axis: number, text: string } | null} */
let active = null;
/** What the arrow keys do to the selected part. @type {{ kind: Kind | null }} */
export const keyed = { kind: null };

/** The part whose handles are shown, or null. */
function partShown() {
  return state.view.shown.handles && state.connection === 'live' ? selectedPart() : null;
}

/** @param {Part} part */
const middleOf = ({ frame, middle }) => placed(frame, middle);

/** The handles of a part, as they lie in the scene. @param {Part} part @param {Lens} lens
 * @param {boolean} isFlat @returns {Grip[]} */
function gripsOf(part, lens, isFlat) {
  const { axes } = part.frame;
  const centre = middleOf(part);
  const seen = lens.project(centre);
  if (!seen) return [];
  const dimension = state.scene?.dimension ?? 3;
  const pixel = lens.pixel(centre);
  /** @type {Grip[]} */
  const grips = [];
  for (let axis = 0; axis < dimension; axis += 1) {
    const knob = along(centre, axes[axis], ARROW * pixel);
    const tip = lens.project(knob);
    const isLong = tip && Math.hypot(tip.x - seen.x, tip.y - seen.y) > SHORTEST;
    if (isLong) grips.push({ kind: 'move', axis, knob, ring: [] });
  }
  for (const axis of dimension === 2 ? [2] : [0, 1, 2]) {
    if (isFlat && Math.abs(product(axes[axis], lens.basis.forward)) < EDGE_ON) continue;
    const at = (/** @type {number} */ angle) => along(along(centre, axes[(axis + 1) % 3],
      RING * pixel * Math.cos(angle)), axes[(axis + 2) % 3], RING * pixel * Math.sin(angle));
    const ring = Array.from({ length: PARTS }, (_, index) => at((2 * Math.PI * index) / PARTS));
    grips.push({ kind: 'turn', axis, knob: at(Math.PI / 4), ring });
  }
  const corner = SQUARE * Math.SQRT1_2;
  grips.push({ kind: 'free', axis: -1, knob: centre, ring: [] },
    { kind: 'scale', axis: -1, knob: lens.at(seen.x - corner, seen.y - corner, centre), ring: [] });
  return grips;
}

/** @param {Lens} lens @param {Place} place @param {Vector} point */
function apart(lens, { x, y }, point) {
  const seen = lens.project(point);
  return seen ? Math.hypot(seen.x - x, seen.y - y) : Infinity;
}

/** The handle that is nearest to a place within a reach in pixels, how far it is, and what a drag of
 * it does, in words too; null without one. A ring is held anywhere, within half of the reach.
 * @param {() => Lens} lens @param {boolean} isFlat @param {Place} place @param {number} reach
 * @returns {{ apart: number, name: string, begin: () => Drag } | null} */
export function gripAt(lens, isFlat, place, reach) {
  const part = partShown();
  if (!part) return null;
  const now = lens();
  const [nearest] = gripsOf(part, now, isFlat).map((grip) => {
    const line = Math.min(Infinity, ...grip.ring.map((point) => apart(now, place, point)));
    return { grip, apart: Math.min(apart(now, place, grip.knob), 2 * line) };
  }).sort((a, b) => a.apart - b.apart);
  if (!nearest || nearest.apart > reach) return null;
  return { apart: nearest.apart, name: nameOf(nearest.grip), begin: () => gripDrag(part, nearest.grip, lens, place) };
}

/** What a handle does. @param {Grip} grip */
function nameOf({ kind, axis }) {
  if (kind === 'move') return `Move along ${'xyz'[axis]}`;
  if (kind === 'turn') return `Turn about ${'xyz'[axis]}`;
  return kind === 'scale' ? 'Scale' : 'Move parallel to the screen';
}

/** Where along an axis through a point a place of the screen is [m]. @param {Lens} lens
 * @param {Place} place @param {Vector} centre @param {Vector} axis */
function alongAxis(lens, place, centre, axis) {
  const { from, way } = rayOf(lens, place, centre);
  const slope = product(way, axis);
  const off = subtract(from, centre);
  return (product(off, axis) - slope * product(off, way)) / Math.max(1 - slope * slope, 1e-3);
}

/** The line that is seen as a place, from the depth of a point. @param {Lens} lens
 * @param {Place} place @param {Vector} through */
function rayOf(lens, { x, y }, through) {
  const from = lens.at(x, y, through);
  return { from, way: unit(subtract(lens.at(x, y, add(through, lens.basis.forward)), from)) };
}

/** The angle of a place about an axis of a part [rad]. @param {Lens} lens @param {Place} place
 * @param {Vector} centre @param {Vector[]} axes @param {number} axis */
function angleAbout(lens, place, centre, axes, axis) {
  const about = axes[axis];
  const { from, way } = rayOf(lens, place, centre);
  if (Math.abs(product(way, about)) > EDGE_ON) {
    const distance = product(subtract(centre, from), about) / product(way, about);
    const arm = subtract(along(from, way, distance), centre);
    return Math.atan2(product(arm, axes[(axis + 2) % 3]), product(arm, axes[(axis + 1) % 3]));
  }
  // Seen from its edge, a ring turns as its near side moves.
  const seen = lens.project(centre);
  const tip = lens.project(along(centre, unit(cross(about, lens.towards(centre))), RING * lens.pixel(centre)));
  if (!seen || !tip) return 0;
  const [across, down] = [tip.x - seen.x, tip.y - seen.y];
  return ((place.x - seen.x) * across + (place.y - seen.y) * down) / (across * across + down * down);
}

/** @param {Part} part @param {Grip} grip @param {() => Lens} lens @param {Place} place
 * @returns {Drag} */
function gripDrag(part, { kind, axis }, lens, place) {
  const { frame } = part;
  const centre = middleOf(part);
  /** @type {import('../panels/edits.js').Change[]} */
  let last = [];
  const begin = { ...place };
  let before = kind === 'turn' ? angleAbout(lens(), place, centre, frame.axes, axis) : 0;
  let angle = 0;
  const reach = apart(lens(), place, centre);

  /** What the drag to a place changes, and in words. @param {Place} to */
  const changesTo = (to) => {
    const now = lens();
    const pixel = now.pixel(centre);
    if (kind === 'turn') {
      const next = angleAbout(now, to, centre, frame.axes, axis);
      angle += Math.atan2(Math.sin(next - before), Math.cos(next - before));
      before = next;
      const degrees = Number(((angle * 180) / Math.PI).toFixed(1));
      return { changes: turnedPart(part, AXES[axis], degrees, pixel / 10), text: `${degrees}°` };
    }
    if (kind === 'scale') {
      const factor = Number(Math.max(apart(now, to, centre) / reach, 0.01).toPrecision(3));
      return { changes: scaledPart(part, factor, pixel / 10), text: `× ${factor}` };
    }
    const by = kind === 'free'
      ? within(frame, subtract(now.at(to.x, to.y, centre), now.at(begin.x, begin.y, centre)))
      : scale(AXES[axis], (alongAxis(now, to, centre, frame.axes[axis])
        - alongAxis(now, begin, centre, frame.axes[axis])) / frame.scale);
    const way = kind === 'free' ? Math.hypot(...by) : by[axis];
    const text = `${kind === 'free' ? '' : `${'xyz'[axis]} `}${way > 0 ? '+' : ''}${length(way)}`;
    return { changes: movedPart(part, by, pixel), text };
  };
  return {
    move(to) {
      const { changes, text } = changesTo(to);
      active = { kind, axis, text };
      if (changes.length === 0 || JSON.stringify(changes) === JSON.stringify(last)) return;
      last = changes;
      edit(changes, true);
    },
    end() {
      active = null;
      if (last.length > 0) edit(last);
    },
  };
}

/** @param {Context} context @param {Lens} lens @param {boolean} isFlat
 * @param {import('./texts.js').Texts} texts @param {Inks} inks */
export function paintGrips(context, lens, isFlat, texts, inks) {
  const part = partShown();
  const grips = part ? gripsOf(part, lens, isFlat) : [];
  if (!part || grips.length === 0) return;
  mark('handles');
  const middle = middleOf(part);
  for (const { kind, axis, knob, ring } of grips) {
    const place = lens.project(knob);
    if (!place) continue;
    const color = AXIS_COLORS[axis] ?? inks.ink;
    const isStrong = active ? active.kind === kind && active.axis === axis : keyed.kind === kind;
    const radius = isStrong ? KNOB + 2 : KNOB;
    if (kind === 'move') {
      const tip = along(middle, subtract(knob, middle), TIP);
      const [from, to] = [lens.project(middle), lens.project(tip)];
      arrow(context, from, to, color, isStrong ? 3.5 : 2, inks.halo);
      if (from && to) {
        for (const share of ON_ARROW) {
          texts.taken.push({
            x: from.x + share * (to.x - from.x), y: from.y + share * (to.y - from.y), wide: 2 * KNOB, high: 2 * KNOB,
          });
        }
      }
    }
    polyline(context, ring.map(lens.project), color, isStrong ? 2.5 : 1, inks.halo, true);
    if (kind === 'scale') square(context, place, radius, color);
    else dot(context, place, radius, kind === 'free' ? inks.halo : color, kind === 'free' ? inks.ink : '#ffffff');
    texts.taken.push({ ...place, wide: 2 * radius, high: 2 * radius });
    const text = active && isStrong ? active.text : keyed.kind && kind === 'free' ? `arrow keys ${keyed.kind} it` : '';
    if (text) texts.add(text, place.x, place.y - 22, { rank: RANK.hovered });
  }
}

/** @param {Context} context @param {Place} place @param {number} half @param {string} color */
function square(context, { x, y }, half, color) {
  context.fillStyle = color;
  context.fillRect(x - half, y - half, 2 * half, 2 * half);
  context.strokeStyle = '#ffffff';
  context.lineWidth = 1.5;
  context.strokeRect(x - half, y - half, 2 * half, 2 * half);
}
