// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/** What buttons and keys ask for. */

import { changed, lookAt, setView, state } from '../state.js';
import { goBack } from './edits.js';
import { ask, download, fileName, page, tell, tellError } from './page.js';
import { openTrace } from './recording.js';
import { baseName } from './saving.js';
import { replaceScene } from './unsaved.js';

/** The speed of the servo's time, also while it is held. */
export const clock = { speed: 1 };

/** What is said where two bodies are needed and the scene has fewer. */
export const TWO_NEEDED = 'This needs two bodies, and the scene has fewer: add one with “add…” in Shapes.';

export const undo = () => goBack('undo');
export const redo = () => goBack('redo');

/** Opens a file: a trace to be replayed, any other as the scene. @param {File} file */
export async function openFile(file) {
  try {
    if (/\.csv$/i.test(file.name)) await openTrace(file);
    else await openText(file.name, await file.text());
  } catch (error) {
    tellError(error);
  }
}

/** Opens another scene. @param {string} name @param {string} text */
export function openText(name, text) {
  return replaceScene(baseName(name), async () => {
    if (await ask({ do: 'open', name, text })) tell(`${baseName(name)} is open.`);
  });
}

/** Gives the scene as a file. */
export function downloadScene() {
  const { scene } = state;
  if (!scene) return;
  const text = scene.text ?? JSON.stringify(scene.scene, null, 2);
  download(new Blob([text], { type: 'application/json' }), fileName('.json'));
}

/** @param {number} speed */
export async function setSpeed(speed) {
  const answer = await ask({ do: 'clock', speed });
  if (answer && speed > 0) clock.speed = speed;
  changed('playback');
}

/** Holds the servo's time, or lets it go on. */
export function hold() {
  void setSpeed(state.newest?.held ? clock.speed : 0);
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
