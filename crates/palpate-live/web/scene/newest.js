// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/** Questions of which only the newest counts. */

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
