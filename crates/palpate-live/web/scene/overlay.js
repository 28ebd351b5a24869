// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * What lies over the scene: points, forces, contacts, names and boxes.
 *
 * @typedef {import('./ink.js').Context} Context
 * @typedef {import('./ink.js').Inks} Inks
 * @typedef {import('./panels.js').View} View
 * @typedef {import('./setting.js').Setting} Setting
 * @typedef {import('./setting.js').Box} Box
 * @typedef {import('./vectors.js').Vector} Vector
 * @typedef {import('../wire.js').Point} Point
 * @typedef {import('./texts.js').Texts} Texts
 */

import { handOf, ledPlace } from '../input/hand.js';
import { state } from '../state.js';
import { pullInWords } from './guides.js';
import { arrow, dot, numbered, polyline, ring, spring } from './ink.js';
import { COLORS, LIFTED, mark, veiled } from './marks.js';
import { centreOf, cornersOf, numberOf } from './setting.js';
import { slice } from './slice.js';
import { widthOf } from './texts.js';
import { level, roundUp } from './units.js';
import { along, dot as product, inSpace, norm, placedBy, subtract } from './vectors.js';

/** The length of the arrow of the largest force in pixels. */
const LONGEST = 130;
/** The largest force if the device does not tell it [N]. */
const MOST_FORCE = 10;
const { force: FORCE, normal: NORMAL, contact: CONTACT } = COLORS;
/** The order in which texts take their places. */
export const RANK = { hovered: 0, selected: 1, verdict: 2, force: 3, touched: 4, name: 10, point: 15, small: 20 };
/** A body that is seen smaller than this has its name last, in pixels. */
const SMALL = 24;
/** A contact is on the far side of its body where the cosine from its normal to the viewer is less. */
const FAR_SIDE = -0.05;
/** How far off the plane a hand is for words to say so, in pixels. */
const WORTH_TELLING = 2;
/** The part of an edge that a bracket around the selected body covers. */
const BRACKET = 0.18;
const EDGES = [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4],
  [0, 4], [1, 5], [2, 6], [3, 7]];

/** The edges of a box, whose corners `place` moves. @param {Context} context @param {View} view @param {Box} box
 * @param {string} color @param {(point: Vector) => Vector} [place] */
function paintBox(context, { lens }, box, color, place = (point) => point) {
  const places = cornersOf(box).map((corner) => lens.project(place(corner)));
  for (const [from, to] of EDGES) {
    if (to < places.length) polyline(context, [places[from], places[to]], color, 1, 'transparent');
  }
}

/** The corners of the box of the selected body. @param {Context} context @param {View} view
 * @param {Box} box @param {string} halo */
function paintBrackets(context, { lens }, box, halo) {
  const corners = cornersOf(box);
  for (const [from, to] of EDGES) {
    if (to >= corners.length) continue;
    const way = [0, 1, 2].map((axis) => corners[to][axis] - corners[from][axis]);
    for (const [end, part] of /** @type {[number, number][]} */ ([[from, BRACKET], [to, -BRACKET]])) {
      const places = [corners[end], along(corners[end], way, part)].map(lens.project);
      polyline(context, places, COLORS.selected, 1.5, halo);
    }
  }
}

/** The number of the body that is selected, or that a selected part is in; −1 without one. */
export function selectedBody() {
  const number = /^\/bodies\/(\d+)(\/|$)/.exec(state.selection ?? '')?.[1];
  return number === undefined ? -1 : Number(number);
}

/** How far the corners of a box are apart, as it is seen, in pixels.
 * @param {View} view @param {Box} box */
function seenSize({ lens }, { low, high }) {
  const middle = centreOf({ low, high });
  return Math.hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]) / lens.pixel(middle);
}

/** Boxes, balls and names of the bodies. @param {Context} context @param {View} view
 * @param {Setting} setting @param {Texts} texts @param {Inks} inks
 * @param {{ outlined: number, hovered: number }} which a body that has its box in any case, and one
 *   whose name is elsewhere; −1 for none */
export function paintBodies(context, view, setting, texts, inks, { outlined, hovered }) {
  const { shown } = state.view;
  const selected = selectedBody();
  const touched = new Set((state.frame?.points ?? []).filter(({ contact }) => contact).map(({ body }) => body));
  setting.bodies.forEach(({ name, box }, body) => {
    if (!box) return;
    const size = seenSize(view, box);
    const place = view.lens.project(centreOf(box));
    if (shown.bounds) {
      mark('bounds');
      paintBox(context, view, box, inks.muted);
      ring(context, place, size / 2, inks.muted, 1, 'transparent');
    }
    if (body === selected) mark('selected');
    if (body === outlined) paintBrackets(context, view, box, inks.halo);
    if (!shown.names || !place || body === hovered) return;
    const rank = body === selected ? RANK.selected : touched.has(body) ? RANK.touched
      : size > SMALL ? RANK.name : RANK.small;
    // Of bodies alike, the larger is the first.
    texts.add(body === selected ? `▸ ${name}` : name, place.x, place.y, { rank: rank + 1 / (2 + size) });
  });
}

/** The keys of the hand's middle and contact points, and of contacts of bodies, for what bodies hide. */
export const MIDDLE = 'middle';
export const keyOfPoint = (/** @type {number} */ number) => `point ${number}`;
const keyOfContact = (/** @type {number} */ number) => `contact ${number}`;

/** The contacts of bodies, each with the points on both. @param {any} answer */
const contactsOf = (answer) => (answer?.pairs ?? []).flatMap((/** @type {any} */ pair) => pair.contacts)
  .map((/** @type {any} */ { point_a: a, point_b: b, normal }) => ({ a: inSpace(a), b: inSpace(b), normal }));

/** What bodies may hide. Of a contact point in a body, the proxy tells whether it is seen.
 * @param {any} answer the contacts of bodies @returns {import('./veil.js').Mark[]} */
export function marksOf(answer) {
  const points = state.frame?.points ?? [];
  const middle = points.length > 1 ? [{ key: MIDDLE, point: handOf() ?? [0, 0, 0], radius: 0 }] : [];
  const hand = points.map(({ contact, device, proxy }, number) =>
    ({ key: keyOfPoint(number), point: contact ? proxy : device, radius: 0 }));
  const contacts = contactsOf(answer).map((/** @type {any} */ { a, b }, /** @type {number} */ number) =>
    ({ key: keyOfContact(number), point: a, radius: norm(subtract(a, b)) }));
  return [...middle, ...hand, ...(state.view.shown.contacts ? contacts : [])];
}

/** Contacts of bodies, and boxes that were ruled out. @param {Context} context
 * @param {View} view @param {any} answer @param {Inks} inks @param {(key: string) => boolean} hides */
export function paintContacts(context, view, answer, inks, hides) {
  const { project, pixel } = view.lens;
  const { shown } = state.view;
  for (const { proof } of shown.proof ? answer?.pairs ?? [] : []) {
    if (!proof) continue;
    mark('proof');
    const place = placedBy(proof.world_from_boxes);
    for (const { aabb } of proof.boxes) {
      paintBox(context, view, { low: inSpace(aabb.min), high: inSpace(aabb.max) }, COLORS.proof, place);
    }
  }
  if (!shown.contacts) return;
  contactsOf(answer).forEach((/** @type {any} */ { a, b, normal }, /** @type {number} */ number) => {
    veiled(context, hides(keyOfContact(number)), () => {
      mark('contact');
      polyline(context, [project(a), project(b)], CONTACT, 2, inks.halo);
      dot(context, project(a), 4, CONTACT, inks.halo);
      if (shown.normals) {
        mark('contactNormal');
        const tip = along(a, inSpace(normal), 34 * pixel(a));
        arrow(context, project(a), project(tip), CONTACT, 1.5, inks.halo);
      }
    });
  });
}

/** How far a point lies behind the plane of space that is drawn alone; 0 where there is none [m].
 * @param {View} view @param {Vector} point */
const behindPlane = ({ lens, isFlat }, point) => (isFlat && state.scene?.dimension === 3
  ? product(subtract(point, slice.frame.origin), lens.basis.forward) : 0);

/** One contact point: where the device is, the proxy on the surface, force and normal.
 * @param {Context} context @param {View} view @param {Point} point @param {string} color
 * @param {Inks} inks */
function paintPoint(context, view, point, color, inks) {
  const { lens } = view;
  const { shown } = state.view;
  if (state.frame?.lifted) {
    mark('lifted');
    context.save();
    context.globalAlpha *= LIFTED;
    ring(context, lens.project(point.device), 6, color, 1.5, inks.halo);
    context.restore();
    return;
  }
  const [device, proxy] = [lens.project(point.device), lens.project(point.proxy)];
  const felt = point.contact ? { place: proxy, radius: 6, at: point.proxy } : { place: device, radius: 5, at: point.device };
  const isOff = Math.abs(behindPlane(view, felt.at)) > felt.radius * lens.pixel(felt.at);
  if (isOff) mark('off');
  if (!isOff || point.contact) mark(point.contact ? 'device' : 'free');
  if (point.contact) {
    if (!isOff) mark('proxy');
    polyline(context, [device, proxy], color, 1.5, inks.halo);
    ring(context, device, 5, color, 1.5, inks.halo);
    if (shown.normals) {
      mark('normal');
      const tip = along(point.proxy, point.normal, 38 * lens.pixel(point.proxy));
      arrow(context, proxy, lens.project(tip), NORMAL, 1.5, inks.halo);
    }
    if (point.slipping) ring(context, proxy, 10, color, 1, inks.halo);
  }
  if (isOff) ring(context, felt.place, felt.radius, color, 1.5, inks.halo);
  else dot(context, felt.place, felt.radius, color, inks.halo);
  if (shown.forces && norm(point.force) > 0.01) {
    mark('force');
    const most = Number(state.scene?.device?.max_force) || MOST_FORCE;
    const reach = Math.min(1.2, norm(point.force) / most) * LONGEST * lens.pixel(point.proxy);
    const tip = along(point.proxy, point.force, reach / norm(point.force));
    arrow(context, proxy, lens.project(tip), FORCE, 3, inks.halo);
  }
}

/** The middle of a hand with several points, and its arms. @param {Context} context @param {View} view
 * @param {Vector} hand @param {Point[]} points @param {Inks} inks @param {(key: string) => boolean} hides */
function paintMiddle(context, { lens: { project } }, hand, points, inks, hides) {
  const middle = project(hand);
  for (const { device } of points) polyline(context, [middle, project(device)], inks.muted, 1, 'transparent');
  veiled(context, hides(MIDDLE), () => ring(context, middle, 8, inks.ink, 1.5, inks.halo));
}

/** The contact points, with their numbers if there are several. @param {Context} context @param {View} view
 * @param {Point[]} points @param {Texts} texts @param {Inks} inks @param {(key: string) => boolean} hides */
function paintPoints(context, view, points, texts, inks, hides) {
  points.forEach((point, number) => {
    const place = view.lens.project(point.device);
    const leads = number === state.touch.point;
    // A contact on the far side of a body lies behind it.
    const isFar = !view.isFlat && point.contact && product(point.normal, view.lens.towards(point.proxy)) < FAR_SIDE;
    veiled(context, isFar || hides(keyOfPoint(number)), () => {
      paintPoint(context, view, point, numbered(number), inks);
      if (leads) ring(context, place, 10, inks.ink, 1.5, inks.halo);
    });
    if (points.length > 1 && place && (leads || state.view.shown.names)) {
      texts.add(String(number + 1), place.x + 12, place.y - 10, { rank: leads ? RANK.selected : RANK.point, isFixed: true });
    }
  });
}

/** The spring by which the page leads the hand. @param {Context} context @param {View} view
 * @param {Vector} led @param {Vector} target @param {Inks} inks */
function paintSpring(context, { lens: { project } }, led, target, inks) {
  mark('spring');
  const goal = project(target);
  spring(context, project(led), goal, inks.ink, inks.halo);
  ring(context, goal, 7, inks.ink, 1.5, inks.halo);
  dot(context, goal, 2, inks.ink, inks.halo);
}

/** How far the hand is off the plane. @param {View} view @param {Vector} led @param {Texts} texts */
function addDistance(view, led, texts) {
  const behind = behindPlane(view, led);
  const pixel = view.lens.pixel(led);
  const at = view.lens.project(led);
  if (!at || Math.abs(behind) <= WORTH_TELLING * pixel) return;
  const far = level(Math.abs(behind), roundUp(WORTH_TELLING * pixel));
  texts.add(`${far} ${behind > 0 ? 'behind' : 'in front of'} the plane`, at.x, at.y - 20, { rank: RANK.force });
}

/** The force, beside the point that feels most of it. @param {Context} context @param {View} view
 * @param {Point[]} points @param {Texts} texts */
function addForce(context, view, points, texts) {
  const force = state.frame?.force ?? 0;
  const strongest = points.reduce((most, point) => (norm(point.force) > norm(most.force) ? point : most));
  const place = view.lens.project(strongest.proxy);
  if (!(force > 0.01) || !place) return;
  const pull = pullInWords(strongest);
  const words = `${force.toFixed(2)} N${pull && `, ${pull}`}`;
  texts.add(words, place.x + 16 + widthOf(context, words) / 2, place.y + 16, { rank: RANK.force });
}

/** The hand with its points, and the spring by which the page leads it.
 * @param {Context} context @param {View} view @param {Vector | null} target @param {Texts} texts
 * @param {Inks} inks @param {(key: string) => boolean} hides */
export function paintHand(context, view, target, texts, inks, hides) {
  const points = state.frame?.points ?? [];
  const hand = handOf();
  if (!hand) return;
  const led = ledPlace() ?? hand;
  if (points.length > 1) paintMiddle(context, view, hand, points, inks, hides);
  paintPoints(context, view, points, texts, inks, hides);
  // Of the past, where the hand was led is not known.
  const isNow = state.frame === state.newest;
  if (target && isNow && state.view.shown.spring) paintSpring(context, view, led, target, inks);
  addDistance(view, led, texts);
  if (state.view.shown.forces) addForce(context, view, points, texts);
}

/** What the probe found, and the name of the body that it is on. @param {Context} context
 * @param {View} view @param {import('./probe.js').Probed | null} probe @param {Texts} texts
 * @param {Inks} inks */
export function paintProbe(context, view, probe, texts, inks) {
  if (!probe) return;
  const { lens } = view;
  mark('probe');
  const at = lens.project(probe.at);
  if (probe.nearest) {
    const nearest = lens.project(probe.nearest);
    polyline(context, [at, nearest], NORMAL, 1.5, inks.halo);
    dot(context, nearest, 3.5, NORMAL, inks.halo);
  }
  if (at && probe.safe > 0) ring(context, at, probe.safe / lens.pixel(probe.at), NORMAL, 1, 'transparent');
  dot(context, at, 2.5, inks.ink, inks.halo);
  const name = state.scene?.bodies?.[hoveredBody(view, probe)]?.name;
  if (name && at) texts.add(name, at.x, at.y - 20, { rank: RANK.hovered });
}

/** The number of the body that the probe is on; −1 where it is beside all. @param {View} view
 * @param {import('./probe.js').Probed | null} probe */
export function hoveredBody({ lens }, probe) {
  return probe && probe.value < 2 * lens.pixel(probe.at) ? numberOf(probe.body) : -1;
}
