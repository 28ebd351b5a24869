// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/** The line at the top: the scene, the device, and the connection. */

import { html, useLayoutEffect, useRef, useState } from '../vendor/htm-preact.js';
import { unheardInWords } from '../heard.js';
import { isDark } from '../scene/colors.js';
import { changed, state } from '../state.js';
import * as actions from './actions.js';
import { openedBefore } from './before.js';
import { GALLERY } from './gallery.js';
import { copyLink } from './link.js';
import { page, tellError, useTopics } from './page.js';
import { baseName, save, saveAs } from './saving.js';

const THEME = 'palpate-theme';

/** Takes the theme that was chosen before, and follows the system's. */
export function startTheme() {
  const chosen = localStorage.getItem(THEME);
  if (chosen) document.documentElement.dataset.theme = chosen;
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => changed('theme'));
}

function toggleTheme() {
  const theme = isDark() ? 'light' : 'dark';
  document.documentElement.dataset.theme = theme;
  localStorage.setItem(THEME, theme);
  changed('theme');
}

/** @param {{ help: () => void }} given */
export function Header({ help }) {
  useTopics(['connection', 'scene', 'theme', 'welcome']);
  const { scene, welcome } = state;
  return html`
    <h1 class="brand"><img src="favicon.svg" alt="" width="20" height="20" /><span>palpate</span></h1>
    <${Menu} help=${help} />
    <${Steps} />
    <span class="device" title="The device that the hand holds, and how often its force is computed">
      ${scene?.device ? deviceInWords(scene.device) : ''}${welcome?.rate ? ` · ${rateInWords(welcome.rate)}` : ''}
    </span>
    <${Connection} />
    <span class="gap"></span>
    <button class="plain roomy" onClick=${toggleTheme} aria-label=${isDark() ? 'Light theme' : 'Dark theme'}
      title=${isDark() ? 'Light theme' : 'Dark theme'}>
      <svg viewBox="0 0 16 16" width="16" height="16" aria-hidden="true"><circle cx="8" cy="8" r="6.5" fill="none"
        stroke="currentColor" stroke-width="1.5" /><path d="M8 1.5a6.5 6.5 0 0 1 0 13z" fill="currentColor" /></svg>
    </button>
    <button class="plain roomy" onClick=${help} aria-label="Help" title="Help: ? or F1">?</button>`;
}

/** @param {any} device */
function deviceInWords(device) {
  const points = device.points > 1 ? `, ${device.points} points` : '';
  return `${device.name}${points}`;
}

/** @param {number} rate */
function rateInWords(rate) {
  return rate >= 1000 ? `${rate / 1000} kHz` : `${rate} Hz`;
}

/** Whether the program is connected and heard. The seconds are not read out. */
function Connection() {
  useTopics(['heard']);
  const { connection } = state;
  if (connection === 'live' && state.unheard !== null) {
    const [, word, seconds] = /^(.*?)( for .*)$/.exec(unheardInWords()) ?? [];
    return html`<span class="connection unheard" role="status" title="The connection is open, but the program says nothing">
      <span class="dot" aria-hidden="true"></span><span>${word}<span aria-hidden="true">${seconds}</span></span></span>`;
  }
  const words = { connecting: 'connecting', live: 'live', lost: 'lost', closed: 'not connected' };
  return html`<span class=${`connection ${connection}`} role="status">
    <span class="dot" aria-hidden="true"></span><span>${words[connection]}</span></span>`;
}

/** One edit back, and forth again. */
function Steps() {
  const { scene } = state;
  const steps = [
    { name: 'undo', help: 'Undo the last edit', key: 'Z', isPossible: scene?.can_undo, run: actions.undo, turn: '' },
    { name: 'redo', help: 'Make the edit again', key: 'Y', isPossible: scene?.can_redo, run: actions.redo,
      turn: 'matrix(-1 0 0 1 16 0)' },
  ];
  return html`<span class="steps roomy" role="group" aria-label="Steps of editing">
    ${steps.map(({ name, help, key, isPossible, run, turn }) => html`<button key=${name} class="step" onClick=${run}
      disabled=${!isPossible} title=${`${help}: Ctrl ${key}`} aria-label=${name} aria-keyshortcuts=${`Control+${key}`}>
      <svg viewBox="0 0 16 16" width="14" height="14" aria-hidden="true"><path transform=${turn} fill="none" stroke="currentColor"
        stroke-width="1.6" d="M6 2.5 2.5 6 6 9.5M2.5 6h7.5a3.5 3.5 0 0 1 0 7H6" /></svg> <span>${name}</span></button>`)}
  </span>`;
}

/** The scene's name, and what can be done with its file; on a slim page also what has no room beside it.
 * @param {{ help: () => void }} given */
function Menu({ help }) {
  useTopics(['scene']);
  const [isOpen, setIsOpen] = useState(false);
  const box = useRef(/** @type {HTMLElement | null} */ (null));
  const file = useRef(/** @type {HTMLInputElement | null} */ (null));
  const { scene, welcome } = state;
  // At once: a key that is pressed before the next picture closes it too.
  useLayoutEffect(() => {
    if (!isOpen) return undefined;
    const close = (/** @type {Event} */ event) => {
      const isWithin = event.target instanceof Element && box.current?.contains(event.target);
      if (!isWithin || (event instanceof KeyboardEvent && event.key === 'Escape')) setIsOpen(false);
    };
    addEventListener('pointerdown', close);
    addEventListener('keydown', close);
    return () => {
      removeEventListener('pointerdown', close);
      removeEventListener('keydown', close);
    };
  }, [isOpen]);
  const before = isOpen ? openedBefore() : [];
  const item = (/** @type {string} */ name, /** @type {() => unknown} */ run, disabled = false, key = '', kind = '') => html`
    <li class=${kind}><button disabled=${disabled} onClick=${() => {
      setIsOpen(false);
      void Promise.resolve(run()).catch(tellError);
    }}>${name}${key && html` <kbd>${key}</kbd>`}</button></li>`;
  return html`<div class="menu" ref=${box}>
    <button class="scene-name" aria-expanded=${String(isOpen)} onClick=${() => setIsOpen(!isOpen)}
      title=${scene?.file ?? 'This scene has no file: Save as… gives it one'}>
      <span class="cut">${scene ? baseName(scene.file ?? scene.name) : 'no scene'}</span>${scene?.file === null && html` <span class="quiet">no file</span>`}${scene && !scene.is_saved ? html`<span class="unsaved" title="Not saved: the program keeps the edits until it ends, also without a page"> •</span>` : ''}
      <span class="caret open" aria-hidden="true"></span>
    </button>
    <input type="file" hidden accept=".json,.csv,application/json,text/csv" ref=${file} aria-label="Scene or trace"
      onChange=${(/** @type {any} */ event) => {
        const [chosen] = event.currentTarget.files;
        event.currentTarget.value = '';
        if (chosen) void actions.openFile(chosen);
      }} />
    ${isOpen && html`<ul class="menu-list">
      ${item('Undo', actions.undo, !scene?.can_undo, 'Ctrl Z', 'slim')}
      ${item('Redo', actions.redo, !scene?.can_redo, 'Ctrl Y', 'slim')}
      ${item('Help', help, false, '?', 'slim')}
      ${item(isDark() ? 'Light theme' : 'Dark theme', toggleTheme, false, '', 'slim')}
      ${item('Open a scene or a trace…', () => file.current?.click())}
      ${item('Save', () => save(), !scene, 'Ctrl S')}
      ${item('Save as…', saveAs, !scene, 'Ctrl Shift S')}
      ${item('Download the scene', actions.downloadScene, !scene)}
      ${item('Download the picture', actions.downloadPicture, !scene)}
      ${item('Copy a link to this view', copyLink, !scene)}
      ${page.shownLink && html`<li class="link"><label>Link <input readonly value=${page.shownLink}
        onFocus=${(/** @type {any} */ event) => event.currentTarget.select()} /></label></li>`}
      ${before.length > 0 && html`<li class="menu-title" title="As they were in this page when another took their place; a file is not watched any more">Opened before</li>`}
      ${before.map(({ name, text, isEdited }) => item(`${name}${isEdited ? ', edited' : ''}`, () => actions.openText(name, text)))}
      <li class="menu-title">Gallery</li>
      ${GALLERY.map(([name, make]) => item(name, () =>
        actions.openText(name, JSON.stringify(make(), null, 2)), !welcome))}
    </ul>`}
  </div>`;
}
