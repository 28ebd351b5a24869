// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

/** What the tests in a browser share: the browser, the program, cases and their report. */

import { spawn } from 'node:child_process';
import { mkdtempSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { createInterface } from 'node:readline';

const tools = process.env.PALPATE_PAGE_TOOLS;
if (tools === undefined) {
  throw new Error('PALPATE_PAGE_TOOLS is not set: run `cargo xtask test`, which fetches what the tests need');
}
const require = createRequire(join(tools, 'package.json'));
const { chromium } = require('playwright-core');

/** The path of a file in a package. @param {string} name */
export const toolPath = (name) => require.resolve(name);

/** A browser that draws by software, the same on every machine. @param {string[]} [more] */
export function browser(more = []) {
  return chromium.launch({
    executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
    args: [
      '--no-sandbox', '--use-angle=swiftshader', '--disable-background-networking',
      '--disable-component-update', '--disable-sync', '--disable-quic', '--no-first-run', ...more,
    ],
  });
}

/** A folder that is gone with the machine's temporary files. */
export const scratch = () => mkdtempSync(join(tmpdir(), 'palpate-page-'));

/** Programs that run: none outlives the tests, also if a case takes too long. */
const running = new Set();
process.on('exit', () => running.forEach((child) => child.kill('SIGKILL')));

/**
 * Starts the program; gives the address of its page.
 * @param {string} program @param {string[]} words @param {string} folder for what it remembers
 */
export async function start(program, words, folder) {
  const child = spawn(program, words, {
    env: { ...process.env, XDG_RUNTIME_DIR: folder },
    stdio: ['ignore', 'pipe', 'pipe'],
  });
  running.add(child);
  child.on('exit', () => running.delete(child));
  const lines = createInterface({ input: child.stderr });
  const url = await new Promise((resolve, reject) => {
    const said = [];
    lines.on('line', (line) => {
      said.push(line);
      const live = /^live at (\S+)$/.exec(line);
      if (live) resolve(live[1]);
    });
    child.on('exit', (code) => reject(new Error(`the program ended with ${code}: ${said.join('\n')}`)));
  });
  const ended = new Promise((resolve) => child.on('exit', (code, signal) => resolve(code ?? signal)));
  return { url, child, ended, kill: (signal = 'SIGKILL') => (child.kill(signal), ended) };
}

/** Waits until `look` gives something true, and gives that. Fails after `patience` [ms].
 * @template T @param {string} what @param {() => Promise<T> | T} look */
export async function until(what, look, patience = 30000) {
  const end = Date.now() + patience;
  for (;;) {
    const found = await look();
    if (found) return found;
    if (Date.now() > end) throw new Error(`waited in vain: ${what}`);
    await new Promise((resolve) => setTimeout(resolve, 30));
  }
}

/** @param {unknown} condition @param {string} what */
export function check(condition, what) {
  if (!condition) throw new Error(what);
}

/** @param {number} value @param {number} wanted @param {number} by @param {string} what */
export function near(value, wanted, by, what) {
  check(Math.abs(value - wanted) <= by, `${what}: ${value}, wanted ${wanted} ± ${by}`);
}

/** Runs cases one after the other, and ends with 1 if one fails. Names the failures last, where a
 * reader of a shortened log looks.
 * @param {[string, () => Promise<void>][]} cases */
export async function run(cases) {
  const only = process.env.PALPATE_PAGE_ONLY;
  const failures = [];
  for (const [name, work] of cases.filter(([name]) => !only || name.includes(only))) {
    const begin = Date.now();
    const late = new Promise((_, reject) => setTimeout(() => reject(new Error('took more than two minutes')), 120000).unref());
    try {
      await Promise.race([work(), late]);
      console.log(`ok      ${name} (${((Date.now() - begin) / 1000).toFixed(1)} s)`);
    } catch (error) {
      failures.push(`FAILED  ${name}: ${error instanceof Error ? error.stack : error}`);
      console.log(failures.at(-1));
    }
  }
  for (const failure of failures) console.error(failure);
  process.exit(failures.length > 0 ? 1 : 0);
}
