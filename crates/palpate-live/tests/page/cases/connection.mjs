// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

/** The connection and the graphics card come and go. */

import { join } from 'node:path';
import { check, scratch, start, until } from '../harness.mjs';
import { BALL, opened, state, serving, written, ask, violations, pictures, program, withOwnBrowser } from '../shared.mjs';

/** Whether the second canvas, which holds what the program drew, has more than one colour. */
const isDrawn = (page) => page.evaluate(() => {
  const canvas = document.querySelectorAll('#stage canvas')[1];
  const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
  return new Set(new Uint32Array(data.buffer)).size > 50;
});

/** A scene of so many small balls: its formula is too long for a browser. */
const crowd = (count) => JSON.stringify({
  palpate: 1,
  dimension: 3,
  bodies: Array.from({ length: count }, (_, i) => ({
    name: `b${i}`,
    shape: { ball: { radius: 0.004 } },
    pose: { translation: [0.02 * (i % 12), 0.02 * (Math.floor(i / 12) % 12), 0.02 * Math.floor(i / 144)] },
  })),
});

export default [
  ['the gallery loads without a complaint, in both themes and sizes, and can be used by all', () => serving([], async ({ url }) => {
    for (const [width, height] of [[1280, 720], [820, 1180]]) {
      for (const colorScheme of ['light', 'dark']) {
        const { page, context, complaints } = await opened(url, { viewport: { width, height }, colorScheme });
        check(!page.url().includes('#'), 'the token stays in the address');
        await page.waitForTimeout(3000);
        await until('a whole picture', () => page.evaluate(async () => (await import('/panels/page.js')).page.stage.stats().isStill));
        const wrong = await violations(page);
        check(wrong.length === 0, `axe: ${wrong.join('; ')}`);
        await page.screenshot({ path: join(pictures, `gallery-${width}-${colorScheme}.png`) });
        check(complaints.length === 0, complaints.join('\n'));
        await context.close();
      }
    }
  })],

  ['the page comes back when the program was killed and started again', async () => {
    const folder = scratch();
    const file = written(BALL);
    const first = await start(program, ['live', file], folder);
    const { page, context } = await opened(first.url);
    await first.kill();
    await until('words that the program ended', async () => (await state(page, 'connection')) === 'lost');
    await page.waitForTimeout(200);
    await page.screenshot({ path: join(pictures, 'lost.png') });
    const second = await start(program, ['live', file], folder);
    check(second.url === first.url, `another address: ${second.url}, before ${first.url}`);
    await until('the page', async () => (await state(page, 'connection')) === 'live');
    await context.close();
    check((await second.kill('SIGINT')) === 0, 'Ctrl-C is a good end');
  }],

  ['a lost context is restored, and without WebGL the program draws', () => withOwnBrowser(() => serving([written(BALL)], async ({ url }) => {
    const { page, context } = await opened(url);
    await until('the picture', () => page.evaluate(() => window.seen.links > 0));
    const links = await page.evaluate(() => window.seen.links);
    await page.evaluate(() => {
      const gl = document.querySelector('#stage canvas').getContext('webgl2');
      const card = gl.getExtension('WEBGL_lose_context');
      card.loseContext();
      setTimeout(() => card.restoreContext(), 100);
    });
    await until('another program', () => page.evaluate((links) => window.seen.links > links, links));
    await context.close();
    const without = await opened(url, {}, () => {
      const get = HTMLCanvasElement.prototype.getContext;
      HTMLCanvasElement.prototype.getContext = function (kind, ...more) {
        return kind.startsWith('webgl') ? null : get.call(this, kind, ...more);
      };
    });
    await until('a picture of the program', () => isDrawn(without.page));
    await without.page.screenshot({ path: join(pictures, 'drawn.png') });
    // Bodies once could not be pressed where no card draws them.
    const stage = await without.page.locator('#stage').boundingBox();
    const [x, y] = [stage.x + stage.width / 2, stage.y + stage.height / 2];
    await without.page.mouse.move(x, y);
    await without.page.mouse.down();
    await without.page.mouse.move(x + 3, y + 3, { steps: 3 });
    await until('a contact', async () => (await state(without.page, 'frame.force')) > 0.05);
    await without.page.mouse.up();
    await without.context.close();
  }))],

  ['the program draws the scene while its samples are awaited', () => serving([written(crowd(800))], async ({ url }) => {
    const { page, context } = await opened(url, {}, () => {}, (page) => page.routeWebSocket(/socket/, (socket) => {
      const server = socket.connectToServer();
      // The samples are never asked for.
      socket.onMessage((message) => {
        if (typeof message === 'string' && JSON.parse(message).do === 'samples') return;
        server.send(message);
      });
    }));
    await until('words that say so', () => page.getByText('drawn by the program, waiting for samples').isVisible());
    await until('a picture of the program', () => isDrawn(page));
    await page.screenshot({ path: join(pictures, 'awaited.png') });
    await context.close();
  })],

  ['two tabs see the same scene, and a hidden one gets one frame a second', () => serving([written(BALL)], async ({ url }) => {
    const [one, two] = [await opened(url), await opened(url)];
    const revision = await state(one.page, 'scene.revision');
    await ask(one.page, { do: 'edit', base: revision, changes: [{ at: '/bodies/0/name', to: 'bead' }] });
    for (const { page } of [one, two]) {
      await until('the name', async () => (await state(page, 'scene.scene.bodies.0.name')) === 'bead');
    }
    const stale = await ask(two.page, { do: 'edit', base: revision, changes: [{ at: '/bodies/0/name', to: 'x' }] });
    check(stale.do === 'refused' && stale.message.includes('edited elsewhere'), JSON.stringify(stale));
    const frames = async (page) => {
      const before = await page.evaluate(async () => (await import('/state.js')).state.history.length);
      await page.waitForTimeout(1500);
      return (await page.evaluate(async () => (await import('/state.js')).state.history.length)) - before;
    };
    await two.page.evaluate(() => {
      Object.defineProperty(document, 'hidden', { value: true });
      Object.defineProperty(document, 'visibilityState', { value: 'hidden' });
      document.dispatchEvent(new Event('visibilitychange'));
    });
    await two.page.waitForTimeout(300);
    const hidden = await frames(two.page);
    check(hidden <= 3, `a hidden page got ${hidden} frames in 1.5 s`);
    await one.context.close();
    await two.context.close();
  })],
];
