// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/** The button that gives forces again, far from STOP, while the program is stopped. */

import { state } from '../state.js';
import { html, useEffect, useLayoutEffect, useState } from '../vendor/htm-preact.js';
import { useTopics } from './page.js';
import { FORCES_COME_BACK, canRelease, isOthers, isStopped, noteShown, release, untilRelease } from './stopping.js';

/** Between two looks at the clock [ms]. */
const LOOK = 100;

export function Release() {
  useTopics(['stop', 'newest', 'connection', 'heard'], 50);
  return isStopped() ? html`<${Stopped} />` : null;
}

function Stopped() {
  const [, look] = useState(0);
  useEffect(() => {
    const timer = setInterval(() => look(performance.now()), LOOK);
    return () => clearInterval(timer);
  }, []);
  useLayoutEffect(noteShown);
  const wait = untilRelease();
  const words = state.unheard !== null ? 'release: not heard' : wait > 0 ? `release in ${(Math.ceil(wait / 100) / 10).toFixed(1)} s` : 'release';
  return html`<section class="stopped" aria-label="Stopped">
    <span><b>${isOthers() ? 'Stopped by another page.' : 'Stopped.'}</b> All forces are zero.</span>
    <button type="button" id="release" class="release" disabled=${!canRelease()} onClick=${release}
      title=${FORCES_COME_BACK} aria-keyshortcuts="R">${words} <kbd aria-hidden="true">R</kbd></button>
  </section>`;
}
