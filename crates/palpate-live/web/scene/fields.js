// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * A field as the card needs it: texts, textures and uniforms.
 *
 * @typedef {import('../wire.js').Grid} Grid
 * @typedef {import('./program.js').Value} Value
 * @typedef {import('./setting.js').Setting} Setting
 */

import { colorsInUse } from './colors.js';
import { flat, space } from './glsl.js';

/** The colours of the bodies, and their promises in the last channel: outside + 4·inside.
 * @param {Setting} setting */
function paletteOf({ bodies }) {
  const all = bodies.length > 0 ? bodies : [{ color: colorsInUse().outside, promises: [0, 0] }];
  return new Uint8Array(all.flatMap(({ color, promises: [outside, inside] }) =>
    [...color.map((part) => Math.round(255 * part)), outside + 4 * inside]));
}

export class Field {
  /** @param {string} text that defines the function `field` @param {Setting} setting
   * @param {Grid[]} grids samples that the text reads @param {Record<string, Value>} values its
   *   uniforms @param {boolean} isUrgent whether it is wanted in the middle of a drag */
  constructor(text, setting, grids, values, isUrgent) {
    const { dimension } = setting;
    this.dimension = dimension;
    this.text = text;
    /** Texts of programs that were made. @type {Map<string, string>} */
    this.programs = new Map();
    this.isUrgent = isUrgent;
    this.grids = grids;
    this.palette = paletteOf(setting);
    this.values = { zero: 0, palette: 0, grid0: 1, grid1: 2, grid2: 3, ...values };
    /** @type {WebGLTexture[]} */
    this.textures = [];
    this.epoch = -1;
  }

  /** The text of the program for a panel; empty where there is none.
   * @param {import('./layer.js').Panel} panel */
  program({ kind, map }) {
    const key = kind === 'space' ? kind : `${kind} ${map}`;
    let program = this.programs.get(key);
    if (program === undefined) {
      const { text, dimension } = this;
      program = kind === 'flat' ? flat(text, dimension, map)
        : dimension === 3 ? space(text, kind === 'slice', map) : '';
      this.programs.set(key, program);
    }
    return program;
  }

  /** Binds its textures, and gives its uniforms.
   * @param {WebGL2RenderingContext} gl @param {number} epoch of the context: textures are lost
   *   with it */
  bind(gl, epoch) {
    if (this.epoch !== epoch) {
      this.epoch = epoch;
      this.textures = [this.upload(gl, null), ...this.grids.map((grid) => this.upload(gl, grid))];
    }
    this.textures.forEach((texture, index) => {
      gl.activeTexture(gl.TEXTURE0 + index);
      gl.bindTexture(kindOf(gl, this.grids[index - 1]), texture);
    });
    return this.values;
  }

  /** Makes the texture of a grid, or of the palette. @param {WebGL2RenderingContext} gl
   * @param {Grid | null} grid */
  upload(gl, grid) {
    const texture = gl.createTexture();
    const kind = kindOf(gl, grid);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(kind, texture);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    // Pairs of a number and a value are read one by one.
    const isPaired = grid !== null && grid.values.length > grid.counts.reduce((all, count) => all * count);
    const filter = grid && !isPaired ? gl.LINEAR : gl.NEAREST;
    gl.texParameteri(kind, gl.TEXTURE_MIN_FILTER, filter);
    gl.texParameteri(kind, gl.TEXTURE_MAG_FILTER, filter);
    for (const wrap of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T, gl.TEXTURE_WRAP_R]) {
      if (wrap !== gl.TEXTURE_WRAP_R || kind === gl.TEXTURE_3D) {
        gl.texParameteri(kind, wrap, gl.CLAMP_TO_EDGE);
      }
    }
    if (!grid) {
      const count = this.palette.length / 4;
      gl.texImage2D(kind, 0, gl.RGBA8, count, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, this.palette);
      return texture;
    }
    const [width, height, depth] = grid.counts;
    const [half, single] = isPaired ? [gl.RG16F, gl.RG32F] : [gl.R16F, gl.R32F];
    const inner = grid.half ? half : single;
    const format = isPaired ? gl.RG : gl.RED;
    const type = grid.half ? gl.HALF_FLOAT : gl.FLOAT;
    if (kind === gl.TEXTURE_3D) {
      gl.texImage3D(kind, 0, inner, width, height, depth, 0, format, type, grid.values);
    } else {
      gl.texImage2D(kind, 0, inner, width, height, 0, format, type, grid.values);
    }
    return texture;
  }

  /** Gives its textures back. @param {WebGL2RenderingContext} gl */
  free(gl) {
    for (const texture of this.textures) gl.deleteTexture(texture);
    this.textures = [];
    this.epoch = -1;
  }
}

/** @param {WebGL2RenderingContext} gl @param {Grid | null | undefined} grid */
function kindOf(gl, grid) {
  return grid?.dimension === 3 ? gl.TEXTURE_3D : gl.TEXTURE_2D;
}
