// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

/**
 * Measures how fast the live page is, and prints a table with the bars that it should keep on two
 * quiet cores without a graphics card. It asserts nothing: other machines have other times.
 *
 *     node bars.mjs PATH_TO_PALPATE
 *
 * It takes the browser from `target/page`, which `cargo xtask test` fills.
 */

import { cpus, loadavg } from 'node:os';
import { fileURLToPath } from 'node:url';

const root = new URL('../../../../', import.meta.url);
process.env.PALPATE_PAGE_TOOLS ??= fileURLToPath(new URL('target/page', root));
const { browser, scratch, start, until } = await import('./harness.mjs');

const [program] = process.argv.slice(2);
if (program === undefined) throw new Error('which program? node bars.mjs PATH_TO_PALPATE');

/** The sizes of the picture in CSS pixels. */
const SIZES = [[640, 400], [1280, 720]];
/** How long the camera turns, and how long state is counted [ms]. */
const TURNING = 2500;
const COUNTING = 4000;
/** Moves of a slider. */
const SLIDES = 15;

/** @type {[string, string, string][]} what was measured, the number, and the bar */
const rows = [];
const ms = (value) => `${value.toFixed(value < 10 ? 1 : 0)} ms`;
const middle = (values) => [...values].sort((a, b) => a - b)[Math.floor(values.length / 2)];

/** Runs in the page: keeps the layer that draws the scene, and measures it. */
async function measuring() {
  const { Layer } = await import('/scene/layer.js');
  const { Program } = await import('/scene/program.js');
  const { state } = await import('/state.js');
  const { page } = await import('/panels/page.js');
  const { step, drawMoving, learn } = Layer.prototype;
  let layer;
  Layer.prototype.step = function (...given) {
    layer = this;
    return step.apply(this, given);
  };
  // The field of the moving picture that the card draws, and what waits for one of another field.
  let drawn = null;
  let waiting = () => {};
  Layer.prototype.drawMoving = function (field) {
    drawn = field;
    return drawMoving.call(this, field);
  };
  Layer.prototype.learn = function (time) {
    waiting();
    return learn.call(this, time);
  };
  const frame = () => new Promise((resolve) => requestAnimationFrame(resolve));
  const until = async (look) => {
    while (!look()) await frame();
  };
  window.bars = {
    /** Lays the stage out in this size, above all else. */
    async lay(width, height) {
      Object.assign(document.getElementById('stage').style, {
        position: 'fixed', left: '0', top: '0', width: `${width}px`, height: `${height}px`, zIndex: '9',
      });
      await until(() => layer && layer.width === width && layer.height === height);
      await until(() => page.stage.stats().isStill);
    },
    /** The time of a picture with all pixels [ms], the least of five. */
    full() {
      const { gl, field, panels, width, height } = layer;
      const pixel = new Uint8Array(4);
      const times = [1, 2, 3, 4, 5].map(() => {
        const begun = performance.now();
        gl.bindFramebuffer(gl.FRAMEBUFFER, layer.targetOf(1));
        for (const panel of panels) layer.draw(panel, 1, field, null, { x: 0, y: 0, width, height });
        gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
        return performance.now() - begun;
      });
      layer.change();
      page.stage.fit();
      return Math.min(...times);
    },
    /** The times and scales of pictures while `window.isTurning`. */
    async moving() {
      const seen = [];
      do {
        await frame();
        const { time, scale } = page.stage.stats();
        if (seen.at(-1)?.time !== time) seen.push({ time, scale });
      } while (window.isTurning);
      return seen;
    },
    /** The largest gap between two animation frames until the picture is complete, and how long that takes [ms]. */
    async refining() {
      await until(() => !page.stage.stats().isStill);
      const begun = await frame();
      let [last, gap] = [begun, 0];
      while (!page.stage.stats().isStill) {
        const now = await frame();
        gap = Math.max(gap, now - last);
        last = now;
      }
      return { gap, time: last - begun };
    },
    /** The time that a program of the scene takes to compile and to draw for the first time [ms]. */
    compiling() {
      const gl = document.createElement('canvas').getContext('webgl2');
      const text = `${layer.field.program(layer.panels[0])}// ${performance.now()}`;
      const begun = performance.now();
      const program = new Program(gl, text, false);
      if (!program.isReady()) throw new Error(program.error);
      program.use();
      gl.viewport(0, 0, 16, 16);
      gl.drawArrays(gl.TRIANGLES, 0, 3);
      gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
      return performance.now() - begun;
    },
    /** The times from a slider that moves to a picture of what it changed [ms]. */
    async sliding(count) {
      const slider = document.querySelector('#selected input[type=range]');
      const begin = Number(slider.value);
      const times = [];
      for (let at = 1; at <= count; at += 1) {
        const { field } = layer;
        const begun = performance.now();
        slider.value = String(begin * (1 - 0.01 * at));
        slider.dispatchEvent(new Event('input', { bubbles: true }));
        await new Promise((resolve) => {
          waiting = () => drawn !== field && resolve();
        });
        times.push(performance.now() - begun);
        await new Promise((resolve) => setTimeout(resolve, 30));
      }
      slider.dispatchEvent(new Event('change', { bubbles: true }));
      return times;
    },
    operations: () => state.way.operations,
  };
}

/** Frames of state a second. */
const counted = (page) => page.evaluate(async (time) => {
  const { listen } = await import('/state.js');
  let count = 0;
  const stop = listen(['frame'], () => (count += 1));
  await new Promise((resolve) => setTimeout(resolve, time));
  stop();
  return (1000 * count) / time;
}, COUNTING);

/** @param {string} name @param {(page: import('playwright-core').Page) => Promise<void>} work */
async function withScene(name, work) {
  const served = await start(program, ['live', fileURLToPath(new URL(`scenes/${name}.json`, root))], scratch());
  const chrome = await browser();
  try {
    const page = await chrome.newPage({ viewport: { width: 1300, height: 800 } });
    await page.goto(served.url);
    await until('a scene', () => page.evaluate(async () => (await import('/state.js')).state.frame !== null));
    await page.evaluate(measuring);
    await page.evaluate(() => window.dispatchEvent(new Event('pointerup')));
    await work(page);
  } finally {
    await chrome.close();
    await served.kill();
  }
}

/** @param {import('playwright-core').Page} page @param {string} scene @param {string} part to slide */
async function measure(page, scene, part, [whole, moved]) {
  for (const [width, height] of SIZES) {
    const size = `${scene}, ${width}×${height}`;
    await page.evaluate(([w, h]) => window.bars.lay(w, h), [width, height]);
    const full = await page.evaluate(() => window.bars.full());
    rows.push([`${size}: a picture with all pixels`, ms(full), width === 640 ? whole : '']);
    await page.mouse.move(width / 2, height / 2);
    await page.mouse.down({ button: 'right' });
    await page.evaluate(() => (window.isTurning = true));
    const moving = page.evaluate(() => window.bars.moving());
    for (let begun = Date.now(), at = 0; Date.now() - begun < TURNING; at += 1) {
      await page.mouse.move(width / 2 + 60 * Math.sin(at / 10), height / 2);
      await page.waitForTimeout(16);
    }
    await page.evaluate(() => (window.isTurning = false));
    // The first half of the pictures finds the resolution.
    const turned = await moving;
    const seen = turned.slice(turned.length >> 1);
    const refining = page.evaluate(() => window.bars.refining());
    await page.mouse.up({ button: 'right' });
    const { gap, time } = await refining;
    const scale = middle(seen.map((one) => one.scale));
    const pictures = `${ms(middle(seen.map((one) => one.time)))} at ${scale} of the pixels along a side`;
    rows.push([`${size}: a moving picture`, pictures, moved]);
    rows.push([`${size}: largest gap between animation frames while tiles refine`, `${ms(gap)}, complete after ${ms(time)}`, '≤ 100 ms']);
  }
  const operations = await page.evaluate(() => window.bars.operations());
  const compiling = [];
  for (let time = 0; time < 3; time += 1) compiling.push(await page.evaluate(() => window.bars.compiling()));
  rows.push([`${scene}: compiling ${operations} operations`, ms(Math.min(...compiling)), operations > 2000 ? '≤ 500 ms' : '']);
  await page.evaluate(() => document.getElementById('stage').removeAttribute('style'));
  await page.evaluate(async (part) => (await import('/state.js')).select(part), part);
  await page.locator('#selected input[type=range]').first().waitFor();
  const [first, ...others] = await page.evaluate((count) => window.bars.sliding(count), SLIDES);
  rows.push([`${scene}: from a slider to the picture`, `${ms(middle(others))}, at most ${ms(Math.max(...others))}, the first ${ms(first)}`, '≤ 100 ms']);
  rows.push([`${scene}: frames of state`, `${(await counted(page)).toFixed(1)}/s`, '≥ 55/s']);
}

await withScene('s3', async (page) => {
  const { bytes, files } = await page.evaluate(() => {
    const entries = [...performance.getEntriesByType('navigation'), ...performance.getEntriesByType('resource')];
    return { bytes: entries.reduce((sum, { transferSize }) => sum + transferSize, 0), files: entries.length };
  });
  rows.push(['the page by wire', `${(bytes / 1000).toFixed(0)} kB in ${files} files`, '≤ 300 kB']);
  await measure(page, 'S3', '/bodies/0/shape/smooth_union/1', ['≤ 33 ms', '']);
});
await withScene('s4', (page) => measure(page, 'S4', '/bodies/0/shape/union/0', ['', '≤ 66 ms']));
await withScene('sampler_plane', async (page) => {
  await page.evaluate(() => window.bars.lay(640, 400));
  const operations = await page.evaluate(() => window.bars.operations());
  const time = await page.evaluate(() => window.bars.compiling());
  rows.push([`every primitive of the plane: compiling ${operations} operations`, ms(time), '≤ 500 ms']);
});

const widths = [0, 1].map((column) => Math.max(...rows.map((row) => row[column].length)));
for (const [what, number, bar] of rows) {
  console.log(`${what.padEnd(widths[0])}  ${number.padEnd(widths[1])}  ${bar}`);
}
console.log(`${cpus().length} cores, load ${loadavg().map((load) => load.toFixed(1)).join(', ')}; drawn by software`);
