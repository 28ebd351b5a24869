// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * What the servo did, in words, and what its safety chain does.
 *
 * @typedef {import('../wire.js').Message} Message
 */

import { unheardInWords } from '../heard.js';
import { html } from '../vendor/htm-preact.js';
import { changed, state } from '../state.js';
import { count, servoTime, short } from './numbers.js';
import { tell, useTopics } from './page.js';
import { actingStages, useClock, withheldInWords } from './safety.js';
import { isOthers } from './stopping.js';

/** Events that are kept. */
const KEPT = 200;

let number = 0;

/** Takes events that the program sent. @param {Message[]} events */
export function takeEvents(events) {
  const rate = state.welcome?.rate ?? 1000;
  for (const event of events) {
    number += 1;
    state.events.push({ ...event, time: event.tick / rate, number });
    if (event.kind === 'placed') tell(`An edit has covered the hand${bodyOf(event) && ` with ${bodyOf(event)}`}: the force rises from zero.`, 'bad');
  }
  state.events.splice(0, Math.max(0, state.events.length - KEPT));
  changed('events');
}

/** Kinds whose names say too little. @type {Record<string, string>} */
const KINDS = {
  carried: 'an edit covered the hand, which was moved out to the surface',
  placed: 'an edit covered the hand; the force rises from zero',
};

/** The name of the body of an event. @param {Message} event @returns {string} */
const bodyOf = ({ body }) => (body === undefined ? '' : String(state.scene?.bodies?.[body]?.name ?? body));

/** @param {Message} event */
function inWords(event) {
  const speed = typeof event.speed === 'number' ? `at ${short(1000 * event.speed)} mm/s` : '';
  const force = typeof event.force === 'number' ? `at ${short(event.force)} N` : '';
  const distance = typeof event.distance === 'number' ? `by ${short(1000 * event.distance)} mm` : '';
  const kind = KINDS[event.kind] ?? event.kind.replace(/_/g, ' ');
  return [kind, bodyOf(event), speed, force, distance].filter(Boolean).join(' · ');
}

export function Events() {
  useTopics(['events'], 100);
  const shown = state.events.slice(-80).reverse();
  const points = state.scene?.device?.points ?? 1;
  return html`<ol class="events" tabindex="0" aria-label="Events, newest first">
    ${shown.length === 0 && html`<li class="quiet">nothing happened yet</li>`}
    ${shown.map((event) => html`<li key=${event.number} class=${event.kind === 'placed' ? 'event-warns' : ''}>
      <span class="when">${servoTime(event.time, state.welcome?.rate)}</span>
      ${inWords(event)}${points > 1 ? ` · point ${event.point + 1}` : ''}</li>`)}
  </ol>`;
}

/** How long the scene's formula is, in words. */
export function operations() {
  const { way } = state;
  if (way?.kind === 'samples') return 'drawn from samples';
  return way?.operations === undefined ? '' : `${count(way.operations)} operations`;
}

/** The line at the foot: what the safety chain does, in words. */
export function Status() {
  useTopics(['newest', 'scene', 'safety', 'connection', 'heard', 'stop'], 100);
  useClock();
  const { scene, connection, newest } = state;
  const limit = scene?.device?.max_force;
  const safety = connection !== 'live' ? 'not connected' : unheardInWords() ? unheardInWords()
    : newest?.stopped ? `stopped${isOthers() ? ' by another page' : ''}, all forces are zero until “release” or R`
    : withheldInWords(newest) || actingStages() || 'ok';
  const isCalm = safety === 'ok';
  return html`
    <span class=${isCalm ? 'safety' : state.unheard === null ? 'safety acting' : 'safety unheard'} title="What stands between the wanted force and the hand: the tab Safety explains each stage">safety: <b>${safety}</b></span>
    ${limit !== undefined && html`<span>force limit ${short(limit)} N</span>`}
    ${newest && html`<span title="Energy that the safety chain kept from the hand, since the servo began">kept back ${short(1000 * newest.kept)} mJ</span>`}
    ${newest && newest.lost > 0 && html`<span>${newest.lost} events lost</span>`}
    <span class="gap"></span>
    ${scene && html`<span>${operations()}</span>`}
    ${scene && html`<span>revision ${scene.revision}</span>`}
    ${scene?.restarted && html`<span title=${scene.restarted}>the servo began again</span>`}`;
}
