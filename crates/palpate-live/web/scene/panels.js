// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * What is drawn where: a panel for the program and a lens for all else.
 *
 * @typedef {import('./camera.js').Lens} Lens
 * @typedef {import('./camera.js').Rect} Rect
 * @typedef {import('./layer.js').Panel} Panel
 * @typedef {import('./setting.js').Setting} Setting
 * @typedef {import('./vectors.js').Vector} Vector
 * @typedef {{ only: number, shift: Vector }} Moved the body `only` moved by −`shift`
 * @typedef {Moved & { panel: Panel, lens: Lens, title: string, other: Moved, spacing: number, isFlat: boolean,
 *   hasPlane: boolean, hasLines: boolean, isWhole: boolean }} View a part of the stage: of a body, which
 *   is compared with another, or of the whole scene; `hasPlane` if there is a plane in it, `hasLines`
 *   if the map of the plane has isolines
 */

import { state } from '../state.js';
import { FIELD_OF_VIEW } from './camera.js';
import { THEMED, colorsInUse } from './colors.js';
import { MAPS } from './glsl.js';
import { selectedBody } from './overlay.js';
import { shifts } from './setting.js';
import { slice } from './slice.js';
import { roundUp } from './units.js';
import { scale, subtract } from './vectors.js';

/** Isolines over the height of a picture at most. */
const LINES = 24;
/** Most evaluations a pixel. */
const STEPS = 220;
/** The step of differences over the size of the scene: values are off by 2e-7 of it. */
const LEAST_STEP = 2e-4;
/** The distance, and the difference of two, over which a map changes its colour, over the size of the
 * scene. */
const RANGE = { distance: 0.35, difference: 0.06 };
/** Room around the box in which rays march, over the size of the scene. */
const ROOM = 0.004;
/** Between panels in pixels. */
const GAP = 4;

/** Three rectangles beside each other, or above each other. @param {Rect} all @returns {Rect[]} */
function thirds({ x, y, width, height }) {
  return [0, 1, 2].map((index) => {
    if (width > height) {
      const part = (width - 2 * GAP) / 3;
      return { x: x + index * (part + GAP), y, width: part, height };
    }
    const part = (height - 2 * GAP) / 3;
    return { x, y: y + index * (part + GAP), width, height: part };
  });
}

/** Whether the picture is a map of a plane; the program draws no bodies that are compared.
 * @param {Setting} setting */
export function isFlat(setting) {
  const { mode } = state.view;
  return setting.dimension === 2 || mode === 'plane' || (mode === 'compare' && !state.hasCard);
}

/** Whether the map of a plane is to be seen: the program draws none in space. @param {View} view */
export const hasMap = ({ hasPlane, isFlat: isPlane }) => hasPlane && (isPlane || state.hasCard);

/** The parts of the stage. @param {Setting} setting
 * @param {{ orbit: import('./camera.js').Orbit, flat: import('./camera.js').Flat }} cameras
 * @param {Rect} all @returns {View[]} */
export function viewsOf(setting, cameras, all) {
  const { view } = state;
  const isComparing = view.mode === 'compare' && setting.bodies.length > 1;
  if (!isComparing) return [viewOf(setting, cameras, all, '', [-1, -1], MAPS[view.map])];
  const [a, b] = view.compared;
  const [nameA, nameB] = [a, b].map((body) => setting.bodies[body]?.name ?? `body ${body}`);
  const [left, right, last] = thirds(all);
  return [
    viewOf(setting, cameras, left, nameA, [a, b], MAPS[view.map]),
    viewOf(setting, cameras, right, nameB, [b, a], MAPS[view.map]),
    viewOf(setting, cameras, last, `${nameA} − ${nameB}`, [a, b], MAPS.difference),
  ];
}

/** @param {Setting} setting @param {{ orbit: import('./camera.js').Orbit,
 *   flat: import('./camera.js').Flat }} cameras @param {Rect} rect @param {string} title
 * @param {number[]} bodies the body that is shown, −1 for all, and that it differs from
 * @param {number} map @returns {View} */
function viewOf(setting, cameras, rect, title, [only, other], map) {
  const { view } = state;
  const flat = isFlat(setting);
  const camera = flat ? cameras.flat : cameras.orbit;
  const lens = camera.lens(rect);
  const isWhole = only < 0;
  const [shift, otherShift] = isWhole ? [[0, 0, 0], [0, 0, 0]] : shifts(setting, [only, other]);
  const spacing = view.spacing ?? roundUp(camera.height / LINES);
  const colors = colorsInUse();
  const shown = {
    spacing, only, other, shift, otherShift,
    selected: selectedBody() + 1,
    range: (map === MAPS.difference ? RANGE.difference : RANGE.distance) * setting.size,
    sineFactor: view.sineFactor,
    isolines: view.isolines,
    asInMemoir: view.asInMemoir,
    positiveInside: view.positiveInside,
    channels: [view.channels.red, view.channels.green, view.channels.blue].map(Number),
    leastStep: LEAST_STEP * setting.size,
    theme: THEMED.map((name) => colors[name]),
  };
  const hasPlane = flat || view.mode === 'slice' || view.mode === 'compare';
  const hasLines = hasPlane && view.isolines && map !== MAPS.difference
    && !(map === MAPS.distance && view.asInMemoir);
  const compared = { only: other, shift: otherShift };
  const common = { lens, title, only, shift, other: compared, spacing, isFlat: flat, hasPlane, hasLines, isWhole };
  if (flat) {
    const { frame: { origin, right, up }, centre, height } = cameras.flat;
    const needsGradient = map === MAPS.gradient || map === MAPS.promise;
    const values = {
      ...shown, leastStep: view.offset ?? shown.leastStep, origin, across: right, above: up, centre,
      span: [(height * rect.width) / rect.height, height],
      first: needsGradient ? 0 : 4,
      last: map === MAPS.difference ? 6 : 5,
    };
    return { ...common, panel: { kind: 'flat', map, rect, values } };
  }
  const { eye, right, up, forward } = lens.basis;
  const tangent = Math.tan(FIELD_OF_VIEW / 2);
  const box = (isWhole ? null : setting.bodies[only]?.box) ?? setting.box;
  const room = [1, 1, 1].map(() => ROOM * setting.size);
  const values = {
    ...shown, eye, forward,
    across: scale(right, (tangent * rect.width) / rect.height),
    above: scale(up, tangent),
    low: subtract(subtract(box.low, shift), room),
    high: subtract(subtract(box.high, shift), scale(room, -1)),
    cone: tangent,
    rate: 1 / Math.max(Number(state.scene?.lipschitz ?? 1), 0.25),
    steps: STEPS,
    picking: false,
    sliceOrigin: slice.frame.origin,
    sliceAcross: slice.frame.right,
    sliceAbove: slice.frame.up,
    sliceReach: slice.reach,
  };
  return { ...common, panel: { kind: hasPlane ? 'slice' : 'space', map, rect, values } };
}
