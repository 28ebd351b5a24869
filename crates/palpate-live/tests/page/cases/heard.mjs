// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

/** Whether the program is heard. */

import { check, until } from '../harness.mjs';
import { BALL, between, opened, pause, said, says, serving, state, written } from '../shared.mjs';

/** Waits until nothing comes from a program any more. */
async function quiet(page) {
  let last = -1;
  await until('no more frames', async () => {
    const now = await page.evaluate(async () => {
      const { state } = await import('/state.js');
      return state.newest.beat + state.newest.tick;
    });
    const isQuiet = now === last;
    last = now;
    return isQuiet;
  });
}

export default [
  ['a program that is frozen is not heard, STOP is not confirmed, and both are when it goes on', () => serving([written(BALL)], async ({ url, child }) => {
    const { page } = await opened(url, {}, undefined, (page) => page.clock.install());
    await pause(page);
    child.kill('SIGSTOP');
    await quiet(page);
    await page.clock.runFor(400);
    check((await said(page, '.connection')) === 'live', `after 0.4 s: ${await said(page, '.connection')}`);
    await page.clock.runFor(500);
    for (const place of ['.connection', 'footer']) {
      check(/not heard for 0\.\d s/.test(await said(page, place)), `after 0.9 s: ${await said(page, place)}`);
    }
    check(!/\bok\b|live/.test(await said(page, 'body')), 'live or ok somewhere else');
    const color = (place) => page.locator(place).first().evaluate((element) => getComputedStyle(element).color);
    check((await color('.readout .large')) === (await color('.unit')), 'the force is not grey');
    check(/^force, last heard/.test(await said(page, '.readout')), await said(page, '.readout'));
    await page.clock.runFor(1000);
    check(/not heard for 1\.\d s/.test(await said(page, '.connection')), await said(page, '.connection'));
    await page.locator('#stop').click();
    await page.clock.runFor(500);
    check((await said(page, '#stop')) === 'STOP sent, not confirmed', await said(page, '#stop'));
    check((await said(page, '#stop-place [role=alert]')) === 'STOP was sent. The program has not confirmed it.', 'not announced');
    child.kill('SIGCONT');
    await page.clock.resume();
    await says(page, '.connection', /^live$/);
    await says(page, '#stop', /^STOP forces are zero$/);
  })],

  ['a frame that is repeated is no sign of life', () => serving([written(BALL)], async ({ url }) => {
    let isRepeating = false;
    let last = null;
    let wires = null;
    const { page } = await opened(url, {}, undefined, async (page) => {
      wires = await between(page, { toPage: (data) => {
        if (typeof data === 'string' || data[0] !== 1) return isRepeating;
        if (!isRepeating) last = data;
        return isRepeating;
      } });
    });
    isRepeating = true;
    const timer = setInterval(() => wires.page.send(last), 50);
    await says(page, '.connection', /^not heard for/);
    clearInterval(timer);
    isRepeating = false;
    await says(page, '.connection', /^live$/);
  })],

  ['a program whose clock is held is heard', () => serving([written(BALL)], async ({ url }) => {
    const { page } = await opened(url);
    await page.keyboard.press('p');
    await until('a clock that is held', () => state(page, 'frame.held'));
    const seen = await page.evaluate(async () => {
      const { listen, state } = await import('/state.js');
      const beats = new Set();
      let silence = 0;
      listen(['heard'], () => (silence = Math.max(silence, state.unheard ?? 0)));
      await new Promise((resolve) => listen(['newest'], () => beats.add(state.newest.beat).size > 8 && resolve(undefined)));
      return silence;
    });
    check(seen === 0, `not heard for ${seen} ms`);
  })],

  ['a page that is hidden waits longer, and counts anew when it is seen', () => serving([written(BALL)], async ({ url, child }) => {
    const { page } = await opened(url, {}, undefined, (page) => page.clock.install());
    const hide = (is) => page.evaluate((is) => {
      Object.defineProperty(document, 'hidden', { value: is, configurable: true });
      document.dispatchEvent(new Event('visibilitychange'));
    }, is);
    await pause(page);
    await hide(true);
    child.kill('SIGSTOP');
    await quiet(page);
    await page.clock.runFor(2000);
    check((await state(page, 'unheard')) === null, 'not heard after 2 s while hidden');
    await page.clock.runFor(1000);
    check((await state(page, 'unheard')) > 2500, 'heard after 3 s while hidden');
    await hide(false);
    check((await state(page, 'unheard')) === null, 'the start does not count anew');
    await page.clock.runFor(700);
    check((await state(page, 'unheard')) > 500, 'heard after 0.7 s');
    child.kill('SIGCONT');
  })],
];
