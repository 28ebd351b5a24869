// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * The toys of the memoir as numbers: a triangle, a circle, a pair of bodies and a moving element,
 * each with what is proven beside what a local method says.
 *
 * @typedef {import('../plane/toys.js').Toy} Toy
 */

import { LETTERS } from '../plane/handles.js';
import { GRADIENTS, METHODS, PAIR_METHODS, listenToys, setToys, toys } from '../plane/toys.js';
import { boxOf, centreOf } from '../scene/setting.js';
import { toDecimals } from '../scene/vectors.js';
import { state } from '../state.js';
import { html, useEffect, useReducer } from '../vendor/htm-preact.js';
import { TWO_NEEDED } from './actions.js';
import { ChoiceField, NumberField, Switch, VectorField } from './fields.js';
import { extent } from './numbers.js';
import { useTopics } from './page.js';
import { Point } from './point.js';
import { tookTime } from './profile.js';
import { Verdict } from './verdict.js';

const KINDS = ['a point', 'a segment', 'a triangle'];

/** @type {[Toy, string, string][]} */
const TOYS = [
  ['element', 'Triangle', 'The least distance over a point, a segment or a triangle, proven and by a local method'],
  ['ball', 'Circle', 'Whether a circle meets the scene'],
  ['pair', 'Two bodies', 'The separation of two bodies, proven and by local descents'],
  ['sweep', 'Moving element', 'When the element first touches the scene'],
];

/** Draws anew when a toy or an answer changes. */
function useToys() {
  const [, redraw] = useReducer((/** @type {number} */ count) => count + 1, 0);
  useEffect(() => {
    const stop = listenToys(() => {
      for (const [toy] of TOYS) {
        const { certified, local, time } = toys.results[toy] ?? {};
        if (time ?? certified?.time) tookTime(`${toy}, proven`, time ?? certified.time);
        const spent = [local ?? []].flat().reduce((sum, one) => sum + one.time, 0);
        if (spent > 0) tookTime(`${toy}, local`, spent);
      }
      redraw(undefined);
    });
    return () => void stop();
  }, []);
}

export function Checks() {
  useTopics(['scene', 'welcome']);
  useToys();
  const isPlane = state.scene?.dimension === 2;
  return html`
    <div class="panel-head"><h2>Checks</h2></div>
    <div class="scroll" tabindex="0" role="region" aria-label="Numbers of the checks">
      <${Point} />
      ${!isPlane && html`<p class="quiet">Triangle, circle and their proofs are for scenes in the plane, such as
        memoir_star.json.</p>`}
      ${isPlane && TOYS.map(([toy, name, help]) => html`<div key=${toy} class="check">
        <${Switch} label=${name} help=${help} value=${toys.shown[toy]}
          change=${(/** @type {boolean} */ is) => setToys({ shown: { ...toys.shown, [toy]: is } })} />
        ${toys.shown[toy] && html`
          ${toys.refused[toy] && html`<p class="problem">${toys.refused[toy]}</p>`}
          <${Verdict} toy=${toy} result=${toys.results[toy]} />
          <${Parameters} toy=${toy} />
          ${toy === 'pair' && html`<${Starts} />`}`}
      </div>`)}
    </div>`;
}

/** @param {{ toy: Toy }} given */
function Parameters({ toy }) {
  if (toy === 'ball') {
    const { centre, radius } = toys.ball;
    return html`<${VectorField} label="centre" unit="m" value=${centre} scale=${scale()}
        change=${(/** @type {number[]} */ to) => setToys({ ball: { centre: to, radius } })} />
      <${NumberField} label="radius" unit="m" value=${radius} min=${0} above own scale=${scale()}
        change=${(/** @type {number} */ to) => setToys({ ball: { centre, radius: to } })} />`;
  }
  if (toy === 'sweep') {
    return html`${!toys.shown.element && html`<${Corners} />`}
      <${VectorField} label="motion in 1 s" unit="m" value=${toys.by} scale=${scale()}
        change=${(/** @type {number[]} */ by) => setToys({ by })} />`;
  }
  return toy === 'pair' ? html`<${Pair} />` : html`<${Corners} /><${Method} />`;
}

/** A length that suits the scene [m]. */
function scale() {
  return extent(state.scene?.bounds) / 2;
}

/** The middle of the scene [m]. */
function middle() {
  const box = boxOf(state.scene?.bounds);
  return box ? centreOf(box).slice(0, 2).map((part) => toDecimals(part, 6)) : [0, 0];
}

/** The longest edge of an element [m]: the program's µ is a tenth of it. @param {number[][]} corners */
function longestEdge(corners) {
  const edges = corners.flatMap((one, index) => corners.slice(index + 1)
    .map((other) => Math.hypot(...one.map((x, axis) => x - other[axis]))));
  return Math.max(0, ...edges);
}

function Corners() {
  const { corners } = toys;
  const take = (/** @type {string} */ count) => {
    const middle = corners[0] ?? [0, 0];
    const more = [[0.2, 0], [0, 0.2]].map((way) => middle.map((place, axis) => place + way[axis] * scale()));
    // A start is weights of as many corners as there are.
    setToys({ corners: [...corners, ...more].slice(0, Number(count)), start: null, at: null });
  };
  return html`<${ChoiceField} label="element" value=${String(corners.length)} change=${take}
      choices=${KINDS.map((name, index) => [String(index + 1), name])} />
    ${corners.map((corner, index) => html`<${VectorField} key=${index} label=${`vertex ${LETTERS[index]}`} unit="m"
      value=${corner} scale=${scale()} change=${(/** @type {number[]} */ to) =>
        setToys({ corners: corners.map((old, at) => (at === index ? to : old)) })} />`)}`;
}

function Pair() {
  const { pair } = toys;
  const names = (state.scene?.bodies ?? []).map((/** @type {any} */ body, /** @type {number} */ index) => [String(index), body.name]);
  if (names.length < 2) return html`<p class="quiet">${TWO_NEEDED}</p>`;
  return html`
    ${/** @type {const} */ (['a', 'b']).map((side) => html`<${ChoiceField} key=${side} label=${`body ${side.toUpperCase()}`}
      value=${String(pair[side])} choices=${names}
      change=${(/** @type {string} */ to) => setToys({ pair: { ...pair, [side]: Number(to) } })} />`)}
    <${ChoiceField} label="local method" value=${pair.method} choices=${Object.entries(PAIR_METHODS)}
      change=${(/** @type {string} */ method) => setToys({ pair: { ...pair, method } })} />
    <p class="quiet">Click on the picture to add a start, drag one to move it, or use the numbers.</p>`;
}

/** Starts of the search between two bodies, as numbers. */
function Starts() {
  const { pair } = toys;
  const put = (/** @type {number[][]} */ starts) => setToys({ pair: { ...pair, starts } });
  if ((state.scene?.bodies ?? []).length < 2) return null;
  return html`
    ${pair.starts.map((start, index) => html`<div class="element" key=${index}>
      <${VectorField} label=${`start ${index + 1}`} unit="m" value=${start} scale=${scale()}
        change=${(/** @type {number[]} */ to) => put(pair.starts.map((old, at) => (at === index ? to : old)))} />
      <button class="small" title="Take out" aria-label=${`Take out start ${index + 1}`}
        onClick=${() => put(pair.starts.filter((_, at) => at !== index))}>×</button>
    </div>`)}
    <button class="small" onClick=${() => put([...pair.starts, middle()])}>add a start</button>
    ${pair.starts.length > 0 && html`<button class="small"
      onClick=${() => put([])}>take the starts away</button>`}`;
}

function Method() {
  const { corners, method, alpha, mu, gradient, iterations, start, at } = toys;
  const free = (/** @type {string} */ key, /** @type {string} */ label, /** @type {number | null} */ value,
    /** @type {number} */ first, /** @type {Record<string, any>} */ limits, /** @type {string} */ help) => html`
    <${Switch} label=${`${label} by the program`} value=${value === null}
      change=${(/** @type {boolean} */ own) => setToys({ [key]: own ? null : first })} />
    ${value !== null && html`<${NumberField} label=${label} help=${help} value=${value} own ...${limits}
      change=${(/** @type {number} */ to) => setToys({ [key]: to })} />`}`;
  const path = toys.results.element?.local?.path;
  return html`
    <${ChoiceField} label="local method" value=${method} choices=${Object.entries(METHODS)}
      change=${(/** @type {string} */ to) => setToys({ method: to })} />
    ${method === 'naive' && html`
      ${free('alpha', 'step size α', alpha, 0.1, { min: 0, max: 1, above: true }, 'The memoir’s α: a step is α times the distance long')}
      ${free('mu', 'least distance µ', mu, longestEdge(corners) / 10, { min: 0, scale: scale(), unit: 'm' }, 'The memoir’s µ: nearer than µ a step is α µ long, so that steps do not vanish at the surface')}
      <p class="quiet">Each step goes down the slope by the step size α times the distance, but at least by α times µ: where
        that is longer than the way to the minimum, the path goes to and fro across it.</p>
      <${ChoiceField} label="gradient" value=${gradient} choices=${Object.entries(GRADIENTS)}
        change=${(/** @type {string} */ to) => setToys({ gradient: to })} />
      <${NumberField} label="iterations" value=${iterations} min=${1} max=${1000} whole own
        change=${(/** @type {number} */ to) => setToys({ iterations: to })} />`}
    ${corners.length > 1 && html`
      <${Switch} label="start in the middle" value=${start === null}
        change=${(/** @type {boolean} */ is) => setToys({ start: is ? null : corners.map(() => 1 / corners.length) })} />
      ${start !== null && html`<${VectorField} label="weights of the start" value=${start}
        names=${['A', 'B', 'C']} min=${0} own change=${(/** @type {number[]} */ to) => setToys({ start: to })} />`}`}
    ${Array.isArray(path) && path.length > 1 && html`<${NumberField} key=${path.length} label="step of the path"
      whole own min=${0} max=${path.length - 1} value=${Math.min(at ?? Infinity, path.length - 1)}
      change=${(/** @type {number} */ to) => setToys({ at: to === path.length - 1 ? null : to })} />`}`;
}
