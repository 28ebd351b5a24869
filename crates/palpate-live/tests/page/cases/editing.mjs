// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

/** The scene is edited, saved, and replaced by another. */

import { copyFileSync, readFileSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { check, near, until } from '../harness.mjs';
import { BALL, DISC, live, opened, state, serving, written, ask, scenes } from '../shared.mjs';

export default [
  ['a slider moves the field by uniforms, without a new program', () => serving([written(BALL)], async ({ url }) => {
    const { page, context } = await opened(url);
    await page.evaluate(async () => (await import('/state.js')).select('/bodies/0/shape/ball'));
    const slider = page.locator('#selected input[type=range]').first();
    const box = await slider.boundingBox();
    const [left, middle] = [box.x + 0.3 * box.width, box.y + box.height / 2];
    await page.mouse.move(left, middle);
    await page.mouse.down();
    await page.mouse.move(left + 5, middle, { steps: 3 });
    await until('numbers as uniforms', async () => (await state(page, 'way.uniforms.length')) > 0);
    await page.waitForTimeout(300);
    const text = await state(page, 'way.glsl');
    const links = await page.evaluate(() => window.seen.links);
    const radius = await state(page, 'scene.scene.bodies.0.shape.ball.radius');
    await page.mouse.move(left + 60, middle, { steps: 12 });
    await until('another radius', async () => (await state(page, 'scene.scene.bodies.0.shape.ball.radius')) !== radius);
    check((await state(page, 'way.glsl')) === text, 'the text of the shader changed');
    check((await page.evaluate(() => window.seen.links)) === links, 'a program was compiled');
    await page.mouse.up();
    await until('literals again', async () => (await state(page, 'way.uniforms.length')) === 0);
    await context.close();
  })],

  ['handles in the view move, turn and scale the selected body, each in one step to undo', async () => {
    for (const [scene, corner] of [[DISC, [-0.09, 0]], [BALL, [-0.09, 0, 0]]]) {
      await serving([written(scene)], async ({ url }) => {
        const { page, context } = await opened(url);
        const isPlane = corner.length === 2;
        // The hand does not come between the mouse and a handle.
        await ask(page, { do: 'tour', on: false });
        await ask(page, { do: 'hand', target: corner, held: true });
        await until('a hand beside the ball', async () => Math.abs((await state(page, 'frame.points.0.device'))[0] - corner[0]) < 1e-3);
        await page.evaluate(async () => (await import('/state.js')).select('/bodies/0'));
        const stage = await page.locator('#stage').boundingBox();
        const [x, y] = [stage.x + stage.width / 2, stage.y + stage.height / 2];
        const begin = JSON.stringify(await state(page, 'scene.scene.bodies.0'));
        const drag = async (across, down, by, found) => {
          await page.mouse.move(x + across, y + down);
          await page.mouse.down();
          await page.mouse.move(x + across + by[0], y + down + by[1], { steps: 8 });
          await until('an edit', async () => JSON.stringify(await state(page, 'scene.scene.bodies.0')) !== begin);
          await page.mouse.up();
          await until('literals again', async () => (await state(page, 'way.uniforms.length')) === 0);
          found(await state(page, 'scene.scene.bodies.0'));
          await page.keyboard.press('Control+z');
          await until('the ball of before', async () => JSON.stringify(await state(page, 'scene.scene.bodies.0')) === begin);
          check(!(await state(page, 'scene.can_undo')), 'a drag left more than one step to undo');
        };
        // In the plane a pixel is a part of the picture's height of 0.12 m; in space the arrow along x is seen
        // to the right and downwards.
        await drag(isPlane ? 60 : 49, isPlane ? 0 : 14, [40, 10], ({ pose: { translation: [along, ...others] } }) => {
          if (isPlane) near(along, (40 * 0.12) / stage.height, 2e-4, 'how far the arrow was dragged');
          check(along > 0.005 && others.every((part) => part === 0), `moved to ${[along, ...others]}`);
        });
        if (isPlane) {
          await drag(65, -65, [-65, -27], ({ pose }) => near(pose.rotate_degrees, 45, 2, 'the turn of a ring by an eighth'));
        } else {
          await drag(0, -55, [0, -30], ({ pose: { translation } }) => check(translation[1] > 0.005 && translation[0] === 0, `moved to ${translation}`));
        }
        await drag(-96, -96, [-48, -48], ({ shape }) => near(shape.scale, 1.5, 0.02, 'a factor'));
        // By keys: a step along x for each press.
        await page.locator('#stage canvas').last().focus();
        await page.keyboard.press('m');
        await page.keyboard.press('ArrowRight');
        await until('a step', async () => (await state(page, 'scene.scene.bodies.0.pose.translation.0')) > 0);
        await until('literals after the step', async () => (await state(page, 'way.uniforms.length')) === 0);
        await page.getByText('display', { exact: true }).click();
        await page.getByLabel('handles', { exact: true }).click();
        const revision = await state(page, 'scene.revision');
        await page.mouse.move(x - 96, y - 96);
        await page.mouse.down();
        await page.mouse.move(x - 140, y - 140, { steps: 8 });
        await page.mouse.up();
        await page.waitForTimeout(200);
        check((await state(page, 'scene.revision')) === revision, 'a handle that is switched off was dragged');
        await context.close();
      });
    }
  }],

  ['an edit is undone, saved and read again to the same bytes', () => {
    const file = written('');
    copyFileSync(join(scenes, 'cup.json'), file);
    const begin = readFileSync(file, 'utf8');
    return serving([file], async ({ url }) => {
      const { page, context } = await opened(url);
      const revision = await state(page, 'scene.revision');
      const edited = await ask(page, { do: 'edit', base: revision, changes: [{ at: '/bodies/0/name', to: 'mug' }] });
      check(edited.do === 'done', JSON.stringify(edited));
      await until('the new name', async () => (await state(page, 'scene.scene.bodies.0.name')) === 'mug');
      await page.keyboard.press('Control+z');
      await until('the old name', async () => (await state(page, 'scene.scene.bodies.0.name')) !== 'mug');
      await page.keyboard.press('Control+y');
      await until('the new name again', async () => (await state(page, 'scene.scene.bodies.0.name')) === 'mug');
      await page.keyboard.press('Control+s');
      await until('a saved scene', () => state(page, 'scene.is_saved'));
      const saved = readFileSync(file, 'utf8');
      check(saved !== begin && saved === (await state(page, 'scene.text')), 'the file has another text');
      await page.reload();
      await live(page);
      check((await state(page, 'scene.text')) === saved, 'the page reads another text');
      writeFileSync(file, begin);
      await until('the file changed elsewhere', async () => (await state(page, 'scene.text')) === begin);
      await context.close();
    });
  }],

  ['the page asks before another scene takes the place of edits that are not saved', () => serving([written(BALL)], async ({ url }) => {
    const { page, context } = await opened(url);
    const body = () => state(page, 'scene.scene.bodies.0.name');
    const dialog = page.getByRole('dialog', { name: 'The scene is not saved' });
    const choose = async (scene) => {
      await page.locator('.scene-name').click();
      await page.getByRole('button', { name: scene, exact: true }).click();
    };
    const revision = await state(page, 'scene.revision');
    await ask(page, { do: 'edit', base: revision, changes: [{ at: '/bodies/0/name', to: 'bead' }] });
    await until('an edit', async () => (await body()) === 'bead');
    await choose('cone and cube');
    await dialog.getByRole('button', { name: 'Cancel' }).click();
    await dialog.waitFor({ state: 'detached' });
    await page.waitForTimeout(200);
    check((await body()) === 'bead' && !(await state(page, 'scene.is_saved')), 'the edit is lost');
    await choose('cone and cube');
    await dialog.getByRole('button', { name: 'Discard the edits' }).click();
    await until('the other scene', async () => (await body()) === 'cone and cube');
    await choose('drilled box');
    await until('a third scene, without a question', async () => (await body()) === 'drilled box');
    await context.close();
  })],

  ['what was recorded is replayed, and a scene is saved as another file', () => {
    const file = written(BALL);
    return serving([file], async ({ url }) => {
      const { page, context } = await opened(url);
      await page.getByRole('button', { name: 'record', exact: true }).click();
      await until('a recording', () => state(page, 'frame.recording'));
      await ask(page, { do: 'hand', target: [0, 0.045, 0], held: true });
      await until('a force', async () => (await state(page, 'frame.force')) > 0.5);
      await page.getByRole('button', { name: /^recording/ }).click();
      await until('no recording', async () => !(await state(page, 'frame.recording')));
      await page.getByRole('button', { name: 'replay', exact: true }).click();
      await until('a replay', () => state(page, 'frame.replaying'));
      await page.getByRole('button', { name: 'end replay' }).click();
      await until('its end', async () => !(await state(page, 'frame.replaying')));
      await page.keyboard.press('Control+Shift+s');
      await page.locator('#save-name').fill('other');
      await page.keyboard.press('Enter');
      await until('the other file', async () => (await state(page, 'scene.name')) === 'other.json');
      check(readFileSync(join(dirname(file), 'other.json'), 'utf8') === readFileSync(file, 'utf8'), 'the other file has another text');
      await context.close();
    });
  }],
];
