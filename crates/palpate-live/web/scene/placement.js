// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * Where the selected body or shape is placed, and the edits that place it elsewhere.
 *
 * A body is moved and turned by its pose, a shape by `translate` and a turn, which it gets if it
 * has none; both are scaled by a `scale` below these. All is done about the middle of the part.
 *
 * @typedef {import('./frames.js').Frame} Frame
 * @typedef {import('./vectors.js').Vector} Vector
 * @typedef {import('../panels/edits.js').Change} Change
 * @typedef {{ pointer: string, name: string, isBody: boolean, value: any, frame: Frame, middle: Vector }} Part
 *   `frame` is what the numbers of its place count in, and `middle` is in that frame
 */

import { aboutShape } from '../panels/beside.js';
import { isPlacement, listOf, makerOf } from '../panels/nodes.js';
import { parts, within as pointerWithin } from '../panels/schema.js';
import { state } from '../state.js';
import { SCENE, frameIn, placed, turnedBy } from './frames.js';
import { add, inSpace, rounded, scale, subtract, turn } from './vectors.js';

/** The frame in which a named shape is used first. @param {string} name @returns {Frame | null} */
function frameOfNamed(name) {
  const { bodies, shapes } = state.scene?.scene;
  const visited = new Set();
  /** @param {any} shape @param {Frame | null} frame @returns {Frame | null} */
  const search = (shape, frame) => {
    const reference = typeof shape === 'string' ? shape : shape?.shape;
    if (!frame || reference === name) return frame;
    if (reference !== undefined) {
      if (visited.has(reference)) return null;
      visited.add(reference);
      return search(shapes?.[reference], frame);
    }
    const list = listOf(shape);
    for (const operand of list ? shape[list] : []) {
      const found = search(operand, frame);
      if (found) return found;
    }
    return shape?.of === undefined ? null : search(shape.of, frameIn(frame, shape));
  };
  for (const body of bodies) {
    const found = search(body.shape, frameIn(SCENE, body.pose ?? {}));
    if (found) return found;
  }
  return null;
}

/** What a shape is, below its moves and turns. @param {any} shape @returns {string} */
function nameOf(shape) {
  if (typeof shape === 'string') return shape;
  return isPlacement(shape) ? nameOf(shape.of) : (makerOf(shape) ?? 'shape').replace(/_/g, ' ');
}

/** The part of a shape that the rest of a pointer leads into. @param {string} pointer
 * @param {any} value @param {Frame | null} start @param {string[]} rest @returns {Part | null} */
function shapeAt(pointer, value, start, rest) {
  let [inner, place, frame] = [value, pointer, start];
  for (const [at, key] of rest.entries()) {
    if (key === 'of') {
      if (!isPlacement(inner)) return frame && shapeAt(pointerWithin(place, key), inner.of, frameIn(frame, inner), rest.slice(at + 1));
      frame = frame && frameIn(frame, inner);
      inner = inner.of;
      place = pointerWithin(place, key);
    } else if (key === listOf(inner) && rest[at + 1] !== undefined) {
      const index = rest[at + 1];
      return shapeAt(pointerWithin(pointerWithin(place, key), index), inner[key][index], frame, rest.slice(at + 2));
    } else break;
  }
  if (!start || value === undefined) return null;
  return { pointer, name: nameOf(value), isBody: false, value, frame: start, middle: inSpace(aboutShape(value).centre) };
}

/** The body or shape that a pointer leads into, if it has a place of its own.
 * @param {string} pointer @returns {Part | null} */
function partAt(pointer) {
  const scene = state.scene?.scene;
  const [list, key, ...rest] = parts(pointer);
  const at = pointerWithin(`/${list}`, key);
  if (list === 'shapes' && scene?.shapes?.[key] !== undefined) {
    return shapeAt(at, scene.shapes[key], frameOfNamed(key), rest);
  }
  const body = list === 'bodies' ? scene?.bodies[key] : undefined;
  if (!body) return null;
  const frame = frameIn(SCENE, body.pose ?? {});
  if (!frame) return null;
  if (rest[0] === 'shape') return shapeAt(pointerWithin(at, 'shape'), body.shape, frame, rest.slice(1));
  const middle = placed(frame, inSpace(aboutShape(body.shape).centre));
  return { pointer: at, name: body.name, isBody: true, value: body, frame: SCENE, middle };
}

/** The selected part, found once a scene. @type {{ scene: any, selection: string | null, part: Part | null }} */
let found = { scene: null, selection: null, part: null };

/** The selected body or shape with its place; null without one. */
export function selectedPart() {
  const { scene, selection } = state;
  if (found.scene !== scene || found.selection !== selection) {
    found = { scene, selection, part: scene && selection ? partAt(selection) : null };
  }
  return found.part;
}

/** @typedef {{ factor: number, digits: number }} Scaling */

/** @param {any} old @param {Scaling} by */
const scaledNumber = (old, { factor, digits }) => {
  const by = (/** @type {number} */ one) => Number((one * factor).toPrecision(digits));
  return Array.isArray(old) ? old.map(by) : by(old);
};

/** A shape that is scaled. @param {any} shape @param {Scaling} by */
const scaledShape = (shape, by) => (shape.scale === undefined
  ? { scale: scaledNumber(1, by), of: shape } : { ...shape, scale: scaledNumber(shape.scale, by) });

/** @param {string} at @param {any} shape @param {Scaling} by @returns {Change[]} */
const scaling = (at, shape, by) => [shape.scale === undefined
  ? { at, to: scaledShape(shape, by) } : { at: pointerWithin(at, 'scale'), to: scaledNumber(shape.scale, by) }];

/** The shape of a part that a scaling goes to. @param {Part} part */
const shapeToScale = ({ isBody, value }) => (isBody ? value.shape : isPlacement(value) ? value.of : value);

/** How a part is scaled: a factor, or one for each axis. @param {Part} part @returns {number | number[]} */
export const scaleOf = (part) => shapeToScale(part).scale ?? 1;

/** Whether a part has a scale already. @param {Part | null} part */
export const isScaled = (part) => part !== null && shapeToScale(part).scale !== undefined;

/** The edit that places a part anew.
 * @param {Part} part @param {{ translation?: number[], turned?: Record<string, any>, by?: Scaling }} to
 * @returns {Change[]} */
function placing({ pointer, isBody, value }, { translation, turned = {}, by }) {
  const place = { ...(translation && { [isBody ? 'translation' : 'translate']: translation }), ...turned };
  const isPlaced = Object.keys(place).length > 0;
  const scaled = (/** @type {string} */ key) =>
    (by === undefined ? [] : scaling(pointerWithin(pointer, key), value[key], by));
  if (isBody) {
    const pose = { at: pointerWithin(pointer, 'pose'), to: { ...value.pose, ...place } };
    return [...(isPlaced ? [pose] : []), ...scaled('shape')];
  }
  if (isPlacement(value)) {
    return [...Object.entries(place).map(([key, to]) => ({ at: pointerWithin(pointer, key), to })), ...scaled('of')];
  }
  if (!isPlaced) return by === undefined ? [] : scaling(pointer, value, by);
  return [{ at: pointer, to: { ...place, of: by === undefined ? value : scaledShape(value, by) } }];
}

/** @param {Part} part @returns {Vector} */
const translationOf = ({ isBody, value }) =>
  inSpace((isBody ? value.pose?.translation : isPlacement(value) ? value.translate : null) ?? [0, 0, 0]);

/** A translation to the decimal place just below a pixel; a number that does not change stays as it
 * is, and none of them is told if all do. @param {Part} part @param {Vector} to
 * @param {number} pixel its size in the part's frame */
function translated(part, to, pixel) {
  const before = translationOf(part).slice(0, state.scene?.dimension ?? 3);
  const round = rounded(to, pixel);
  const after = before.map((old, axis) => (Math.abs(to[axis] - old) < 1e-6 * pixel ? old : round[axis]));
  return after.some((now, axis) => now !== before[axis]) ? { translation: after } : {};
}

/** The edit that moves a part. @param {Part} part @param {Vector} by in its frame
 * @param {number} pixel [m] */
export const movedPart = (part, by, pixel) =>
  placing(part, translated(part, add(translationOf(part), by), pixel / part.frame.scale));

/** The edit that turns a part about its middle. @param {Part} part @param {Vector} axis of its frame
 * @param {number} degrees @param {number} pixel [m] */
export function turnedPart(part, axis, degrees, pixel) {
  const { isBody, value, middle, frame } = part;
  const arm = turn(subtract(translationOf(part), middle), axis, (degrees * Math.PI) / 180);
  const holder = isBody ? value.pose ?? {} : isPlacement(value) ? value : {};
  return placing(part, {
    ...translated(part, add(middle, arm), pixel / frame.scale),
    turned: turnedBy(holder, axis, degrees, state.scene?.dimension ?? 3),
  });
}

/** The edit that scales a part about its middle. @param {Part} part @param {number} factor
 * @param {number} pixel [m] @param {number} [digits] that its scale keeps */
export function scaledPart(part, factor, pixel, digits = 3) {
  const arm = scale(subtract(translationOf(part), part.middle), factor);
  return placing(part, { ...translated(part, add(part.middle, arm), pixel / part.frame.scale), by: { factor, digits } });
}
