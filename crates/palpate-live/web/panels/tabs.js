// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/** On a narrow page: which panel is below the picture. On a wide one: which is on the right. */

import { html, useEffect, useState } from '../vendor/htm-preact.js';

/** The size from which all panels have room; style.css and panels.css have it too. */
const WIDE = matchMedia('(min-width: 960px) and (min-height: 481px)');

/** Whether all panels have room; draws a component anew when that changes. */
export function useWide() {
  const [isWide, setIsWide] = useState(WIDE.matches);
  useEffect(() => {
    const turn = () => setIsWide(WIDE.matches);
    WIDE.addEventListener('change', turn);
    return () => WIDE.removeEventListener('change', turn);
  }, []);
  return isWide;
}

/** @param {{ main: HTMLElement }} given */
export function Tabs({ main }) {
  const [chosen, setChosen] = useState('shapes');
  const isWide = useWide();
  // All panels but these two are always seen on a wide page.
  const shown = isWide && chosen !== 'checks' ? 'selected' : chosen;
  useEffect(() => {
    main.dataset.panel = shown;
  }, [shown]);
  const tabs = [['shapes', 'Shapes'], ['selected', 'Selected'], ['touch', 'Touch'], ['checks', 'Checks'], ['time', 'Charts']];
  return html`<div class="tabs" role="group" aria-label="Panels">
    ${tabs.map(([key, name]) => html`<button key=${key} class=${`tab-${key}`} aria-pressed=${String(shown === key)}
      onClick=${() => setChosen(key)}>${name}</button>`)}
  </div>`;
}
