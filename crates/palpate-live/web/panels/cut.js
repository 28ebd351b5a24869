// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/** The plane that cuts the scene, as numbers and buttons: what its handles do for a pointer. */

import { listenSlice, moveSlice, normalOf, setSlice, slice, turnSlice } from '../scene/slice.js';
import { state } from '../state.js';
import { html, useEffect, useReducer } from '../vendor/htm-preact.js';
import { ChoiceField, NumberField } from './fields.js';
import { extent } from './numbers.js';

/** Axes of the plane by its name. @type {Record<string, [number[], number[]]>} */
const PLANES = { xy: [[1, 0, 0], [0, 1, 0]], xz: [[1, 0, 0], [0, 0, -1]], yz: [[0, 0, -1], [0, 1, 0]] };
/** How far a button turns it [°]. */
const TURN = 5;

/** @param {number[]} a @param {number[]} b */
const dot = (a, b) => a.reduce((sum, part, axis) => sum + part * b[axis], 0);

export function Cut() {
  const [, redraw] = useReducer((/** @type {number} */ count) => count + 1, 0);
  useEffect(() => {
    const stop = listenSlice(() => redraw(undefined));
    return () => void stop();
  }, []);
  const normal = normalOf();
  const place = dot(slice.frame.origin, normal);
  const name = Object.keys(PLANES).find((key) => Math.abs(PLANES[key].reduce((sum, axis) =>
    sum + dot(normal, axis) ** 2, 0)) < 1e-6) ?? 'free';
  const lay = (/** @type {string} */ to) => {
    if (!(to in PLANES)) return;
    const [right, up] = PLANES[to];
    setSlice({ frame: { ...slice.frame, right: /** @type {any} */ (right), up: /** @type {any} */ (up) } });
  };
  return html`<fieldset><legend>Slice</legend>
    <${ChoiceField} label="lies along" value=${name} choices=${[...Object.keys(PLANES), 'free']} change=${lay} />
    <${NumberField} label="along its normal" unit="m" own value=${place} scale=${extent(state.scene?.bounds)}
      change=${(/** @type {number} */ to) => moveSlice(to - place)} />
    <div class="switches">${/** @type {const} */ ([['right', 'across'], ['up', 'above']]).map(([axis, words]) => [-TURN, TURN].map((angle) => html`
      <button key=${words + angle} class="small" onClick=${() => turnSlice(axis, (angle * Math.PI) / 180)}
        aria-label=${`Turn the slice by ${angle}° about its axis ${words}`}>${words} ${angle > 0 ? '+' : '−'}${TURN}°</button>`))}</div>
  </fieldset>`;
}
