// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

/**
 * Compares shaders with the core: each formula at 4096 points, against the values that the core
 * has in single precision. Arguments: a folder with cases.json, points.f32 and values.f32.
 */

import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { browser } from './harness.mjs';

/** The largest difference, in units in the last place of the size. */
const MOST_ULP = 4;
/** Values nearer to zero may have either sign, as parts of the size. */
const NEAR_ZERO = 1e-5;

const folder = process.argv[2];
/** @type {{ name: string, glsl: string, dimension: number, size: number }[]} */
const cases = JSON.parse(readFileSync(join(folder, 'cases.json'), 'utf8'));
const floats = (name) => {
  const bytes = readFileSync(join(folder, name));
  return new Float32Array(bytes.buffer, bytes.byteOffset, bytes.byteLength / 4);
};
const [points, values] = [floats('points.f32'), floats('values.f32')];
const SIDE = 64;
const COUNT = SIDE * SIDE;

/** Evaluates a formula at points in the page. */
const evaluate = ({ glsl, dimension, points: base64, side }) => {
  const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
  const points = new Float32Array(bytes.buffer);
  const gl = (window.gl ??= document.createElement('canvas').getContext('webgl2'));
  gl.getExtension('EXT_color_buffer_float');
  const shader = (kind, text) => {
    const made = gl.createShader(kind);
    gl.shaderSource(made, text);
    gl.compileShader(made);
    return made;
  };
  const program = gl.createProgram();
  const vertex = '#version 300 es\nin vec2 a; void main() { gl_Position = vec4(a, 0.0, 1.0); }';
  const swizzle = 'xyz'.slice(0, dimension);
  const fragment = `#version 300 es\nprecision highp float; precision highp int;
    uniform highp sampler2D points; out vec4 result;
    ${glsl}
    void main() { result = vec4(field(texelFetch(points, ivec2(gl_FragCoord.xy), 0).${swizzle}, -1), 0.0, 0.0); }`;
  const parts = [shader(gl.VERTEX_SHADER, vertex), shader(gl.FRAGMENT_SHADER, fragment)];
  parts.forEach((part) => gl.attachShader(program, part));
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) {
    return { error: `${gl.getShaderInfoLog(parts[1])} ${gl.getProgramInfoLog(program)}` };
  }
  const texture = (data, unit) => {
    const made = gl.createTexture();
    gl.activeTexture(gl.TEXTURE0 + unit);
    gl.bindTexture(gl.TEXTURE_2D, made);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, side, side, 0, gl.RGBA, gl.FLOAT, data);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
    return made;
  };
  const source = texture(points, 0);
  const target = texture(null, 1);
  const frame = gl.createFramebuffer();
  gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
  gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, target, 0);
  gl.viewport(0, 0, side, side);
  gl.useProgram(program);
  gl.uniform1i(gl.getUniformLocation(program, 'points'), 0);
  const corners = gl.createBuffer();
  gl.bindBuffer(gl.ARRAY_BUFFER, corners);
  gl.bufferData(gl.ARRAY_BUFFER, new Float32Array([-1, -1, 3, -1, -1, 3]), gl.STATIC_DRAW);
  gl.enableVertexAttribArray(0);
  gl.vertexAttribPointer(0, 2, gl.FLOAT, false, 0, 0);
  gl.drawArrays(gl.TRIANGLES, 0, 3);
  const result = new Float32Array(4 * side * side);
  gl.readPixels(0, 0, side, side, gl.RGBA, gl.FLOAT, result);
  [source, target].forEach((made) => gl.deleteTexture(made));
  gl.deleteFramebuffer(frame);
  gl.deleteProgram(program);
  return { values: Array.from({ length: side * side }, (_, i) => result[4 * i]), lost: gl.isContextLost() };
};

const opened = await browser();
const page = await opened.newPage();
const wrong = [];
let worst = { ulp: 0, name: '' };
for (const [index, { name, glsl, dimension, size }] of cases.entries()) {
  const part = points.subarray(4 * COUNT * index, 4 * COUNT * (index + 1));
  const base64 = Buffer.from(part.buffer, part.byteOffset, part.byteLength).toString('base64');
  const found = await page.evaluate(evaluate, { glsl, dimension, points: base64, side: SIDE });
  if (found.error || found.lost) {
    wrong.push(`${name} does not compile: ${found.error}`);
    continue;
  }
  const ulp = 2 ** -23 * size;
  let most = 0;
  for (let i = 0; i < COUNT; i += 1) {
    const [shader, core] = [found.values[i], values[COUNT * index + i]];
    const apart = Math.abs(shader - core) / ulp;
    // Written so that NaN is wrong.
    if (!(apart <= MOST_ULP) || (shader < 0 !== core < 0 && Math.abs(core) > NEAR_ZERO * size)) {
      const at = Array.from(part.subarray(4 * i, 4 * i + dimension));
      wrong.push(`${name} at ${at}: ${shader} in the shader, ${core} in the core, ${apart.toFixed(1)} ulp apart`);
      break;
    }
    most = Math.max(most, apart);
  }
  if (most > worst.ulp) worst = { ulp: most, name };
}
await opened.close();
console.log(`${cases.length} formulas, at most ${worst.ulp.toFixed(2)} ulp of the size apart (${worst.name})`);
wrong.forEach((line) => console.log(line));
process.exit(wrong.length > 0 ? 1 : 0);
