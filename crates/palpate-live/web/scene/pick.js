// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * What a pixel of the scene shows: asked of the program that draws it, with one pixel of four
 * floats as its target, and read back without waiting for the card.
 *
 * @typedef {import('./layer.js').Layer} Layer
 * @typedef {import('./layer.js').Panel} Panel
 * @typedef {import('./vectors.js').Vector} Vector
 */

/** How often the card is asked whether it is done [ms]. */
const POLL = 3;

/** Creates the function that picks: the point of the surface that is seen at a place of a
 * panel, or null where there is none, or no card to ask.
 * @param {Layer} layer
 * @returns {(panel: Panel, x: number, y: number) => Promise<{ point: Vector, body: number } | null>} */
export function createPick(layer) {
  /** The pixel, null where the card has none of floats, and the losses of its context.
   * @type {{ frame: WebGLFramebuffer | null, losses: number }} */
  let target = { frame: null, losses: -1 };

  /** @param {WebGL2RenderingContext} gl */
  function targetOf(gl) {
    if (target.losses === layer.losses) return target.frame;
    const texture = gl.createTexture();
    gl.activeTexture(gl.TEXTURE7);
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA32F, 1, 1);
    const frame = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texture, 0);
    const isComplete = gl.checkFramebufferStatus(gl.FRAMEBUFFER) === gl.FRAMEBUFFER_COMPLETE;
    target = { frame: isComplete ? frame : null, losses: layer.losses };
    return target.frame;
  }

  return async (panel, x, y) => {
    const { gl, field, programs } = layer;
    if (!gl || !field || !programs || gl.isContextLost() || panel.kind === 'flat') return null;
    const program = programs.get(field.program(panel));
    const frame = program.isReady() ? targetOf(gl) : null;
    if (!frame) return null;
    gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
    gl.viewport(0, 0, 1, 1);
    gl.disable(gl.SCISSOR_TEST);
    program.use();
    const { rect, values } = panel;
    program.set({
      ...values,
      ...field.bind(gl, layer.losses),
      viewport: [rect.width, rect.height],
      lowerLeft: [0.5 - (x - rect.x), 0.5 - (rect.y + rect.height - y)],
      cone: Number(values.cone) / rect.height,
      picking: true,
    });
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    program.set({ picking: false });
    const buffer = gl.createBuffer();
    gl.bindBuffer(gl.PIXEL_PACK_BUFFER, buffer);
    gl.bufferData(gl.PIXEL_PACK_BUFFER, 16, gl.STREAM_READ);
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.FLOAT, 0);
    gl.bindBuffer(gl.PIXEL_PACK_BUFFER, null);
    const fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    gl.flush();
    while (fence && !gl.isContextLost()
      && gl.getSyncParameter(fence, gl.SYNC_STATUS) !== gl.SIGNALED) {
      await new Promise((resolve) => { setTimeout(resolve, POLL); });
    }
    const read = new Float32Array(4);
    gl.bindBuffer(gl.PIXEL_PACK_BUFFER, buffer);
    gl.getBufferSubData(gl.PIXEL_PACK_BUFFER, 0, read);
    gl.bindBuffer(gl.PIXEL_PACK_BUFFER, null);
    gl.deleteBuffer(buffer);
    gl.deleteSync(fence);
    if (gl.isContextLost() || read[3] < -1.5) return null;
    return { point: [...read.slice(0, 3)], body: read[3] };
  };
}
