// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * What places of the scene show: asked of the program that draws them, with a pixel of four floats
 * for each as its target, and read back without waiting for the card. Where there is no card, the
 * core follows the lines of sight.
 *
 * @typedef {import('../wire.js').Wire} Wire
 * @typedef {import('../input/pointer.js').Place} Place
 * @typedef {import('./layer.js').Layer} Layer
 * @typedef {import('./panels.js').View} View
 * @typedef {import('./vectors.js').Vector} Vector
 * @typedef {{ point: Vector, body: number }} Hit the number of the body is −1 where it is not known
 */

import { NOTHING } from './glsl.js';
import { setting } from './setting.js';
import { along, norm, scale, subtract, unit } from './vectors.js';

/** How often the card is asked whether it is done [ms]. */
const POLL = 3;
/** Places that are looked at together. */
export const MOST_PLACES = 64;
/** Numbers of a pixel. */
const CHANNELS = 4;
/** How far lines of sight reach behind the middle of the scene, over its size. */
const BEYOND = 2;

/** Asks the core where the line of sight through a place first meets the scene: all of it, as its pictures
 * are not cut by the plane. Fails where the core cannot tell within its budget.
 * @param {Wire} wire @param {View} view @param {Place} place @returns {Promise<Hit | null>} */
async function cast(wire, { lens }, { x, y }) {
  const { centre, size } = setting();
  const { eye } = lens.basis;
  const reach = norm(subtract(centre, eye)) + BEYOND * size;
  const by = scale(unit(subtract(lens.at(x, y, centre), eye)), reach);
  const { touches, upper } = await wire.ask({ do: 'sweep', corners: [eye], by });
  if (touches === false) return null;
  if (upper === null) throw new Error('the budget is spent');
  return { point: along(eye, by, upper), body: -1 };
}

/** Creates the function that picks: for each place of a view the point of the surface that is seen
 * there, null where there is none, undefined where that is not known; null while nothing can tell.
 * @param {Layer} layer @param {Wire} wire
 * @returns {(view: View, places: Place[]) => Promise<(Hit | null | undefined)[] | null>} */
export function createPick(layer, wire) {
  /** The pixels, null where the card has none of floats, and the losses of its context.
   * @type {{ frame: WebGLFramebuffer | null, losses: number }} */
  let target = { frame: null, losses: -1 };

  /** @param {WebGL2RenderingContext} gl */
  function targetOf(gl) {
    if (target.losses === layer.losses) return target.frame;
    const texture = gl.createTexture();
    gl.activeTexture(gl.TEXTURE7);
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA32F, MOST_PLACES, 1);
    const frame = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texture, 0);
    const isComplete = gl.checkFramebufferStatus(gl.FRAMEBUFFER) === gl.FRAMEBUFFER_COMPLETE;
    target = { frame: isComplete ? frame : null, losses: layer.losses };
    return target.frame;
  }

  return async (view, places) => {
    const { panel } = view;
    const { gl, field, programs } = layer;
    if (panel.kind === 'flat') return null;
    if (!gl) return Promise.all(places.map((place) => cast(wire, view, place).catch(() => undefined)));
    if (!field || !programs || gl.isContextLost()) return null;
    const program = programs.get(field.program(panel));
    const frame = program.isReady() ? targetOf(gl) : null;
    if (!frame) return null;
    gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
    gl.disable(gl.SCISSOR_TEST);
    program.use();
    const { rect, values } = panel;
    program.set({
      ...values,
      ...field.bind(gl, layer.losses),
      viewport: [rect.width, rect.height],
      cone: Number(values.cone) / rect.height,
      picking: true,
    });
    places.forEach(({ x, y }, index) => {
      gl.viewport(index, 0, 1, 1);
      program.set({ lowerLeft: [index + 0.5 - (x - rect.x), 0.5 - (rect.y + rect.height - y)] });
      gl.drawArrays(gl.TRIANGLES, 0, 3);
    });
    program.set({ picking: false });
    const read = new Float32Array(CHANNELS * places.length);
    const buffer = gl.createBuffer();
    gl.bindBuffer(gl.PIXEL_PACK_BUFFER, buffer);
    gl.bufferData(gl.PIXEL_PACK_BUFFER, read.byteLength, gl.STREAM_READ);
    gl.readPixels(0, 0, places.length, 1, gl.RGBA, gl.FLOAT, 0);
    gl.bindBuffer(gl.PIXEL_PACK_BUFFER, null);
    const fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    gl.flush();
    while (fence && !gl.isContextLost()
      && gl.getSyncParameter(fence, gl.SYNC_STATUS) !== gl.SIGNALED) {
      await new Promise((resolve) => { setTimeout(resolve, POLL); });
    }
    gl.bindBuffer(gl.PIXEL_PACK_BUFFER, buffer);
    gl.getBufferSubData(gl.PIXEL_PACK_BUFFER, 0, read);
    gl.bindBuffer(gl.PIXEL_PACK_BUFFER, null);
    gl.deleteBuffer(buffer);
    gl.deleteSync(fence);
    if (gl.isContextLost()) return null;
    return places.map((_, index) => {
      const [x, y, z, body] = read.subarray(CHANNELS * index, CHANNELS * (index + 1));
      return body === NOTHING ? null : { point: [x, y, z], body };
    });
  };
}
