// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/** The scene is saved to its file, or to another one. */

import { state } from '../state.js';
import { html, useState } from '../vendor/htm-preact.js';
import { Dialog, closeDialog, openDialog } from './dialog.js';
import { fileName, page, reasonOf, tell } from './page.js';

/** The last part of a path. @param {string | null | undefined} path */
export function baseName(path) {
  return (path ?? '').replace(/^.*[\\/]/, '');
}

/** Writes the scene to a file. @param {{ as?: string, force?: boolean }} [more] */
export async function write(more = {}) {
  await page.wire?.ask({ do: 'save', ...more });
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
    await write({ force });
    tell(`${baseName(scene.file)} is saved.`);
  } catch (error) {
    const other = { name: 'Save as…', run: saveAs };
    tell(reasonOf(error), 'bad', force ? [other] : [{ name: 'Save all the same', run: () => void save(true) }, other]);
  }
}

/** Asks for the name of another file. @param {() => void} [then] what follows once it is written */
export function saveAs(then) {
  if (state.scene) openDialog(() => html`<${SaveAs} then=${then} />`);
}

/** @param {{ then?: () => void }} given */
function SaveAs({ then }) {
  const [name, setName] = useState(state.scene?.file ? fileName('-2.json') : fileName('.json'));
  const [refused, setRefused] = useState('');
  const given = name.trim();
  const as = given === '' || given.endsWith('.json') ? given : `${given}.json`;
  const send = async (/** @type {boolean} */ force) => {
    try {
      await write({ as, force });
      closeDialog();
      tell(`The scene is saved as ${as}.`);
      then?.();
    } catch (error) {
      setRefused(reasonOf(error));
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
      <p role="status">${as !== given && html`A scene file ends in .json: the name will be <b>${as}</b>.`}</p>
      ${refused && html`<p class="problem" role="alert">${refused}</p>`}
      <div class="buttons">
        <button>Save</button>
        ${refused && html`<button type="button" onClick=${() => void send(true)}>Save all the same</button>`}
      </div>
    </form>
  <//>`;
}
