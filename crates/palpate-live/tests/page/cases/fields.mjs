// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

/** Keys in fields and windows, and what fields begin with. */

import { check, until } from '../harness.mjs';
import { BALL, between, opened, pause, said, says, serving, state, written } from '../shared.mjs';

/** Two bodies, the first of rubber. */
const RUBBER = (() => {
  const scene = JSON.parse(BALL);
  scene.bodies[0].material = 'rubber';
  return JSON.stringify(scene, null, 2);
})();

const radius = (page) => state(page, 'scene.scene.bodies.0.shape.ball.radius');

/** Selects the ball, and gives the field of its radius. */
async function radiusField(page) {
  await page.evaluate(async () => (await import('/state.js')).select('/bodies/0/shape'));
  const field = page.locator('#selected').getByLabel('radius').first();
  await field.waitFor();
  return field;
}

/** Releases by the key that the page names, without a press of the mouse. */
async function releaseByKey(page) {
  await until('a stop', () => state(page, 'frame.stopped'));
  check(/ R$/.test(await said(page, '#release')), `the page names no key: ${await said(page, '#release')}`);
  await page.locator('#release:enabled').waitFor();
  await page.keyboard.press('r');
  await until('forces again', async () => !(await state(page, 'frame.stopped')));
}

export default [
  ['Esc stops from everywhere: it empties a field, closes a window and a menu, and R goes on', () => serving([written(BALL)], async ({ url }) => {
    const { page } = await opened(url);
    const field = await radiusField(page);
    await field.fill('0.07');
    await page.keyboard.press('Escape');
    await releaseByKey(page);
    check((await field.inputValue()) === '0.05' && (await radius(page)) === 0.05, `typed: ${await field.inputValue()}`);
    const name = page.getByRole('textbox', { name: 'description' });
    await page.evaluate(async () => (await import('/state.js')).select(null));
    await name.fill('not this');
    await page.keyboard.press('Escape');
    await releaseByKey(page);
    check((await name.inputValue()) === '' && (await state(page, 'scene.scene.description')) === undefined, 'a note was entered');
    for (const open of [() => page.keyboard.press('?'), () => page.keyboard.press('Control+Shift+s')]) {
      await open();
      await page.locator('dialog').waitFor();
      await page.keyboard.press('Escape');
      await page.locator('dialog').waitFor({ state: 'detached' });
      await releaseByKey(page);
    }
    await page.locator('.scene-name').click();
    await page.keyboard.press('Escape');
    await page.locator('.menu-list').waitFor({ state: 'detached' });
    await releaseByKey(page);
    // A list that is open keeps keys to itself.
    await page.locator('#view select').first().click();
    await page.keyboard.press('Escape');
    await releaseByKey(page);
    for (const place of ['#view select', '#time input[type=range]', '[role=tree] [tabindex="0"]', '#stage canvas >> nth=-1']) {
      await page.locator(place).first().focus();
      await page.keyboard.press('Escape');
      await releaseByKey(page);
    }
  })],

  ['a key that is held stops and never releases', () => serving([written(BALL)], async ({ url }) => {
    let stops = 0;
    let last = 0;
    const { page } = await opened(url, {}, undefined, async (page) => {
      await page.clock.install();
      await between(page, { toProgram: (data) => {
        if (/"do":"stop"/.test(String(data))) [stops, last] = [stops + 1, Date.now()];
        return false;
      } });
    });
    // The time of the page is that of the test: a second of it passes here.
    await pause(page);
    await page.keyboard.down('Escape');
    await until('a stop', () => state(page, 'frame.stopped'));
    await page.clock.runFor(60);
    for (let time = 0; time < 1500; time += 30) {
      await page.keyboard.down('Escape');
      await page.clock.runFor(30);
      check(await page.locator('#release').isDisabled(), 'a release while Esc is held');
    }
    await page.keyboard.up('Escape');
    check(stops > 1 && stops < 9, `${stops} STOPs of a key that is held`);
    // R that was down before the second is over does not release by repeating.
    await page.keyboard.down('r');
    // The second begins when the page hears of the last STOP, at any of its times.
    await until('a release that may be pressed', async () => {
      await page.clock.runFor(60);
      return page.locator('#release').isEnabled();
    });
    await until('a second of the program', () => Date.now() - last > 1100);
    await page.keyboard.down('r');
    await page.keyboard.down('r');
    check(await state(page, 'frame.stopped'), 'a repeated R released');
    await page.keyboard.up('r');
    await page.keyboard.press('r');
    await until('forces again', async () => !(await state(page, 'frame.stopped')));
  })],

  ['Ctrl Z in a field drops what was typed, and stops and undoes nothing', () => serving([written(BALL)], async ({ url }) => {
    const { page } = await opened(url);
    const field = await radiusField(page);
    check(/Ctrl Z drops what was typed; so does Esc, which stops all forces too/.test(await field.getAttribute('title')), 'no hint');
    await field.fill('0.06');
    await page.keyboard.press('Enter');
    await until('an edit', async () => (await radius(page)) === 0.06);
    await field.fill('0.07');
    await page.keyboard.press('Control+z');
    await until('the number of before', async () => (await field.inputValue()) === '0.06');
    await field.fill('none');
    await page.keyboard.press('Enter');
    await page.locator('#selected .problem').waitFor();
    await page.keyboard.press('Control+z');
    await page.locator('#selected .problem').waitFor({ state: 'detached' });
    await field.blur();
    check((await radius(page)) === 0.06 && (await state(page, 'scene.can_undo')), 'the edit was undone or another made');
    check(!(await state(page, 'frame.stopped')), 'Ctrl Z stopped');
    // Without a draft it undoes the scene.
    await field.focus();
    await page.keyboard.press('Control+z');
    await until('the first radius', async () => (await radius(page)) === 0.05);
  })],

  ['own numbers begin with those of the preset', () => serving([written(RUBBER)], async ({ url }) => {
    const { page } = await opened(url);
    const { rubber } = await state(page, 'welcome.presets');
    await page.evaluate(async () => (await import('/state.js')).select('/bodies/0'));
    await page.locator('#selected').getByLabel('material').first().selectOption('own');
    const own = await until('own numbers', async () => {
      const { material } = await state(page, 'scene.scene.bodies.0');
      return typeof material === 'object' && material;
    });
    for (const [key, value] of Object.entries(rubber)) {
      const [found, wanted] = [own[key], value].map((one) => JSON.stringify(one));
      check(found === wanted, `${key} is ${found}, of rubber ${wanted}`);
    }
  })],

  ['a notice covers no card, at any size', () => serving([written(BALL)], async ({ url, kill }) => {
    const { page } = await opened(url);
    await page.evaluate(async () => {
      const { tell } = await import('/panels/page.js');
      for (const part of ['one', 'two', 'three', 'four']) tell(`A notice, number ${part}, that is as long as those of the program are.`, 'bad', [{ name: 'Stay', run: () => {} }]);
    });
    await kill();
    await says(page, '#words', /The program has ended\./);
    for (const [width, height] of [[320, 480], [480, 320], [390, 844], [844, 390], [1280, 800]]) {
      await page.setViewportSize({ width, height });
      const hidden = await page.evaluate(() => {
        const card = document.querySelector('.words').getBoundingClientRect();
        const places = [0.02, 0.5, 0.98].flatMap((x) => [0.05, 0.5, 0.95].map((y) => [card.left + x * card.width, card.top + y * card.height]));
        return places.filter(([x, y]) => !document.elementFromPoint(x, y)?.closest('.words'));
      });
      check(hidden.length === 0, `at ${width}×${height} the card is covered at ${hidden.join(' and ')}`);
    }
  })],
];
