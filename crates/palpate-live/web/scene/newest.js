// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * Questions of which only the newest counts.
 *
 * @typedef {import('../wire.js').Wire} Wire
 * @typedef {import('../wire.js').Message} Message
 */

/** How long the newest waits for what is worked on before it [ms]. */
const PATIENCE = 1000;

/** Makes work that is done one at a time: what is asked for meanwhile waits, and only the newest
 * of it is done. Work that fails is left: whoever asked it asks again when something changes.
 * @template T @param {(input: T) => Promise<void>} work
 * @param {() => void} [giveUp] ends work for which something newer has waited too long
 * @returns {(input: T) => void} */
export function newest(work, giveUp = () => {}) {
  let isBusy = false;
  let begun = 0;
  let timer = 0;
  /** @type {{ input: T } | null} */
  let waiting = null;
  return async function run(input) {
    if (isBusy) {
      if (!waiting) timer = window.setTimeout(giveUp, begun + PATIENCE - performance.now());
      waiting = { input };
      return;
    }
    isBusy = true;
    begun = performance.now();
    try {
      await work(input);
    } catch {
      // See above.
    }
    clearTimeout(timer);
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
      const id = wire.newId();
      current = id;
      try {
        return await wire.ask(message, id);
      } finally {
        if (current === id) current = null;
      }
    },
    giveUp() {
      if (current !== null) wire.cancel(current);
    },
  };
}
