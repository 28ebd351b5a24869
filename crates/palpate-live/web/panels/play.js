// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/** The play bar, the charts' tabs, and the counters. */

import { html, useEffect, useRef, useState } from '../vendor/htm-preact.js';
import { lookAt, state } from '../state.js';
import * as actions from './actions.js';
import { Charts } from './charts.js';
import { Events } from './events.js';
import { FallingBall } from './fall.js';
import { count, servoTime, time } from './numbers.js';
import { page, useTopics } from './page.js';
import { Profile } from './profile.js';
import { downloadTrace, record, recorded, replay } from './recording.js';
import { Safety } from './safety.js';
import { useWide } from './tabs.js';

/** Between two updates [ms]. */
const INTERVAL = 100;
/** Between two counts [ms], and how many make a rate, at least and at most: frames come in steps of
 * 17 ms, and late where the page is busy. */
const COUNTING = 1000;
const COUNTS = { least: 3, most: 6 };

/** @type {Record<string, [string, () => any]>} */
const TABS = {
  charts: ['Charts', Charts],
  events: ['Events', Events],
  safety: ['Safety', Safety],
  profile: ['Profile', Profile],
  ball: ['Falling ball', FallingBall],
};

export function Time() {
  const [tab, setTab] = useState('charts');
  const Body = TABS[tab][1];
  // On a narrow page what is looked at comes first.
  const isWide = useWide();
  return html`
    ${isWide && html`<${PlayBar} />`}
    <div class="time-tabs" role="group" aria-label="Below the play bar">
      ${Object.entries(TABS).map(([key, [name]]) => html`<button key=${key} class="small" aria-pressed=${String(tab === key)}
        onClick=${() => setTab(key)}>${name}</button>`)}
      <${Counters} />
    </div>
    <div class="time-body">
      <${Body} key=${tab} />
    </div>
    ${!isWide && html`<${PlayBar} />`}`;
}

function PlayBar() {
  useTopics(['newest', 'playback', 'scene', 'connection', 'heard'], INTERVAL);
  const { history, lookingAt, frame, newest } = state;
  const last = Math.max(history.length - 1, 0);
  const at = lookingAt ?? last;
  const isFollowing = lookingAt === null;
  const isHeld = newest?.held ?? false;
  const rate = state.welcome?.rate;
  const ago = servoTime(newest && frame ? newest.time - frame.time : 0, rate);
  const words = !isFollowing ? `looking back ${ago}`
    : state.connection !== 'live' ? 'not connected' : state.unheard !== null ? 'not heard'
    : newest?.stopped ? (newest.replaying ? 'replaying without forces' : 'stopped: forces are zero')
    : isHeld ? 'time is held' : newest?.replaying ? 'replaying' : 'following';
  return html`<div class="play">
    <button class="small" onClick=${() => actions.lookBy(-1)} aria-label="One frame back" title="One frame back: ,"
      disabled=${history.length === 0}>◂</button>
    <button class="small" onClick=${() => actions.lookBy(1)} aria-label="One frame forth" title="One frame forth: → while looking back"
      disabled=${isFollowing}>▸</button>
    <button class="small" onClick=${actions.hold} title="Hold the servo's time, or go on: P" aria-pressed=${String(isHeld)}>
      ${isHeld ? 'go on' : 'hold'}</button>
    <button class="small" onClick=${actions.step} title="One step of the servo: ." disabled=${!isHeld}>step</button>
    <button class="small" onClick=${() => lookAt(null)} title="Follow the present: Home" aria-pressed=${String(isFollowing)}>
      follow</button>
    <span class=${isFollowing && !newest?.replaying ? 'play-words' : 'play-words replay'}>${words}</span>
    <input type="range" class="slider scrub" min="0" max=${last} value=${at} aria-label="Look back"
      aria-valuetext=${isFollowing ? 'now' : `${ago} ago`} disabled=${last === 0}
      onInput=${(/** @type {any} */ event) => lookAt(Number(event.currentTarget.value))} />
    <span class="unit time-shown">${frame ? servoTime(frame.time, rate) : '–'}</span>
    <select class="small" aria-label="Speed of time" title="Slow motion: S"
      value=${String(actions.clock.speed)}
      onChange=${(/** @type {any} */ event) => void actions.setSpeed(Number(event.currentTarget.value))}>
      ${[1, 0.25, 0.1].map((speed) => html`<option key=${speed} value=${String(speed)}
        selected=${speed === actions.clock.speed}>${speed}×</option>`)}
    </select>
    <button class=${newest?.recording ? 'small recording' : 'small'} aria-pressed=${String(newest?.recording ?? false)}
      onClick=${record} title="Keep every tick, at most 200 000 rows">
      ${newest?.recording ? `recording ${recorded()}` : 'record'}</button>
    <button class="small" aria-pressed=${String(newest?.replaying ?? false)} disabled=${newest?.recording ?? false}
      onClick=${() => replay(!newest?.replaying)} title="Lead the hand along what was recorded last">
      ${newest?.replaying ? 'end replay' : 'replay'}</button>
    <${TraceButton} />
    <button class="small" onClick=${downloadTrace} title=${`What was recorded${recorded() && `, ${recorded()}`}, as CSV`}>CSV</button>
    <button class="small png" onClick=${actions.downloadPicture} title="The picture as PNG">PNG</button>
  </div>`;
}

/** Opens a trace to replay it. */
function TraceButton() {
  const file = useRef(/** @type {HTMLInputElement | null} */ (null));
  return html`<button class="small" onClick=${() => file.current?.click()}
      title="Open a trace, a CSV file, and replay it; it can be dropped on the page too">open trace…</button>
    <input type="file" hidden accept=".csv,text/csv" ref=${file} aria-label="Trace file"
      onChange=${(/** @type {any} */ event) => {
        const [chosen] = event.currentTarget.files;
        event.currentTarget.value = '';
        if (chosen) void actions.openFile(chosen);
      }} />`;
}

/** Frames and ticks a second, evaluations and pages. */
function Counters() {
  useTopics(['clients']);
  const [shown, setShown] = useState({ drawn: 0, ticks: 0 });
  useEffect(() => {
    let isOver = false;
    let frames = 0;
    const each = () => {
      frames += 1;
      if (!isOver) requestAnimationFrame(each);
    };
    requestAnimationFrame(each);
    /** @type {{ frames: number, tick: number, at: number }[]} */
    let counts = [];
    const timer = setInterval(() => {
      const now = { frames, tick: state.newest?.tick ?? 0, at: performance.now() };
      // Another servo began.
      if (now.tick < counts[counts.length - 1]?.tick) counts = [];
      counts = [...counts, now].slice(-COUNTS.most);
      if (counts.length < COUNTS.least) return;
      const [first] = counts;
      const seconds = (now.at - first.at) / 1000;
      setShown({ drawn: (frames - first.frames) / seconds, ticks: (now.tick - first.tick) / seconds });
    }, COUNTING);
    return () => {
      isOver = true;
      clearInterval(timer);
    };
  }, []);
  const { frame } = state;
  const recent = state.history.slice(-60);
  const cost = recent.reduce((sum, one) => sum + one.cost, 0) / (recent.length || 1);
  return html`<span class="counters">
    <span title="How often the page draws, and how long a picture takes">${Math.round(shown.drawn)} frames/s
      of ${time((page.stage?.stats().time ?? 0) / 1000)}</span>
    <span title="How often the servo computes a force, and how long its longest tick takes, on average over a second">${count(shown.ticks)} ticks/s
      of ${time(cost)}</span>
    <span>${count(frame?.evaluations ?? 0)} evaluations a tick</span>
    <span>${state.clients} ${state.clients === 1 ? 'page' : 'pages'}</span>
  </span>`;
}
