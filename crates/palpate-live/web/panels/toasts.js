// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/** Messages that come and go, and what the page says while it cannot work. */

import { html, useEffect, useReducer, useState } from '../vendor/htm-preact.js';
import { state } from '../state.js';
import { TWO_NEEDED, downloadScene } from './actions.js';
import { tokenIn } from './link.js';
import { dismiss, listenToasts, toasts, useTopics } from './page.js';
import { Waiting } from './waiting.js';

export function Toasts() {
  const [, redraw] = useReducer((/** @type {number} */ count) => count + 1, 0);
  useEffect(() => listenToasts(() => redraw(undefined)), []);
  return html`<${Waiting} />${toasts.map(({ id, kind, text, actions }) => html`<div key=${id} class=${`toast ${kind}`}>
    <span>${text}</span>
    ${actions.map(({ name, run }) => html`<button key=${name} class="small" onClick=${() => {
      dismiss(id);
      run();
    }}>${name}</button>`)}
    <button class="small" aria-label="Close the message" onClick=${() => dismiss(id)}>×</button>
  </div>`)}`;
}

/** The state of the page in words, over the picture, while there is one to tell.
 * @param {{ start: (token: string) => void }} given */
export function Words({ start }) {
  useTopics(['connection', 'scene', 'playback', 'view']);
  const { connection, scene } = state;
  if (connection === 'closed') return html`<${NoToken} start=${start} />`;
  if (connection === 'lost') {
    return html`<div class="words bad">${state.why
      ? html`<b>The program has closed the connection: ${state.why}.</b>
        The page tries again. STOP reaches the program all the same.`
      : html`<b>The program has ended.</b>
        Start it again, and this page comes back. If it still runs, STOP tries to reach it all the same.`}
      ${scene && !scene.is_saved && html`<p>The scene has edits that are not saved: this page still has them.</p>
        <button class="small" onClick=${downloadScene}>Download the scene</button>`}</div>`;
  }
  if (connection === 'connecting') return html`<div class="words">Connecting to the program…</div>`;
  if (scene && (scene.bodies ?? []).length === 0) {
    return html`<div class="words">The scene is empty: add a body with “add…”, or open a file.</div>`;
  }
  if (scene && state.view.mode === 'compare' && scene.bodies.length < 2) return html`<div class="words">${TWO_NEEDED}</div>`;
  return null;
}

/** @param {{ start: (token: string) => void }} given */
function NoToken({ start }) {
  const [text, setText] = useState('');
  return html`<form class="words" onSubmit=${(/** @type {Event} */ event) => {
    event.preventDefault();
    const token = tokenIn(text);
    if (token) start(token);
  }}>
    <b>${state.why || 'This page needs the token of the program.'}</b>
    <p>A program that moves a hand obeys only who knows its token. <code>palpate live</code> prints an address
      such as <code>${location.origin}/#…</code> where it was started: open that one, or paste it here.</p>
    <label>Address or token <input value=${text} autocomplete="off" spellcheck=${false}
      onInput=${(/** @type {any} */ event) => setText(event.currentTarget.value)}
      onKeyDown=${(/** @type {KeyboardEvent} */ event) => event.key === 'Escape' && setText('')} /></label>
    <button>Connect</button>
  </form>`;
}
