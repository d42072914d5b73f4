// Reduces the samples of a flow to what a chart of a given width can show: lowest and highest value of each column of
// pixels. Peaks of a single cycle therefore stay visible.

import type { Topic } from "./document";

/** Number of samples of a block of a summary. */
const BLOCK = 128;

/** Lowest and highest values of blocks of samples, so that a long recording is not scanned for every frame. */
class Summary {
  readonly low: Float64Array;
  readonly high: Float64Array;

  constructor(values: Float64Array) {
    const count = Math.ceil(values.length / BLOCK);
    this.low = new Float64Array(count).fill(Infinity);
    this.high = new Float64Array(count).fill(-Infinity);
    for (let k = 0; k < values.length; k++) {
      const block = (k / BLOCK) | 0;
      const value = values[k]!;
      if (value < this.low[block]!) this.low[block] = value;
      if (value > this.high[block]!) this.high[block] = value;
    }
  }
}

const summaries = new WeakMap<Float64Array, Summary>();

function summaryOf(values: Float64Array): Summary {
  const known = summaries.get(values);
  if (known) return known;
  const made = new Summary(values);
  summaries.set(values, made);
  return made;
}

/** Lowest and highest of the values from row `from` to row `to`; infinite if there is none. */
function extremes(values: Float64Array, summary: Summary, from: number, to: number, out: [number, number]): void {
  let [low, high] = out;
  for (let k = from; k < to; ) {
    if (k % BLOCK === 0 && k + BLOCK <= to) {
      const block = k / BLOCK;
      if (summary.low[block]! < low) low = summary.low[block]!;
      if (summary.high[block]! > high) high = summary.high[block]!;
      k += BLOCK;
    } else {
      const value = values[k]!;
      if (value < low) low = value;
      if (value > high) high = value;
      k++;
    }
  }
  out[0] = low;
  out[1] = high;
}

/** Times of the points of a chart, common to all its lines, in ticks. */
export interface Grid {
  from: number;
  to: number;
  /** Number of columns; 0 if every tick is a point. */
  columns: number;
  ticks: Float64Array;
}

/** Returns the points of a chart with this width in pixels for a range of ticks. */
export function grid(from: number, to: number, width: number): Grid {
  const [first, last] = [Math.floor(from), Math.ceil(to)];
  const columns = Math.max(1, Math.floor(width));
  if (last - first <= 2 * columns) {
    const ticks = Float64Array.from({ length: last - first }, (_, k) => first + k);
    return { from: first, to: last, columns: 0, ticks };
  }
  const step = (last - first) / columns;
  const ticks = Float64Array.from({ length: 2 * columns }, (_, k) => first + ((k >> 1) + 0.25 + 0.5 * (k & 1)) * step);
  return { from: first, to: last, columns, ticks };
}

/** Returns the values of a line at the points of a grid; `null` where there is none. */
export function sample(topic: Topic, values: Float64Array, grid: Grid): (number | null)[] {
  const out = new Array<number | null>(grid.ticks.length).fill(null);
  if (grid.columns === 0) {
    topic.rowsWithin(grid.from, grid.to, (row, from, to) => {
      for (let tick = from; tick < to; tick++) {
        const value = values[row + tick - from]!;
        if (Number.isFinite(value)) out[tick - grid.from] = value;
      }
    });
    return out;
  }
  const summary = summaryOf(values);
  const step = (grid.to - grid.from) / grid.columns;
  const found: [number, number] = [0, 0];
  for (let column = 0; column < grid.columns; column++) {
    const from = Math.round(grid.from + column * step);
    const to = Math.round(grid.from + (column + 1) * step);
    found[0] = Infinity;
    found[1] = -Infinity;
    let rising = true;
    topic.rowsWithin(from, to, (row, first, last) => {
      extremes(values, summary, row, row + last - first, found);
      rising = values[row]! <= values[row + last - first - 1]!;
    });
    if (!Number.isFinite(found[0]) || !Number.isFinite(found[1])) continue;
    out[2 * column] = rising ? found[0] : found[1];
    out[2 * column + 1] = rising ? found[1] : found[0];
  }
  return out;
}
