// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * Programs of the graphics card: compiled once a text, while the last picture stays, and their
 * uniforms set by name.
 *
 * @typedef {number | boolean | number[] | number[][]} Value
 */

import { VERTEX } from './glsl.js';

/** Programs that are kept. */
const KEPT = 16;

/** A program that is linked, or is about to be. */
export class Program {
  /** @param {WebGL2RenderingContext} gl @param {string} text @param {boolean} isParallel */
  constructor(gl, text, isParallel) {
    this.gl = gl;
    this.program = gl.createProgram();
    this.isParallel = isParallel;
    this.isLinked = false;
    /** Why it cannot be used. */
    this.error = '';
    /** @type {Map<string, { at: WebGLUniformLocation, type: number }>} */
    this.uniforms = new Map();
    this.shaders = [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, text]].map(
      ([kind, source]) => {
        const shader = /** @type {WebGLShader} */ (gl.createShader(Number(kind)));
        gl.shaderSource(shader, String(source));
        gl.compileShader(shader);
        gl.attachShader(this.program, shader);
        return shader;
      },
    );
    gl.linkProgram(this.program);
  }

  /** Whether it can be used; does not wait where the driver compiles beside the page. */
  isReady() {
    const { gl, program } = this;
    if (this.isLinked) return true;
    // COMPLETION_STATUS_KHR
    if (this.error || (this.isParallel && !gl.getProgramParameter(program, 0x91b1))) return false;
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) {
      // A lost context refuses everything, and says nothing about the text.
      if (!gl.isContextLost()) {
        const logs = this.shaders.map((shader) => gl.getShaderInfoLog(shader));
        this.error = [gl.getProgramInfoLog(program), ...logs].join('\n').trim() || 'no reason given';
      }
      return false;
    }
    for (const shader of this.shaders) gl.deleteShader(shader);
    for (let i = 0; i < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); i += 1) {
      const info = gl.getActiveUniform(program, i);
      const at = info && gl.getUniformLocation(program, info.name);
      if (info && at) this.uniforms.set(info.name.replace('[0]', ''), { at, type: info.type });
    }
    this.isLinked = true;
    return true;
  }

  use() {
    this.gl.useProgram(this.program);
  }

  /** Sets uniforms of the program in use; names that it does not have are passed over.
   * @param {Record<string, Value>} values */
  set(values) {
    const { gl } = this;
    for (const [name, value] of Object.entries(values)) {
      const uniform = this.uniforms.get(name);
      if (!uniform) continue;
      const { at, type } = uniform;
      const numbers = Array.isArray(value) ? value.flat() : [Number(value)];
      if (type === gl.FLOAT) gl.uniform1fv(at, numbers);
      else if (type === gl.FLOAT_VEC2) gl.uniform2fv(at, numbers);
      else if (type === gl.FLOAT_VEC3) gl.uniform3fv(at, numbers);
      else gl.uniform1iv(at, numbers);
    }
  }
}

/** Programs by their text. */
export class Programs {
  /** @param {WebGL2RenderingContext} gl */
  constructor(gl) {
    this.gl = gl;
    this.isParallel = gl.getExtension('KHR_parallel_shader_compile') !== null;
    /** @type {Map<string, Program>} */
    this.kept = new Map();
  }

  /** The program of a text, perhaps not ready yet. @param {string} text */
  get(text) {
    const known = this.kept.get(text);
    const program = known ?? new Program(this.gl, text, this.isParallel);
    this.kept.delete(text);
    this.kept.set(text, program);
    const [oldest] = this.kept.keys();
    if (this.kept.size > KEPT) {
      this.gl.deleteProgram(this.kept.get(oldest)?.program ?? null);
      this.kept.delete(oldest);
    }
    return program;
  }

  /** @param {string} text */
  has(text) {
    return this.kept.has(text);
  }
}
