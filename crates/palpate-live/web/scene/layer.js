// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * The scene layer: panels drawn by programs into a target that is kept, and shown from there.
 *
 * While the picture changes it is drawn with fewer pixels, as many as the card can draw in a
 * frame. Once it stands still it is refined tile by tile, with a fence after each batch, so that
 * neither the page nor the rest of the machine waits for it.
 *
 * @typedef {import('./camera.js').Rect} Rect
 * @typedef {import('./program.js').Value} Value
 * @typedef {import('./program.js').Program} Program
 * @typedef {'space' | 'slice' | 'flat'} Kind of a program: space, with or without a plane that
 *   cuts it, and the map of a plane
 * @typedef {{ kind: Kind, map: number, rect: Rect, values: Record<string, Value> }} Panel
 * @typedef {import('./fields.js').Field} Field
 */

import { Programs } from './program.js';

/** Parts of the full resolution, along each side. */
const SCALES = [1, 1 / 2, 1 / 4, 1 / 8];
/** The time in which a moving picture must be drawn [ms]. */
const FRAME = 20;
/** What a fence costs by itself [ms]. */
const FENCE = 3;
/** How long nothing may change before the picture is refined [ms]. */
const STILL = 120;
/** The edge of a tile in pixels of the target. */
const TILE = 128;
const MOST_TILES = 64;
/** Batches of tiles grow as long as they are drawn in this time [ms], about two frames. */
const QUICK = 36;
/** From one showing of a picture that is refined to the next [ms]: it costs as much as many tiles. */
const SHOWING = 200;
/** Where in a pixel its samples are, one a pass. */
const OFFSETS = [[0, 0], [0.25, -0.5], [-0.5, -0.25], [0.25, 0.375]];
/** If the first pass took longer than this, edges stay as they are [ms]. */
const SLOW_PASS = 1500;

/** Bottom to top, as the card counts. @param {Rect} rect @param {number} height */
const flipped = (rect, height) => ({ ...rect, y: height - rect.y - rect.height });

export class Layer {
  /** @param {HTMLCanvasElement} canvas
   * @param {(what: 'restored' | 'gone' | 'waiting' | 'error', why?: string) => void} tell */
  constructor(canvas, tell) {
    this.canvas = canvas;
    this.tell = tell;
    this.gl = canvas.getContext('webgl2', { antialias: false, depth: false, alpha: true });
    this.losses = 0;
    /** Pixels of the target a CSS pixel. */
    this.ratio = 1;
    /** The size of the whole picture in pixels. */
    this.width = 1;
    this.height = 1;
    /** @type {Panel[]} */
    this.panels = [];
    /** The field that is drawn, and one whose programs are not ready. @type {Field | null} */
    this.field = null;
    /** @type {Field | null} */
    this.next = null;
    /** The time of a full picture [ms]. @type {number | null} */
    this.cost = null;
    this.scale = SCALES[2];
    /** The scale of the picture that is shown. */
    this.shownScale = 1;
    this.isChanged = false;
    /** Whether the picture has all its pixels. */
    this.isDone = false;
    this.changedAt = 0;
    this.drawnAt = 0;
    /** @type {WebGLSync | null} */
    this.fence = null;
    this.isMoving = false;
    this.batch = 2;
    /** Tiles to draw, pass after pass. */
    this.tile = 0;
    this.tiles = 0;
    /** Whether tiles were drawn that are not shown yet. */
    this.isStale = false;
    /** When the picture was shown last [ms]. */
    this.shownAt = 0;
    this.passBegan = 0;
    this.lastTime = 0;
    canvas.addEventListener('webglcontextlost', (event) => {
      event.preventDefault();
      this.losses += 1;
      this.fence = null;
      if (this.losses > 1) {
        this.gl = null;
        tell('gone');
      }
    });
    canvas.addEventListener('webglcontextrestored', () => {
      if (!this.gl) return;
      this.prepare();
      tell('restored');
    });
    if (this.gl) this.prepare();
  }

  prepare() {
    const gl = /** @type {WebGL2RenderingContext} */ (this.gl);
    gl.getExtension('EXT_color_buffer_float');
    gl.getExtension('OES_texture_float_linear');
    this.timer = gl.getExtension('EXT_disjoint_timer_query_webgl2');
    /** Times the moving picture. @type {WebGLQuery | null} */
    this.query = null;
    this.programs = new Programs(gl);
    /** Programs that have drawn once: many drivers compile only then. */
    this.warm = new WeakSet();
    /** @type {WeakMap<Program, WebGLSync>} */
    this.warming = new WeakMap();
    this.targets = [0, 1].map(() => ({
      frame: gl.createFramebuffer(), pixels: gl.createRenderbuffer(),
    }));
    this.field = null;
    this.cost = null;
    this.resize();
  }

  /** Takes the size of the canvas on the page. */
  resize() {
    const { gl, canvas } = this;
    if (!gl || !this.targets) return;
    // A card that gave up once gets half of the work.
    const budget = this.losses > 0 ? Math.SQRT1_2 : 1;
    this.ratio = Math.min(devicePixelRatio || 1, 2) * budget;
    const width = Math.max(1, Math.round(canvas.clientWidth * this.ratio));
    const height = Math.max(1, Math.round(canvas.clientHeight * this.ratio));
    this.width = width;
    this.height = height;
    for (const { frame, pixels } of this.targets) {
      gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
      gl.bindRenderbuffer(gl.RENDERBUFFER, pixels);
      gl.renderbufferStorage(gl.RENDERBUFFER, gl.RGBA8, width, height);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.RENDERBUFFER, pixels);
    }
    this.change();
  }

  change() {
    this.isChanged = true;
    this.isDone = false;
    this.changedAt = performance.now();
  }

  /** Shows other panels, or another field. @param {Panel[]} panels @param {Field} field */
  show(panels, field) {
    this.panels = panels;
    this.next = field === this.field ? null : field;
    this.change();
  }

  /** Whether the programs of a field can draw; makes them if not. @param {Field} field
   * @param {boolean} makes whether to make them */
  canDraw(field, makes) {
    const texts = this.panels.map((panel) => field.program(panel));
    // A field in the plane has no program for space.
    if (texts.includes('')) return false;
    return texts.every((text, index) => {
      if (!makes && !this.programs?.has(text)) return false;
      const program = this.programs?.get(text);
      return program && (makes ? this.isWarm(program, field, this.panels[index]) : this.warm?.has(program));
    });
  }

  /** @param {Program} program @param {Field} field @param {Panel} panel */
  isWarm(program, field, panel) {
    const gl = /** @type {WebGL2RenderingContext} */ (this.gl);
    if (!program.isReady()) {
      if (program.error) {
        this.next = null;
        this.tell('error', program.error);
      }
      return false;
    }
    if (this.warm?.has(program)) return true;
    const begun = this.warming?.get(program);
    if (!begun) {
      const within = { x: 0, y: 0, width: this.width, height: this.height };
      this.draw({ ...panel, values: { ...panel.values, steps: 1 } }, 1 / 64, field, program, within);
      const fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
      if (fence) this.warming?.set(program, fence);
      gl.flush();
      return false;
    }
    if (!this.isSignalled(begun)) return false;
    gl.deleteSync(begun);
    this.warming?.delete(program);
    this.warm?.add(program);
    return true;
  }

  /** @param {WebGLSync} fence */
  isSignalled(fence) {
    const gl = /** @type {WebGL2RenderingContext} */ (this.gl);
    return gl.getSyncParameter(fence, gl.SYNC_STATUS) === gl.SIGNALED;
  }

  /** Does a frame's work. Whether there is more to do.
   * @param {boolean} isPressed whether a pointer is down: then only what is urgent is compiled */
  step(isPressed) {
    const { gl } = this;
    if (!gl || gl.isContextLost()) return false;
    if (this.fence && !this.isFinished()) return true;
    if (this.next && this.panels.length > 0 && (this.next.isUrgent || !isPressed || !this.field)) {
      if (this.canDraw(this.next, true)) {
        this.field?.free(gl);
        this.field = this.next;
        this.next = null;
        this.cost = null;
        this.change();
      }
    }
    const { field } = this;
    if (!field || this.panels.length === 0) return this.next !== null;
    // A field that is about to be replaced goes on with the programs that it has.
    if (!this.canDraw(field, this.next === null)) return true;
    const now = performance.now();
    if (this.isChanged) {
      this.isChanged = false;
      this.drawMoving(field);
      return true;
    }
    if (now - this.changedAt < STILL) return true;
    this.isDone = !this.refine(field, now);
    return !this.isDone || this.next !== null;
  }

  /** Whether the card has done what was asked last; learns from how long that took. */
  isFinished() {
    const gl = /** @type {WebGL2RenderingContext} */ (this.gl);
    const fence = /** @type {WebGLSync} */ (this.fence);
    if (!this.isSignalled(fence)) {
      return false;
    }
    gl.deleteSync(fence);
    this.fence = null;
    const time = performance.now() - this.drawnAt;
    if (this.isMoving) {
      this.learn(this.timeOfCard() ?? Math.max(time - FENCE, 0.2));
    } else {
      if (time < QUICK) this.batch = Math.min(2 * this.batch, MOST_TILES);
      if (time > 2 * QUICK) this.batch = Math.max(this.batch >> 1, 1);
    }
    return true;
  }

  /** What the card took for the moving picture itself [ms], without waiting behind the rest of
   * the page; null where it does not tell. */
  timeOfCard() {
    const gl = /** @type {WebGL2RenderingContext} */ (this.gl);
    const { query, timer } = this;
    this.query = null;
    if (!query || !timer) return null;
    const isTold = gl.getQueryParameter(query, gl.QUERY_RESULT_AVAILABLE)
      && !gl.getParameter(timer.GPU_DISJOINT_EXT);
    const time = isTold ? gl.getQueryParameter(query, gl.QUERY_RESULT) / 1e6 : null;
    gl.deleteQuery(query);
    return time;
  }

  setFence() {
    const gl = /** @type {WebGL2RenderingContext} */ (this.gl);
    this.fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    this.drawnAt = performance.now();
    gl.flush();
  }

  /** @param {Field} field */
  drawMoving(field) {
    const gl = /** @type {WebGL2RenderingContext} */ (this.gl);
    const { width, height, scale } = this;
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.targetOf(scale));
    gl.disable(gl.SCISSOR_TEST);
    if (this.timer) {
      this.query = gl.createQuery();
      gl.beginQuery(this.timer.TIME_ELAPSED_EXT, /** @type {WebGLQuery} */ (this.query));
    }
    gl.clear(gl.COLOR_BUFFER_BIT);
    const all = { x: 0, y: 0, width, height };
    for (const panel of this.panels) this.draw(panel, scale, field, null, all);
    if (this.timer) gl.endQuery(this.timer.TIME_ELAPSED_EXT);
    this.shownScale = scale;
    this.present();
    this.isMoving = true;
    this.setFence();
    this.watch(this.fence);
    this.tile = 0;
    this.tiles = scale === 1 ? this.tilesAPass() : 0;
  }

  /** Asks more often than once a frame whether the card is done: a frame is too coarse a clock
   * for what takes less than one. @param {WebGLSync | null} fence */
  watch(fence) {
    setTimeout(() => {
      const isLost = !this.gl || this.gl.isContextLost();
      if (fence && fence === this.fence && !isLost && !this.isFinished()) this.watch(fence);
    }, 1);
  }

  /** Chooses the resolution of moving pictures by the time that one took [ms].
   * @param {number} time */
  learn(time) {
    this.lastTime = time;
    const cost = time / this.scale ** 2;
    this.cost = this.cost === null ? cost : 0.5 * (this.cost + cost);
    // A finer picture is tried only where it is sure to hold.
    const holds = (/** @type {number} */ part) =>
      (this.cost ?? 0) * part ** 2 <= (part > this.scale ? 0.75 : 1) * FRAME;
    this.scale = SCALES.find(holds) ?? SCALES[SCALES.length - 1];
  }

  tilesAPass() {
    return Math.ceil(this.width / TILE) * Math.ceil(this.height / TILE);
  }

  /** Draws the next tiles of a picture that stands still. Whether there are more.
   * @param {Field} field @param {number} now */
  refine(field, now) {
    const gl = /** @type {WebGL2RenderingContext} */ (this.gl);
    const pass = this.tilesAPass();
    // The moving picture was the first pass if it had all pixels.
    const at = this.tile + this.tiles;
    if (this.tile === 0) this.passBegan = now;
    const isSlow = this.tiles === 0 && at >= pass && now - this.passBegan > SLOW_PASS;
    if (at >= OFFSETS.length * pass || isSlow) {
      if (this.isStale) this.present();
      return false;
    }
    const columns = Math.ceil(this.width / TILE);
    if (this.shownScale !== 1) this.enlarge();
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.targetOf(1));
    gl.enable(gl.SCISSOR_TEST);
    const end = Math.min(at + this.batch, (Math.floor(at / pass) + 1) * pass);
    for (let index = at; index < end; index += 1) {
      const number = Math.floor(index / pass);
      const place = index % pass;
      // Top down, as the card counts from below.
      const row = pass / columns - 1 - Math.floor(place / columns);
      const tile = { x: (place % columns) * TILE, y: row * TILE, width: TILE, height: TILE };
      gl.scissor(tile.x, tile.y, TILE, TILE);
      if (number === 0) gl.clear(gl.COLOR_BUFFER_BIT);
      else gl.enable(gl.BLEND);
      gl.blendColor(0, 0, 0, 1 / (number + 1));
      gl.blendFunc(gl.CONSTANT_ALPHA, gl.ONE_MINUS_CONSTANT_ALPHA);
      for (const panel of this.panels) {
        this.draw(panel, 1, field, null, tile, OFFSETS[number]);
      }
      gl.disable(gl.BLEND);
    }
    gl.disable(gl.SCISSOR_TEST);
    this.tile += end - at;
    this.isStale = true;
    if (now - this.shownAt > SHOWING) this.present();
    this.isMoving = false;
    this.setFence();
    this.watch(this.fence);
    return true;
  }

  /** Draws a part of a panel. @param {Panel} panel @param {number} scale @param {Field} field
   * @param {Program | null} only @param {Rect} within what may be drawn, in pixels of the target
   * @param {number[]} [offset] of the samples, in pixels */
  draw(panel, scale, field, only, within, offset = [0, 0]) {
    const gl = /** @type {WebGL2RenderingContext} */ (this.gl);
    const program = only ?? this.programs?.get(field.program(panel));
    const part = this.ratio * scale;
    const { x, y, width, height } = flipped(panel.rect, this.canvas.clientHeight);
    const [left, bottom, wide, high] = [x, y, width, height].map((v) => Math.round(v * part));
    const [low, above] = [Math.max(left, within.x), Math.max(bottom, within.y)];
    const right = Math.min(left + wide, within.x + within.width);
    const top = Math.min(bottom + high, within.y + within.height);
    if (!program || right <= low || top <= above) return;
    gl.viewport(0, 0, this.width, this.height);
    gl.enable(gl.SCISSOR_TEST);
    gl.scissor(low, above, right - low, top - above);
    program.use();
    program.set({
      ...panel.values,
      ...field.bind(gl, this.losses),
      viewport: [wide, high],
      lowerLeft: [left + offset[0], bottom + offset[1]],
      cone: Number(panel.values.cone ?? 0) / high,
    });
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  }

  /** Moving pictures have a target of their own: tiles are laid over the last one.
   * @param {number} scale */
  targetOf(scale) {
    return this.targets?.[scale === 1 ? 0 : 1].frame ?? null;
  }

  /** Enlarges the last moving picture, for tiles to replace. */
  enlarge() {
    const gl = /** @type {WebGL2RenderingContext} */ (this.gl);
    const { width, height } = this;
    const [wide, high] = [width, height].map((side) => Math.round(side * this.shownScale));
    gl.disable(gl.SCISSOR_TEST);
    gl.bindFramebuffer(gl.READ_FRAMEBUFFER, this.targetOf(this.shownScale));
    gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, this.targetOf(1));
    gl.blitFramebuffer(0, 0, wide, high, 0, 0, width, height, gl.COLOR_BUFFER_BIT, gl.LINEAR);
    this.shownScale = 1;
  }

  /** Shows the picture on the page, which enlarges one with fewer pixels: that is cheaper than
   * to enlarge it here. */
  present() {
    const gl = /** @type {WebGL2RenderingContext} */ (this.gl);
    const { canvas } = this;
    const [width, height] = [this.width, this.height].map((side) =>
      Math.max(1, Math.round(side * this.shownScale)));
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    gl.disable(gl.SCISSOR_TEST);
    gl.bindFramebuffer(gl.READ_FRAMEBUFFER, this.targetOf(this.shownScale));
    gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, null);
    // Without this, Chromium clears the canvas after the copy when it is exported.
    gl.clear(gl.COLOR_BUFFER_BIT);
    gl.blitFramebuffer(0, 0, width, height, 0, 0, width, height, gl.COLOR_BUFFER_BIT, gl.NEAREST);
    this.isStale = false;
    this.shownAt = performance.now();
  }
}
