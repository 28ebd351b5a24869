// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/** The selected part with all its numbers. */

import { html } from '../vendor/htm-preact.js';
import { isScaled, scaleOf, scaledPart, selectedPart } from '../scene/placement.js';
import { boxOf } from '../scene/setting.js';
import { subtract } from '../scene/vectors.js';
import { select, state } from '../state.js';
import { hasName, rename } from './changes.js';
import { edit, problemAt } from './edits.js';
import { ChoiceField, NumberField, TextField } from './fields.js';
import { operations } from './events.js';
import { Form, named } from './form.js';
import { listOf, makerOf, partAt, partsOfScene } from './nodes.js';
import { extent, short } from './numbers.js';
import { useTopics } from './page.js';
import { parts, schemaAt, schemaOf, valueAt, within, withoutUnit } from './schema.js';

/** What a scale that is typed keeps: its digits, and places over the size of the scene. */
const DIGITS = 9;
/** A material of its own where no preset was chosen before. */
const OWN = { stiffness: 500, damping: 1 };
const FINE = 1e-6;

export function Selected() {
  useTopics(['scene', 'selection', 'problems']);
  const tree = partsOfScene();
  const part = state.selection === null ? null : partAt(tree, state.selection);
  const value = part ? valueAt(part.pointer) : undefined;
  if (part?.pointer === '/tool' && value === undefined) return html`<${NoTool} />`;
  if (!part || value === undefined || part.kind === 'group') return html`<${WholeScene} />`;
  const name = part.pointer.startsWith('/shapes/') ? parts(part.pointer)[1] : value.name;
  return html`
    <div class="panel-head"><h2>${part.kind === 'other' ? heading(part.pointer) : part.label}</h2></div>
    <div class="scroll" tabindex="0" role="region" aria-label="Fields">
      ${state.problems.has(part.pointer) && html`<p class="problem">${state.problems.get(part.pointer)}</p>`}
      ${hasName(part.pointer) && html`<${TextField} label="name" value=${name}
        problem=${problemAt(within(part.pointer, 'name'))}
        change=${(/** @type {string} */ to) => rename(part.pointer, to)} />`}
      ${part.kind === 'body' ? html`<${Body} pointer=${part.pointer} body=${value} />`
        : part.kind === 'shape' ? html`<${Shape} key=${part.pointer} pointer=${part.pointer} />
            ${!isScaled(selectedPart()) && html`<${Scale} />`}`
          : html`<${Form} key=${part.pointer} pointer=${part.pointer} value=${value}
              node=${schemaAt(part.pointer)} skip=${['name', 'shape']} />`}
    </div>`;
}

/** @param {string} pointer */
function heading(pointer) {
  const [list, index] = parts(pointer);
  return index === undefined ? named(list) : `${named(list).replace(/s$/, '')} ${Number(index) + 1}`;
}

/** What touches a scene that has no tool. */
function NoTool() {
  return html`<div class="panel-head"><h2>tool</h2></div>
    <div class="scroll" tabindex="0" role="region" aria-label="Fields">
      <p class="quiet">The scene has no tool of its own: a ball with a radius of 2 mm touches it. “add” below the tree gives it
        one, with a radius, contact points or a shape.</p>
    </div>`;
}

/** What is shown while no part with numbers is selected. */
function WholeScene() {
  const { scene } = state;
  if (!scene) return html`<div class="panel-head"><h2>Selected</h2></div>`;
  const box = boxOf(scene.bounds);
  const size = box && subtract(box.high, box.low).slice(0, scene.dimension).map((part) => short(part)).join(' × ');
  return html`
    <div class="panel-head"><h2>Scene</h2></div>
    <div class="scroll" tabindex="0" role="region" aria-label="Fields">
      <${TextField} label="description" long value=${scene.scene.description ?? ''}
        change=${(/** @type {string} */ to) => edit([to === '' ? { at: '/description' } : { at: '/description', to }])} />
      <dl class="facts">
        <dt>dimension</dt><dd>${scene.dimension}</dd>
        <dt>size</dt><dd>${size ? `${size} m` : 'endless'}</dd>
        <dt>bodies</dt><dd>${scene.bodies.length}</dd>
        ${operations() && html`<dt>formula</dt><dd>${operations()}</dd>`}
        <dt>Lipschitz</dt><dd>${short(scene.lipschitz)}</dd>
        <dt>drawn by</dt><dd>${drawnBy()}</dd>
      </dl>
      <p class="quiet">Select a part in the tree to see and change its numbers.</p>
    </div>`;
}

function drawnBy() {
  const { way } = state;
  if (way?.kind === 'formula') return 'the formula, exactly';
  if (way?.kind === 'samples') return `samples: ${way.why}`;
  return '–';
}

/** @param {{ pointer: string, body: any }} given */
function Body({ pointer, body }) {
  const index = Number(parts(pointer)[1]);
  const known = state.scene?.bodies?.[index];
  const node = schemaAt(pointer);
  const names = Object.keys(state.welcome?.presets ?? {});
  const material = typeof body.material === 'string' ? body.material : body.material ? 'own' : 'default';
  const take = (/** @type {string} */ to) => {
    const at = within(pointer, 'material');
    if (to === 'default') edit([{ at }]);
    else edit([{ at, to: to === 'own' ? state.welcome?.presets?.[material] ?? OWN : to }]);
  };
  return html`
    <p class="promise">promise: <b>${known?.promise ?? '–'}</b></p>
    <button class="small" onClick=${() => select(within(pointer, 'shape'))}>its shape</button>
    <${ChoiceField} label="material" value=${material} change=${take}
      choices=${[['default', 'default'], ...names.map((name) => [name, name.replace(/_/g, ' ')]), ['own', 'own numbers']]}
      problem=${typeof body.material === 'object' ? null : problemAt(within(pointer, 'material'))} />
    <${Scale} />
    <${Form} key=${pointer} pointer=${pointer} value=${body} node=${node}
      skip=${['name', 'shape', ...(typeof body.material === 'object' ? [] : ['material'])]} />`;
}

/** How the selected body or shape is scaled, as the square handle does it. */
function Scale() {
  const part = selectedPart();
  const value = part ? scaleOf(part) : null;
  if (typeof value !== 'number') return null;
  return html`<${NumberField} label="scale" value=${value} min=${0} above
    help="About its middle, by a “scale” inside its shape"
    change=${(/** @type {number} */ to, /** @type {boolean} */ moving) => {
      const now = selectedPart();
      const before = now && scaleOf(now);
      // A shape with a scale shows it in its form, in place of this field, which would end the drag.
      if (moving && !now?.isBody && !isScaled(now)) return;
      if (now && typeof before === 'number') {
        edit(scaledPart(now, to / before, FINE * extent(state.scene?.bounds), DIGITS), moving);
      }
    }} />`;
}

/** A shape: its moves and turns, and then the primitive or operator below them.
 * @param {{ pointer: string }} given */
function Shape({ pointer }) {
  const value = valueAt(pointer);
  if (typeof value === 'string') {
    const names = Object.keys(state.scene?.scene.shapes ?? {});
    return html`<${ChoiceField} label="shape" value=${value} choices=${names.map((name) => [name, name])}
        problem=${problemAt(pointer)} change=${(/** @type {string} */ to) => edit([{ at: pointer, to }])} />
      <button class="small" onClick=${() => select(within('/shapes', value))}>show it</button>`;
  }
  const maker = makerOf(value) ?? '';
  const node = schemaAt(pointer);
  const isPrimitive = listOf(value) === null && value.of === undefined && maker !== 'shape';
  const about = state.welcome?.catalogue?.find((/** @type {any} */ entry) => entry.name === maker);
  const place = within(pointer, maker);
  const isPlace = ['translate', 'rotate_degrees', 'rotation'].includes(maker);
  const ownKeys = isPrimitive ? ['description'] : Object.keys(value).filter((key) => key !== 'of' && key !== listOf(value));
  const shownNode = { ...node, properties: Object.fromEntries(
    ['description', ...ownKeys, ...(maker.startsWith('smooth') ? ['profile'] : []), ...extraPlaces(value)]
      .map((key) => [key, node.properties?.[key]]).filter(([, inner]) => inner)),
    required: [maker, ...(isPlace ? [] : ownKeys.filter((key) => !['profile', 'description'].includes(key)))] };
  const skip = ['of', ...(listOf(value) ? [listOf(value)] : []), ...(isPrimitive ? [maker] : [])];
  return html`<div class="shape">
    <p class="quiet">${withoutUnit(node.properties?.[maker]?.description)}</p>
    ${isPrimitive && html`<${Form} pointer=${place} value=${value[maker]} node=${schemaOf(node, value, maker)}
      addable=${false} />`}
    <${Form} pointer=${pointer} value=${value} node=${shownNode} skip=${skip} />
    ${about && html`<p class="promise" title=${about.origin}>promise: <b>${about.promise}</b>; origin: ${about.origin}</p>`}
    ${isPlace && html`<h3>${makerOf(value.of) ? named(makerOf(value.of) ?? '') : value.of}</h3>
      <${Shape} pointer=${within(pointer, 'of')} />`}
  </div>`;
}

/** Moves and turns may share an object. @param {any} value */
function extraPlaces(value) {
  if (value.translate !== undefined && value.rotation === undefined) return ['rotate_degrees'];
  return value.rotate_degrees !== undefined || value.rotation !== undefined ? ['translate'] : [];
}
