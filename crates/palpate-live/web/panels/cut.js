// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/** The plane that cuts the scene, as numbers and buttons: what its handles do for a pointer. */

import { PLANES, listenSlice, moveSlice, normalOf, setSlice, slice, turnSlice } from '../scene/slice.js';
import { dot } from '../scene/vectors.js';
import { state } from '../state.js';
import { html, useEffect, useReducer } from '../vendor/htm-preact.js';
import { ChoiceField, NumberField } from './fields.js';
import { extent } from './numbers.js';

/** How far a button turns it [°]. */
const TURN = 5;

export function Cut() {
  const [, redraw] = useReducer((/** @type {number} */ count) => count + 1, 0);
  useEffect(() => {
    const stop = listenSlice(() => redraw(undefined));
    return () => void stop();
  }, []);
  const normal = normalOf();
  const place = dot(slice.frame.origin, normal);
  const isAlong = (/** @type {string} */ key) => Math.hypot(dot(normal, PLANES[key].right), dot(normal, PLANES[key].up)) < 1e-3;
  const name = Object.keys(PLANES).find(isAlong) ?? 'free';
  const lay = (/** @type {string} */ to) => {
    if (to in PLANES) setSlice({ frame: { ...slice.frame, ...PLANES[to] } });
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
