// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * The socket to the program, as docs/live-protocol.md describes it: questions with answers,
 * binary messages decoded, and a connection that comes back by itself.
 *
 * @typedef {{ device: number[], proxy: number[], force: number[], wanted: number[],
 *   normal: number[], depth: number, largestForce: number, body: number, contact: boolean,
 *   slipping: boolean }} Point
 * @typedef {{ dimension: number, stopped: boolean, held: boolean, acted: boolean,
 *   recording: boolean, touring: boolean, replaying: boolean, lifted: boolean, revision: number,
 *   tick: number, time: number, force: number, depth: number, cost: number, lateness: number, taken: number,
 *   given: number, kept: number, evaluations: number, lost: number, beat: number, points: Point[] }} Frame
 * @typedef {{ dimension: number, id: number, revision: number, counts: number[],
 *   first: number[], last: number[], half: boolean, values: Uint16Array | Float32Array }} Grid
 * @typedef {{ id: number, revision: number, png: Blob }} Picture
 * @typedef {Record<string, any>} Message
 */

export const VERSION = 2;

const HEADER = 64;
const POINT = 72;
/** The wait before a connection is tried again [ms]: doubled each time, up to the longest. */
const SHORTEST_WAIT = 100;
const LONGEST_WAIT = 2000;

/** @param {DataView} data @param {number} at @returns {number[]} */
function triple(data, at) {
  return [0, 4, 8].map((offset) => data.getFloat32(at + offset, true));
}

/** @param {DataView} data @returns {Frame} */
export function decodeFrame(data) {
  const float = (/** @type {number} */ at) => data.getFloat32(at, true);
  const flags = data.getUint8(3);
  const points = [];
  for (let point = 0; point < data.getUint16(60, true); point += 1) {
    const at = HEADER + POINT * point;
    const state = data.getUint16(at + 70, true);
    points.push({
      device: triple(data, at),
      proxy: triple(data, at + 12),
      force: triple(data, at + 24),
      wanted: triple(data, at + 36),
      normal: triple(data, at + 48),
      depth: float(at + 60),
      largestForce: float(at + 64),
      body: data.getUint16(at + 68, true),
      contact: (state & 1) !== 0,
      slipping: (state & 2) !== 0,
    });
  }
  return {
    dimension: data.getUint8(2),
    stopped: (flags & 1) !== 0,
    held: (flags & 2) !== 0,
    acted: (flags & 4) !== 0,
    recording: (flags & 8) !== 0,
    touring: (flags & 16) !== 0,
    replaying: (flags & 32) !== 0,
    lifted: (flags & 64) !== 0,
    revision: data.getUint32(4, true),
    tick: Number(data.getBigUint64(8, true)),
    time: data.getFloat64(16, true),
    force: float(24),
    depth: float(28),
    cost: float(32),
    lateness: float(36),
    taken: float(40),
    given: float(44),
    kept: float(48),
    evaluations: float(52),
    lost: data.getUint32(56, true),
    beat: data.getUint16(62, true),
    points,
  };
}

/** @param {DataView} data @returns {Grid} */
export function decodeGrid(data) {
  const half = data.getUint8(3) === 2;
  const counts = [12, 16, 20].map((at) => data.getUint32(at, true));
  const count = counts[0] * counts[1] * counts[2];
  const start = data.byteOffset + 48;
  const values = half
    ? new Uint16Array(data.buffer, start, count)
    : new Float32Array(data.buffer, start, count);
  return {
    dimension: data.getUint8(2),
    id: data.getUint32(4, true),
    revision: data.getUint32(8, true),
    counts,
    first: triple(data, 24),
    last: triple(data, 36),
    half,
    values,
  };
}

/** @param {DataView} data @returns {Picture} */
export function decodePicture(data) {
  const bytes = new Uint8Array(data.buffer, data.byteOffset + 16, data.getUint32(12, true));
  return {
    id: data.getUint32(4, true),
    revision: data.getUint32(8, true),
    png: new Blob([/** @type {BlobPart} */ (bytes)], { type: 'image/png' }),
  };
}

/** What the program said instead of an answer. */
export class Refused extends Error {
  /** @param {Message} message */
  constructor(message) {
    super(message.message);
    /** @type {{ at: string, path: string, line: number, problem: string }[]} */
    this.problems = message.problems;
  }
}

/**
 * @typedef {object} Handlers
 * @property {(frame: Frame) => void} frame
 * @property {(message: Message) => void} message what is no answer
 * @property {(state: 'connecting' | 'live' | 'lost' | 'closed', why?: string) => void} connection
 */

/** A connection that is made again whenever it is lost. */
export class Wire {
  /** @param {string} token @param {Handlers} handlers */
  constructor(token, handlers) {
    this.token = token;
    this.handlers = handlers;
    /** @type {WebSocket | null} */
    this.socket = null;
    /** Questions without an answer yet; `since` is on the clock of `performance.now()`.
     * @type {Map<number, { resolve: (answer: any) => void, reject: (error: Error) => void,
     *   what: string, since: number }>} */
    this.waiting = new Map();
    this.lastId = 0;
    this.wait = SHORTEST_WAIT;
    this.open();
  }

  open() {
    this.handlers.connection('connecting');
    const scheme = location.protocol === 'https:' ? 'wss' : 'ws';
    const socket = new WebSocket(`${scheme}://${location.host}/socket?token=${encodeURIComponent(this.token)}`);
    socket.binaryType = 'arraybuffer';
    this.socket = socket;
    let why = '';
    let isOpened = false;
    socket.onopen = () => {
      isOpened = true;
      this.send({ do: 'hello', version: VERSION });
    };
    socket.onmessage = ({ data }) => {
      if (typeof data !== 'string') {
        this.takeBinary(data);
        return;
      }
      const message = JSON.parse(data);
      if (message.do === 'bye') why = message.why;
      if (message.do === 'welcome') {
        // A program that closes what it opened is not asked again at once.
        this.wait = SHORTEST_WAIT;
        this.handlers.connection('live');
      }
      this.takeText(message);
    };
    socket.onclose = async () => {
      this.socket = null;
      for (const { reject } of this.waiting.values()) reject(new Error('the connection was lost'));
      this.waiting.clear();
      if (!isOpened && await this.isTokenWrong()) {
        this.handlers.connection('closed', 'The program does not know this token.');
        return;
      }
      this.handlers.connection('lost', why);
      setTimeout(() => this.open(), this.wait);
      this.wait = Math.min(2 * this.wait, LONGEST_WAIT);
    };
  }

  /** Whether the program is there and refuses the token: a socket does not tell. */
  async isTokenWrong() {
    try {
      const signal = AbortSignal.timeout(LONGEST_WAIT);
      const answer = await fetch(`scene.json?token=${encodeURIComponent(this.token)}`, { method: 'HEAD', signal });
      return answer.status === 401;
    } catch {
      return false;
    }
  }

  /** @param {ArrayBuffer} buffer */
  takeBinary(buffer) {
    const data = new DataView(buffer);
    const kind = data.getUint8(0);
    if (data.getUint8(1) !== VERSION) return;
    if (kind === 1) {
      const start = performance.now();
      const frame = decodeFrame(data);
      performance.measure('decode', { start });
      this.handlers.frame(frame);
    }
    if (kind === 2) this.answer(decodeGrid(data));
    if (kind === 3) this.answer(decodePicture(data));
  }

  /** @param {Message} message */
  takeText(message) {
    if (message.id === undefined) {
      this.handlers.message(message);
    } else if (message.do === 'refused') {
      const asker = this.waiting.get(message.id);
      this.waiting.delete(message.id);
      asker?.reject(new Refused(message));
    } else {
      this.answer(message);
    }
  }

  /** @param {Message | Grid | Picture} message */
  answer(message) {
    const asker = this.waiting.get(message.id);
    this.waiting.delete(message.id);
    asker?.resolve(message);
  }

  /** Whether what is sent can arrive. */
  isOpen() {
    return this.socket?.readyState === WebSocket.OPEN;
  }

  /** Sends what needs no answer. @param {Message} message */
  send(message) {
    if (this.isOpen()) this.socket?.send(JSON.stringify(message));
  }

  /** The questions without an answer for longer than a time [ms], oldest first.
   * @param {number} longest */
  slow(longest) {
    const before = performance.now() - longest;
    return [...this.waiting].filter(([, { since }]) => since < before)
      .map(([id, { what, since }]) => ({ id, what, since }));
  }

  /** Ends a question, which is then refused. @param {number} id */
  cancel(id) {
    this.send({ do: 'cancel', question: id });
  }

  /** A number for a question. */
  newId() {
    this.lastId += 1;
    return this.lastId;
  }

  /** Asks, and gives the answer. @param {Message} message @returns {Promise<any>} */
  ask(message, id = this.newId()) {
    if (!this.isOpen()) {
      return Promise.reject(new Error('the program is not connected'));
    }
    return new Promise((resolve, reject) => {
      this.waiting.set(id, { resolve, reject, what: message.question?.question ?? message.do, since: performance.now() });
      this.send({ ...message, id });
    });
  }
}
