// Reads the document of a recording: a head in JSON, then blocks of numbers. `document.rs` describes the form.

import type { NetHead } from "./net/graph";

/** Half-open interval of ticks or rows. */
export type Span = [number, number];

export interface JointHead {
  prismatic: boolean;
  point: [number, number, number];
  direction: [number, number, number];
  range: [number, number];
  /** Maximum velocity, acceleration and jerk; `null` without a limit. */
  limits: (number | null)[];
}

export interface ArmHead {
  name: string;
  model: string;
  base: number[];
  joints: JointHead[];
  flange: number[];
  tool: number[];
  toolLimits: (number | null)[];
}

export interface ActivityHead {
  command: string;
  id: number;
  path: string;
  devices: string[];
  spans: Span[];
}

export interface RecordedEvent {
  event: string;
  tick: number;
  command?: string;
  device?: string;
  [key: string]: unknown;
}

interface ColumnHead {
  name: string;
  kind: "bool" | "int" | "real";
  unit: string;
  absent: Span[];
  rows: number;
  form: "f64" | "i32";
  exponent: number;
  order: number;
  offset: number;
}

interface TopicHead {
  name: string;
  ticks: Span[];
  columns: ColumnHead[];
}

export interface Head {
  version: string;
  exact: boolean;
  tickNs: number;
  ticks: Span;
  program: string;
  source: string | null;
  cell: string;
  arms: ArmHead[];
  topics: TopicHead[];
  activity: ActivityHead[];
  events: RecordedEvent[];
  lost: number;
  cut: string | null;
  nets: NetHead[];
  /** Reason why there are no nets. */
  netsNote: string | null;
  /** Whether the run goes on. */
  live: boolean;
}

const MAGIC = "RPIVIEW1";

/** Topic of a recording: the ticks for which its flows have rows. */
export class Topic {
  readonly spans: Span[] = [];
  /** First row of each interval of ticks. */
  private readonly firstRows: number[] = [];
  private rows = 0;

  constructor(
    readonly name: string,
    spans: Span[],
  ) {
    this.append(spans);
  }

  /** Adds later intervals of ticks. */
  append(spans: Span[]): void {
    for (const [from, to] of spans) {
      const last = this.spans.at(-1);
      if (last && last[1] === from) last[1] = to;
      else {
        this.spans.push([from, to]);
        this.firstRows.push(this.rows);
      }
      this.rows += to - from;
    }
  }

  /** Returns the row of a tick; -1 if the topic has no message in this tick. */
  rowOf(tick: number): number {
    const k = this.spanFrom(tick + 1) - 1;
    const span = this.spans[k];
    return span && tick >= span[0] && tick < span[1] ? this.firstRows[k]! + tick - span[0] : -1;
  }

  /** Calls `take` for each interval of ticks in a range, with the row of its first tick. */
  rowsWithin(from: number, to: number, take: (row: number, from: number, to: number) => void): void {
    const start = Math.max(0, this.spanFrom(from + 1) - 1);
    for (let k = start; k < this.spans.length && this.spans[k]![0] < to; k++) {
      const [a, b] = this.spans[k]!;
      const [first, last] = [Math.max(a, from), Math.min(b, to)];
      if (first < last) take(this.firstRows[k]! + first - a, first, last);
    }
  }

  /** Returns the index of the first interval that starts at this tick or later. */
  private spanFrom(tick: number): number {
    let [low, high] = [0, this.spans.length];
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.spans[middle]![0] < tick) low = middle + 1;
      else high = middle;
    }
    return low;
  }
}

/** Flow of a command or port of a device: one number per row of its topic. */
export class Flow {
  readonly id: string;
  /** Values by row, and derivatives by order, computed when they are first used. */
  private readonly derivatives: Float64Array[] = [];
  /** Memory of the values of a run that goes on, with room for later ones. */
  private room = new Float64Array(0);

  constructor(
    readonly topic: Topic,
    private readonly head: ColumnHead,
    private readonly blocks: ArrayBuffer,
    private readonly tickSeconds: number,
  ) {
    this.id = `${topic.name}.${head.name}`;
  }

  get name(): string {
    return this.head.name;
  }

  get kind(): "bool" | "int" | "real" {
    return this.head.kind;
  }

  /** Name without the indices, which flows of one list share. */
  get family(): string {
    return this.id.replace(/\[\d+\]/g, "");
  }

  /** Last index in the name; -1 if there is none. */
  get index(): number {
    const found = /\[(\d+)\][^[]*$/.exec(this.head.name);
    return found ? Number(found[1]) : -1;
  }

  /** True if no row has a value. */
  get isAbsent(): boolean {
    const { absent, rows } = this.head;
    return absent.length === 1 && absent[0]![1] - absent[0]![0] === rows;
  }

  /** Returns the unit of the derivative of this order. */
  unit(order = 0): string {
    const unit = this.head.unit;
    if (order === 0 || unit === "") return order === 0 ? unit : `1/s${power(order)}`;
    return `${unit}/s${power(order)}`;
  }

  /** Returns the derivative of this order by row; order 0 has the values. NaN where there is none. */
  values(order = 0): Float64Array {
    const known = this.derivatives[order];
    if (known) return known;
    const made = order === 0 ? decode(this.head, this.blocks) : this.differences(order);
    this.derivatives[order] = made;
    return made;
  }

  /** Returns the value in a tick; `undefined` in a tick without a value. */
  at(tick: number, order = 0): number | undefined {
    const row = this.topic.rowOf(tick);
    if (row < 0 || this.head.absent.some(([from, to]) => row >= from && row < to)) return undefined;
    return this.values(order)[row];
  }

  /** Adds the values of later ticks, which are those of the same flow in another document. */
  append(more: Flow): void {
    const [own, added] = [this.values(), more.values()];
    const rows = own.length + added.length;
    if (rows > this.room.length) {
      this.room = new Float64Array(Math.max(1024, 2 * rows));
      this.room.set(own);
    }
    this.room.set(added, own.length);
    this.derivatives.splice(0, Infinity, this.room.subarray(0, rows));
    for (const [from, to] of more.head.absent) {
      const last = this.head.absent.at(-1);
      if (last && last[1] === from + own.length) last[1] = to + own.length;
      else this.head.absent.push([from + own.length, to + own.length]);
    }
    this.head.rows = rows;
  }

  private differences(order: number): Float64Array {
    const below = this.values(order - 1);
    const out = new Float64Array(below.length).fill(NaN);
    this.topic.rowsWithin(-Infinity, Infinity, (row, from, to) => {
      for (let k = row + 1; k < row + to - from; k++) out[k] = (below[k]! - below[k - 1]!) / this.tickSeconds;
    });
    return out;
  }
}

function power(order: number): string {
  return ["", "", "²", "³", "⁴"][order] ?? "";
}

function decode(head: ColumnHead, blocks: ArrayBuffer): Float64Array {
  const { rows, offset } = head;
  const out = head.form === "f64" ? new Float64Array(blocks, offset, rows).slice() : decodeRounded(head, blocks);
  for (const [from, to] of head.absent) out.fill(NaN, from, to);
  return out;
}

/** Decodes rounded values: bytes by their place in the number, and differences of an order. */
function decodeRounded(head: ColumnHead, blocks: ArrayBuffer): Float64Array {
  const { rows } = head;
  const bytes = new Uint8Array(blocks, head.offset, 4 * rows);
  const integers = new Int32Array(rows);
  for (let r = 0; r < rows; r++) {
    const folded = bytes[r]! | (bytes[rows + r]! << 8) | (bytes[2 * rows + r]! << 16) | (bytes[3 * rows + r]! << 24);
    integers[r] = (folded >>> 1) ^ -(folded & 1);
  }
  for (let k = 0; k < head.order; k++) {
    let sum = 0;
    for (let r = 0; r < rows; r++) {
      sum = (sum + integers[r]!) | 0;
      integers[r] = sum;
    }
  }
  const unit = 2 ** head.exponent;
  return Float64Array.from(integers, (value) => value * unit);
}

/** Recording as the page shows it. */
export class Recording {
  readonly flows: Flow[];
  readonly topics: Topic[];
  private readonly byId = new Map<string, Flow>();

  constructor(
    readonly head: Head,
    blocks: ArrayBuffer,
    /** Whether the server can be asked for more about the run. */
    readonly isServed: boolean,
  ) {
    this.topics = head.topics.map((topic) => new Topic(topic.name, topic.ticks));
    this.flows = head.topics.flatMap((topic, k) => topic.columns.map((column) => new Flow(this.topics[k]!, column, blocks, this.tickSeconds)));
    for (const flow of this.flows) this.byId.set(flow.id, flow);
  }

  get tickSeconds(): number {
    return this.head.tickNs * 1e-9;
  }

  get first(): number {
    return this.head.ticks[0];
  }

  /** Last tick; the first one in an empty recording. */
  get last(): number {
    return Math.max(this.first, this.head.ticks[1] - 1);
  }

  flow(id: string): Flow | undefined {
    return this.byId.get(id);
  }

  /** Whether the run goes on. */
  get isLive(): boolean {
    return this.head.live;
  }

  /** Adds the values of later ticks. Returns whether there are flows that were not known before. */
  append(later: Recording): boolean {
    let hasNew = false;
    for (const topic of later.topics) {
      const flows = later.flows.filter((flow) => flow.topic === topic);
      const same = flows.length > 0 ? this.byId.get(flows[0]!.id)?.topic : undefined;
      if (same && flows.every((flow) => this.byId.get(flow.id)?.topic === same)) {
        same.append(topic.spans);
        for (const flow of flows) this.byId.get(flow.id)!.append(flow);
      } else if (!same) {
        hasNew = true;
        this.topics.push(topic);
        this.flows.push(...flows);
        for (const flow of flows) this.byId.set(flow.id, flow);
      }
    }
    const { head } = this;
    Object.assign(head, { ticks: [head.ticks[0], later.head.ticks[1]], activity: later.head.activity, events: later.head.events });
    return hasNew;
  }

  /** Loads the values of a flow that was not recorded: the server replays the recording. Returns its numbers. */
  async loadFlow(name: string): Promise<Flow[]> {
    const response = await fetch(`flow/${encodeURIComponent(name)}`);
    if (!response.ok) throw new Error(await response.text());
    const added = parse(await response.arrayBuffer(), true).flows;
    for (const flow of added) {
      if (this.byId.has(flow.id)) continue;
      this.byId.set(flow.id, flow);
      this.flows.push(flow);
    }
    return added.map((flow) => this.byId.get(flow.id)!);
  }

  /** Returns the commands that run in a tick. */
  commandsAt(tick: number): ActivityHead[] {
    return this.head.activity.filter((a) => a.path === "" && isWithin(a.spans, tick));
  }
}

/** Returns whether a tick is in one of the intervals, which are in ascending order. */
export function isWithin(spans: Span[], tick: number): boolean {
  let [low, high] = [0, spans.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (spans[middle]![1] <= tick) low = middle + 1;
    else high = middle;
  }
  return low < spans.length && spans[low]![0] <= tick;
}

/** Parses a document. Throws an error if the bytes are not a document. */
export function parse(bytes: ArrayBuffer, isServed: boolean): Recording {
  const view = new DataView(bytes);
  const magic = new TextDecoder().decode(bytes.slice(0, MAGIC.length));
  if (magic !== MAGIC) throw new Error("the document has an unknown form");
  const start = MAGIC.length + 4;
  const length = view.getUint32(MAGIC.length, true);
  const head = JSON.parse(new TextDecoder().decode(bytes.slice(start, start + length))) as Head;
  return new Recording(head, bytes.slice(Math.ceil((start + length) / 8) * 8), isServed);
}

/** Loads the document: from the page itself if it is a report, otherwise from the server. Waits for the first cycle of a run. */
export async function load(): Promise<Recording> {
  const own = document.getElementById("document");
  if (own === null) {
    for (;;) {
      const response = await fetch("document");
      if (!response.ok) throw new Error(`the server answers ${response.status}`);
      const recording = parse(await response.arrayBuffer(), true);
      if (!recording.isLive || recording.head.ticks[1] > recording.head.ticks[0]) return recording;
      await new Promise((done) => setTimeout(done, 100));
    }
  }
  const text = atob(own.textContent ?? "");
  own.remove();
  const packed = Uint8Array.from(text, (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  return parse(await new Response(stream).arrayBuffer(), false);
}

/** Loads the values of a run from a tick on; `undefined` if the run has ended. */
export async function loadSince(tick: number): Promise<Recording | undefined> {
  const response = await fetch(`since/${tick}`);
  if (!response.ok) throw new Error(`the server answers ${response.status}`);
  const bytes = await response.arrayBuffer();
  return bytes.byteLength === 0 ? undefined : parse(bytes, true);
}
