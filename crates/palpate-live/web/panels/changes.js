// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/** What the tree's buttons do: each function asks for one edit, and selects what it made. */

import { select, state } from '../state.js';
import { aboutShape, besideBodies, besideOperands, moved } from './beside.js';
import { edit } from './edits.js';
import { SEVERAL, listOf, onOne, operators } from './nodes.js';
import { extent } from './numbers.js';
import { holder, parts, valueAt, within } from './schema.js';

/** @param {string} name a key that is an operator on several shapes */
function parameterOf(name) {
  return SEVERAL[/** @type {keyof typeof SEVERAL} */ (name)];
}

/** A length that suits the scene [m]. @param {number} part of the scene's size */
function length(part) {
  return Number((part * extent(state.scene?.bounds)).toPrecision(2));
}

/** @param {string} operator @param {any} old the operator of before, whose numbers are kept */
function parametersFor(operator, old) {
  const key = parameterOf(operator);
  if (!key) return {};
  const profile = key === 'width' && old?.profile ? { profile: old.profile } : {};
  return { [key]: old?.[key] ?? (key === 'progress' ? 0.5 : length(0.02)), ...profile };
}

/** Makes another operator of the one at a pointer. @param {string} pointer @param {string} operator */
export function switchOperator(pointer, operator) {
  const shape = valueAt(pointer);
  const list = listOf(shape);
  if (!list || list === operator) return;
  const note = shape.description === undefined ? {} : { description: shape.description };
  edit([{ at: pointer, to: { ...note, ...parametersFor(operator, shape), [operator]: shape[list] } }]);
}

/** The catalogue's primitives of the scene's dimension. @returns {any[]} */
export function primitives() {
  const dimension = state.scene?.dimension;
  return (state.welcome?.catalogue ?? []).filter((/** @type {any} */ entry) => entry.dimension === dimension);
}

/** The example of a primitive, such that it suits the scene or a size.
 * @param {string} name @param {number} [size] its largest length [m] */
function example(name, size = length(0.15)) {
  return exampleOf(primitives().find((primitive) => primitive.name === name), size);
}

/** The example of an entry of the catalogue, scaled to a largest length [m].
 * @param {any} entry @param {number} size */
export function exampleOf(entry, size) {
  const [key, values] = /** @type {[string, any]} */ (Object.entries(entry?.example ?? { ball: { radius: 1 } })[0]);
  const lengths = new Set((entry?.parameters ?? []).filter((/** @type {any} */ one) => one.unit === 'm')
    .map((/** @type {any} */ one) => one.key));
  const numbers = (/** @type {any} */ value) => [value].flat(9).map(Math.abs);
  const largest = Math.max(...Object.keys(values).filter((one) => lengths.has(one))
    .flatMap((one) => numbers(values[one])));
  const factor = Number.isFinite(largest) && largest > 0 ? Number((size / largest).toPrecision(2)) : 1;
  /** @param {any} value @returns {any} */
  const scaled = (value) => Array.isArray(value)
    ? value.map(scaled) : Number((value * factor).toPrecision(12));
  return { [key]: Object.fromEntries(Object.entries(values).map(([one, value]) =>
    [one, lengths.has(one) ? scaled(value) : value])) };
}

/** A name that no key or body has yet. @param {string} base @param {(name: string) => boolean} isTaken */
function freshName(base, isTaken) {
  let name = base;
  for (let number = 2; isTaken(name); number += 1) name = `${base} ${number}`;
  return name;
}

/** @param {string} name */
const isBody = (name) => state.scene?.scene.bodies.some((/** @type {any} */ body) => body.name === name);

/** Adds a primitive to the operator at a pointer, or as a body if there is none, beside what is there.
 * @param {string | null} pointer @param {string} primitive */
export function add(pointer, primitive) {
  const list = pointer === null ? null : listOf(valueAt(pointer));
  if (pointer !== null && list) {
    const operands = valueAt(pointer)[list];
    const at = within(pointer, list);
    const shape = example(primitive, Number((0.8 * aboutShape(operands[0]).reach).toPrecision(2)));
    edit([{ at: within(at, '-'), to: moved(shape, besideOperands(operands)) }]);
    select(within(at, operands.length));
    return;
  }
  const name = freshName(primitive.replace(/_/g, ' '), isBody);
  const count = state.scene?.scene.bodies.length;
  const entry = primitives().find((one) => one.name === primitive);
  const shape = example(primitive);
  const place = besideBodies(aboutShape(shape).reach, entry?.bounded ?? true);
  const pose = place.some((part) => part !== 0) ? { pose: { translation: place } } : {};
  edit([{ at: '/bodies/-', to: { name, shape, ...pose } }]);
  select(`/bodies/${count}`);
}

/** Adds a guide, a motion, a view, a tool or a named shape. @param {string} kind */
export function addOther(kind) {
  const scene = state.scene?.scene;
  const zero = Array(state.scene?.dimension ?? 3).fill(0);
  const along = zero.map((_, axis) => (axis === 1 ? length(0.2) : 0));
  const body = scene.bodies[0].name;
  const inList = (/** @type {string} */ key, /** @type {any} */ value) => {
    const at = scene[key]?.length ?? 0;
    edit([at > 0 ? { at: `/${key}/-`, to: value } : { at: `/${key}`, to: [value] }]);
    select(`/${key}/${at}`);
  };
  if (kind === 'guide') inList('guides', { line: { through: zero, direction: [1, ...zero.slice(1)] } });
  if (kind === 'motion') inList('motions', { body, to: { translation: along }, repeat: 'back_and_forth' });
  if (kind === 'view') {
    const names = (scene.views ?? []).map((/** @type {any} */ view) => view.name);
    inList('views', { name: freshName('view', (name) => names.includes(name)) });
  }
  if (kind === 'tool' && !scene.tool) {
    edit([{ at: '/tool', to: { radius: 0.002 } }]);
    select('/tool');
  }
  if (kind === 'named shape') {
    const name = freshName('shape', (taken) => scene.shapes?.[taken] !== undefined);
    const shape = example('ball');
    edit([scene.shapes ? { at: within('/shapes', name), to: shape } : { at: '/shapes', to: { [name]: shape } }]);
    select(within('/shapes', name));
  }
}

/** Values with which operators on one shape change little. @returns {Record<string, any>} */
function firstParameters() {
  const isPlane = state.scene?.dimension === 2;
  const zero = Array(state.scene?.dimension ?? 3).fill(0);
  return {
    translate: zero, rotate_degrees: isPlane ? 15 : { axis: [0, 1, 0], angle: 15 }, scale: 1.2,
    offset: length(0.01),
    ...Object.fromEntries(operators().map(({ name, first }) => [
      name, Array.isArray(first) ? first.slice(0, zero.length).map(length) : length(first),
    ])),
    mirror: 'x', repeat: { x: { spacing: length(0.3), first: 0, last: 2 } },
    bend_degrees: Number((30 / extent(state.scene?.bounds)).toPrecision(2)),
    twist_degrees: Number((90 / extent(state.scene?.bounds)).toPrecision(2)),
  };
}

/** Operators that a shape can be wrapped in. @returns {string[]} */
export function wrappers() {
  const first = firstParameters();
  const one = onOne().filter((key) => key in first && (key !== 'twist_degrees' || state.scene?.dimension === 3));
  return [...Object.keys(SEVERAL).filter((key) => key !== 'displace'), ...one];
}

/** Puts an operator around the shape at a pointer; one on several shapes gets a second, a ball on
 * the edge of the first. @param {string} pointer @param {string} operator */
export function wrap(pointer, operator) {
  const shape = valueAt(pointer);
  const to = operator in SEVERAL
    ? { ...parametersFor(operator, null), [operator]: [shape, secondOf(shape)] }
    : { [operator]: firstParameters()[operator], of: shape };
  edit([{ at: pointer, to }]);
  select(pointer);
}

/** @param {any} shape */
function secondOf(shape) {
  const size = Number((0.7 * aboutShape(shape).reach).toPrecision(2));
  return moved(example('ball', size), besideOperands([shape]));
}

/** Puts what an operator holds, of several the first, in the operator's place. @param {string} pointer */
export function unwrap(pointer) {
  const shape = valueAt(pointer);
  const list = listOf(shape);
  const to = list ? shape[list][0] : shape?.of;
  if (to !== undefined) edit([{ at: pointer, to }]);
}

/** Whether a shape has an operator that can be taken away. @param {string} pointer */
export function canUnwrap(pointer) {
  const shape = valueAt(pointer);
  return listOf(shape) !== null || shape?.of !== undefined;
}

/** The list that a part is an element of, and its place there.
 * @param {string} pointer @returns {{ at: string, list: any[], index: number } | null} */
export function placeOf(pointer) {
  const at = holder(pointer);
  const list = valueAt(at);
  return Array.isArray(list) ? { at, list, index: Number(parts(pointer).pop()) } : null;
}

/** Whether a part can be removed. @param {string} pointer */
export function canRemove(pointer) {
  const place = placeOf(pointer);
  if (place) return place.list.length > 1 || ['/guides', '/motions', '/views'].includes(place.at);
  return (pointer === '/tool' && valueAt(pointer) !== undefined) || /^\/shapes\/[^/]+$/.test(pointer);
}

/** The operator that would be left with one shape if a part were removed, or null.
 * @param {string} pointer */
export function operatorLeftAlone(pointer) {
  const place = placeOf(pointer);
  const operator = place && holder(place.at);
  return operator && place.list.length === 2 && listOf(valueAt(operator)) === parts(place.at).pop() ? operator : null;
}

/** Removes a part; an operator that is left with one shape makes place for it. @param {string} pointer */
export function remove(pointer) {
  const place = placeOf(pointer);
  const operator = operatorLeftAlone(pointer);
  if (place && operator) {
    edit([{ at: operator, to: place.list[1 - place.index] }]);
    select(operator);
    return;
  }
  const isLast = place?.list.length === 1 || (holder(pointer) === '/shapes' && Object.keys(valueAt('/shapes')).length === 1);
  edit([{ at: isLast ? holder(pointer) : pointer }]);
  select(null);
}

/** @param {string} pointer */
export function duplicate(pointer) {
  const place = placeOf(pointer);
  if (!place) return;
  const { at, list, index } = place;
  const copy = structuredClone(list[index]);
  if (copy?.name) copy.name = freshName(copy.name, (name) => list.some((one) => one.name === name));
  edit([{ at, to: [...list.slice(0, index + 1), copy, ...list.slice(index + 1)] }]);
  select(within(at, index + 1));
}

/** Exchanges a part with the one before or after it. @param {string} pointer @param {-1 | 1} way */
export function move(pointer, way) {
  const place = placeOf(pointer);
  if (!place) return;
  const { at, index } = place;
  const list = [...place.list];
  const other = index + way;
  if (other < 0 || other >= list.length) return;
  [list[index], list[other]] = [list[other], list[index]];
  edit([{ at, to: list }]);
  select(within(at, other));
}

/** Puts another name in place of references to a shape. @param {any} value
 * @param {string} from @param {string} to @returns {any} */
function referring(value, from, to) {
  if (value === from) return to;
  if (Array.isArray(value)) return value.map((one) => referring(one, from, to));
  if (typeof value !== 'object' || !value) return value;
  // Only these keys hold shapes.
  const holds = ['of', 'shape', ...Object.keys(SEVERAL)];
  return Object.fromEntries(Object.entries(value).map(([key, inner]) =>
    [key, holds.includes(key) ? referring(inner, from, to) : inner]));
}

/** Gives a body or a named shape another name, everywhere. @param {string} pointer @param {string} name */
export function rename(pointer, name) {
  const scene = state.scene?.scene;
  const old = valueAt(pointer)?.name;
  if (pointer.startsWith('/shapes/')) {
    const from = parts(pointer)[1];
    const shapes = Object.fromEntries(Object.entries(scene.shapes)
      .map(([key, shape]) => [key === from ? name : key, referring(shape, from, name)]));
    const bodies = scene.bodies.map((/** @type {any} */ body) => ({ ...body, shape: referring(body.shape, from, name) }));
    const tool = scene.tool?.shape ? [{ at: '/tool/shape', to: referring(scene.tool.shape, from, name) }] : [];
    edit([{ at: '/shapes', to: shapes }, { at: '/bodies', to: bodies }, ...tool]);
    select(within('/shapes', name));
    return;
  }
  const motions = (scene.motions ?? []).map((/** @type {any} */ motion, /** @type {number} */ index) =>
    ({ motion, index })).filter((/** @type {any} */ one) => pointer.startsWith('/bodies/') && one.motion.body === old);
  edit([{ at: within(pointer, 'name'), to: name },
    ...motions.map((/** @type {any} */ one) => ({ at: `/motions/${one.index}/body`, to: name }))]);
}

/** Whether a part has a name. @param {string} pointer */
export function hasName(pointer) {
  return /^\/(bodies|views|shapes)\/[^/]+$/.test(pointer);
}
