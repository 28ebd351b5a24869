// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * A form for a part of the scene, made from the schema: a field for each key that is there, and
 * a menu of those that may be added.
 *
 * @typedef {import('./schema.js').Schema} Schema
 */

import { html } from '../vendor/htm-preact.js';
import { state } from '../state.js';
import { edit, forgetProblem, problemAt } from './edits.js';
import { ChoiceField, NumberField, TextField, VectorField } from './fields.js';
import { extent } from './numbers.js';
import { followed, schemaOf, unitIn, within, withoutUnit } from './schema.js';

/** Elements of a list that are shown; the others say how many they are. */
const SHOWN_ELEMENTS = 24;

/** A name for people. @param {string} key */
export function named(key) {
  return key.replace(/_degrees$/, '').replace(/_/g, ' ');
}

/** The least value, whether it is allowed itself, and the greatest. @param {Schema} node */
function limitsOf(node) {
  return {
    min: node.minimum ?? node.exclusiveMinimum,
    above: node.exclusiveMinimum !== undefined,
    max: node.maximum,
    whole: node.type === 'integer',
  };
}

/** A typical value of a unit in this scene. @param {string} unit @param {string} key */
function scaleOf(unit, key) {
  if (unit === 'm') return extent(state.scene?.bounds) / 2;
  if (key.includes('degrees') || key === 'angle') return 90;
  return 0;
}

/** @param {string} key @param {Schema} node */
function unitOf(key, node) {
  if (/^(bend|twist)_degrees$/.test(key)) return '°/m';
  if (key === 'bend' || key === 'twist') return 'rad/m';
  if (key.endsWith('_degrees') || (key === 'angle' && node.description?.includes('°'))) return '°';
  if (key === 'angle') return 'rad';
  return unitIn(node.description);
}

/** @param {any} value @param {Schema} node */
function choicesOf(value, node) {
  const constants = node.oneOf?.filter((/** @type {Schema} */ one) => one.const !== undefined);
  if (constants?.length) return constants.map((/** @type {Schema} */ one) => one.const);
  const inner = node.anyOf?.map(followed).find((/** @type {Schema} */ one) => one.enum);
  return typeof value === 'string' ? (node.enum ?? inner?.enum ?? null) : null;
}

/** @param {any} value */
const isVector = (value) =>
  Array.isArray(value) && value.length > 0 && value.length < 5 && value.every((x) => typeof x === 'number');

/** A field for the value at a pointer.
 * @param {{ pointer: string, name: string, value: any, node: Schema }} given */
export function Field({ pointer, name, value, node }) {
  const unit = unitOf(name, node);
  const shared = {
    label: named(name), unit, help: withoutUnit(node.description), problem: problemAt(pointer),
    scale: scaleOf(unit, name), forget: () => forgetProblem(pointer),
  };
  const put = (/** @type {any} */ to, moving = false) => edit([{ at: pointer, to }], moving);
  const choices = choicesOf(value, node);
  if (choices) {
    return html`<${ChoiceField} ...${shared} value=${value} choices=${choices} change=${put} />`;
  }
  if (typeof value === 'number') {
    return html`<${NumberField} ...${shared} ...${limitsOf(node)} value=${value} change=${put} />`;
  }
  if (isVector(value)) {
    const limits = limitsOf(followed(node.items));
    return html`<${VectorField} ...${shared} ...${limits} value=${value} change=${put} />`;
  }
  if (Array.isArray(value)) return html`<${List} ...${{ pointer, name, value, node }} />`;
  if (typeof value === 'object' && value) {
    return html`<details class="inner" open>
      <summary title=${shared.help}>${shared.label}</summary>
      <${Form} pointer=${pointer} value=${value} node=${node} />
    </details>`;
  }
  if (typeof value === 'boolean') {
    return html`<${ChoiceField} ...${shared} value=${String(value)} choices=${['true', 'false']}
      change=${(/** @type {string} */ to) => put(to === 'true')} />`;
  }
  return html`<${TextField} ...${shared} value=${String(value)} change=${put}
    long=${name === 'description'} />`;
}

/** The elements of a list, with buttons to take one out and to add one.
 * @param {{ pointer: string, name: string, value: any[], node: Schema }} given */
function List({ pointer, name, value, node }) {
  const problem = problemAt(pointer);
  const hidden = value.length - SHOWN_ELEMENTS;
  return html`<details class="inner" open=${value.length < 9}>
    <summary>${named(name)}: ${value.length}</summary>
    ${value.slice(0, SHOWN_ELEMENTS).map((element, index) => html`<div class="element" key=${index}>
      <${Field} pointer=${within(pointer, index)} name=${`${index + 1}`} value=${element}
        node=${schemaOf(node, value, String(index))} />
      <button class="small" title="Take out" aria-label=${`Take out ${index + 1}`}
        onClick=${() => edit([{ at: within(pointer, index) }])}>×</button>
    </div>`)}
    ${hidden > 0 && html`<p class="quiet">and ${hidden} more</p>`}
    ${value.length > 0 && html`<button class="small" onClick=${() =>
      edit([{ at: within(pointer, '-'), to: value[value.length - 1] }])}>add one more</button>`}
    ${problem && html`<p class="problem">${problem}</p>`}
  </details>`;
}

/** A first value for a key that is added. @param {Schema} node @param {string} key @returns {any} */
function firstValue(node, key) {
  const own = followed(node);
  if (own.default !== undefined) return own.default;
  if (own.enum) return own.enum[0];
  const constant = own.oneOf?.find((/** @type {Schema} */ one) => one.const !== undefined);
  if (constant) return constant.const;
  if (own.anyOf) return firstValue(own.anyOf[0], key);
  if (own.type === 'string') return key === 'description' ? 'A note.' : key;
  if (own.type === 'integer') return own.minimum ?? 1;
  if (own.type === 'number') {
    if (unitIn(own.description) === 'm') return Number((extent(state.scene?.bounds) / 20).toPrecision(2));
    return own.minimum === 0 ? 0 : Math.min(own.maximum ?? 1, 1);
  }
  if (own.type === 'array') {
    const least = own.minItems ?? 1;
    const element = firstValue(own.items, key);
    if (element === 0 || typeof element === 'number') {
      return Array.from({ length: least }, (_, at) => (key === 'translation' ? 0 : at === 0 ? 1 : 0));
    }
    return Array.from({ length: least }, () => element);
  }
  const required = own.required ?? [];
  return Object.fromEntries(required.map((/** @type {string} */ inner) =>
    [inner, inner === 'angle' ? 0 : firstValue(own.properties[inner], inner)]));
}

/** The fields of an object; `skip` are keys that are shown elsewhere.
 * @param {{ pointer: string, value: Record<string, any>, node: Schema, skip?: string[],
 *   addable?: boolean }} given */
export function Form({ pointer, value, node, skip = [], addable = true }) {
  const known = Object.keys(node.properties ?? {});
  const keys = Object.keys(value).filter((key) => !skip.includes(key) && key !== 'description');
  const missing = known.filter((key) => value[key] === undefined && !skip.includes(key));
  const required = node.required ?? [];
  return html`<div class="form">
    ${[...keys, ...('description' in value && !skip.includes('description') ? ['description'] : [])].map((key) => html`
      <div class="row" key=${key}>
        <${Field} pointer=${within(pointer, key)} name=${key} value=${value[key]}
          node=${schemaOf(node, value, key)} />
        ${addable && known.includes(key) && !required.includes(key) && html`<button class="small"
          title=${`Leave out ${named(key)}`} aria-label=${`Leave out ${named(key)}`}
          onClick=${() => edit([{ at: within(pointer, key) }])}>×</button>`}
      </div>`)}
    ${addable && missing.length > 0 && html`<select class="add" aria-label="Add a value" value=""
      onChange=${(/** @type {any} */ event) => {
        const key = event.currentTarget.value;
        event.currentTarget.value = '';
        if (key) edit([{ at: within(pointer, key), to: firstValue(node.properties[key], key) }]);
      }}>
      <option value="">add…</option>
      ${missing.map((key) => html`<option key=${key} value=${key}>${named(key)}</option>`)}
    </select>`}
  </div>`;
}
