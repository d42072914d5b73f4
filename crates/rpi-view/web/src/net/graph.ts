// The net of a command: scenes of boxes, of which each but the first one is inside a box. `net_head.rs` describes the form.

/** Name, kind, flow, fragment, file, line, the number of the scene inside or -1, and further flows. */
type BoxHead = [string, BoxKind, string | null, string | null, string | null, number | null, number, string[]];
/** Box and port where a line begins, box and port where it ends, and bits: 1 for a delay, 2 for a condition. */
type LineHead = [number, number, number, number, number];

export type BoxKind = "flow" | "call" | "fragment" | "sensor" | "actuator" | "result" | "condition" | "in" | "out";

export interface SceneHead {
  boxes: BoxHead[];
  lines: LineHead[];
  /** Boxes and dummies of each column from top to bottom; numbers beyond the boxes are dummies. */
  columns: number[][];
  /** Dummies on the way of each line; `null` for a line that leads backwards or is too long. */
  chains: (number[] | null)[];
}

export interface NetHead {
  command: string;
  scenes: SceneHead[];
}

/** Box of a net. */
export interface NetBox {
  /** Number of the scene and number of the box in it. */
  scene: number;
  index: number;
  name: string;
  kind: BoxKind;
  flow: string | null;
  /** Further flows with values of the box: other names, and further outputs of a call. */
  others: string[];
  fragment: string | null;
  file: string | null;
  line: number | null;
  inner: number;
}

/** A box that was looked for, and which of its flows. */
export interface Found {
  box: NetBox;
  flow: string | null;
}

export class NetGraph {
  readonly command: string;
  readonly scenes: SceneHead[];
  readonly boxes: NetBox[][];
  /** Box around each scene; none for the first one. */
  readonly around: (NetBox | undefined)[];
  /** Boxes that are open. */
  readonly open = new Set<NetBox>();

  constructor(head: NetHead) {
    this.command = head.command;
    this.scenes = head.scenes;
    this.around = head.scenes.map(() => undefined);
    this.boxes = head.scenes.map((scene, s) =>
      scene.boxes.map(([name, kind, flow, fragment, file, line, inner, others], index) => ({ scene: s, index, name, kind, flow, others, fragment, file, line, inner })),
    );
    for (const box of this.boxes.flat()) if (box.inner >= 0) this.around[box.inner] = box;
  }

  box(scene: number, index: number): NetBox {
    return this.boxes[scene]![index]!;
  }

  /** Returns the boxes around a box from the innermost to the outermost. */
  outside(box: NetBox): NetBox[] {
    const found: NetBox[] = [];
    for (let next = this.around[box.scene]; next; next = this.around[next.scene]) found.push(next);
    return found;
  }

  /** Opens all boxes around a box. */
  reveal(box: NetBox): void {
    for (const outer of this.outside(box)) this.open.add(outer);
  }

  /** Returns the path of the innermost fragment around a box, as the recording has it; empty for the command. */
  fragmentOf(box: NetBox): string {
    return [box, ...this.outside(box)].find((outer) => outer.fragment !== null)?.fragment ?? "";
  }

  /** Returns the boxes whose names, or flows in whose names, there are all words, the shortest names first. */
  find(text: string): Found[] {
    const words = text.toLowerCase().split(/\s+/).filter(Boolean);
    if (words.length === 0) return [];
    const fits = (name: string) => words.every((word) => name.toLowerCase().includes(word));
    const found: (Found & { name: string })[] = [];
    for (const box of this.boxes.flat()) {
      if (box.kind === "in" || box.kind === "out") continue;
      const name = box.flow ?? box.fragment?.replaceAll("/", ".") ?? box.name;
      if (fits(name)) found.push({ box, flow: box.flow, name });
      for (const flow of box.others) if (fits(flow)) found.push({ box, flow, name: flow });
    }
    return found.sort((a, b) => a.name.length - b.name.length);
  }

  /** Returns the box of a flow; without one, that of the nearest call or fragment around it. */
  boxOf(flow: string): NetBox | undefined {
    const all = this.boxes.flat().filter((box) => box.kind !== "in" && box.kind !== "out");
    for (let name = flow.replace(/\[\d+\]/g, ""); name; name = name.slice(0, Math.max(0, name.lastIndexOf(".")))) {
      const found = all.find((box) => box.flow === name || box.others.includes(name)) ?? all.find((box) => box.fragment?.replaceAll("/", ".") === name);
      if (found) return found;
    }
    return undefined;
  }
}
