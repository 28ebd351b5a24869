// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * What time goes into: the page's own work, of which each part tells by `performance.measure`,
 * and the program's.
 */

import { html } from '../vendor/htm-preact.js';
import { state } from '../state.js';
import { short, time } from './numbers.js';
import { page, useTopics } from './page.js';

/** Entries that are averaged, and how long one counts [ms]. */
const KEPT = 60;
const FRESH = 3000;

/** @type {Map<string, { at: number, duration: number }[]>} */
const measured = new Map();

/** Times of the program's answers, by what was asked. @type {Map<string, number>} */
const answers = new Map();

/** Starts to take the measures of the page's parts. */
export function startProfile() {
  new PerformanceObserver((list) => {
    for (const { name, startTime, duration } of list.getEntries()) {
      const entries = measured.get(name) ?? [];
      entries.push({ at: startTime, duration });
      if (entries.length > KEPT) entries.shift();
      measured.set(name, entries);
    }
    performance.clearMeasures();
  }).observe({ type: 'measure' });
}

/** Keeps the time that the program took for an answer. @param {string} name @param {number} seconds */
export function tookTime(name, seconds) {
  answers.set(name, seconds);
}

/** @returns {{ name: string, mean: number, largest: number, count: number }[]} in seconds */
function pageWork() {
  const now = performance.now();
  return [...measured].map(([name, all]) => {
    const entries = all.filter(({ at }) => now - at < FRESH);
    const times = entries.map(({ duration }) => duration / 1000);
    const mean = times.reduce((sum, one) => sum + one, 0) / (times.length || 1);
    return { name, mean, largest: Math.max(0, ...times), count: times.length };
  }).filter(({ count }) => count > 0).concat(picture()).sort((a, b) => b.mean - a.mean);
}

/** The time of the picture, which the stage knows: the graphics card works beside the page. */
function picture() {
  const { time: taken, scale } = page.stage?.stats() ?? { time: 0, scale: 1 };
  const name = `picture at ${Math.round(100 * scale)} %`;
  return taken > 0 ? [{ name, mean: taken / 1000, largest: taken / 1000, count: 1 }] : [];
}

function programWork() {
  const recent = state.history.slice(-KEPT);
  const mean = (/** @type {(frame: import('../wire.js').Frame) => number} */ of) =>
    recent.reduce((sum, frame) => sum + of(frame), 0) / (recent.length || 1);
  const most = (/** @type {(frame: import('../wire.js').Frame) => number} */ of) => Math.max(0, ...recent.map(of));
  return [
    { name: 'longest tick', mean: mean((frame) => frame.cost), largest: most((frame) => frame.cost), count: recent.length },
    { name: 'lateness', mean: mean((frame) => frame.lateness), largest: most((frame) => frame.lateness), count: recent.length },
    ...[...answers].map(([name, seconds]) => ({ name, mean: seconds, largest: seconds, count: 1 })),
  ];
}

export function Profile() {
  useTopics(['frame', 'scene'], 500);
  const period = 1 / (state.welcome?.rate ?? 1000);
  const rows = programWork();
  return html`<div class="profile" tabindex="0" role="region" aria-label="Profile">
    <${Bars} title="This page, a frame has 16 700 µs" rows=${pageWork()} whole=${1 / 60} />
    <div>
      <${Bars} title=${`The program, a tick has ${time(period)}; the longest took ${short((100 * rows[0].largest) / period)} % of it`}
        rows=${rows} whole=${period} />
      <${Flame} />
    </div>
  </div>`;
}

/** What the program did to build the newest revision: the whole above its parts, each as wide as
 * the time that it took. */
function Flame() {
  const parts = /** @type {{ name: string, time: number }[]} */ (state.scene?.spent ?? []);
  const whole = parts.reduce((sum, part) => sum + part.time, 0);
  if (whole === 0) return null;
  return html`<div class="flame">
    <b>Revision ${state.scene?.revision}, in the program</b>
    <div class="flame-row"><span class="flame-bar whole">the whole edit ${time(whole)}</span></div>
    <ul class="flame-row">${parts.map(({ name, time: taken }) => html`<li key=${name} class="flame-bar" style=${{ flexGrow: taken / whole }}
      title=${`${name}: ${time(taken)}`}>${name} ${time(taken)}</li>`)}</ul>
    <p class="quiet">${parts.map(({ name, time: taken }) => `${name} ${time(taken)}`).join(' · ')}</p>
  </div>`;
}

/** @param {{ title: string, rows: ReturnType<typeof pageWork>, whole: number }} given */
function Bars({ title, rows, whole }) {
  const part = (/** @type {number} */ seconds) => `${Math.min(100, (100 * seconds) / whole)}%`;
  return html`<div class="bars"><b>${title}</b>
    ${rows.length === 0 && html`<p class="quiet">nothing measured</p>`}
    ${rows.map(({ name, mean, largest }) => html`<div class="bar" key=${name}
      title=${`${name}: mean ${time(mean)}, largest ${time(largest)}`}>
      <span class="bar-name">${name}</span>
      <span class="bar-track"><span class="bar-largest" style=${{ width: part(largest) }}></span>
        <span class="bar-mean" style=${{ width: part(mean) }}></span></span>
      <span class="bar-time">${Math.round(mean * 1e6)} µs</span>
    </div>`)}
  </div>`;
}
