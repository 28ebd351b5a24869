// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

/** STOP and its release. */

import { check, scratch, start, until } from '../harness.mjs';
import { BALL, ask, between, live, opened, program, said, says, serving, state, written } from '../shared.mjs';

/** The last STOP as the page knows it. */
const told = (page) => until('a STOP with a number', () => page.evaluate(async () => (await import('/panels/stopping.js')).lastStop()));

export default [
  ['a stop acts within two ticks, from Esc anywhere', () => serving([written(BALL)], async ({ url }) => {
    const { page, context } = await opened(url);
    await ask(page, { do: 'tour', on: false });
    await page.evaluate(async () => { (await import('/state.js')).changed('view'); });
    await ask(page, { do: 'hand', target: [0, 0.045, 0], held: true });
    await until('a force', async () => (await state(page, 'frame.force')) > 0.5);
    await ask(page, { do: 'clock', speed: 0 });
    await until('a clock that is held', () => state(page, 'frame.held'));
    await page.waitForTimeout(100);
    const tick = await state(page, 'frame.tick');
    await page.locator('.scene-name').focus();
    await page.keyboard.press('Escape');
    const frame = await until('a stop', async () => {
      const frame = await state(page, 'frame');
      return frame.stopped && frame;
    });
    check(frame.tick <= tick + 2, `stopped at tick ${frame.tick}, asked for at ${tick}`);
    check(frame.points.every(({ force }) => Math.hypot(...force) === 0), 'a force is left');
    await page.locator('#release:enabled').click();
    await ask(page, { do: 'clock', speed: 1 });
    await until('a release', async () => !(await state(page, 'frame.stopped')));
    check((await state(page, 'frame.force')) < 0.1, 'a force throws the hand out of the ball');
    for (const height of [0.08, 0.045]) {
      await ask(page, { do: 'hand', target: [0, height, 0], held: true });
      await until('a hand that is there', async () => Math.abs((await state(page, 'frame.points.0.device'))[1] - height) < 5e-3);
    }
    await until('forces again, once the hand was out', async () => (await state(page, 'frame.force')) > 0.5);
    await context.close();
  })],

  ['STOP always stops and never releases; release is another button, after a second, for a person alone', () => serving([written(BALL)], async ({ url }) => {
    const sent = [];
    const posts = [];
    const { page } = await opened(url, {}, undefined, async (page) => {
      await between(page, { toProgram: (data) => void (typeof data === 'string' && sent.push(data)) });
      page.on('request', (request) => request.method() === 'POST' && posts.push(request.url()));
    });
    const stops = () => sent.filter((text) => text.startsWith('{"do":"stop"'));
    await page.evaluate(() => {
      const marks = (window.marks = { pressed: 0, enabled: 0, texts: [] });
      addEventListener('pointerdown', ({ target }) => {
        if (target.closest('#stop')) Object.assign(marks, { pressed: performance.now(), enabled: 0 });
      }, true);
      new MutationObserver(() => {
        const release = document.getElementById('release');
        if (release) marks.texts.push(release.innerText.trim());
        if (release && !release.disabled) marks.enabled ||= performance.now();
      }).observe(document.getElementById('release-place'), { subtree: true, childList: true, attributes: true, characterData: true });
    });
    // A press stops before it ends.
    await page.locator('#stop').hover();
    await page.mouse.down();
    await until('a stop', () => state(page, 'frame.stopped'));
    await page.mouse.up();
    await says(page, '#stop', /^STOP forces are zero$/);
    check(stops().length === 1 && stops()[0].length < 256, `sent ${stops()}`);
    const { press } = JSON.parse(stops()[0]);
    check(/^[0-9a-f]{16}$/.test(press), `a press ${press}`);
    check(posts.length === 1 && posts[0].endsWith(`&press=${press}`), `posted ${posts}`);
    const first = await told(page);
    check(first.isMine && (await said(page, '.stopped')).startsWith('Stopped. All forces are zero.'), 'not stopped by this page');
    await page.locator('#stop').focus();
    await page.keyboard.press('Enter');
    await page.keyboard.press('Space');
    await until('two more', () => stops().length === 3);
    // A double click presses twice more; the second from the last one counts.
    await page.locator('#stop').dblclick();
    await until('two more', () => stops().length === 5);
    await until('a later number', async () => (await told(page)).number > first.number);
    await page.locator('#release:enabled').waitFor();
    const marks = await page.evaluate(() => window.marks);
    check(marks.enabled - marks.pressed >= 1000, `a release ${marks.enabled - marks.pressed} ms after the last press`);
    check(marks.texts.some((text) => /^release in [01]\.\d s/.test(text)), `no countdown: ${marks.texts}`);
    await page.evaluate(() => {
      document.getElementById('release').click();
      document.dispatchEvent(new KeyboardEvent('keydown', { key: 'r', bubbles: true }));
    });
    check(!sent.some((text) => text.includes('"release"')), 'a script released');
    check(await state(page, 'frame.stopped'), 'not stopped any more');
    const { number } = await told(page);
    await page.locator('#release').click();
    await until('forces again', async () => !(await state(page, 'frame.stopped')));
    const [release] = sent.filter((text) => text.includes('"release"')).map((text) => JSON.parse(text));
    check(release.number === number, `released ${release.number}`);
    await page.locator('#release').waitFor({ state: 'detached' });
    await says(page, '#stop', /^STOP$/);
  })],

  ['another page releases two seconds after the last STOP, and after a reload a page is another one', () => serving([written(BALL)], async ({ url }) => {
    const [one, two] = [(await opened(url)).page, (await opened(url)).page];
    // A press stops before its click ends.
    const begun = Date.now();
    await one.locator('#stop').click();
    await says(two, '.stopped', /^Stopped by another page\. All forces are zero\. release in/);
    await says(two, '#stop', /^STOP stopped by another page$/);
    await two.locator('#release:enabled').waitFor();
    check(Date.now() - begun >= 2000, `another page may release after ${Date.now() - begun} ms`);
    await two.locator('#release').click();
    await until('forces again', async () => !(await state(one, 'frame.stopped')));
    for (const page of [one, two]) await page.locator('#release').waitFor({ state: 'detached' });
    // The page that pressed goes: nobody's STOP is left to another page.
    await one.keyboard.press('Escape');
    await says(one, '.stopped', /^Stopped\. /);
    const { number } = await told(one);
    await one.reload();
    await live(one);
    await says(one, '.stopped', /^Stopped by another page\. /);
    check((await told(one)).number >= number, 'an earlier STOP after a reload');
    await one.locator('#release:enabled').click();
    await until('forces again', async () => !(await state(two, 'frame.stopped')));
  })],

  ['a STOP over HTTP alone is that of no page, and works while the socket does not', () => serving([written(BALL)], async ({ url }) => {
    let isCut = false;
    let wires = null;
    const { page: cut } = await opened(url, {}, undefined, async (page) => {
      wires = await between(page, { refuses: () => isCut });
    });
    const { page: other } = await opened(url);
    isCut = true;
    await wires.page.close();
    await until('no connection', async () => (await state(cut, 'connection')) !== 'live');
    await cut.locator('#stop').click();
    await until('a stop', () => state(other, 'frame.stopped'));
    await says(other, '.stopped', /^Stopped by another page\. /);
    await until('a confirmation by HTTP', async () => !/sent/.test(await said(cut, '#stop')));
    isCut = false;
    await says(cut, '.stopped', /^Stopped by another page\. /);
  })],

  ['STOP says that it was not sent, and is sent when the program is back', async () => {
    const folder = scratch();
    const file = written(BALL);
    const first = await start(program, ['live', file], folder);
    const { page } = await opened(first.url);
    await first.kill();
    await until('no connection', async () => (await state(page, 'connection')) === 'lost');
    await page.locator('#stop').click();
    await says(page, '#stop', /^STOP not sent: the program is not connected$/);
    await says(page, '#stop-place [role=alert]', /^STOP was not sent: the program is not connected\.$/);
    const second = await start(program, ['live', file], folder);
    await until('a stop', () => state(page, 'frame.stopped'));
    await says(page, '#stop', /^STOP forces are zero$/);
    await second.kill();
  }],

  ['after a release and while a hand is in a body, the page says that the force waits, and then that it rises', () => serving([written(BALL)], async ({ url }) => {
    const { page } = await opened(url);
    await ask(page, { do: 'tour', on: false });
    await ask(page, { do: 'hand', target: [0, 0.045, 0], held: true });
    await until('a force', async () => (await state(page, 'frame.force')) > 0.5);
    await page.keyboard.press('Escape');
    await says(page, 'footer', /safety: stopped, all forces are zero until “release” or R/);
    await page.locator('#release:enabled').click();
    await says(page, 'footer', /safety: no force until the hand is out of the bodies/);
    await says(page, '.touched', /ball: no force until the hand is out of the bodies/);
    check(!/rises/.test(await said(page, 'footer')), await said(page, 'footer'));
    await page.getByRole('button', { name: 'Safety', exact: true }).click();
    await says(page, '.safety-stages li.acting', /waits: /);
    await ask(page, { do: 'hand', target: [0, 0.08, 0], held: true });
    await until('a hand that is out', async () => !(await state(page, 'frame.points.0.contact')));
    await ask(page, { do: 'hand', target: [0, 0.045, 0], held: true });
    await until('forces again', async () => (await state(page, 'frame.force')) > 0.1);
    check(!/waits|no force/.test(await said(page, 'footer')), await said(page, 'footer'));
  })],

  ['what edits do to a touch is told in words', () => serving([written(BALL)], async ({ url }) => {
    let wires = null;
    const { page } = await opened(url, {}, undefined, async (page) => (wires = await between(page, {})));
    const tell = (event) => wires.page.send(JSON.stringify({ do: 'events', events: [{ tick: 1, point: 0, body: 0, ...event }] }));
    tell({ kind: 'carried', distance: 0.0032 });
    tell({ kind: 'placed' });
    await says(page, '#toasts', /An edit has covered the hand with ball: the force rises from zero\./);
    await page.getByRole('button', { name: 'Events' }).click();
    await says(page, '.events', /an edit covered the hand; the force rises from zero · ball/);
    await says(page, '.events', /an edit covered the hand, which was moved out to the surface · ball · by 3.2 mm/);
  })],
];
