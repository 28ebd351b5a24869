// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * The stages between the force that is wanted and the hand: what each does, and which act.
 *
 * @typedef {{ name: string, ticks: number, largest: number }} Stage
 */

import { norm } from '../scene/vectors.js';
import { changed, state } from '../state.js';
import { html, useEffect, useReducer } from '../vendor/htm-preact.js';
import { count, short } from './numbers.js';
import { useTopics } from './page.js';

/** How long a stage that acted is told of in the foot line, and marked in the list [ms]. */
const NOW = 1500;
/** Between two looks at the clock [ms]: a stage no longer acts without a message that says so. */
const LOOK = 500;

/** When a frame last told that some stage acts, on the clock of `performance.now()`. */
let actedAt = -Infinity;

/** For the foot line, and what the stage does. @type {Record<string, [string, string]>} */
const WORDS = {
  'held readings': ['reading held', 'A reading that no hand can have made is not believed: the one before is held.'],
  'limit cycles': ['oscillation softened', 'A wall that begins to oscillate by itself is made softer.'],
  'passivity of guides': ['guides held back', 'Guides and magnets add no energy that comes from sampling them in ticks.'],
  passivity: ['energy held back', 'The force gives the hand no more energy than it took and the device’s damping dissipates.'],
  'force rate': ['force rate limited', 'The force changes by no more in a tick than the device follows.'],
  'largest force': ['force limited', 'The force is shortened to the largest that is allowed; its direction stays.'],
  'lasting force': ['lasting force lowered', 'A large force that lasts is lowered before the motors grow hot.'],
  'not a number': ['force zero: not a number', 'A force or a reading that is no finite number makes the force zero.'],
  'rise from zero': ['force rises from zero', 'A force that was zero, at the start, after a stop or where an edit covered the hand, waits until the hand is out of the bodies where that is needed, and then rises slowly.'],
  watchdog: ['force lowered: late ticks', 'While ticks are late the force falls to zero, since an old force is a wrong one.'],
  'emergency stop': ['stopped', 'STOP, Esc or the device’s own switch makes all forces zero.'],
  'torque rate': ['torque rate limited', 'The torque changes by no more in a tick than the device follows.'],
  'largest torque': ['torque limited', 'The torque is shortened to the largest that is allowed.'],
  'lasting torque': ['lasting torque lowered', 'A large torque that lasts is lowered before the motors grow hot.'],
};

/** Takes what the program tells of its stages. @param {Stage[]} stages */
export function takeSafety(stages) {
  const now = performance.now();
  const before = new Map(state.safety.map((stage) => [stage.name, stage]));
  state.safety = stages.map(({ name, ticks, largest }) => {
    const last = before.get(name);
    const acted = last && ticks > last.ticks ? now : last && ticks === last.ticks ? last.acted : -Infinity;
    return { name, ticks, largest, acted };
  });
  changed('safety');
}

/** Takes note of what frames say of the stages. @param {import('../wire.js').Frame} frame */
export function watchSafety(frame) {
  if (frame.acted) actedAt = performance.now();
}

/** @param {number} time on the clock of `performance.now()` */
export const isNow = (time) => performance.now() - time < NOW;

/** The stage that brings a force back from zero. */
const RISE = 'rise from zero';

/** Whether a body is touched of which no force is felt. @param {import('../wire.js').Frame | null} frame */
const isWithheld = (frame) =>
  frame?.points.some(({ contact, wanted, force }) => contact && norm(wanted) > 0 && norm(force) === 0) ?? false;

/** What a person does who touches a body and feels no force after a stop; empty where there is one.
 * @param {import('../wire.js').Frame | null} frame */
export function withheldInWords(frame) {
  const isActing = state.safety.some((stage) => stage.name === RISE && isNow(stage.acted));
  return isWithheld(frame) && isActing ? `no force until the hand is out of the bodies: ${state.newest?.stopped ? 'release, then draw it out' : 'draw it out'}` : '';
}

/** What a stage does, for the foot line: a force rises where there is one, and else waits.
 * @param {string} name */
function inWords(name) {
  if (name !== RISE) return WORDS[name]?.[0] ?? `${name} acts`;
  if (isWithheld(state.newest)) return 'force waits until the hand is out of the bodies';
  return state.newest?.points.some(({ force }) => norm(force) > 0) ? WORDS[name][0] : '';
}

/** What the stages do now, for the foot line; empty if none acts. */
export function actingStages() {
  const names = state.safety.filter(({ acted }) => isNow(acted)).map(({ name }) => inWords(name)).filter(Boolean);
  return names.join(', ') || (isNow(actedAt) ? 'a stage changes the force' : '');
}

/** Draws a component anew at each look at the clock. */
export function useClock() {
  const [, redraw] = useReducer((/** @type {number} */ looks) => looks + 1, 0);
  useEffect(() => {
    const timer = setInterval(() => redraw(undefined), LOOK);
    return () => clearInterval(timer);
  }, []);
}

/** How often a stage acted, and the most that it took from the force.
 * @param {Stage} stage @param {number} rate ticks a second */
function done({ name, ticks, largest }, rate) {
  if (ticks === 0) return 'never';
  const most = largest > 0 ? `, up to ${short(largest)} ${name.includes('torque') ? 'N·m' : 'N'}` : '';
  return `${count(ticks)} ${ticks === 1 ? 'tick' : 'ticks'}, ${short(ticks / rate)} s${most}`;
}

export function Safety() {
  useTopics(['safety', 'scene'], LOOK);
  useClock();
  const rate = state.welcome?.rate ?? 1000;
  const limit = state.scene?.device?.max_force;
  const kept = state.newest?.kept ?? 0;
  return html`<div class="safety-stages" tabindex="0" role="region" aria-label="Safety">
    <p>Each force passes these stages, from the first to the last, before it reaches the hand.
      ${limit !== undefined && html` The largest force is ${short(limit)} N.`} So far ${short(1000 * kept)} mJ were kept back.</p>
    ${state.safety.length === 0 && html`<p class="quiet">No stage has changed a force since this page came.</p>`}
    <ol>${state.safety.map((stage) => {
      const { name, acted } = stage;
      const isActing = isNow(acted);
      const acts = name === RISE && isWithheld(state.newest) ? 'waits' : 'acts';
      return html`<li key=${name} class=${isActing ? 'acting' : ''}>
        <b>${name}</b> <span class="quiet">${WORDS[name]?.[1] ?? ''}</span> <span class="stage-ticks">· ${isActing ? `${acts}: ` : ''}${done(stage, rate)}</span>
      </li>`;
    })}</ol>
  </div>`;
}
