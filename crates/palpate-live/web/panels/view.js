// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/** What the picture shows, above it. */

import { isLegendOpen, openLegend } from '../scene/marks.js';
import { html, useEffect, useRef } from '../vendor/htm-preact.js';
import { changed, setView, state } from '../state.js';
import { setMode } from './actions.js';
import { Cut } from './cut.js';
import { NumberField, Switch } from './fields.js';
import { extent } from './numbers.js';
import { page, useTopics } from './page.js';

/** @type {[typeof state.view.mode, string, string][]} */
export const MODES = [
  ['space', '3D', 'The scene in space: 1'],
  ['slice', 'Slice', 'The scene in space with a plane through it: 2'],
  ['plane', 'Plane', 'The map of the plane alone: 3'],
  ['compare', 'Compare', 'Two bodies side by side, and their difference: 4'],
];

/** @type {[string, string][]} */
export const MAPS = [
  ['inside', 'inside, outside'], ['distance', 'distance'], ['gradient', 'gradient'], ['promise', 'promise'],
];

/** @type {[keyof typeof state.view.shown, string, string][]} */
const SHOWN = [
  ['contacts', 'contacts', 'Pink dots: where bodies touch or come nearest'],
  ['normals', 'normals', 'Green arrows: which way the touched surface faces; pink ones the same at contacts of bodies'],
  ['forces', 'forces', 'Orange arrows: the force on the hand'],
  ['spring', 'spring to the hand', 'Between the hand and the pointer that draws it'],
  ['proof', 'boxes of the proof', 'Regions in which the proof has ruled a contact out'],
  ['bounds', 'bounds', 'The box around each body, and the ball around that'],
  ['names', 'names', 'The name of each body'],
  ['handles', 'handles', 'Of the selected body or shape: arrows and their middle move it, rings turn it, the square scales it'],
];

/** The largest sine factor. */
export const MOST_SINE = 10;

/** @param {string} mode */
function isPossible(mode) {
  return state.scene?.dimension !== 2 || mode === 'plane' || mode === 'compare';
}

export function ViewBar() {
  useTopics(['view', 'scene']);
  const { view, scene } = state;
  const bodies = scene?.bodies ?? [];
  const tabKeys = (/** @type {KeyboardEvent} */ event) => {
    const way = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (way === undefined) return;
    event.preventDefault();
    const open = MODES.filter(([mode]) => isPossible(mode));
    const next = open[(open.findIndex(([mode]) => mode === view.mode) + way + open.length) % open.length];
    setMode(next[0]);
    document.getElementById(`mode-${next[0]}`)?.focus();
  };
  return html`
    <div class="modes" role="tablist" aria-label="View" onKeyDown=${tabKeys}>
      ${MODES.map(([mode, name, help]) => html`<button key=${mode} id=${`mode-${mode}`} role="tab" title=${help}
        aria-selected=${String(view.mode === mode)} aria-controls="stage" tabindex=${view.mode === mode ? 0 : -1}
        disabled=${!isPossible(mode)} onClick=${() => setMode(mode)}>${name}</button>`)}
    </div>
    ${view.mode === 'compare' && bodies.length > 1 && [0, 1].map((side) => html`<select key=${side} class="small"
      aria-label=${`Body ${'AB'[side]}`} value=${view.compared[side]}
      onChange=${(/** @type {any} */ event) => setView({
        compared: view.compared.map((old, at) => (at === side ? Number(event.currentTarget.value) : old)) })}>
      ${bodies.map((/** @type {any} */ body, /** @type {number} */ index) => html`<option key=${index} value=${index}
        selected=${view.compared[side] === index}>${'AB'[side]}: ${body.name}</option>`)}
    </select>`)}
    <${MapChoice} />
    <${Display} />
    <span class="gap"></span>
    <${Cameras} />`;
}

/** From where the scene is seen. */
function Cameras() {
  const { scene } = state;
  const views = scene?.scene?.views ?? [];
  return html`<span class="cameras-all">
    ${views.length > 0 && html`<select class="small" aria-label="Views of the scene" value=""
      onChange=${(/** @type {any} */ event) => {
        const chosen = views[Number(event.currentTarget.value)];
        event.currentTarget.value = '';
        if (chosen?.spacing) setView({ spacing: chosen.spacing });
        if (chosen) page.stage?.setCamera(chosen.name);
      }}>
      <option value="">views…</option>
      ${views.map((/** @type {any} */ one, /** @type {number} */ index) =>
        html`<option key=${one.name} value=${index}>${one.name}</option>`)}
    </select>`}
    ${scene?.dimension === 3 && html`<span class="cameras" role="group" aria-label="Look along an axis">
      ${['x', 'y', 'z'].map((axis) => html`<button key=${axis} class="small"
        title=${`Look along ${axis}`} aria-label=${`Look along ${axis}`}
        onClick=${() => page.stage?.setCamera(axis)}>${axis}</button>`)}
    </span>`}
    <span class="cameras" role="group" aria-label="Zoom">
      ${[['out', '−', 'Zoom out'], ['in', '+', 'Zoom in']].map(([name, sign, help]) => html`<button key=${name}
        class="small" aria-label=${help} title=${help} onClick=${() => page.stage?.setCamera(name)}>${sign}</button>`)}
    </span>
    <button class="small" title="Show the whole scene: F" onClick=${() => page.stage?.setCamera('reset')}>whole</button>
  </span>`;
}

/** What the colours of the field mean. */
function MapChoice() {
  const { view } = state;
  return html`<select class="small map" aria-label="Map" value=${view.map} title="What the colours of the field mean"
    onChange=${(/** @type {any} */ event) => setView({ map: event.currentTarget.value })}>
    ${MAPS.map(([key, name]) => html`<option key=${key} value=${key} selected=${key === view.map}>${name}</option>`)}
  </select>`;
}

/** Folds the legend in the corner of the picture. */
export function LegendButton() {
  useTopics(['view']);
  const isOpen = isLegendOpen();
  return html`<button class="small" aria-expanded=${String(isOpen)} title="What the colours and the marks of the picture mean"
    onClick=${() => {
      openLegend(!isOpen);
      changed('view');
    }}>legend <span class=${isOpen ? 'caret open' : 'caret'} aria-hidden="true"></span></button>`;
}

/** The switches of the picture, behind a button. */
function Display() {
  const { view } = state;
  const box = useRef(/** @type {HTMLDetailsElement | null} */ (null));
  useEffect(() => {
    const close = (/** @type {Event} */ event) => {
      if (box.current && event.target instanceof Element && !box.current.contains(event.target)) box.current.open = false;
    };
    const escape = (/** @type {KeyboardEvent} */ event) => {
      if (event.key !== 'Escape' || !box.current?.open) return;
      if (box.current.contains(document.activeElement)) box.current.querySelector('summary')?.focus();
      box.current.open = false;
    };
    addEventListener('pointerdown', close);
    addEventListener('focusin', close);
    addEventListener('keydown', escape);
    return () => {
      removeEventListener('keydown', escape);
      removeEventListener('pointerdown', close);
      removeEventListener('focusin', close);
    };
  }, []);
  return html`<details class="popover" ref=${box}>
    <summary class="small">display</summary>
    <div class="sheet" role="group" aria-label="Display">
      <fieldset class="folded"><legend>Seen</legend><${MapChoice} /><${Cameras} /></fieldset>
      ${view.mode === 'slice' && html`<${Cut} />`}
      <fieldset><legend>Lines</legend>
        <${Switch} label="isolines" value=${view.isolines} change=${(/** @type {boolean} */ isolines) => setView({ isolines })} />
        <${Switch} label="spacing that suits the view" value=${view.spacing === null}
          change=${(/** @type {boolean} */ own) => setView({ spacing: own ? null : spacing() })} />
        ${view.spacing !== null && html`<${NumberField} label="spacing" unit="m" value=${view.spacing} min=${0} above own
          scale=${spacing()} change=${(/** @type {number} */ to) => setView({ spacing: to })} />`}
        <${Switch} label="positive inside" value=${view.positiveInside}
          help="Shows distances with the other sign; the program's own stay negative inside"
          change=${(/** @type {boolean} */ positiveInside) => setView({ positiveInside })} />
      </fieldset>
      ${view.map === 'gradient' && html`<fieldset><legend>Gradient</legend>
        <${Switch} label="exact to the card's precision" value=${view.offset === null}
          change=${(/** @type {boolean} */ is) => setView({ offset: is ? null : spacing() })} />
        ${view.offset !== null && html`<${NumberField} label="offset o" unit="m" value=${view.offset} min=${0} above
          scale=${spacing()} own change=${(/** @type {number} */ offset) => setView({ offset })}
          help="The gradient is taken from differences over this length; a large one shows the memoir's artefacts" />`}
      </fieldset>`}
      <fieldset><legend>As in the memoir</legend>
        <${Switch} label="its colours" value=${view.asInMemoir}
          change=${(/** @type {boolean} */ asInMemoir) => setView({ asInMemoir })} />
        <${NumberField} label="sine factor" value=${view.sineFactor} min=${0} max=${MOST_SINE} own
          change=${(/** @type {number} */ sineFactor) => setView({ sineFactor })} />
        ${/** @type {const} */ (['red', 'green', 'blue']).map((channel) => html`<${Switch} key=${channel}
          label=${channel} value=${view.channels[channel]}
          change=${(/** @type {boolean} */ is) => setView({ channels: { ...view.channels, [channel]: is } })} />`)}
      </fieldset>
      <fieldset><legend>Shown</legend>
        ${SHOWN.map(([key, name, help]) => html`<${Switch} key=${key} label=${name} help=${help} value=${view.shown[key]}
          change=${(/** @type {boolean} */ is) => setView({ shown: { ...view.shown, [key]: is } })} />`)}
      </fieldset>
    </div>
  </details>`;
}

/** A first spacing of isolines [m]. */
function spacing() {
  return Number((extent(state.scene?.bounds) / 40).toPrecision(1));
}
