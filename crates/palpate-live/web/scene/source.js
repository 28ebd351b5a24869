// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * Where the values of the scene come from: its formula, samples of it, or, where there is
 * neither, pictures and slices that the program makes.
 *
 * @typedef {import('../wire.js').Wire} Wire
 * @typedef {import('../wire.js').Grid} Grid
 * @typedef {import('./setting.js').Setting} Setting
 */

import { state } from '../state.js';
import { Field } from './fields.js';
import { samples } from './glsl.js';
import { Nearest } from './nearest.js';
import { asking, newest } from './newest.js';
import { length } from './units.js';
import { inSpace } from './vectors.js';

/** Samples along the longest side: of a scene that stands, and of one that is being changed. */
const CELLS = { plane: [1024, 256], space: [128, 64] };
/** How long nothing changes before fine samples are asked for [ms]. */
const SETTLE = 300;

/** Samples along the longest side that tell bodies apart, and the most bodies that have some. */
const OWNERS = { plane: 256, space: 64, most: 128 };

export class Source {
  /** @param {Wire} wire @param {(field: Field) => void} take takes a field that can be drawn */
  constructor(wire, take) {
    this.questions = asking(wire);
    this.take = take;
    /** @type {'formula' | 'samples' | 'drawn'} */
    this.kind = 'drawn';
    /** Between samples [m]. */
    this.spacing = 0;
    /** @type {Setting | null} */
    this.setting = null;
    this.settling = 0;
    /** Whether coarse samples do. */
    this.isCoarse = true;
    this.text = '';
    /** Which scene it is, as `state.opened` counts. */
    this.opened = 0;
    /** Why the formula could not be used. */
    this.failure = '';
    /** What tells the bodies apart. @type {Nearest | null} */
    this.owners = null;
    this.ask = newest(() => this.fetch());
  }

  /** Whether the program draws the scene: for a browser that cannot, or until its samples are here. */
  get isDrawn() {
    return this.kind === 'drawn' || (this.kind === 'samples' && this.spacing === 0);
  }

  /** The way that the scene is drawn, in words. */
  get words() {
    if (this.kind === 'formula') return 'formula, exact';
    if (this.kind === 'drawn') return 'drawn by the program';
    return this.isDrawn ? 'drawn by the program, waiting for samples' : `drawn from samples ${length(this.spacing)} apart`;
  }

  get why() {
    if (!state.hasCard) return 'this browser draws no WebGL 2';
    return this.failure || String(state.way?.why ?? '');
  }

  /** Takes the newest scene and way. @param {Setting} setting */
  update(setting) {
    const { way } = state;
    this.setting = setting;
    if (way?.glsl !== this.text) this.failure = '';
    if (state.opened !== this.opened) {
      this.opened = state.opened;
      this.spacing = 0;
      this.owners = null;
    }
    this.text = way?.glsl ?? '';
    const kind = way?.kind ?? 'drawn';
    this.kind = kind === 'formula' && this.failure ? 'samples' : kind;
    if (!state.hasCard) this.kind = 'drawn';
    if (this.kind === 'formula') {
      /** @type {number[]} */
      const u = way?.uniforms ?? [];
      // The text has uniforms while a control is dragged.
      this.take(new Field(this.text, setting, [], { u }, u.length > 0));
    }
    if (this.kind === 'samples') this.renew();
    else clearTimeout(this.settling);
  }

  /** Asks for coarse samples at once, and for fine ones when the scene has settled. */
  renew() {
    clearTimeout(this.settling);
    // Fine samples of what the scene was may take long, and nobody waits for them any more.
    if (!this.isCoarse) this.questions.giveUp();
    this.isCoarse = true;
    this.ask(undefined);
    this.settling = window.setTimeout(() => {
      this.isCoarse = false;
      this.ask(undefined);
    }, SETTLE);
  }

  /** The card refused the formula: samples do as well. @param {string} why */
  fail(why) {
    const line = why.split('\n').find((each) => each.startsWith('ERROR')) ?? why;
    this.failure = `the browser did not take the formula: ${line}`;
    if (this.setting) this.update(this.setting);
  }

  /** Fetches samples of the newest scene. */
  async fetch() {
    const { setting } = this;
    if (!setting) return;
    const { isCoarse } = this;
    const [fine, coarse] = setting.dimension === 2 ? CELLS.plane : CELLS.space;
    const cells = isCoarse ? coarse : fine;
    const bodies = state.view.mode === 'compare' ? state.view.compared : [];
    /** @type {Grid[]} */
    const grids = [await this.questions.ask({ do: 'samples', cells })];
    for (const body of bodies) grids.push(await this.questions.ask({ do: 'samples', cells, body }));
    const count = setting.bodies.length;
    const isTelling = bodies.length === 0 && count > 1 && count <= OWNERS.most;
    // While the scene is being changed, bodies are told apart by what they were before.
    if (!isTelling || this.owners?.count !== count) this.owners = null;
    this.takeSamples(grids, bodies, setting);
    if (!isTelling || isCoarse) return;
    /** @type {Nearest | null} */
    let owners = null;
    for (let body = 0; body < count; body += 1) {
      const places = setting.dimension === 2 ? OWNERS.plane : OWNERS.space;
      const grid = await this.questions.ask({ do: 'samples', cells: places, body });
      owners ??= new Nearest(grid);
      owners.take(grid);
    }
    this.owners = owners;
    this.takeSamples(grids, bodies, setting);
  }

  /** @param {Grid[]} grids of the scene, and of two bodies if they are compared
   * @param {number[]} bodies @param {Setting} setting */
  takeSamples(grids, bodies, setting) {
    const { counts, first, last } = grids[0];
    this.spacing = Math.max(...counts.slice(0, setting.dimension).map((count, axis) =>
      (last[axis] - first[axis]) / Math.max(count - 1, 1)));
    const owners = this.owners?.grid;
    const three = [0, 1, 2].map((index) => grids[index] ?? grids[0]);
    const values = {
      gridLow: three.map((grid) => inSpace(grid.first)),
      gridHigh: three.map((grid) => inSpace(grid.last)),
      firstBody: bodies[0] ?? 0,
      // Units 1 to 3 hold the grids.
      ...(bodies.length === 0 ? { grid1: 1, grid2: 1 } : {}),
      ...(owners && { owners: 2, ownersLow: inSpace(owners.first), ownersHigh: inSpace(owners.last) }),
    };
    const text = samples(setting.dimension, owners !== undefined);
    this.take(new Field(text, setting, owners ? [...grids, owners] : grids, values, true));
  }
}
