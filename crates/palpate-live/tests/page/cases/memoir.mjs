// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

/** What the memoir asks: its triangle, its falling ball. */

import { execFileSync } from 'node:child_process';
import { join } from 'node:path';
import { check, until } from '../harness.mjs';
import { ask, between, opened, pictures, program, scenes, serving } from '../shared.mjs';

export default [
  ["the memoir's triangle has the core's verdict along a way", () => {
    const file = join(scenes, 'memoir_star.json');
    return serving([file], async ({ url }) => {
      // What was asked about a triangle, and the answers, by their numbers.
      const questions = new Map();
      const answers = new Map();
      const { page, context } = await opened(url, {}, undefined, async (page) => void await between(page, {
        toProgram: (data) => {
          const { do: what, corners, id } = JSON.parse(String(data));
          return what === 'element' && void questions.set(JSON.stringify(corners), id);
        },
        toPage: (data) => {
          const answer = typeof data === 'string' ? JSON.parse(data) : {};
          return answer.do === 'element' && void answers.set(answer.id, answer);
        },
      }));
      await page.evaluate(async () => {
        const { setToys } = await import('/plane/toys.js');
        setToys({ shown: { element: true, ball: false, pair: false, sweep: false } });
      });
      for (let step = 0; step <= 4; step += 1) {
        const corners = [[1.0 + 0.1 * step, 1.1], [1.4 + 0.1 * step, 0.5], [0.8 + 0.1 * step, 0.9]];
        await page.evaluate(async (corners) => (await import('/plane/toys.js')).setToys({ corners, method: 'naive' }), corners);
        const found = await until('an answer about this triangle', () => answers.get(questions.get(JSON.stringify(corners))));
        await until('the answer on the page', () => page.evaluate(async (lower) =>
          (await import('/plane/toys.js')).toys.results.element?.certified.lower === lower, found.certified.lower));
        const words = ['descend', file, '--json', '--method', 'naive', '--triangle', ...corners.map((corner) => corner.join(','))];
        const core = JSON.parse(execFileSync(program, words, { encoding: 'utf8' }));
        const { lower, upper } = core.certified;
        check(found.certified.lower <= upper && lower <= found.certified.upper,
          `proven ${found.certified.lower} to ${found.certified.upper}, by the core ${lower} to ${upper}`);
      }
      await page.locator('.tab-checks').click();
      const shown = [[1.2, 0.85], [1.5, 0.4], [1.22, 0.62]];
      await page.evaluate(async (corners) => (await import('/plane/toys.js')).setToys({ corners }), shown);
      const last = await until('an answer about the triangle of the picture', () => answers.get(questions.get(JSON.stringify(shown))));
      await until('the answer on the page', () => page.evaluate(async (lower) =>
        (await import('/plane/toys.js')).toys.results.element?.certified.lower === lower, last.certified.lower));
      await until('a whole picture', () => page.evaluate(async () => (await import('/panels/page.js')).page.stage.stats().isStill));
      await page.screenshot({ path: join(pictures, 'memoir.png') });
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
      const question = { question: 'point', at, radius: 0.99 * fell.radius };
      const { touches } = (await ask(page, { do: 'ask', question })).answer.ball;
      check(touches === false, `the ball at ${at}, ${fell.radius} m, is in the star: ${touches}`);
    }
    await context.close();
  })],
];
