// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * The guides of the scene: as lines, and in words while they pull.
 *
 * @typedef {import('./ink.js').Context} Context
 * @typedef {import('./ink.js').Inks} Inks
 * @typedef {import('./panels.js').View} View
 * @typedef {import('./setting.js').Setting} Setting
 * @typedef {import('./vectors.js').Vector} Vector
 */

import { state } from '../state.js';
import { polyline, ring } from './ink.js';
import { COLORS, mark } from './marks.js';
import { AXES, along, cross, dot, inSpace, norm, subtract, unit } from './vectors.js';

/** Straight pieces of a smooth curve between two of its points, as the core has them. */
const PIECES = 16;
/** The arms of the cross at a point in pixels. */
const ARM = 8;
/** What pulls less is not told of [N]. */
const LEAST = 0.02;

/** The smooth curve through points, by Catmull and Rom, with the tangents of the core.
 * @param {Vector[]} points @returns {Vector[]} */
function smooth(points) {
  return points.flatMap((to, number) => {
    const from = points[number - 1];
    if (!from) return [to];
    const leave = subtract(to, points[number - 2] ?? from);
    const arrive = subtract(points[number + 1] ?? to, from);
    return Array.from({ length: PIECES }, (_, piece) => {
      const t = (piece + 1) / PIECES;
      const between = along(from, subtract(to, from), t * t * (3 - 2 * t));
      return along(along(between, leave, 0.5 * t * (1 - t) ** 2), arrive, 0.5 * t * t * (t - 1));
    });
  });
}

/** Lines of endless guides reach as far as the scene from what is nearest to its middle.
 * @param {Vector} through @param {Vector} direction @param {Setting} setting @returns {Vector[]} */
function endless(through, direction, { centre, size }) {
  const foot = along(through, direction, dot(subtract(centre, through), direction));
  return [along(foot, direction, -size), along(foot, direction, size)];
}

/** The outline of a part of a plane, or, in the plane, a line.
 * @param {{ through: number[], normal: number[] }} plane @param {Setting} setting @returns {Vector[]} */
function planeLines(plane, setting) {
  const [through, normal] = [inSpace(plane.through), unit(inSpace(plane.normal))];
  if (setting.dimension === 2) return endless(through, cross(AXES[2], normal), setting);
  const least = [...AXES].sort((a, b) => Math.abs(dot(a, normal)) - Math.abs(dot(b, normal)))[0];
  const right = unit(cross(normal, least));
  const up = cross(normal, right);
  const { centre, size } = setting;
  const foot = along(centre, normal, dot(subtract(through, centre), normal));
  return [[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]].map(([x, y]) =>
    along(along(foot, right, 0.5 * x * size), up, 0.5 * y * size));
}

/** @param {Vector} point @param {number} arm [m] @param {number} dimension @returns {Vector[][]} */
const crossAt = (point, arm, dimension) =>
  AXES.slice(0, dimension).map((axis) => [along(point, axis, -arm), along(point, axis, arm)]);

/** The lines of a guide. @param {any} guide @param {View} view @param {Setting} setting @returns {Vector[][]} */
function linesOf({ point, line, segment, plane, curve, well }, { lens }, setting) {
  if (line) return [endless(inSpace(line.through), unit(inSpace(line.direction)), setting)];
  if (segment) return [[inSpace(segment.from), inSpace(segment.to)]];
  if (plane) return [planeLines(plane, setting)];
  if (curve) return [curve.smooth ? smooth(curve.points.map(inSpace)) : curve.points.map(inSpace)];
  const middle = inSpace(point ?? well.center);
  return crossAt(middle, ARM * lens.pixel(middle), setting.dimension);
}

/** @param {Context} context @param {View} view @param {Setting} setting @param {Inks} inks */
export function paintGuides(context, view, setting, inks) {
  const { project, pixel } = view.lens;
  const guides = state.scene?.scene?.guides ?? [];
  guides.forEach((/** @type {any} */ guide, /** @type {number} */ number) => {
    mark('guide');
    const color = state.selection === `/guides/${number}` ? COLORS.selected : COLORS.guide;
    for (const places of linesOf(guide, view, setting)) polyline(context, places.map(project), color, 1.5, inks.halo);
    if (!guide.well) return;
    const centre = inSpace(guide.well.center);
    ring(context, project(centre), guide.well.reach / pixel(centre), color, 1, inks.halo);
  });
}

/** What pulls a point beside what it touches, in words; empty if nothing does.
 * @param {import('../wire.js').Point} point */
export function pullInWords(point) {
  const { bodies = [], guides = [] } = state.scene?.scene ?? {};
  // The safety chain changes the force of what is touched too.
  const isKnown = !point.contact || !state.frame?.acted;
  if (!isKnown || norm(subtract(point.force, point.wanted)) < LEAST) return '';
  const isMagnetic = bodies.some((/** @type {any} */ { material }) => material === 'magnet' || material?.magnet);
  return [guides.length > 0 && 'guided', isMagnetic && 'drawn by a magnet'].filter(Boolean).join(' or ');
}
