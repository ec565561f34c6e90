// A reader of rls streams (docs/rls.md), fed with chunks of any size. It keeps one record and no line.

import { crc32 } from "./crc32.js";

const MAGIC = [0x89, 0x52, 0x4c, 0x53, 0x0d, 0x0a, 0x1a, 0x0a];
const MOST_WIDTH = 1_048_576;
const MOST_LINE = 8_388_608;
const MOST_INKS = 65_535;

/** Rasters of more bytes than this under the checksum are not summed: it would cost more than it tells. */
const MOST_SUMMED = 64 << 20;

/**
 * What is known before the first line. `to` is the line behind the last. Without a list of inks the raster is shaded: a run's ink is its colour, 0xRRGGBB.
 * @typedef {{ width: number, from: number, to: number, inks: number[][] | null, paper: number[] }} Header
 */

/**
 * `n` equal lines from `y` on, with `count` runs: three numbers each in `runs`, first column, column behind the last, ink.
 * `runs` is used again for the next record.
 * @typedef {{ y: number, n: number, count: number, runs: Uint32Array }} Lines
 */

/** A stream that breaks its rules, or ends before its end. */
export class Broken extends Error {}

const WHITE = [255, 255, 255];

/** More bytes are needed. */
const SHORT = -1;

export class Reader {
  /**
   * @param {(header: Header) => void} onHeader
   * @param {(lines: Lines) => void} onLines
   */
  constructor(onHeader, onLines) {
    this.onHeader = onHeader;
    this.onLines = onLines;
    /** @type {Header | undefined} */
    this.header = undefined;
    this.ended = false;
    this.lines = 0;
    this.repeated = 0;
    this.runs = 0;
    /** Whether the checksum was compared. */
    this.summed = false;
    this.crc = 0;
    this.row = new Uint8Array(0);
    /** @type {Uint8Array} */
    this.bytes = new Uint8Array(0);
    this.at = 0;
    this.record = { y: 0, n: 0, count: 0, runs: new Uint32Array(3 * 256) };
  }

  /**
   * Takes the next bytes, and tells of the records that they complete.
   * @param {Uint8Array} chunk
   */
  push(chunk) {
    const left = this.bytes.length - this.at;
    if (left === 0) {
      this.bytes = chunk;
    } else {
      const joined = new Uint8Array(left + chunk.length);
      joined.set(this.bytes.subarray(this.at));
      joined.set(chunk, left);
      this.bytes = joined;
    }
    this.at = 0;
    while (this.at < this.bytes.length) {
      const start = this.at;
      if (this.ended) throw new Broken("there are bytes behind the end of the stream");
      if (!(this.header ? this.#record() : this.#head())) {
        this.at = start;
        break;
      }
    }
    if (this.at === this.bytes.length) {
      this.bytes = new Uint8Array(0);
      this.at = 0;
    }
  }

  /** To be called behind the last byte: a stream without its end is broken. */
  finish() {
    if (!this.ended) throw new Broken("the stream breaks off before its end");
  }

  /** The next number, or SHORT. */
  #number() {
    const bytes = this.bytes;
    let value = 0;
    let unit = 1;
    for (let i = this.at; i < bytes.length; i++) {
      const byte = bytes[i];
      value += (byte & 127) * unit;
      if (byte < 128) {
        if (byte === 0 && i > this.at) throw new Broken("a number is longer than it has to be");
        this.at = i + 1;
        return value;
      }
      unit *= 128;
      if (unit > Number.MAX_SAFE_INTEGER) throw new Broken("a number is too large");
    }
    return SHORT;
  }

  /** The next colour, or SHORT. */
  #colour() {
    const { bytes, at } = this;
    if (bytes.length - at < 3) return SHORT;
    this.at = at + 3;
    return (bytes[at] << 16) | (bytes[at + 1] << 8) | bytes[at + 2];
  }

  #head() {
    for (const byte of MAGIC) {
      if (this.at === this.bytes.length) return false;
      if (this.bytes[this.at++] !== byte) throw new Broken("this is no rls stream");
    }
    const version = this.#number();
    if (version === SHORT) return false;
    if (version !== 1) throw new Broken(`rls version ${version} is not known here`);
    const kind = this.#number();
    if (kind === SHORT) return false;
    if (kind > 1) throw new Broken(`rls kind ${kind} is not known here`);
    const width = this.#number();
    const from = width === SHORT ? SHORT : this.#number();
    const to = from === SHORT ? SHORT : this.#number();
    const shaded = kind === 1;
    const count = to === SHORT ? SHORT : shaded ? 1 : this.#number();
    if (count === SHORT) return false;
    if (width < 1 || width > MOST_WIDTH || from >= to || to > MOST_LINE || count > MOST_INKS) throw new Broken("the header is out of bounds");
    if (this.bytes.length - this.at < 3 * count) return false;
    const colours = Array.from({ length: count }, (_, i) => Array.from(this.bytes.subarray(this.at + 3 * i, this.at + 3 * i + 3)));
    this.at += 3 * count;
    this.header = { width, from, to, inks: shaded ? null : colours, paper: shaded ? colours[0] : WHITE };
    const rowBytes = shaded ? 3 * width : count < 2 ? Math.ceil(width / 8) : count < 256 ? width : 2 * width;
    this.summed = rowBytes * (to - from) <= MOST_SUMMED;
    this.row = new Uint8Array(this.summed ? rowBytes : 0);
    this.onHeader(this.header);
    return true;
  }

  #record() {
    const { width, from, to, inks } = /** @type {Header} */ (this.header);
    const n = this.#number();
    if (n === SHORT) return false;
    if (n === 0) return this.#end();
    const count = this.#number();
    if (count === SHORT) return false;
    const y = from + this.lines;
    if (y + n > to) throw new Broken(`line ${y}: more lines than the header says`);
    if (count > width) throw new Broken(`line ${y}: more runs than pixels`);
    const record = this.record;
    if (record.runs.length < 3 * count) record.runs = new Uint32Array(6 * count);
    const runs = record.runs;
    const several = inks !== null && inks.length > 1;
    const most = inks ? inks.length : 1 << 24;
    let end = 0;
    let before = -1;
    for (let i = 0; i < 3 * count; i += 3) {
      const gap = this.#number();
      const length = gap === SHORT ? SHORT : this.#number();
      if (length === SHORT) return false;
      const ink = several ? this.#number() : inks ? 0 : this.#colour();
      if (ink === SHORT) return false;
      if (length === 0 || ink >= most || end + gap + length > width || (gap === 0 && ink === before)) {
        throw new Broken(`line ${y}: run ${i / 3 + 1} is out of bounds`);
      }
      runs[i] = end + gap;
      end += gap + length;
      runs[i + 1] = end;
      runs[i + 2] = ink;
      before = ink;
    }
    record.y = y;
    record.n = n;
    record.count = count;
    this.lines += n;
    this.repeated += n - 1;
    this.runs += n * count;
    if (this.summed) this.#sum(record);
    this.onLines(record);
    return true;
  }

  /** @param {Lines} record */
  #sum({ n, count, runs }) {
    const row = this.row;
    const { inks: listed, paper } = /** @type {Header} */ (this.header);
    const inks = listed?.length ?? Infinity;
    if (listed) row.fill(0);
    else fillColour(row, 0, row.length / 3, paper);
    for (let i = 0; i < 3 * count; i += 3) {
      const [start, end, ink] = [runs[i], runs[i + 1], runs[i + 2] + 1];
      if (inks < 2) {
        fillBits(row, start, end);
      } else if (inks < 256) {
        row.fill(ink, start, end);
      } else if (!listed) {
        const colour = runs[i + 2];
        fillColour(row, start, end, [colour >> 16, (colour >> 8) & 255, colour & 255]);
      } else {
        for (let x = start; x < end; x++) {
          row[2 * x] = ink >> 8;
          row[2 * x + 1] = ink & 255;
        }
      }
    }
    for (let i = 0; i < n; i++) this.crc = crc32(this.crc, row);
  }

  #end() {
    const { from, to } = /** @type {Header} */ (this.header);
    const lines = this.#number();
    const runs = lines === SHORT ? SHORT : this.#number();
    if (runs === SHORT || this.bytes.length - this.at < 4) return false;
    const crc = new DataView(this.bytes.buffer, this.bytes.byteOffset + this.at, 4).getUint32(0);
    this.at += 4;
    if (lines !== to - from || lines !== this.lines) throw new Broken(`the stream ends behind ${this.lines} of ${to - from} lines`);
    if (runs !== this.runs) throw new Broken(`the end says ${runs} runs, there were ${this.runs}`);
    if (this.summed && crc !== this.crc) throw new Broken("the checksum is another one: the lines are not what was sent");
    this.ended = true;
    return true;
  }
}

/**
 * Sets the bits `start` to `end` of a row, the most significant of a byte first.
 * @param {Uint8Array} row
 * @param {number} start
 * @param {number} end
 */
function fillBits(row, start, end) {
  const [first, last] = [start >> 3, end >> 3];
  const head = 255 >> (start & 7);
  const tail = ~(255 >> (end & 7)) & 255;
  if (first === last) {
    row[first] |= head & tail;
  } else {
    row[first] |= head;
    row.fill(255, first + 1, last);
    if (tail) row[last] |= tail;
  }
}

/**
 * Sets the pixels `start` to `end` of a row of three bytes a pixel.
 * @param {Uint8Array} row
 * @param {number} start
 * @param {number} end
 * @param {number[]} colour
 */
function fillColour(row, start, end, colour) {
  if (start === end) return;
  row.set(colour, 3 * start);
  // What is there is copied behind itself, twice as much each time.
  for (let done = 1; done < end - start; done *= 2) row.copyWithin(3 * (start + done), 3 * start, 3 * (start + Math.min(done, end - start - done)));
}
