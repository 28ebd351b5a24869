// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/** The scene is saved to its file, or to another one. */

import { state } from '../state.js';
import { html, useState } from '../vendor/htm-preact.js';
import { Dialog, closeDialog, openDialog } from './dialog.js';
import { takeScene } from './edits.js';
import { fileName, page, tell } from './page.js';

/** The last part of a path. @param {string | null | undefined} path */
export function baseName(path) {
  return (path ?? '').replace(/^.*[\\/]/, '');
}

/** @param {import('../wire.js').Message} more */
async function ask(more) {
  const answer = await page.wire?.ask({ do: 'save', ...more });
  if (answer?.do === 'scene') takeScene(answer);
}

/** Saves to the scene's file; a scene without one asks for a name.
 * @param {boolean} [force] also over a file that was changed elsewhere */
export async function save(force = false) {
  const { scene } = state;
  if (!scene) return;
  if (scene.file === null) {
    saveAs();
    return;
  }
  try {
    await ask(force ? { force } : {});
    tell(`${baseName(scene.file)} is saved.`);
  } catch (error) {
    const text = error instanceof Error ? error.message : String(error);
    const other = { name: 'Save as…', run: saveAs };
    tell(text, 'bad', force ? [other] : [{ name: 'Save all the same', run: () => void save(true) }, other]);
  }
}

/** Asks for the name of another file. */
export function saveAs() {
  if (state.scene) openDialog(SaveAs);
}

function SaveAs() {
  const [name, setName] = useState(state.scene?.file ? fileName('-2.json') : fileName('.json'));
  const [refused, setRefused] = useState('');
  const send = async (/** @type {boolean} */ force) => {
    const as = /\.json$/i.test(name.trim()) ? name.trim() : `${name.trim()}.json`;
    try {
      await ask(force ? { as, force } : { as });
      closeDialog();
      tell(`The scene is saved as ${as}.`);
    } catch (error) {
      setRefused(error instanceof Error ? error.message : String(error));
    }
  };
  return html`<${Dialog} title="Save as">
    <form class="save-as" onSubmit=${(/** @type {Event} */ event) => {
      event.preventDefault();
      void send(false);
    }}>
      <label for="save-name">name of the file</label>
      <input id="save-name" value=${name} autocomplete="off" spellcheck=${false} autofocus required
        aria-invalid=${refused ? 'true' : undefined} aria-describedby="save-where"
        onInput=${(/** @type {any} */ event) => {
          setName(event.currentTarget.value);
          setRefused('');
        }} />
      <p class="quiet" id="save-where">${state.scene?.file ? `In the folder of ${state.scene.file}.`
        : 'In the folder where the program was started.'} It becomes the file of the scene.</p>
      ${refused && html`<p class="problem" role="alert">${refused}</p>`}
      <div class="buttons">
        <button>Save</button>
        ${refused && html`<button type="button" onClick=${() => void send(true)}>Save all the same</button>`}
      </div>
    </form>
  <//>`;
}
