// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

/**
 * STOP is on the screen at every size and in every state, and the page fits. With PALPATE_PAGE_PICTURES
 * set, each is kept as a picture.
 */

import { join } from 'node:path';
import { check, until } from '../harness.mjs';
import { BALL, ask, opened, pictures, said, says, serving, state, violations, written } from '../shared.mjs';

const SIZES = [[320, 480], [480, 320], [390, 844], [844, 390], [1280, 800]];
/** Sizes at which the picture has half of the height. */
const HALF = ['390×844', '844×390'];

/** What is wrong with the page as it is laid out; runs in the page. */
function faults({ isTouch, isHalf }) {
  const found = [];
  const dialog = document.querySelector('dialog');
  const button = (dialog ?? document).querySelector('.stop');
  const box = button.getBoundingClientRect();
  const isIn = ({ left, top, right, bottom }) => left >= 0 && top >= 0 && right <= innerWidth && bottom <= innerHeight;
  if (!isIn(box)) found.push(`STOP is at ${[box.left, box.top, box.right, box.bottom]}`);
  if (isTouch && (box.height < 44 || box.width < 44)) found.push(`STOP is ${box.width} × ${box.height}`);
  const home = document.getElementById('stop').getBoundingClientRect();
  if (['left', 'top', 'right', 'bottom'].some((side) => home[side] !== box[side])) found.push('STOP of the window is elsewhere');
  // The corners are round.
  const places = [[0.5, 0.5], [0.02, 0.12], [0.98, 0.12], [0.02, 0.88], [0.98, 0.88]];
  for (const [x, y] of places) {
    const top = document.elementFromPoint(box.left + x * box.width, box.top + y * box.height);
    if (top?.closest('.stop') !== button) found.push(`STOP is covered by ${top?.outerHTML.slice(0, 80)}`);
  }
  if (button.scrollWidth > button.clientWidth + 1 || button.scrollHeight > button.clientHeight + 1) found.push(`“${button.innerText}” is cut off`);
  if (!button.parentElement.querySelector('[aria-live=assertive]')) found.push('STOP is not announced');
  const [first] = (dialog ?? document).querySelectorAll('button, input, select, textarea, summary, a[href], [tabindex="0"]');
  if (first !== button) found.push(`the first in the order of Tab is ${first.outerHTML.slice(0, 80)}`);

  const release = document.getElementById('release');
  if (release) {
    const place = release.getBoundingClientRect();
    if (!isIn(place)) found.push(`release is at ${[place.left, place.top, place.right, place.bottom]}`);
    if (isTouch && place.height < 44) found.push(`release is ${place.height} high`);
    const isApart = place.left >= box.right || place.right <= box.left || place.top >= box.bottom || place.bottom <= box.top;
    if (!isApart) found.push('release lies over STOP');
    const top = document.elementFromPoint(place.left + place.width / 2, place.top + place.height / 2);
    if (!dialog && top?.closest('#release') !== release) found.push(`release is covered by ${top?.outerHTML.slice(0, 80)}`);
  }

  const stage = document.getElementById('stage').getBoundingClientRect();
  if (isHalf && stage.height < innerHeight / 2) found.push(`the picture is ${stage.height} of ${innerHeight} high`);
  if (stage.height < 120 || stage.width < 200) found.push(`the picture is ${stage.width} × ${stage.height}`);
  const { scrollWidth, scrollHeight } = document.documentElement;
  if (scrollWidth > innerWidth || scrollHeight > innerHeight) found.push(`the page is ${scrollWidth} × ${scrollHeight}`);
  // What can be scrolled sideways, and what is cut off at a side.
  const shown = dialog ?? document.body;
  for (const element of shown.querySelectorAll('*')) {
    const { overflowX } = getComputedStyle(element);
    if (['auto', 'scroll'].includes(overflowX) && element.scrollWidth > element.clientWidth + 1 && element.tagName !== 'TEXTAREA') {
      found.push(`${element.className || element.id} scrolls sideways: ${element.scrollWidth} of ${element.clientWidth}`);
    }
  }
  for (const element of shown.querySelectorAll('button, input, select, textarea, summary, h2, label, .switch')) {
    const place = element.getBoundingClientRect();
    const around = element.closest('.sheet, .menu-list, .toast, dialog, main > section, header, #tabs')?.getBoundingClientRect();
    if (!element.checkVisibility() || !around || element.matches('.stop')) continue;
    if (place.left < around.left - 1 || place.right > Math.min(around.right, innerWidth) + 1) {
      found.push(`${element.outerHTML.slice(0, 80)} goes from ${place.left} to ${place.right} in ${around.left} to ${around.right}`);
    }
  }
  return [...new Set(found)];
}

/** What the first press of Tab from the top goes to. */
async function firstByTab(page) {
  await page.evaluate(() => {
    document.body.tabIndex = -1;
    document.body.focus();
    document.body.removeAttribute('tabindex');
  });
  await page.keyboard.press('Tab');
  return page.evaluate(() => document.activeElement?.id);
}

/** States that were looked at. */
let turn = 0;

/** Looks at the page at each size. What axe finds takes long: of most states it looks at one size, each time
 * at another. @param {string} name */
async function look(page, name, { isFresh = true, isWhole = false } = {}) {
  const wrong = [];
  turn += 1;
  for (const [at, [width, height]] of SIZES.entries()) {
    const size = `${width}×${height}`;
    await page.setViewportSize({ width, height });
    await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));
    const found = await page.evaluate(faults, { isTouch: width < 960, isHalf: HALF.includes(size) });
    if (isWhole || turn % SIZES.length === at) found.push(...(await violations(page)).map((one) => `axe: ${one}`));
    if (isFresh && (await firstByTab(page)) !== 'stop') found.push('Tab does not go to STOP first');
    if (process.env.PALPATE_PAGE_PICTURES) await page.screenshot({ path: join(pictures, `${name}-${width}.png`) });
    wrong.push(...found.map((one) => `${name}, ${size}: ${one}`));
  }
  return wrong;
}

/** Opens a page with the hand in the ball, for work that is given the page and what looks at a state. */
const walking = (work) => serving([written(BALL)], async (served) => {
  const { page } = await opened(served.url, { reducedMotion: 'reduce' });
  const wrong = [];
  await work({ ...served, page, see: async (name, options) => wrong.push(...await look(page, name, options)) });
  check(wrong.length === 0, wrong.join('\n'));
});

/** Leads the hand into the ball. */
async function touch(page) {
  await ask(page, { do: 'tour', on: false });
  await ask(page, { do: 'hand', target: [0, 0.045, 0], held: true });
  await until('a force', async () => (await state(page, 'frame.force')) > 0.5);
}

/** Releases, and closes what the page says of it. */
async function release(page) {
  await page.locator('#release:enabled').click();
  await until('forces', async () => !(await state(page, 'frame.stopped')));
  await page.evaluate(async () => {
    const { dismiss, toasts } = await import('/panels/page.js');
    toasts.forEach(({ id }) => dismiss(id));
  });
}

export default [
  ['STOP is on the screen, first and announced, and the page fits, at rest, touching and in each panel', () => walking(async ({ page, see }) => {
    await see('rest', { isWhole: true });

    await touch(page);
    await see('touching');

    await page.evaluate(async () => (await import('/state.js')).select('/bodies/0'));
    for (const panel of ['selected', 'touch', 'checks', 'time']) {
      // A narrow page has a button for each panel.
      await page.setViewportSize({ width: 390, height: 844 });
      await page.locator(`.tab-${panel}`).click();
      await see(`panel-${panel}`);
    }
    for (const tab of ['Events', 'Safety', 'Profile', 'Falling ball']) {
      await page.getByRole('button', { name: tab, exact: true }).click();
      await see(`time-${tab.toLowerCase().replace(' ', '-')}`);
    }
    await page.locator('.scene-name').click();
    await see('menu', { isFresh: false });
    await page.locator('.scene-name').click();
    await page.getByText('display', { exact: true }).click();
    await see('display', { isFresh: false });
    await page.locator('.popover').evaluate((element) => (element.open = false));
    await page.evaluate(async () => {
      const { tell } = await import('/panels/page.js');
      for (const part of ['one', 'two']) tell(`A notice, number ${part}, that is as long as those of the program are.`, 'bad', [{ name: 'Stay', run: () => {} }]);
    });
    await see('notice');
  })],

  ['STOP is on the screen, first and announced, and the page fits, in each window', () => walking(async ({ page, see }) => {
    for (const [name, open] of [
      ['help', () => page.keyboard.press('?')],
      ['save-as', () => page.keyboard.press('Control+Shift+s')],
      ['unsaved', async () => {
        const base = await state(page, 'scene.revision');
        await ask(page, { do: 'edit', base, changes: [{ at: '/bodies/0/name', to: 'bead' }] });
        await until('an edit', async () => (await state(page, 'scene.is_saved')) === false);
        await page.evaluate(async () => void (await import('/panels/actions.js')).openText('other.json', '{}'));
      }],
    ]) {
      await page.evaluate(() => document.activeElement?.blur());
      await open();
      await page.locator('dialog').waitFor();
      await see(`window-${name}`, { isFresh: false });
      if (name === 'help') {
        await page.locator('dialog').focus();
        await page.keyboard.press('Tab');
        check(await page.evaluate(() => document.activeElement?.matches('dialog .stop')), 'Tab in the help does not go to STOP first');
      }
      // STOP of the window stops, and the window stays.
      await page.locator('dialog .stop').click();
      await until('a stop', () => state(page, 'frame.stopped'));
      await page.locator('dialog').getByRole('button', { name: /^(close|Cancel)$/ }).first().click();
      await page.locator('dialog').waitFor({ state: 'detached' });
      if (name !== 'unsaved') await release(page);
    }
  })],

  ['STOP is on the screen, first and announced, and the page fits, stopped, not heard and ended', () => walking(async ({ page, see, child, kill }) => {
    await touch(page);
    await page.locator('#stop').click();
    await until('a stop', () => state(page, 'frame.stopped'));
    await see('stopped', { isWhole: true });
    await release(page);

    await ask(page, { do: 'stop', press: '0123456789abcdef' });
    await says(page, '.stopped', /^Stopped by another page/);
    await see('stopped-by-another');
    await release(page);

    child.kill('SIGSTOP');
    await says(page, '.connection', /^not heard/);
    await page.locator('#stop').click();
    await says(page, '#stop', /sent, not confirmed/);
    await see('not-heard');
    child.kill('SIGCONT');
    await says(page, '.connection', /^live/);

    await kill();
    await says(page, '#words', /The program has ended/);
    await page.locator('#stop').click();
    await says(page, '#stop', /not sent/);
    await see('ended');
    check(!/\bok\b/.test(await said(page, 'footer')), 'ok after the end');
  })],
];
