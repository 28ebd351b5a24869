// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * Edits of the scene on their way to the program: one at a time, and while a control is dragged
 * the newest value alone. Undo and redo wait for their turn too: an edit is of the scene that
 * they leave.
 *
 * @typedef {{ at: string, to?: any }} Change
 * @typedef {{ do: 'edit', changes: Change[], moving: boolean } | { do: 'undo' | 'redo' }} Order
 */

import { Refused } from '../wire.js';
import { changed, state } from '../state.js';
import { page, reasonOf, tell } from './page.js';

/** @type {Order[]} */
const queue = [];
let isBusy = false;
/** Ends when no edit is on its way. */
let working = Promise.resolve();

/** @param {Order} order */
const places = (order) => (order.do === 'edit' ? order.changes.map(({ at }) => at).join(' ') : '');

/** Asks for changes of the scene. @param {Change[]} changes @param {boolean} [moving] */
export function edit(changes, moving = false) {
  const order = /** @type {Order} */ ({ do: 'edit', changes, moving });
  const last = queue[queue.length - 1];
  if (last?.do === 'edit' && last.moving && places(last) === places(order)) queue.pop();
  enqueue(order);
}

/** Takes the last step back, or takes it again. @param {'undo' | 'redo'} way */
export function goBack(way) {
  enqueue({ do: way });
}

/** @param {Order} order */
function enqueue(order) {
  queue.push(order);
  if (!isBusy) working = sendAll();
}

/** Waits until no edit is on its way. */
export const settled = () => working;

async function sendAll() {
  isBusy = true;
  for (let order = queue.shift(); order; order = queue.shift()) await sendOne(order);
  isBusy = false;
}

/** @param {Order} order */
async function sendOne(order) {
  const base = state.scene?.revision;
  try {
    // The scene comes before the answer.
    await page.wire?.ask(order.do === 'edit' ? { ...order, base } : order);
    setProblems([]);
  } catch (error) {
    const problems = error instanceof Refused ? error.problems : [];
    const text = reasonOf(error);
    const [first] = problems;
    if (order.do === 'edit') {
      setProblems(first ? problems : [{ at: order.changes[0].at, problem: text }]);
      if (order.moving) return;
    }
    tell(first ? `${first.path}: ${first.problem}` : text, 'bad');
  }
}

/** @param {{ at: string, problem: string }[]} problems */
function setProblems(problems) {
  if (problems.length === 0 && state.problems.size === 0) return;
  state.problems = new Map(problems.map(({ at, problem }) => [at, problem]));
  changed('problems');
}

/** What was wrong at a JSON pointer, or within it; null if nothing was. @param {string} pointer */
export function problemAt(pointer) {
  for (const [at, message] of state.problems) {
    if (at === pointer || at.startsWith(`${pointer}/`)) return message;
  }
  return null;
}

/** Forgets what was wrong at a JSON pointer, or within it: a person gave it up. @param {string} pointer */
export function forgetProblem(pointer) {
  if (problemAt(pointer) === null) return;
  for (const at of [...state.problems.keys()]) {
    if (at === pointer || at.startsWith(`${pointer}/`)) state.problems.delete(at);
  }
  changed('problems');
}

/** Takes a scene that the program sent. @param {import('../wire.js').Message} scene */
export function takeScene(scene) {
  const before = state.scene;
  // The scene that was opened last comes again when it is saved, and when the connection is back.
  const isOther = scene.by === 'open' && scene.text !== before?.text;
  if (isOther || scene.dimension !== before?.dimension) state.opened += 1;
  state.scene = scene;
  state.way = scene.way;
  changed('scene');
}
