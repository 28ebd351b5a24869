// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * What all panels use: the wire, the stage, messages to a person, and drawing anew when
 * something changes.
 *
 * @typedef {import('../wire.js').Wire} Wire
 * @typedef {import('../wire.js').Message} Message
 * @typedef {import('../state.js').Topic} Topic
 * @typedef {ReturnType<typeof import('../scene/stage.js').createStage>} Stage
 * @typedef {{ name: string, run: () => void }} Action
 * @typedef {{ id: number, kind: 'word' | 'bad', text: string, actions: Action[] }} Toast
 */

import { useLayoutEffect, useReducer } from '../vendor/htm-preact.js';
import { listen, state } from '../state.js';

/** How long a message stays [ms]. */
const TOAST_TIME = 6000;

/** @type {{ wire: Wire | null, stage: Stage | null, token: string, shownLink: string }} */
export const page = { wire: null, stage: null, token: '', shownLink: '' };

/** @type {Toast[]} */
export let toasts = [];
/** @type {Set<() => void>} */
const toastListeners = new Set();
let nextToast = 1;

/** @param {Toast[]} next */
function setToasts(next) {
  toasts = next;
  toastListeners.forEach((listener) => listener());
}

/** Calls `listener` when messages change. @param {() => void} listener */
export function listenToasts(listener) {
  toastListeners.add(listener);
  return () => void toastListeners.delete(listener);
}

/** @param {number} id */
export function dismiss(id) {
  if (toasts.some((toast) => toast.id === id)) setToasts(toasts.filter((toast) => toast.id !== id));
}

/** Tells a person something; the same text is not told twice at once. Gives the message's number.
 * @param {string} text @param {'word' | 'bad'} [kind]
 * @param {Action[]} [actions] with an action the message stays */
export function tell(text, kind = 'word', actions = []) {
  const told = toasts.find((toast) => toast.text === text);
  if (told) return told.id;
  const id = nextToast;
  nextToast += 1;
  setToasts([...toasts.slice(-3), { id, kind, text, actions }]);
  if (actions.length === 0) setTimeout(() => dismiss(id), kind === 'bad' ? 2 * TOAST_TIME : TOAST_TIME);
  return id;
}

/** Why something failed, in words. @param {unknown} error */
export const reasonOf = (error) => (error instanceof Error ? error.message : String(error));

/** Tells why something failed. @param {unknown} error */
export function tellError(error) {
  tell(reasonOf(error), 'bad');
}

/** Asks the program; tells a refusal, and then gives null.
 * @param {Message} message @returns {Promise<Message | null>} */
export async function ask(message) {
  if (!page.wire) return null;
  try {
    return await page.wire.ask(message);
  } catch (error) {
    tellError(error);
    return null;
  }
}

/** Draws a component anew after changes of the topics, at most every `interval` [ms].
 * @param {Topic[]} topics @param {number} [interval] */
export function useTopics(topics, interval = 0) {
  const [, redraw] = useReducer((/** @type {number} */ count) => count + 1, 0);
  // A layout effect listens at once: what changes before the next picture is seen too.
  useLayoutEffect(() => {
    let timer = 0;
    const stop = listen(topics, () => {
      if (interval === 0) {
        redraw(undefined);
      } else if (timer === 0) {
        timer = setTimeout(() => {
          timer = 0;
          redraw(undefined);
        }, interval);
      }
    });
    return () => {
      stop();
      clearTimeout(timer);
    };
  }, []);
}

/** A name for a file of this scene. @param {string} ending */
export function fileName(ending) {
  const name = (state.scene?.name ?? 'scene').replace(/^.*[\\/]/, '');
  return `${name.replace(/\.json$/, '').replace(/[^\w.-]+/g, '_')}${ending}`;
}

/** Gives a file to the person. @param {Blob} blob @param {string} name */
export function download(blob, name) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}
