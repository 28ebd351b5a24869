// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * Edits of the scene on their way to the program: one at a time, and while a control is dragged
 * the newest value alone.
 *
 * @typedef {{ at: string, to?: any }} Change
 */

import { Refused } from '../wire.js';
import { changed, listen, state } from '../state.js';
import { page, tell } from './page.js';

/** How long a scene may take to follow the answer to its edit [ms]. */
const SCENE_WAIT = 1000;

/** @type {{ changes: Change[], moving: boolean }[]} */
let queue = [];
let isBusy = false;

/** @param {Change[]} changes */
const places = (changes) => changes.map(({ at }) => at).join(' ');

/** Asks for changes of the scene. @param {Change[]} changes @param {boolean} [moving] */
export function edit(changes, moving = false) {
  const last = queue[queue.length - 1];
  if (last?.moving && places(last.changes) === places(changes)) queue.pop();
  queue.push({ changes, moving });
  if (!isBusy) void sendAll();
}

async function sendAll() {
  isBusy = true;
  while (queue.length > 0) {
    const next = /** @type {{ changes: Change[], moving: boolean }} */ (queue.shift());
    await sendOne(next.changes, next.moving);
  }
  isBusy = false;
}

/** @param {Change[]} changes @param {boolean} moving */
async function sendOne(changes, moving) {
  const base = state.scene?.revision;
  try {
    const answer = await page.wire?.ask({ do: 'edit', base, changes, moving });
    if (answer?.do === 'scene') takeScene(answer);
    else if (state.scene?.revision === base) await sceneOrTimeout();
    setProblems([]);
  } catch (error) {
    const problems = error instanceof Refused ? error.problems : [];
    const text = error instanceof Error ? error.message : String(error);
    setProblems(problems.length > 0 ? problems : [{ at: changes[0].at, message: text }]);
    const [first] = problems;
    if (!moving) tell(first ? `${first.path}: ${first.message}` : text, 'bad');
  }
}

function sceneOrTimeout() {
  return new Promise((resolve) => {
    const end = () => {
      stop();
      clearTimeout(timer);
      resolve(undefined);
    };
    const timer = setTimeout(end, SCENE_WAIT);
    const stop = listen(['scene'], end);
  });
}

/** @param {{ at: string, message: string }[]} problems */
function setProblems(problems) {
  if (problems.length === 0 && state.problems.size === 0) return;
  state.problems = new Map(problems.map(({ at, message }) => [at, message]));
  changed('problems');
}

/** What was wrong at a JSON pointer, or within it; null if nothing was. @param {string} pointer */
export function problemAt(pointer) {
  for (const [at, message] of state.problems) {
    if (at === pointer || at.startsWith(`${pointer}/`)) return message;
  }
  return null;
}

/** Takes a scene that the program sent. @param {import('../wire.js').Message} scene */
export function takeScene(scene) {
  state.scene = scene;
  state.way = scene.way;
  changed('scene');
  changed('way');
}
