// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

/**
 * The live page in a browser, served by the program. Arguments: the program, the folder of the
 * scenes, and the folder for pictures.
 */

import { execFileSync } from 'node:child_process';
import { copyFileSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { browser, check, near, run, scratch, start, toolPath, until } from './harness.mjs';

const [program, scenes, pictures] = process.argv.slice(2);
mkdirSync(pictures, { recursive: true });
const axe = readFileSync(toolPath('axe-core/axe.min.js'), 'utf8');

/** A scene with one ball, which is as stiff as the device renders it. */
const BALL = JSON.stringify({
  palpate: 1,
  dimension: 3,
  bodies: [{
    name: 'ball',
    shape: { ball: { radius: 0.05 } },
    material: { stiffness: 300, damping: 0, static_friction: 0, dynamic_friction: 0 },
  }],
}, null, 2);

/** The same in the plane. */
const DISC = BALL.replace('"dimension": 3', '"dimension": 2');

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

/** @type {import('playwright-core').Browser} */
let chrome;

/** A browser for each case, so that none suffers from what another left. */
async function inBrowser(work) {
  chrome = await browser();
  try {
    await work();
  } finally {
    await chrome.close();
  }
}

/** Opens a page of a program; gives it with what it complained about. */
async function opened(url, options = {}, before = () => {}) {
  const context = await chrome.newContext({ viewport: { width: 1280, height: 720 }, acceptDownloads: true, ...options });
  await context.addInitScript(mocks);
  await context.addInitScript(before);
  const page = await context.newPage();
  const complaints = [];
  page.on('console', (m) => ['error', 'warning'].includes(m.type()) && complaints.push(m.text()));
  page.on('pageerror', (error) => complaints.push(String(error.stack)));
  await page.goto(url);
  await live(page);
  return { page, context, complaints };
}

/** What a module of the page holds. */
const state = (page, path) => page.evaluate(async (path) => {
  const { state } = await import('/state.js');
  return path.split('.').reduce((at, key) => at?.[key], state);
}, path);

const live = (page) => until('a scene and a frame', async () => (await state(page, 'connection')) === 'live'
  && (await state(page, 'scene.revision')) > 0 && (await state(page, 'frame.tick')) > 0);

/** Runs work with a program that serves a scene. */
async function serving(words, work) {
  const folder = scratch();
  const served = await start(program, ['live', ...words], folder);
  try {
    await work(served, folder);
  } finally {
    await served.kill();
  }
}

/** Writes a scene into a folder of its own. */
function written(text, name = 'scene.json') {
  const file = join(scratch(), name);
  writeFileSync(file, text);
  return file;
}

/** Asks the program by a second socket, which stays open: the hand is let go by a page that goes. */
const ask = (page, message) => page.evaluate(async (message) => {
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

async function violations(page) {
  await page.evaluate(axe);
  const found = await page.evaluate(() => window.axe.run());
  return found.violations.map((one) => `${one.id}: ${one.nodes.map((node) => node.target).join(' ')}`);
}

const cases = [
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

  ["the memoir's triangle has the core's verdict along a way", () => {
    const file = join(scenes, 'memoir_star.json');
    return serving([file], async ({ url }) => {
      const { page, context } = await opened(url);
      await page.evaluate(async () => {
        const { setToys } = await import('/plane/toys.js');
        setToys({ shown: { element: true, ball: false, pair: false, sweep: false } });
      });
      for (let step = 0; step <= 4; step += 1) {
        const corners = [[1.0 + 0.1 * step, 1.1], [1.4 + 0.1 * step, 0.5], [0.8 + 0.1 * step, 0.9]];
        const found = await page.evaluate(async (corners) => {
          const { setToys, toys } = await import('/plane/toys.js');
          setToys({ corners, method: 'naive' });
          // An answer to what was asked before may still come: the last of them counts.
          for (let last = null, since = 0; since < 30; since += 1) {
            if (toys.results.element !== last) [last, since] = [toys.results.element, 0];
            await new Promise((resolve) => setTimeout(resolve, 10));
          }
          return toys.results.element;
        }, corners);
        const words = ['descend', file, '--json', '--method', 'naive', '--triangle', ...corners.map((corner) => corner.join(','))];
        const core = JSON.parse(execFileSync(program, words, { encoding: 'utf8' }));
        const { lower_m: lower, upper_m: upper } = core.certified;
        check(found.certified.lower <= upper && lower <= found.certified.upper,
          `proven ${found.certified.lower} to ${found.certified.upper}, by the core ${lower} to ${upper}`);
      }
      await page.locator('.tab-checks').click();
      await page.evaluate(async () => (await import('/plane/toys.js')).setToys({ corners: [[1.2, 0.85], [1.5, 0.4], [1.22, 0.62]] }));
      await page.waitForTimeout(2000);
      await page.screenshot({ path: join(pictures, 'memoir.png') });
      await context.close();
    });
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

  ['a ball falls onto the memoir’s star and into none of it', () => serving([join(scenes, 'memoir_star.json')], async ({ url }) => {
    const { page, context } = await opened(url);
    await page.getByRole('button', { name: 'Falling ball' }).click();
    await page.getByRole('switch', { name: 'falling ball' }).or(page.getByLabel('falling ball', { exact: true })).first().click();
    const outcome = page.getByRole('status', { name: 'Outcome of the fall' });
    await until('an outcome', async () => /After .* the ball/.test(await outcome.textContent({ timeout: 10000 })));
    const fell = await page.evaluate(async () => {
      const { fall } = await import('/plane/fall.js');
      return { path: fall.answer.path, radius: fall.radius };
    });
    check(fell.path.length > 50, `a path of ${fell.path.length} places`);
    for (const at of fell.path.filter((_, step) => step % 40 === 0)) {
      // The star's values are bounds: whether a ball touches is searched for.
      const { touches } = await ask(page, { do: 'ball', centre: at, radius: 0.99 * fell.radius });
      check(touches === false, `the ball at ${at}, ${fell.radius} m, is in the star: ${touches}`);
    }
    await context.close();
  })],

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
    await page.locator('#stop').click();
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

  ['a lost context is restored, and without WebGL the program draws', () => serving([written(BALL)], async ({ url }) => {
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
    await until('a picture of the program', () => without.page.evaluate(() => {
      // The second canvas holds what the program drew: more than one colour.
      const canvas = document.querySelectorAll('#stage canvas')[1];
      const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
      return new Set(new Uint32Array(data.buffer)).size > 50;
    }));
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
    // The force of the finger is gone before the pen comes, elsewhere on the ball.
    await until('a hand that is let go', async () => (await state(page, 'frame.force')) < 0.05);
    await page.evaluate(() => window.addEventListener('pointerdown', ({ pointerType }) => (window.pressedBy = pointerType)));
    for (const [type, across] of [['mousePressed', -40], ['mouseMoved', -46]]) {
      await cdp.send('Input.dispatchMouseEvent', {
        type, x: x + across, y: y + 30, button: 'left', buttons: 1, clickCount: 1, pointerType: 'pen', force: 0.5,
      });
    }
    check((await page.evaluate(() => window.pressedBy)) === 'pen', 'the page was pressed by no pen');
    await until('a contact by a pen', async () => (await state(page, 'frame.force')) > 0.1);
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

await run(cases.map(([name, work]) => [name, () => inBrowser(work)]));
