// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * The canvases and texts of the stage.
 *
 * @typedef {import('./ink.js').Inks} Inks
 */

const LABEL = 'The scene. Drag a point or the surface to lead the hand; drag the handles of the selected part to '
  + 'place it, or press M for the arrow keys to do so; drag beside them to turn the view; use the wheel to zoom.';

/** Lays an element over the whole container. @param {HTMLElement} element */
function lay(element) {
  Object.assign(element.style, {
    position: 'absolute', inset: '0', width: '100%', height: '100%', display: 'block',
  });
}

/** The colour behind an element. @param {HTMLElement} element @returns {string} */
function behind(element) {
  for (let each = /** @type {HTMLElement | null} */ (element); each; each = each.parentElement) {
    const color = getComputedStyle(each).backgroundColor;
    if (!/^(transparent|rgba\(.*, 0\))$/.test(color)) return color;
  }
  return '#ffffff';
}

export class Elements {
  /** @param {HTMLElement} container */
  constructor(container) {
    this.container = container;
    this.scene = document.createElement('canvas');
    this.picture = document.createElement('canvas');
    this.overlay = document.createElement('canvas');
    this.way = document.createElement('p');
    this.readout = document.createElement('p');
    /** The button above the legend. */
    this.legend = /** @type {HTMLElement} */ (container.querySelector('#legend'));
    for (const canvas of [this.scene, this.picture, this.overlay]) lay(canvas);
    this.scene.setAttribute('aria-hidden', 'true');
    this.picture.setAttribute('aria-hidden', 'true');
    this.overlay.tabIndex = 0;
    this.overlay.setAttribute('role', 'application');
    this.overlay.setAttribute('aria-label', LABEL);
    for (const text of [this.way, this.readout]) {
      Object.assign(text.style, {
        position: 'absolute', left: '8px', margin: '0', padding: '2px 6px', pointerEvents: 'none',
        font: '12px/1.45 Inter, system-ui, sans-serif', whiteSpace: 'pre', borderRadius: '4px',
        maxWidth: 'calc(100% - 130px)', overflow: 'hidden', textOverflow: 'ellipsis',
      });
    }
    this.readout.hidden = true;
    /** Where the texts are. @type {import('./texts.js').Taken[]} */
    this.notes = [];
    this.way.style.bottom = '6px';
    this.readout.style.bottom = '30px';
    this.readout.style.fontVariantNumeric = 'tabular-nums';
    if (getComputedStyle(container).position === 'static') container.style.position = 'relative';
    container.append(this.scene, this.picture, this.overlay, this.way, this.readout);
    // Painted by the processor: it has few strokes, and where the browser emulates a graphics
    // card, that is much cheaper.
    this.context = /** @type {CanvasRenderingContext2D} */ (
      this.overlay.getContext('2d', { willReadFrequently: true }));
    this.width = 1;
    this.height = 1;
    this.ratio = 1;
    /** The colours of the theme. @type {Inks} */
    this.inks = { ink: '#000000', halo: '#ffffff', paper: '#ffffff', muted: '#8a909a' };
    this.useCard(true);
    this.dress();
  }

  get rect() {
    return { x: 0, y: 0, width: this.width, height: this.height };
  }

  resize() {
    this.width = Math.max(1, this.container.clientWidth);
    this.height = Math.max(1, this.container.clientHeight);
    this.ratio = Math.min(devicePixelRatio || 1, 2);
    this.overlay.width = Math.round(this.width * this.ratio);
    this.overlay.height = Math.round(this.height * this.ratio);
    this.measureNotes();
  }

  /** Shows what the card draws, or what the program drew. @param {boolean} isUsed */
  useCard(isUsed) {
    this.scene.style.visibility = isUsed ? 'visible' : 'hidden';
    this.picture.style.visibility = isUsed ? 'hidden' : 'visible';
  }

  /** Takes the colours of the theme. */
  dress() {
    const paper = behind(this.container);
    const ink = getComputedStyle(this.container).color;
    this.inks = { ink, halo: paper, paper, muted: '#8a909a' };
    for (const text of [this.way, this.readout]) {
      Object.assign(text.style, { color: ink, background: paper });
    }
  }

  /** @param {HTMLElement} element @param {string} text */
  write(element, text) {
    if (element.textContent === text) return;
    element.textContent = text;
    element.hidden = text === '';
    this.measureNotes();
  }

  measureNotes() {
    this.notes = [this.way, this.readout, this.legend].filter((each) => !each.hidden).map((each) => {
      const { offsetLeft: left, offsetTop: top, offsetWidth: wide, offsetHeight: high } = each;
      return { x: left + wide / 2, y: top + high / 2, wide, high };
    });
  }

  /** Where the legend begins. */
  get legendTop() {
    return this.legend.offsetTop + this.legend.offsetHeight;
  }

  /** Tells how the scene is drawn. @param {string} words @param {string} why */
  note(words, why) {
    this.write(this.way, why ? `${words}: ${why}` : words);
  }

  /** Tells what the probe found. @param {string} words */
  read(words) {
    this.write(this.readout, words);
  }

  /** All layers as one picture. @param {boolean} isDrawn whether the program drew the scene
   * @returns {Promise<Blob>} */
  export(isDrawn) {
    const { width, height } = this.overlay;
    const canvas = document.createElement('canvas');
    canvas.width = width;
    canvas.height = height;
    const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext('2d'));
    const { ink, paper } = this.inks;
    context.fillStyle = paper;
    context.fillRect(0, 0, width, height);
    context.drawImage(isDrawn ? this.picture : this.scene, 0, 0, width, height);
    context.drawImage(this.overlay, 0, 0, width, height);
    const ratio = width / this.width;
    context.scale(ratio, ratio);
    context.font = '12px Inter, system-ui, sans-serif';
    context.lineWidth = 3;
    context.strokeStyle = paper;
    context.fillStyle = ink;
    context.strokeText(this.way.textContent ?? '', 14, this.height - 14);
    context.fillText(this.way.textContent ?? '', 14, this.height - 14);
    return new Promise((resolve, reject) => {
      canvas.toBlob((blob) => (blob ? resolve(blob) : reject(new Error('no picture'))), 'image/png');
    });
  }
}
