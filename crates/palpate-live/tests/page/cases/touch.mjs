// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

/** Touch: the mouse, fingers, a pen, keys, a pad. */

import { join } from 'node:path';
import { check, near, until } from '../harness.mjs';
import { BALL, opened, state, serving, written, ask, pictures } from '../shared.mjs';

export default [
  ['a drag into a ball is pushed back by its stiffness', () => serving([written(BALL)], async ({ url }) => {
    const { page, context, complaints } = await opened(url);
    const stage = await page.locator('#stage').boundingBox();
    const [x, y] = [stage.x + stage.width / 2, stage.y + stage.height / 2];
    await until('the picture', () => page.evaluate(() => window.seen.links > 0));
    await page.waitForTimeout(500);
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x + 3, y + 3, { steps: 10 });
    const point = await until('a contact at rest', async () => {
      const before = await state(page, 'frame.points.0');
      await page.waitForTimeout(150);
      const now = await state(page, 'frame.points.0');
      const still = Math.hypot(...now.force.map((f, axis) => f - before.force[axis])) < 0.02;
      return now.contact && now.depth > 1e-3 && still && now;
    });
    const force = Math.hypot(...point.force);
    near(force, 300 * point.depth, 0.05 * 300 * point.depth, `force at a depth of ${point.depth} m`);
    // Across the ball, where the spring and the force are seen from the side.
    await page.mouse.move(x + 90, y - 30, { steps: 30 });
    await page.waitForTimeout(1500);
    await page.screenshot({ path: join(pictures, 'touch.png') });
    await page.mouse.up();
    check(complaints.length === 0, complaints.join('\n'));
    await context.close();
  })],

  ['the keyboard suffices: the tree, a number, the hand, help', () => serving([written(BALL)], async ({ url }) => {
    const { page, context } = await opened(url);
    await page.evaluate(() => document.querySelector('[role=tree] [tabindex="0"], [role=treeitem][tabindex="0"]').focus());
    for (const key of ['ArrowDown', 'ArrowRight', 'ArrowDown']) await page.keyboard.press(key);
    await until('a selected part', async () => (await state(page, 'selection')) !== null);
    const before = await state(page, 'frame.points.0.device');
    await page.evaluate(() => document.activeElement.blur());
    await page.keyboard.down('ArrowRight');
    await until('a hand that moves', async () => {
      const now = await state(page, 'frame.points.0.device');
      return Math.hypot(...now.map((x, axis) => x - before[axis])) > 1e-3;
    });
    await page.keyboard.up('ArrowRight');
    // Keys that came up once let go of the hand: nobody could press on a body by them.
    let rests = [0, 0, 0];
    const way = async () => {
      const now = await state(page, 'frame.points.0.device');
      const gone = Math.hypot(...now.map((x, axis) => x - rests[axis]));
      rests = now;
      return gone;
    };
    await until('a hand at rest', async () => {
      await page.waitForTimeout(300);
      return (await way()) < 1e-4;
    });
    await page.waitForTimeout(2500);
    const gone = await way();
    check(gone < 1e-3, `the hand went by ${gone} m`);
    await page.keyboard.press('?');
    await page.locator('dialog').waitFor();
    await page.screenshot({ path: join(pictures, 'help.png') });
    await page.keyboard.press('Escape');
    await until('a stop', () => state(page, 'frame.stopped'));
    await context.close();
  })],

  ['finger and pen lead the hand', () => serving([written(BALL)], async ({ url }) => {
    const { page, context } = await opened(url, { hasTouch: true });
    await until('the picture', () => page.evaluate(() => window.seen.links > 0));
    await page.waitForTimeout(500);
    const box = await page.locator('#stage').boundingBox();
    const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
    const cdp = await context.newCDPSession(page);
    await cdp.send('Input.dispatchTouchEvent', { type: 'touchStart', touchPoints: [{ x, y, id: 0 }] });
    await cdp.send('Input.dispatchTouchEvent', { type: 'touchMove', touchPoints: [{ x: x + 4, y, id: 0 }] });
    await until('a contact by a finger', async () => (await state(page, 'frame.force')) > 0.1);
    await cdp.send('Input.dispatchTouchEvent', { type: 'touchEnd', touchPoints: [] });
    // The hand is let go before the pen comes, elsewhere on the ball. The device's friction of 0.1 N
    // holds it against the wall.
    await until('a hand that is let go', async () => (await state(page, 'frame.force')) < 0.101);
    await page.evaluate(() => window.addEventListener('pointerdown', ({ pointerType }) => (window.pressedBy = pointerType)));
    for (const [type, across] of [['mousePressed', -40], ['mouseMoved', -46]]) {
      await cdp.send('Input.dispatchMouseEvent', {
        type, x: x + across, y: y + 30, button: 'left', buttons: 1, clickCount: 1, pointerType: 'pen', force: 0.5,
      });
    }
    check((await page.evaluate(() => window.pressedBy)) === 'pen', 'the page was pressed by no pen');
    await until('a contact by a pen', async () => (await state(page, 'frame.force')) > 0.15);
    await context.close();
  })],

  ['a pad leads the hand and rumbles, and sound begins at its button alone', () => serving([written(BALL)], async ({ url }) => {
    const { page, context } = await opened(url);
    check((await page.evaluate(() => window.seen.sounds)) === 0, 'sound before it was asked for');
    await page.getByText('sound off').click();
    await until('sound', () => page.evaluate(() => window.seen.sounds === 1 && window.sound.state === 'running'));
    // From a place over the ball, the stick leads into it.
    await ask(page, { do: 'tour', on: false });
    await ask(page, { do: 'hand', target: [0, 0.07, 0], held: true });
    await until('a hand over the ball', async () => Math.abs((await state(page, 'frame.points.0.device'))[1] - 0.07) < 1e-3);
    await page.locator('#touch select').first().selectOption('gamepad');
    const before = await state(page, 'frame.points.0.device');
    await page.evaluate(() => { window.padOn = true; window.pad.axes[1] = 0.9; });
    await until('a hand that moves', async () => {
      const now = await state(page, 'frame.points.0.device');
      return Math.hypot(...now.map((x, axis) => x - before[axis])) > 1e-3;
    });
    await until('rumble', () => page.evaluate(() => window.seen.fx.some(([kind]) => kind === 'dual-rumble')), 20000);
    await context.close();
  })],
];
