// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/** The button that stops all forces, in the header and in every window that lies over it. */

import { norm } from '../scene/vectors.js';
import { state } from '../state.js';
import { html } from '../vendor/htm-preact.js';
import { page, tell, useTopics } from './page.js';
import { isNow } from './safety.js';

/** Stops all forces; over HTTP if there is no socket. */
export function stop() {
  if (state.connection === 'live') page.wire?.send({ do: 'stop' });
  else navigator.sendBeacon(`stop?token=${encodeURIComponent(page.token)}`);
}

/** How forces come back after a release and after the servo starts. */
export const FORCES_COME_BACK = 'Forces come back once the hand is out of the bodies, rising from zero: draw it out by the mouse or the arrow keys.';

/** What a person does who touches a body and feels no force after a stop; empty where there is one.
 * @param {import('../wire.js').Frame | null} frame */
export function withheldInWords(frame) {
  const isWithheld = frame?.points.some(({ contact, wanted, force }) => contact && norm(wanted) > 0 && norm(force) === 0);
  const isRising = state.safety.some((stage) => stage.name === 'rise from zero' && isNow(stage.acted));
  return isWithheld && isRising ? 'no force until the hand is out of the bodies: draw it out by the mouse or the arrow keys' : '';
}

/** Gives forces again. */
function release() {
  page.wire?.send({ do: 'release' });
  tell(state.newest?.touring ? 'Forces rise from zero once the hand is out of the bodies; the tour goes on.' : FORCES_COME_BACK);
}

/** Stops; once stopped it gives the forces back. @param {{ id?: string }} given */
export function StopButton({ id }) {
  useTopics(['newest', 'connection'], 50);
  const isStopped = state.newest?.stopped ?? false;
  if (isStopped && state.connection === 'live') {
    return html`<button type="button" id=${id} class="stop stopped" onClick=${release}
      title=${FORCES_COME_BACK}>forces are zero — release</button>`;
  }
  return html`<button type="button" id=${id} class="stop" onClick=${stop} title="All forces to zero: Esc">
    <span class="square" aria-hidden="true"></span>STOP</button>`;
}
