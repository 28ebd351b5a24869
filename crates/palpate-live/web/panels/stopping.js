// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * STOP on its way to the program, and its release: what was sent, what the program confirmed, and
 * when this page may release. The rules are those of docs/live-protocol.md; the program keeps them
 * too.
 */

import { changed, listen, state } from '../state.js';
import { dismiss, page, tell, tellError } from './page.js';

/** From this page's last press to a release by this page, at least [ms]: a double click, or a key
 * that is held, never releases. */
const AFTER_OWN = 1000;
/** From a stop whose number the page does not know to a release [ms]: that of another page's. */
const AFTER_OTHERS = 2000;
/** Between two orders while a key is held [ms]; each takes a connection for a moment. */
const REPEAT = 250;
/** An order that is confirmed sooner is not told as sent [ms]. */
const SOON = 300;
/** Frames made before a release may still come for so long [ms]. */
const LAG = 500;

/** The last STOP of this page, until the program confirms it. @type {{ press: string, isPostLost: boolean } | null} */
let pending = null;
/** Orders on the socket without an answer. */
let inFlight = 0;
let pressedAt = -Infinity;
/** The last STOP as the program tells of it. `from` is when this page may release it, on the clock of
 * `performance.now()`. @type {{ number: number, isMine: boolean, from: number } | null} */
let told = null;
let releasedAt = -Infinity;
/** Since when frames say that forces are zero. */
let seenAt = Infinity;
/** The number of the STOP that the page shows. @type {number | undefined} */
let shown;
let isShown = false;

/** Sixteen hexadecimal digits by which the program knows a press that comes on two ways. */
function newPress() {
  return [...crypto.getRandomValues(new Uint8Array(8))].map((byte) => byte.toString(16).padStart(2, '0')).join('');
}

/** @param {string} press */
function confirmed(press) {
  if (pending?.press !== press) return;
  pending = null;
  changed('stop');
}

/** @param {string} press */
async function sendBySocket(press) {
  inFlight += 1;
  try {
    // `do` comes first, and the text is short: so the program reads it before all else.
    await page.wire?.ask({ do: 'stop', press });
    confirmed(press);
  } catch {
    changed('stop');
  } finally {
    inFlight -= 1;
  }
}

/** @param {string} press */
async function sendByPost(press) {
  const address = `stop?token=${encodeURIComponent(page.token)}&press=${press}`;
  const isTaken = await fetch(address, { method: 'POST', keepalive: true }).then(({ ok }) => ok, () => false);
  if (isTaken) confirmed(press);
  else if (pending?.press === press) pending.isPostLost = true;
  changed('stop');
}

/** Stops all forces, on both ways at once. @param {Event} [event] */
export function stop(event) {
  dismiss(notice);
  const now = performance.now();
  const isRepeated = event instanceof KeyboardEvent && event.repeat;
  if (isRepeated && now - pressedAt < REPEAT) return;
  pressedAt = now;
  const press = newPress();
  pending = { press, isPostLost: false };
  void sendBySocket(press);
  void sendByPost(press);
  changed('stop');
  setTimeout(() => changed('stop'), SOON);
}

/** Sends a STOP once more that no program confirmed, on a new connection. */
export function sendAgain() {
  if (!pending) return;
  void sendBySocket(pending.press);
  if (pending.isPostLost) void sendByPost(pending.press);
  pending.isPostLost = false;
}

/** @param {import('../wire.js').Message} message */
export function takeStopped({ number, is_mine: isMine, release_after: seconds }) {
  told = { number, isMine, from: performance.now() + 1000 * seconds };
  releasedAt = -Infinity;
  if (isMine && inFlight <= 1 && pending) confirmed(pending.press);
  changed('stop');
}

/** @param {import('../wire.js').Message} message */
export function takeReleased({ number }) {
  if (told && told.number !== number) return;
  told = null;
  releasedAt = performance.now();
  changed('stop');
}

/** What the program says of the last STOP is of one connection. */
export function forgetStopped() {
  told = null;
  changed('stop');
}

/** Whether forces are zero by a stop, as far as the page knows. */
export function isStopped() {
  const isOver = !told && performance.now() - releasedAt < LAG;
  return state.connection === 'live' && (state.newest?.stopped ?? false) && !isOver;
}

/** The last STOP, as the program tells of it. */
export const lastStop = () => told;

/** Whether another page pressed STOP last, or this page before its connection was lost. */
export const isOthers = () => told !== null && !told.isMine;

/** The time until this page may release [ms]; 0 once it may. */
export function untilRelease() {
  const from = told ? told.from : seenAt + AFTER_OTHERS;
  return Math.max(0, Math.max(from, pressedAt + AFTER_OWN) - performance.now());
}

/** Takes note of the STOP that a person sees: no other is released. */
export function noteShown() {
  isShown = isStopped();
  shown = told?.number;
}

/** Whether a press of this moment releases. */
export function canRelease() {
  return isStopped() && isShown && shown === told?.number && untilRelease() === 0
    && state.unheard === null && pending === null;
}

/** How forces come back after a release and after the servo starts. */
export const FORCES_COME_BACK = 'Draw the hand out of the bodies: forces then rise from zero.';

/** The number of the notice of a release, which goes once it is no longer true. */
let notice = 0;

/** Gives forces again, by a person's press alone. @param {Event} event */
export async function release(event) {
  const isRepeated = event instanceof KeyboardEvent && event.repeat;
  if (!event.isTrusted || isRepeated || !canRelease()) return;
  try {
    await page.wire?.ask({ do: 'release', number: told?.number });
    const isInside = state.newest?.points.some(({ contact }) => contact) ?? false;
    const goesOn = state.newest?.touring ? ' The tour goes on.' : '';
    notice = tell(isInside ? `${FORCES_COME_BACK}${goesOn}` : `Forces are on again.${goesOn}`);
  } catch (error) {
    tellError(error);
  }
}

/** What became of STOP, in few words for the button and in a sentence.
 * @returns {{ short: string, long: string }} */
export function stopInWords() {
  if (pending && pending.isPostLost && !page.wire?.isOpen()) {
    return { short: 'not sent: the program is not connected', long: 'STOP was not sent: the program is not connected.' };
  }
  if (pending) {
    const isSlow = performance.now() - pressedAt >= SOON;
    return { short: 'sent, not confirmed', long: isSlow ? 'STOP was sent. The program has not confirmed it.' : '' };
  }
  if (!isStopped()) return { short: '', long: '' };
  if (state.unheard !== null) {
    return { short: 'stopped when last heard', long: 'The program is not heard. It was stopped when it was heard last.' };
  }
  return isOthers() ? { short: 'stopped by another page', long: 'Stopped by another page: all forces are zero.' }
    : { short: 'forces are zero', long: 'Stopped: all forces are zero.' };
}

/** Starts to follow what frames say of a stop. */
export function startStopping() {
  listen(['newest'], () => {
    const is = state.newest?.stopped ?? false;
    if (is === Number.isFinite(seenAt)) return;
    seenAt = is ? performance.now() : Infinity;
    changed('stop');
  });
}
