// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * Contacts of the bodies, asked for when the scene or what is shown of them changes.
 *
 * @typedef {import('../wire.js').Wire} Wire
 */

import { state } from '../state.js';
import { asking } from './newest.js';

let asked = '';
/** @type {ReturnType<typeof asking> | null} */
let questions = null;

/** @param {Wire} wire @param {(answer: any) => void} take */
export async function askContacts(wire, take) {
  const { contacts, proof } = state.view.shown;
  const isWanted = (contacts || proof) && (state.scene?.bodies?.length ?? 0) > 1;
  const key = isWanted ? `${state.opened} ${state.scene?.revision} ${proof}` : '';
  if (key === asked || state.connection !== 'live') return;
  asked = key;
  questions ??= asking(wire);
  questions.giveUp();
  try {
    const question = { question: 'contacts', proof };
    const told = isWanted ? await questions.ask({ do: 'ask', question }) : null;
    // A newer question was asked meanwhile.
    if (key === asked) take(told?.answer ?? null);
  } catch {
    if (key === asked) asked = '';
  }
}
