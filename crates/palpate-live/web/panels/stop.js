// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * The button that stops all forces, always in the same place: on the page, and in every window
 * that lies over it. It stops in every state, and never releases.
 */

import { html, useRef } from '../vendor/htm-preact.js';
import { useTopics } from './page.js';
import { stop, stopInWords } from './stopping.js';

/** A click that comes sooner after a press on the button is that press [ms]. */
const SAME = 2000;

/** Stops at the press, before it ends; keys and what acts for a person give a click alone.
 * @param {{ id?: string }} given */
export function StopButton({ id }) {
  useTopics(['stop', 'newest', 'connection', 'heard'], 50);
  const pressedAt = useRef(-Infinity);
  const words = stopInWords();
  return html`<button type="button" id=${id} class=${words.short ? 'stop told' : 'stop'} title="All forces to zero: Esc"
      onPointerDown=${(/** @type {Event} */ event) => {
        pressedAt.current = performance.now();
        stop(event);
      }}
      onClick=${(/** @type {MouseEvent} */ event) => {
        const isSame = event.detail > 0 && performance.now() - pressedAt.current < SAME;
        pressedAt.current = -Infinity;
        if (!isSame) stop(event);
      }}>
    <span class="stop-name"><span class="square" aria-hidden="true"></span>STOP</span>
    ${words.short && html` <span class="stop-words">${words.short}</span>`}</button>
  <span class="unseen" role="alert" aria-live="assertive">${words.long}</span>`;
}
