// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * The JSON Schema of scene files, from which the fields are made: it has every key with its
 * type, limits and a description with the unit in brackets.
 *
 * @typedef {Record<string, any>} Schema
 */

import { state } from '../state.js';

/** Parts of a JSON pointer. @param {string} pointer @returns {string[]} */
export function parts(pointer) {
  return pointer.split('/').slice(1).map((part) => part.replace(/~1/g, '/').replace(/~0/g, '~'));
}

/** A JSON pointer to a key within `pointer`. @param {string} pointer @param {string | number} key */
export function within(pointer, key) {
  return `${pointer}/${String(key).replace(/~/g, '~0').replace(/\//g, '~1')}`;
}

/** The JSON pointer of what holds that at `pointer`. @param {string} pointer */
export function holder(pointer) {
  return pointer.slice(0, pointer.lastIndexOf('/'));
}

/** What is at a JSON pointer in the scene, or undefined. @param {string} pointer */
export function valueAt(pointer) {
  return parts(pointer).reduce((value, part) => value?.[part], state.scene?.scene);
}

/** The schema with its reference followed; the description of the place counts.
 * @param {Schema | undefined} node @returns {Schema} */
export function followed(node) {
  const root = state.welcome?.schema;
  if (!node?.$ref || !root) return node ?? {};
  const target = parts(node.$ref.slice(1)).reduce((at, part) => at?.[part], root);
  const { $ref: _, ...own } = node;
  return { ...followed(target), ...own };
}

/** The alternative of a schema that fits a value.
 * @param {Schema} node @param {any} value @returns {Schema} */
function fitting(node, value) {
  const choices = node.anyOf;
  if (!choices || node.properties) return node;
  const fits = choices.map(followed).find((/** @type {Schema} */ choice) => {
    if (Array.isArray(value)) {
      const isLong = !choice.minItems || choice.minItems === value.length;
      const inner = followed(choice.items);
      return choice.type === 'array' && isLong && (inner.type === 'array') === Array.isArray(value[0]);
    }
    if (typeof value === 'string') return Boolean(choice.enum) || choice.type?.includes('string');
    if (typeof value === 'number') return choice.type === 'number' || choice.type === 'integer';
    return choice.type === 'object' || choice.type?.includes?.('object');
  });
  return fits ? { ...fits, description: node.description ?? fits.description } : node;
}

/** The schema of a key or element of a value.
 * @param {Schema} node @param {any} value @param {string} key @returns {Schema} */
export function schemaOf(node, value, key) {
  const inner = value?.[key];
  if (Array.isArray(value)) return fitting(followed(node.items), inner);
  if (key === 'of' && (value?.extrude !== undefined || value?.revolve !== undefined)) {
    return followed({ $ref: '#/$defs/plane/Shape', description: node.properties?.of?.description });
  }
  if (key === 'of') return node;
  const own = followed(node.properties?.[key] ?? node.additionalProperties);
  return fitting(own, inner);
}

/** The schema of what is at a JSON pointer in the scene. @param {string} pointer @returns {Schema} */
export function schemaAt(pointer) {
  const space = state.scene?.dimension === 2 ? 'plane' : 'space';
  let node = followed({ $ref: `#/$defs/${space}/Scene` });
  let value = state.scene?.scene;
  for (const part of parts(pointer)) {
    node = schemaOf(node, value, part);
    value = value?.[part];
  }
  return node;
}

/** The unit that a description ends with, without its brackets. @param {string | undefined} text */
export function unitIn(text) {
  return /\[([^\]]{1,8})\]/.exec(text ?? '')?.[1] ?? '';
}

/** A description without its unit. @param {string | undefined} text */
export function withoutUnit(text) {
  return (text ?? '').replace(/\s*\[[^\]]{1,8}\]/, '').replace(/[`\[\]]/g, '');
}
