// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * The address: the token that comes in it, and links that hold the view and the scene, never
 * the token.
 */

import { setView, state } from '../state.js';
import { openText } from './actions.js';
import { page, tell } from './page.js';
import { MAPS, MODES, MOST_SINE } from './view.js';

const KEY = 'palpate-token';

/** The token of the address, or that of before a reload; and what else the address holds. */
export function takeAddress() {
  const [first, ...rest] = location.hash.slice(1).split('&');
  const token = first.includes('=') ? '' : first;
  const given = new URLSearchParams((token === '' ? [first, ...rest] : rest).join('&'));
  if (token !== '') sessionStorage.setItem(KEY, token);
  history.replaceState(null, '', location.pathname);
  return { token: token || (sessionStorage.getItem(KEY) ?? ''), given };
}

/** Takes a token that was typed or pasted, alone or within the address. @param {string} text */
export function tokenIn(text) {
  const token = text.trim().replace(/^.*#/, '').replace(/&.*$/, '');
  if (token !== '') sessionStorage.setItem(KEY, token);
  return token;
}

/** @param {Blob} blob */
async function bytesOf(blob) {
  return new Uint8Array(await blob.arrayBuffer());
}

/** @param {string} text */
async function packed(text) {
  const stream = new Blob([text]).stream().pipeThrough(new CompressionStream('deflate-raw'));
  const bytes = await bytesOf(await new Response(stream).blob());
  let letters = '';
  for (const byte of bytes) letters += String.fromCharCode(byte);
  return btoa(letters).replace(/\+/g, '-').replace(/\//g, '_').replace(/=+$/, '');
}

/** @param {string} text */
async function unpacked(text) {
  const bytes = Uint8Array.from(atob(text.replace(/-/g, '+').replace(/_/g, '/')), (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate-raw'));
  return new Response(stream).text();
}

/** An address that shows this view of this scene. */
export async function makeLink() {
  const given = new URLSearchParams({ view: JSON.stringify(state.view), name: state.scene?.name ?? 'scene' });
  given.set('scene', await packed(state.scene?.text ?? JSON.stringify(state.scene?.scene)));
  return `${location.origin}${location.pathname}#${given}`;
}

/** Shows what a link holds; a scene only after a person agreed.
 * @param {URLSearchParams} given */
export async function followLink(given) {
  try {
    const view = given.get('view');
    if (view) setView(known(JSON.parse(view)));
    const scene = given.get('scene');
    if (!scene) return;
    const text = await unpacked(scene);
    const name = given.get('name') ?? 'scene';
    tell(`The link holds the scene ${name}. It would replace the one that is open.`, 'word',
      [{ name: 'Open it', run: () => void openText(name, text) }]);
  } catch {
    tell('The link cannot be read: a part of it may be missing.', 'bad');
  }
}

/** A length, or null for one that the page chooses. @param {any} value */
const isLength = (value) => value === null || (value > 0 && value < Infinity);

/** What a part of the view must be, besides being of the type that it has here.
 * @type {Record<string, (value: any) => boolean>} */
const ALLOWED = {
  mode: (value) => MODES.some(([mode]) => mode === value),
  map: (value) => MAPS.some(([map]) => map === value),
  sineFactor: (value) => value >= 0 && value <= MOST_SINE,
  spacing: isLength,
  offset: isLength,
  compared: (value) => value.every((/** @type {number} */ body) => Number.isInteger(body) && body >= 0),
};

/** What is given in place of what the page has; what it does not have, or has with another type, is
 * passed over. @param {any} own @param {any} given @returns {any} */
function fitting(own, given) {
  if (own === null) return typeof given === 'number' ? given : null;
  if (typeof own !== 'object') return typeof given === typeof own ? given : own;
  const parts = Object.entries(own).map(([key, part]) => [key, fitting(part, given?.[key])]);
  return Array.isArray(own) ? parts.map(([, part]) => part) : Object.fromEntries(parts);
}

/** The view that a link gives, as far as the page knows it. @param {any} given */
function known(given) {
  const view = fitting(state.view, given);
  return Object.fromEntries(Object.entries(view).filter(([key, value]) => ALLOWED[key]?.(value) ?? true));
}

/** Copies a link, or shows it in a field where the browser does not let a page copy. */
export async function copyLink() {
  const link = await makeLink();
  if (navigator.clipboard) {
    await navigator.clipboard.writeText(link);
    tell('The link is copied. It holds the view and the scene, not the token.');
  } else {
    page.shownLink = link;
    tell('The browser copies only from secure pages: open the menu to take the link from there.');
  }
}
