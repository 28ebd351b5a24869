// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * Questions of which only the newest counts.
 *
 * @typedef {import('../wire.js').Wire} Wire
 * @typedef {import('../wire.js').Message} Message
 */

/** Makes work that is done one at a time: what is asked for meanwhile waits, and only the newest
 * of it is done. Work that fails is left: whoever asked it asks again when something changes.
 * @template T @param {(input: T) => Promise<void>} work @returns {(input: T) => void} */
export function newest(work) {
  let isBusy = false;
  /** @type {{ input: T } | null} */
  let waiting = null;
  return async function run(input) {
    if (isBusy) {
      waiting = { input };
      return;
    }
    isBusy = true;
    try {
      await work(input);
    } catch {
      // See above.
    }
    isBusy = false;
    const next = waiting;
    waiting = null;
    if (next) run(next.input);
  };
}

/** Questions one at a time, of which the one that is asked can be given up: the program then works
 * on it no longer, and refuses it. @param {Wire} wire */
export function asking(wire) {
  /** @type {number | null} */
  let current = null;
  return {
    /** @param {Message} message @returns {Promise<any>} */
    async ask(message) {
      const id = wire.nextId;
      current = id;
      try {
        return await wire.ask(message);
      } finally {
        if (current === id) current = null;
      }
    },
    giveUp() {
      if (current !== null) wire.cancel(current);
    },
  };
}
