// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * The scene as a tree of parts, and what can be done with a part of it.
 *
 * @typedef {object} Part
 * @property {string} pointer a JSON pointer into the scene
 * @property {string} inner the pointer of the shape below `translate` and `rotate`; `pointer` if there is none
 * @property {string} label
 * @property {string} detail
 * @property {'group' | 'body' | 'shape' | 'other'} kind
 * @property {Part[]} children
 */

import { state } from '../state.js';
import { within } from './schema.js';

/** Operators on several shapes, with their parameter if they have one. */
export const SEVERAL = /** @type {const} */ ({
  union: null,
  intersection: null,
  difference: null,
  symmetric_difference: null,
  smooth_union: 'width',
  smooth_intersection: 'width',
  smooth_difference: 'width',
  displace: 'height',
  morph: 'progress',
});

/** Operators on one shape that are not in the program's catalogue. */
const OTHERS = [
  'translate', 'rotate_degrees', 'rotation', 'scale', 'offset', 'mirror',
  'repeat', 'bend_degrees', 'bend', 'twist_degrees', 'twist', 'extrude', 'revolve',
];

/** The program's catalogue of operators on one shape. @returns {{ name: string, first: number | number[] }[]} */
export function operators() {
  return state.welcome?.operators ?? [];
}

/** Operators on one shape. @returns {string[]} */
export function onOne() {
  return [...OTHERS, ...operators().map(({ name }) => name)];
}

/** Signs that stand before the names of operators. @type {Record<string, string>} */
const SIGNS = {
  union: '∪', intersection: '∩', difference: '−', symmetric_difference: '∆',
  smooth_union: '∪~', smooth_intersection: '∩~', smooth_difference: '−~',
};

const PLACES = ['translate', 'rotate_degrees', 'rotation'];

/** The key that says what a shape is. @param {any} shape @returns {string | null} */
export function makerOf(shape) {
  if (typeof shape !== 'object' || !shape) return null;
  const keys = Object.keys(shape);
  const operator = keys.find((key) => key in SEVERAL || onOne().includes(key));
  const others = ['description', 'width', 'height', 'profile', 'progress', 'of'];
  return operator ?? keys.find((key) => !others.includes(key)) ?? null;
}

/** The key of the list of shapes of an operator, or null. @param {any} shape */
export function listOf(shape) {
  const maker = makerOf(shape);
  return maker && maker in SEVERAL ? /** @type {keyof typeof SEVERAL} */ (maker) : null;
}

/** Whether an object only moves and turns what is under `of`. @param {any} shape */
export function isPlacement(shape) {
  return shape?.of !== undefined && PLACES.includes(makerOf(shape) ?? '');
}

/** @param {any} shape @param {string} pointer @returns {Part} */
function shapePart(shape, pointer) {
  let inner = shape;
  let innerPointer = pointer;
  const moves = [];
  while (isPlacement(inner)) {
    if (inner.translate) moves.push('moved');
    if (inner.rotate_degrees !== undefined || inner.rotation !== undefined) moves.push('turned');
    inner = inner.of;
    innerPointer = within(innerPointer, 'of');
  }
  const part = {
    pointer, inner: innerPointer, kind: /** @type {const} */ ('shape'), detail: [...new Set(moves)].join(', '),
  };
  if (typeof inner === 'string') return { ...part, label: `→ ${inner}`, children: [] };
  const maker = makerOf(inner) ?? 'shape';
  const list = listOf(inner);
  const children = list
    ? inner[list].map((/** @type {any} */ child, /** @type {number} */ index) =>
        shapePart(child, within(within(innerPointer, list), index)))
    : inner?.of !== undefined ? [shapePart(inner.of, within(innerPointer, 'of'))] : [];
  const name = maker === 'shape' ? `→ ${inner.shape}` : maker.replace(/_degrees$/, '').replace(/_/g, ' ');
  return { ...part, label: SIGNS[maker] ? `${SIGNS[maker]} ${name}` : name, children };
}

/** The tree of the newest scene. @returns {Part[]} */
export function partsOfScene() {
  const scene = state.scene?.scene;
  if (!scene) return [];
  /** @param {string} key @param {string} label @param {Part[]} children @returns {Part} */
  const group = (key, label, children) =>
    ({ pointer: `/${key}`, inner: `/${key}`, label, detail: `${children.length}`, kind: 'group', children });
  /** @param {string} pointer @param {string} label @param {string} [detail] @returns {Part} */
  const leaf = (pointer, label, detail = '') =>
    ({ pointer, inner: pointer, label, detail, kind: 'other', children: [] });

  const bodies = (scene.bodies ?? []).map((/** @type {any} */ body, /** @type {number} */ index) => {
    const pointer = `/bodies/${index}`;
    const material = typeof body.material === 'string' ? body.material : body.material ? 'own material' : '';
    return { ...leaf(pointer, body.name, material.replace(/_/g, ' ')), kind: /** @type {const} */ ('body'),
      children: [shapePart(body.shape, `${pointer}/shape`)] };
  });
  const groups = [group('bodies', 'Bodies', bodies)];
  if (scene.shapes) {
    groups.push(group('shapes', 'Named shapes', Object.keys(scene.shapes).map((name) => {
      const pointer = within('/shapes', name);
      const shape = shapePart(scene.shapes[name], pointer);
      return { ...shape, label: name, detail: shape.label };
    })));
  }
  const tool = leaf('/tool', 'Tool', scene.tool ? '' : 'a ball of 2 mm');
  if (scene.tool?.shape) tool.children = [shapePart(scene.tool.shape, '/tool/shape')];
  groups.push(tool);
  const kinds = ['point', 'line', 'segment', 'plane', 'curve', 'well'];
  const guides = (scene.guides ?? []).map((/** @type {any} */ guide, /** @type {number} */ index) =>
    leaf(`/guides/${index}`, kinds.find((kind) => kind in guide) ?? 'guide', guide.description));
  if (guides.length > 0) groups.push(group('guides', 'Guides', guides));
  const motions = (scene.motions ?? []).map((/** @type {any} */ motion, /** @type {number} */ index) =>
    leaf(`/motions/${index}`, motion.body, motion.description));
  if (motions.length > 0) groups.push(group('motions', 'Motions', motions));
  const views = (scene.views ?? []).map((/** @type {any} */ view, /** @type {number} */ index) =>
    leaf(`/views/${index}`, view.name, view.description));
  if (views.length > 0) groups.push(group('views', 'Views', views));
  return groups;
}

/** The innermost part that holds a JSON pointer.
 * @param {Part[]} tree @param {string} pointer @returns {Part | null} */
export function partAt(tree, pointer) {
  for (const part of tree) {
    if (part.pointer === pointer) return part;
    if (pointer.startsWith(`${part.pointer}/`)) return partAt(part.children, pointer) ?? part;
  }
  return null;
}
