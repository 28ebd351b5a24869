// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/** The button that stops all forces, in the header and in every window that lies over it. */

import { state } from '../state.js';
import { html } from '../vendor/htm-preact.js';
import { page, useTopics } from './page.js';

/** Stops all forces; over HTTP if there is no socket. */
export function stop() {
  if (state.connection === 'live') page.wire?.send({ do: 'stop' });
  else navigator.sendBeacon(`stop?token=${encodeURIComponent(page.token)}`);
}

/** How forces come back after a stop, and of a servo that has begun. */
export const FORCES_COME_BACK = 'Forces come back once the hand is out of the bodies, rising from zero.';

/** Gives forces again. */
function release() {
  page.wire?.send({ do: 'release' });
}

/** Stops; once stopped it gives the forces back. @param {{ id?: string }} given */
export function StopButton({ id }) {
  useTopics(['newest', 'connection'], 50);
  const isStopped = state.newest?.stopped ?? false;
  if (isStopped && state.connection === 'live') {
    return html`<button type="button" id=${id} class="stop stopped" onClick=${release}>forces are zero — release</button>`;
  }
  return html`<button type="button" id=${id} class="stop" onClick=${stop} title="All forces to zero: Esc">
    <span class="square" aria-hidden="true"></span>STOP</button>`;
}
