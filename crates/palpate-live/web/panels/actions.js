// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/** What buttons and keys ask for. */

import { changed, lookAt, setView, state } from '../state.js';
import { goBack, takeScene } from './edits.js';
import { ask, download, page, tell, tellError } from './page.js';

/** The speed of the servo's time, also while it is held. */
export const clock = { speed: 1 };

/** Stops all forces; over HTTP if there is no socket. */
export function stop() {
  if (state.connection === 'live') page.wire?.send({ do: 'stop' });
  else navigator.sendBeacon(`stop?token=${encodeURIComponent(page.token)}`);
}

/** Gives forces again, rising from zero. */
export function release() {
  page.wire?.send({ do: 'release' });
}

export const undo = () => goBack('undo');
export const redo = () => goBack('redo');

/** @param {boolean} [force] also over a file that was changed elsewhere */
export async function save(force = false) {
  try {
    const answer = await page.wire?.ask(force ? { do: 'save', force } : { do: 'save' });
    if (answer?.do === 'scene') takeScene(answer);
    tell('The scene is saved.');
  } catch (error) {
    const text = error instanceof Error ? error.message : String(error);
    if (force || state.scene?.file === null) tell(text, 'bad');
    else tell(text, 'bad', { name: 'Save all the same', run: () => void save(true) });
  }
}

/** Opens a file as the scene. @param {File} file */
export async function openFile(file) {
  try {
    await openText(file.name, await file.text());
  } catch (error) {
    tellError(error);
  }
}

/** @param {string} name @param {string} text */
export async function openText(name, text) {
  const answer = await ask({ do: 'open', name, text });
  if (answer?.do === 'scene') takeScene(answer);
  if (answer) tell(`${name} is open.`);
}

/** Gives the scene as a file. */
export function downloadScene() {
  const { scene } = state;
  if (!scene) return;
  const text = scene.text ?? JSON.stringify(scene.scene, null, 2);
  download(new Blob([text], { type: 'application/json' }), fileName('.json'));
}

/** @param {string} ending */
export function fileName(ending) {
  return `${(state.scene?.name ?? 'scene').replace(/\.json$/, '').replace(/[^\w.-]+/g, '_')}${ending}`;
}

/** @param {number} speed */
export async function setSpeed(speed) {
  const answer = await ask({ do: 'clock', speed });
  if (answer && speed > 0) clock.speed = speed;
  changed('playback');
}

/** Holds the servo's time, or lets it go on. */
export function hold() {
  void setSpeed(state.history[state.history.length - 1]?.held ? clock.speed : 0);
}

export function slow() {
  void setSpeed(clock.speed === 0.25 ? 1 : 0.25);
}

export function step() {
  void ask({ do: 'clock', speed: 0, step: 1 });
}

/** Looks further back, or forth; past the newest frame it follows again. @param {number} frames */
export function lookBy(frames) {
  const last = state.history.length - 1;
  const next = (state.lookingAt ?? last) + frames;
  if (last >= 0) lookAt(next >= last && frames > 0 ? null : next);
}

export function record() {
  page.wire?.send({ do: 'record', on: !state.history[state.history.length - 1]?.recording });
}

/** Gives what was recorded as a CSV file. */
export async function downloadTrace() {
  try {
    const answer = await fetch(`trace.csv?token=${encodeURIComponent(page.token)}`);
    if (!answer.ok) throw new Error('There is no recording yet: press record first.');
    download(await answer.blob(), fileName('.trace.csv'));
  } catch (error) {
    tellError(error);
  }
}

/** Gives the picture as it is seen. */
export async function downloadPicture() {
  try {
    const png = await page.stage?.exportPng();
    if (png) download(png, fileName('.png'));
  } catch (error) {
    tellError(error);
  }
}

/** @param {typeof state.view.mode} mode */
export function setMode(mode) {
  if (state.scene?.dimension === 2 && (mode === 'space' || mode === 'slice')) {
    tell('This scene is flat: it has no 3D view and no slice.');
    return;
  }
  setView({ mode });
}
