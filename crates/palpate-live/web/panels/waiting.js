// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/** What the program works on for long, with a button that ends it. */

import { html, useEffect, useState } from '../vendor/htm-preact.js';
import { page } from './page.js';

/** Questions that take longer are shown [ms]. */
const LONG = 1000;
/** Between two looks [ms]. */
const INTERVAL = 250;

/** What the program does for a question. @type {Record<string, string>} */
const WORK = {
  element: 'searches for the least distance', pair: 'proves the separation of two bodies',
  contacts: 'searches for all contacts', sweep: 'searches for the first touch', fall: 'lets the ball fall', samples: 'samples the field',
  slice: 'samples a slice', point: 'looks at the field', replay: 'begins a replay', clock: 'sets the clock', picture: 'draws the picture', edit: 'builds the scene', open: 'opens the scene', undo: 'builds the scene',
  redo: 'builds the scene', save: 'saves the scene',
};
/** What the button of STOP and that of release tell of themselves. */
const TOLD = ['stop', 'release'];
/** Orders, which are not ended halfway. */
const WHOLE = ['edit', 'open', 'undo', 'redo', 'save', 'replay', 'clock'];

export function Waiting() {
  const [slow, setSlow] = useState(/** @type {{ id: number, what: string, since: number }[]} */ ([]));
  useEffect(() => {
    const timer = setInterval(() => setSlow((last) => {
      const next = (page.wire?.slow(LONG) ?? []).filter(({ what }) => !TOLD.includes(what));
      return next.length === 0 && last.length === 0 ? last : next;
    }), INTERVAL);
    return () => clearInterval(timer);
  }, []);
  const now = performance.now();
  return html`${slow.map(({ id, what, since }) => html`<div key=${id} class="toast working">
    <span>The program ${WORK[what] ?? 'works'}
      <span aria-hidden="true">: ${Math.floor((now - since) / 1000)} s</span></span>
    ${!WHOLE.includes(what) && html`<button class="small" onClick=${() => page.wire?.cancel(id)}>cancel</button>`}
  </div>`)}`;
}
