// Coordinates of the boxes of a net in pixels. The layers and the order in them come with the net; which boxes are open decides about sizes,
// and thus about coordinates. Each scene is laid out once until a box in it is opened or closed.

import type { NetBox, NetGraph, SceneHead } from "./graph";

/** Space above and beside the scene in an open box. */
export const HEAD = 26;
export const PAD = 14;
const ROW_GAP = 12;
const COLUMN_GAP = 40;
const LANE = 9;
/** Maximum number of lanes for lines that lead backwards. Further lines share them. */
const MAX_LANES = 24;
/** Height of a dummy: of a line between two columns. */
const DUMMY = 3;
/** Number of passes that move boxes towards the boxes with which they are connected. */
const SWEEPS = 10;
/** Number of passes for scenes with many boxes, and how many these are. */
const FEW_SWEEPS = 4;
const MANY = 4000;
/** Width of a letter, and of the boxes. */
const LETTER = 7.4;
const NARROWEST = 104;
const WIDEST = 240;

/** Memory for the items of a column that are moved together. */
let poolMemory = { bases: new Float64Array(64), counts: new Int32Array(64) };

function pools(size: number): typeof poolMemory {
  if (size > poolMemory.bases.length) poolMemory = { bases: new Float64Array(2 * size), counts: new Int32Array(2 * size) };
  return poolMemory;
}

/** Width and height of a box without its inner scene. */
function closedSize(box: NetBox): [number, number] {
  const letters = (box.name.length + (box.inner < 0 ? 0 : 2)) * LETTER + 18;
  if (box.kind === "in" || box.kind === "out") return [Math.min(WIDEST, letters), 18];
  return [Math.min(WIDEST, Math.max(NARROWEST, letters)), 38];
}

/** Scene with coordinates relative to its upper left corner. */
export class SceneLayout {
  readonly x: Float64Array;
  readonly y: Float64Array;
  readonly w: Float64Array;
  readonly h: Float64Array;
  readonly inner: (SceneLayout | undefined)[];
  /** Points of each line: x and y by turns. The parts between them are horizontal at both ends. */
  readonly lines: Float64Array[] = [];
  /** For each line, whether it leads backwards below the boxes. */
  readonly isBack: boolean[] = [];
  width = 0;
  height = 0;
  /** Position and width of each column. */
  private readonly columnX: number[] = [];
  private readonly columnW: number[] = [];

  constructor(
    private readonly head: SceneHead,
    boxes: NetBox[],
    inside: (box: NetBox) => SceneLayout | undefined,
  ) {
    const count = boxes.length;
    const items = head.columns.reduce((most, column) => column.reduce((m, item) => Math.max(m, item + 1), most), count);
    this.x = new Float64Array(items);
    this.y = new Float64Array(items);
    this.w = new Float64Array(items);
    this.h = new Float64Array(items).fill(DUMMY, count);
    this.inner = boxes.map((box) => (box.inner >= 0 ? inside(box) : undefined));
    boxes.forEach((box, k) => {
      const [width, height] = closedSize(box);
      const inner = this.inner[k];
      this.w[k] = inner ? Math.max(width, inner.width + 2 * PAD) : width;
      this.h[k] = inner ? HEAD + inner.height + PAD : height;
    });
    this.placeRows(count);
    this.placeColumns(count);
    this.route(count);
  }

  /** Distance from the upper edge of a box to the point where a line passes its border. */
  private portY(box: number, port: number): number {
    const inner = this.inner[box];
    if (!inner) return this.h[box]! / 2;
    return port < 0 ? HEAD / 2 : HEAD + inner.y[port]! + inner.h[port]! / 2;
  }

  /** Distance from the left edge of a box to the end of a line: at the port inside of an open box. */
  private portX(box: number, port: number, leaves: boolean): number {
    const inner = this.inner[box];
    if (!inner || port < 0) return leaves ? this.w[box]! : 0;
    return PAD + inner.x[port]! + (leaves ? inner.w[port]! : 0);
  }

  /** Pairs of connected items in adjacent columns: left item, right item, and by how much the right one is lower if the line is horizontal. */
  private links(count: number): { from: number[]; to: number[]; down: number[] } {
    const found = { from: [] as number[], to: [] as number[], down: [] as number[] };
    this.head.lines.forEach(([from, fromPort, to, toPort], k) => {
      const chain = this.head.chains[k];
      if (!chain) return;
      let last = from;
      for (let d = 0; d <= chain.length; d++) {
        const item = chain[d] ?? to;
        const leave = last < count ? this.portY(last, last === from ? fromPort : -1) : DUMMY / 2;
        const enter = item < count ? this.portY(item, item === to ? toPort : -1) : DUMMY / 2;
        found.from.push(last);
        found.to.push(item);
        found.down.push(leave - enter);
        last = item;
      }
    });
    return found;
  }

  private placeRows(count: number): void {
    const { from, to, down } = this.links(count);
    const { columns } = this.head;
    const items = this.y.length;
    // The links of each item, as ranges of one list.
    const start = new Int32Array(items + 1);
    for (let k = 0; k < from.length; k++) {
      start[from[k]! + 1]!++;
      start[to[k]! + 1]!++;
    }
    for (let k = 0; k < items; k++) start[k + 1]! += start[k]!;
    const fill = start.slice();
    const links = new Int32Array(2 * from.length);
    for (let k = 0; k < from.length; k++) {
      links[fill[from[k]!]!++] = k;
      links[fill[to[k]!]!++] = k;
    }
    const wanted = new Float64Array(columns.reduce((most, column) => Math.max(most, column.length), 0));
    for (const column of columns) this.resolve(column, wanted);
    const sweeps = items > MANY ? FEW_SWEEPS : SWEEPS;
    for (let sweep = 0; sweep < sweeps; sweep++) {
      for (let c = 0; c < columns.length; c++) {
        const column = columns[sweep % 2 === 0 ? c : columns.length - 1 - c]!;
        for (let place = 0; place < column.length; place++) {
          const item = column[place]!;
          const degree = start[item + 1]! - start[item]!;
          let sum = 0;
          for (let l = start[item]!; l < start[item + 1]!; l++) {
            const k = links[l]!;
            sum += from[k] === item ? this.y[to[k]!]! - down[k]! : this.y[from[k]!]! + down[k]!;
          }
          wanted[place] = degree > 0 ? sum / degree : this.y[item]!;
        }
        this.resolve(column, wanted);
      }
    }
    this.closeGaps(from, to);
    const top = this.y.reduce((least, y) => Math.min(least, y), Infinity);
    if (Number.isFinite(top)) for (let k = 0; k < items; k++) this.y[k]! -= top;
  }

  /** Moves parts of the net that no line connects up to the parts above them. */
  private closeGaps(from: number[], to: number[]): void {
    const items = this.y.length;
    // Each item knows an item of its part; the last one on the way stands for the part (union-find).
    const parent = Int32Array.from({ length: items }, (_, k) => k);
    const part = (item: number) => {
      while (parent[item] !== item) item = parent[item] = parent[parent[item]!]!;
      return item;
    };
    for (let k = 0; k < from.length; k++) parent[part(from[k]!)] = part(to[k]!);
    const above = new Int32Array(items).fill(-1);
    for (const column of this.head.columns) for (let k = 1; k < column.length; k++) above[column[k]!] = column[k - 1]!;
    const members = new Map<number, number[]>();
    for (let item = 0; item < items; item++) {
      const own = part(item);
      const known = members.get(own);
      if (known) known.push(item);
      else members.set(own, [item]);
    }
    const top = (list: number[]) => list.reduce((least, item) => Math.min(least, this.y[item]!), Infinity);
    const parts = [...members.values()].map((list) => ({ list, top: top(list) })).sort((a, b) => a.top - b.top);
    const ceiling = parts[0]?.top ?? 0;
    for (const { list } of parts) {
      let room = Infinity;
      for (const item of list) {
        const next = above[item]!;
        if (next < 0) room = Math.min(room, this.y[item]! - ceiling);
        else if (part(next) !== part(item)) room = Math.min(room, this.y[item]! - this.y[next]! - this.step(next));
      }
      if (room > 0 && room < Infinity) for (const item of list) this.y[item]! -= room;
    }
  }

  /** Moves the items of a column as close as possible to where they are wanted, without overlap: isotonic regression (Ayer et al., 1955). */
  private resolve(column: number[], wanted: Float64Array): void {
    const { bases, counts } = pools(column.length);
    let [before, top] = [0, 0];
    for (let k = 0; k < column.length; k++) {
      let [base, count] = [wanted[k]! - before, 1];
      while (top > 0 && bases[top - 1]! > base) {
        top--;
        base = (bases[top]! * counts[top]! + base * count) / (counts[top]! + count);
        count += counts[top]!;
      }
      bases[top] = base;
      counts[top++] = count;
      before += this.step(column[k]!);
    }
    let [k, offset] = [0, 0];
    for (let pool = 0; pool < top; pool++) {
      for (let n = 0; n < counts[pool]!; n++, k++) {
        this.y[column[k]!] = bases[pool]! + offset;
        offset += this.step(column[k]!);
      }
    }
  }

  /** Distance from the upper edge of an item to that of the next one in its column. */
  private step(item: number): number {
    return this.h[item]! + (this.h[item] === DUMMY ? DUMMY : ROW_GAP);
  }

  private placeColumns(count: number): void {
    let x = 0;
    for (const column of this.head.columns) {
      const width = column.reduce((most, item) => Math.max(most, this.w[item]!), 0);
      this.columnX.push(x);
      this.columnW.push(width);
      for (const item of column) this.x[item] = x;
      for (const item of column) if (item >= count) this.w[item] = width;
      x += width + COLUMN_GAP;
    }
    this.width = Math.max(0, x - COLUMN_GAP);
    for (let k = 0; k < this.y.length; k++) this.height = Math.max(this.height, this.y[k]! + this.h[k]!);
  }

  private route(count: number): void {
    let lanes = 0;
    const bottom = this.height;
    const columnOf = new Int32Array(this.y.length);
    this.head.columns.forEach((column, c) => column.forEach((item) => (columnOf[item] = c)));
    const edge = (item: number) => this.columnX[columnOf[item]!]! + this.columnW[columnOf[item]!]!;
    for (let k = 0; k < this.head.lines.length; k++) {
      const [from, fromPort, to, toPort] = this.head.lines[k]!;
      const [x0, y0] = [this.x[from]! + this.portX(from, fromPort, true), this.y[from]! + this.portY(from, fromPort)];
      const [x1, y1] = [this.x[to]! + this.portX(to, toPort, false), this.y[to]! + this.portY(to, toPort)];
      const chain = this.head.chains[k];
      const isBack = !chain && columnOf[from]! >= columnOf[to]!;
      this.isBack.push(isBack);
      if (isBack) {
        const own = from === to;
        const lane = own ? this.y[from]! + this.h[from]! + 5 : bottom + LANE * (1 + (lanes++ % MAX_LANES));
        const right = own ? this.x[from]! + this.w[from]! + 7 : edge(from) + 6 + 3 * (lanes % 5);
        const left = this.x[to]! - 8 - 3 * (lanes % 5);
        this.lines.push(new Float64Array([x0, y0, right, y0, right, lane, left, lane, left, y1, x1, y1]));
        continue;
      }
      const dummies = chain ?? [];
      const points = new Float64Array(8 + 4 * dummies.length);
      points.set([x0, y0, edge(from), y0]);
      for (let d = 0; d < dummies.length; d++) {
        const item = dummies[d]!;
        const [x, y] = [this.x[item]!, this.y[item]! + DUMMY / 2];
        points[4 + 4 * d] = x;
        points[5 + 4 * d] = points[7 + 4 * d] = y;
        points[6 + 4 * d] = x + this.w[item]!;
      }
      points.set([this.columnX[columnOf[to]!]!, y1, x1, y1], points.length - 4);
      this.lines.push(points);
    }
    if (lanes > 0) this.height = bottom + LANE * (1 + Math.min(lanes, MAX_LANES));
    else if (count > 0) this.height = bottom + 6;
  }
}

/** Layouts of the scenes of a net, kept until boxes in them open or close. */
export class NetLayout {
  private readonly known = new Map<number, SceneLayout>();
  /** First scene that may not be laid out yet. */
  private next = 0;

  constructor(private readonly net: NetGraph) {}

  root(): SceneLayout {
    return this.scene(0);
  }

  private scene(scene: number): SceneLayout {
    const known = this.known.get(scene);
    if (known) return known;
    const made = new SceneLayout(this.net.scenes[scene]!, this.net.boxes[scene]!, (box) => (this.net.open.has(box) ? this.scene(box.inner) : undefined));
    this.known.set(scene, made);
    return made;
  }

  /** Lays out one scene that was not needed yet, so that its box opens at once. Returns whether there may be more. */
  prepare(): boolean {
    while (this.next < this.net.scenes.length && this.known.has(this.next)) this.next++;
    if (this.next >= this.net.scenes.length) return false;
    this.scene(this.next);
    return true;
  }

  /** Drops the layouts that change if a box opens or closes. */
  changed(box: NetBox): void {
    this.known.delete(box.scene);
    for (const outer of this.net.outside(box)) this.known.delete(outer.scene);
  }

  /** Returns the corner of a box in the first scene, and its size; `undefined` if a box around it is closed. */
  place(box: NetBox): { x: number; y: number; w: number; h: number } | undefined {
    const path = [box, ...this.net.outside(box)].reverse();
    let layout: SceneLayout | undefined = this.root();
    let [x, y] = [0, 0];
    for (const [k, outer] of path.entries()) {
      if (!layout) return undefined;
      x += layout.x[outer.index]!;
      y += layout.y[outer.index]!;
      if (k === path.length - 1) return { x, y, w: layout.w[outer.index]!, h: layout.h[outer.index]! };
      layout = layout.inner[outer.index];
      x += PAD;
      y += HEAD;
    }
    return undefined;
  }
}
