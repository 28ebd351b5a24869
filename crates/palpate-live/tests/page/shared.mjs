// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

/** What the cases of the live page share: the browser, pages, programs, and scenes. */

import { mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { browser, scratch, start, toolPath, until } from './harness.mjs';

export const [program, scenes, pictures] = process.argv.slice(2);
mkdirSync(pictures, { recursive: true });
const axe = readFileSync(toolPath('axe-core/axe.min.js'), 'utf8');

/** A scene with one ball, which is as stiff as the device renders it. */
export const BALL = JSON.stringify({
  palpate: 1,
  dimension: 3,
  bodies: [{
    name: 'ball',
    shape: { ball: { radius: 0.05 } },
    material: { stiffness: 300, damping: 0, static_friction: 0, dynamic_friction: 0 },
  }],
}, null, 2);

/** The same in the plane. */
export const DISC = BALL.replace('"dimension": 3', '"dimension": 2');

/** Runs before the page's modules: a pad, what shakes, and a count of programs and sounds. */
const mocks = () => {
  const count = (window.seen = { fx: [], links: 0, sounds: 0 });
  const buttons = Array.from({ length: 17 }, () => ({ pressed: false, touched: false, value: 0 }));
  window.pad = {
    id: 'mock (STANDARD GAMEPAD)', index: 0, connected: true, mapping: 'standard', timestamp: 0,
    axes: [0, 0, 0, 0], buttons,
    vibrationActuator: { playEffect: (...effect) => (count.fx.push(effect), Promise.resolve('complete')), reset: async () => 'complete' },
  };
  Object.defineProperty(Navigator.prototype, 'getGamepads', { value: () => [window.padOn ? window.pad : null, null, null, null] });
  Object.defineProperty(Navigator.prototype, 'vibrate', { value: (pattern) => (count.fx.push(['vibrate', pattern]), true) });
  const link = WebGL2RenderingContext.prototype.linkProgram;
  WebGL2RenderingContext.prototype.linkProgram = function (made) {
    count.links += 1;
    return link.call(this, made);
  };
  const Sound = window.AudioContext;
  window.AudioContext = class extends Sound {
    constructor(...given) {
      super(...given);
      count.sounds += 1;
      window.sound = this;
    }
  };
};

/** The browser of all cases. @type {Promise<import('playwright-core').Browser> | null} */
let everyones = null;
/** That of the case that runs, if it has one. @type {import('playwright-core').Browser | null} */
let own = null;
/** What the case that runs has opened. @type {Set<import('playwright-core').BrowserContext>} */
const contexts = new Set();

const shared = () => (everyones ??= browser());

/** Runs a case in a browser of its own, since it may leave one that others suffer from. */
export async function withOwnBrowser(work) {
  own = await browser();
  try {
    await work();
  } finally {
    await own.close();
    own = null;
  }
}

/** Runs a case, and closes what it has opened. */
export async function closing(work) {
  try {
    await work();
  } finally {
    await Promise.all([...contexts].map((context) => context.close().catch(() => {})));
    contexts.clear();
  }
}

/** Opens a page of a program; gives it with what it complained about. `before` runs in the page before its
 * modules, `prepare` with the page before it loads. */
export async function opened(url, options = {}, before = () => {}, prepare = async (_page) => {}) {
  const context = await (own ?? await shared()).newContext({ viewport: { width: 1280, height: 720 }, acceptDownloads: true, ...options });
  contexts.add(context);
  await context.addInitScript(mocks);
  await context.addInitScript(before);
  const page = await context.newPage();
  const complaints = [];
  page.on('console', (m) => ['error', 'warning'].includes(m.type()) && complaints.push(m.text()));
  page.on('pageerror', (error) => complaints.push(String(error.stack)));
  await prepare(page);
  await page.goto(url);
  await live(page);
  return { page, context, complaints };
}

/** What a module of the page holds. */
export const state = (page, path) => page.evaluate(async (path) => {
  const { state } = await import('/state.js');
  return path.split('.').reduce((at, key) => at?.[key], state);
}, path);

export const live = (page) => until('a scene and a frame', async () => (await state(page, 'connection')) === 'live'
  && (await state(page, 'scene.revision')) > 0 && (await state(page, 'frame.tick')) > 0);

/** Runs work with a program that serves a scene. */
export async function serving(words, work) {
  const folder = scratch();
  const served = await start(program, ['live', ...words], folder);
  try {
    await work(served, folder);
  } finally {
    await served.kill();
  }
}

/** Writes a scene into a folder of its own. */
export function written(text, name = 'scene.json') {
  const file = join(scratch(), name);
  writeFileSync(file, text);
  return file;
}

/** Asks the program by a second socket, which stays open: the hand is let go by a page that goes. */
export const ask = (page, message) => page.evaluate(async (message) => {
  if (!window.second) {
    const token = Object.values(sessionStorage)[0];
    window.second = new WebSocket(`ws://${location.host}/socket?token=${token}`);
    await new Promise((resolve) => (window.second.onopen = resolve));
  }
  const id = (window.asked = (window.asked ?? 0) + 1);
  const answer = new Promise((resolve) => window.second.addEventListener('message', ({ data }) => {
    if (typeof data === 'string' && JSON.parse(data).id === id) resolve(JSON.parse(data));
  }));
  window.second.send(JSON.stringify({ ...message, id }));
  return answer;
}, message);

export async function violations(page) {
  if (!(await page.evaluate(() => 'axe' in window))) await page.evaluate(axe);
  const found = await page.evaluate(() => window.axe.run({ resultTypes: ['violations'] }));
  return found.violations.map((one) => `${one.id}: ${one.nodes.map((node) => node.target).join(' ')}`);
}

/** What the page says in the place of an element, in one line. */
export const said = async (page, place) => (await page.locator(place).first().innerText()).replace(/\s+/g, ' ').trim();

/** Waits until the page says something in the place of an element. @param {RegExp} words */
export const says = (page, place, words) => until(`${words} in ${place}`, async () => words.test(await said(page, place)));

/** Between page and program: `toPage` and `toProgram` see each message, and pass it on unless they give true.
 * @param {import('playwright-core').Page} page */
export async function between(page, { toPage = (_data) => false, toProgram = (_data) => false, refuses = () => false }) {
  const seen = { page: null, program: null };
  await page.routeWebSocket(/\/socket/, (socket) => {
    if (refuses()) {
      void socket.close();
      return;
    }
    const server = socket.connectToServer();
    Object.assign(seen, { page: socket, program: server });
    socket.onMessage((data) => toProgram(data) || server.send(data));
    server.onMessage((data) => toPage(data) || socket.send(data));
  });
  return seen;
}

/** Holds the page's clock, while the program is heard. */
export async function pause(page) {
  await page.clock.pauseAt(await page.evaluate(() => Date.now() + 10000));
  await page.evaluate(async () => {
    const { listen, state } = await import('/state.js');
    const { beat } = state.newest;
    await new Promise((resolve) => listen(['newest'], () => state.newest.beat !== beat && resolve(undefined)));
  });
}
