// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * Scenes whose place another took, so that a person gets back to them.
 *
 * @typedef {import('../wire.js').Message} Message
 * @typedef {{ name: string, file: string | null, text: string, isEdited: boolean }} PreviousScene
 */

import { state } from '../state.js';
import { GALLERY } from './gallery.js';
import { baseName } from './saving.js';

/** Scenes that are kept, beside the first. */
const MOST = 4;

/** The first scene that was replaced in this page, then at most four later ones, the newest last.
 * @type {PreviousScene[]} */
let kept = [];

/** Keeps a scene whose place another takes. @param {Message | null} previous @param {Message} scene */
export function keepBefore(previous, scene) {
  if (!previous || scene.by !== 'open' || scene.text === previous.text) return;
  const { file, text, is_saved: isSaved } = previous;
  const name = baseName(file ?? previous.name);
  if (isSaved && GALLERY.some(([made]) => made === name)) return;
  const entry = { name, file, text, isEdited: !isSaved };
  const at = kept.findIndex((other) => other.name === name && other.file === file);
  if (at >= 0) kept[at] = entry;
  else kept = [...kept.slice(0, 1), ...kept.slice(1).slice(1 - MOST), entry];
}

/** The scenes that were open before, without that which is open now. */
export const openedBefore = () => kept.filter(({ text }) => text !== state.scene?.text);
