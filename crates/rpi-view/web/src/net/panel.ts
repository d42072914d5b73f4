// The net of a command as a graph: pointer and keys, the selected box with its value, place and actions, and a search.

import { button } from "../button";
import type { Flow, Recording } from "../document";
import type { ViewState } from "../state";
import { type Camera, NetDrawing } from "./drawing";
import { type Found, type NetBox, NetGraph } from "./graph";
import { HEAD, NetLayout, PAD, type SceneLayout } from "./layout";
import { NetValues } from "./values";

/** Smallest and largest number of pixels per unit, and the largest one when a net is first shown. */
const SMALLEST = 0.02;
const LARGEST = 3;
const FIRST = 1;
/** Distance in pixels from which on a press is a drag. */
const DRAG = 4;

/** What the page does with a box. */
export interface NetActions {
  /** Shows a line of a file; returns false if the page does not have the file. */
  showLine(file: string, line: number): boolean;
  /** Plots the recorded flows of a box; if there are none, the flow with this name, which the server must compute. */
  plot(recorded: Flow[], name: string): Promise<void>;
  /** Asks for the causes of the value of a flow. */
  why(command: string, flow: string): void;
}

/** A net with its layout and the place of the visible part. */
interface ShownNet {
  net: NetGraph;
  layout: NetLayout;
  drawing: NetDrawing;
  camera?: Camera;
  selected?: NetBox;
  /** Which flow of the selected box. */
  flow: string | null;
}

export class NetPanel {
  private readonly canvas = document.createElement("canvas");
  private readonly commands = document.createElement("select");
  private readonly search = document.createElement("input");
  private readonly details = document.createElement("p");
  private readonly actionButtons = document.createElement("span");
  private readonly values: NetValues;
  private readonly nets = new Map<string, ShownNet>();
  private shown?: ShownNet;
  private found: Found[] = [];
  private foundAt = 0;
  private scheduled = false;
  /** Layout whose closed boxes are being laid out. */
  private preparing?: NetLayout;
  /** Script time of the last frame in ms, for the tests. */
  frameMs = 0;

  constructor(
    private readonly panel: HTMLElement,
    private readonly state: ViewState,
    private readonly actions: NetActions,
  ) {
    this.values = new NetValues(state, () => this.changed());
    this.load(state.recording);
    if (this.nets.size === 0) {
      panel.append(note(state.recording));
      return;
    }
    this.build();
    new ResizeObserver(() => this.changed()).observe(this.canvas);
    state.onTick(() => this.tick());
    state.onTheme(() => {
      for (const { drawing } of this.nets.values()) drawing.theme();
      this.changed();
    });
    this.tick();
  }

  private load({ head }: Recording): void {
    for (const netHead of head.nets) {
      const net = new NetGraph(netHead);
      const layout = new NetLayout(net);
      this.nets.set(net.command, { net, layout, drawing: new NetDrawing(net, layout, this.values), flow: null });
    }
  }

  private build(): void {
    const bar = document.createElement("div");
    bar.className = "bar net-bar";
    this.commands.setAttribute("aria-label", "Command whose net is shown");
    this.commands.add(new Option("At the cursor", ""));
    for (const name of this.nets.keys()) this.commands.add(new Option(name, name));
    this.commands.addEventListener("change", () => this.tick());
    this.search.type = "search";
    this.search.placeholder = "Find a flow";
    this.search.setAttribute("aria-label", "Find a flow in the net");
    this.search.addEventListener("input", () => this.find(0));
    this.search.addEventListener("keydown", (event) => event.key === "Enter" && this.find(event.shiftKey ? -1 : 1));
    bar.append(
      this.commands,
      this.search,
      button("+", "Zoom into the net", () => this.zoom(1.3)),
      button("−", "Zoom out of the net", () => this.zoom(1 / 1.3)),
      button("All", "Show the whole net (F)", () => this.fit()),
      button("Close all", "Close all boxes of the net", () => this.closeAll()),
    );
    this.canvas.tabIndex = 0;
    this.canvas.className = "net";
    this.canvas.setAttribute("role", "application");
    this.canvas.setAttribute("aria-roledescription", "graph");
    this.canvas.setAttribute("aria-describedby", "net-details");
    this.canvas.addEventListener("keydown", (event) => this.key(event));
    this.canvas.addEventListener("pointerdown", (event) => this.press(event));
    this.canvas.addEventListener("dblclick", (event) => this.toggle(this.at(event)));
    this.canvas.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
    this.details.id = "net-details";
    this.details.setAttribute("role", "status");
    const foot = document.createElement("div");
    foot.className = "bar net-bar";
    foot.append(this.details, this.actionButtons);
    this.panel.append(bar, this.canvas, foot);
  }

  /** Shows the net of the command at the cursor, or of the chosen one. */
  private tick(): void {
    if (this.panel.hidden) return;
    const running = this.state.recording.commandsAt(this.state.tick).map((a) => a.command);
    const name = this.commands.value || running.find((command) => this.nets.has(command)) || this.shown?.net.command || [...this.nets.keys()][0]!;
    const next = this.nets.get(name);
    if (next && next !== this.shown) {
      this.shown = next;
      this.canvas.setAttribute("aria-label", `Net of ${name}. Arrow keys select a box, Enter opens or closes it, F shows the whole net.`);
      this.describe();
    }
    void this.values.update();
    this.changed();
  }

  /** Shows the net anew after the panel was hidden. */
  opened(): void {
    if (this.nets.size > 0) this.tick();
  }

  private changed(): void {
    if (this.scheduled || this.panel.hidden) return;
    this.scheduled = true;
    requestAnimationFrame(() => {
      this.scheduled = false;
      this.frame();
    });
  }

  private frame(): void {
    if (!this.shown || this.panel.hidden || this.canvas.clientWidth === 0) return;
    const start = performance.now();
    this.shown.camera ??= this.firstCamera(FIRST);
    this.shown.drawing.draw(this.canvas, this.shown.camera, this.shown.selected);
    this.showDetails();
    this.frameMs = performance.now() - start;
    this.prepare();
  }

  /** Lays out closed boxes while the browser is idle. */
  private prepare(): void {
    const { layout } = this.shown ?? {};
    if (!layout || this.preparing === layout) return;
    this.preparing = layout;
    const one = () => {
      if (this.preparing === layout && layout.prepare()) requestIdleCallback(one);
    };
    requestIdleCallback(one);
  }

  /** Returns the camera that shows the whole net, if its texts can then be read; otherwise its left end. */
  private firstCamera(largest: number, smallest = 0.5): Camera {
    const root = this.shown!.layout.root();
    const [width, height] = [this.canvas.clientWidth, this.canvas.clientHeight];
    const whole = Math.min((width - 24) / Math.max(1, root.width), (height - 24) / Math.max(1, root.height));
    const scale = Math.min(largest, Math.max(smallest, whole));
    const centred = (size: number, all: number) => (all * scale < size - 24 ? (all - size / scale) / 2 : -12 / scale);
    return { x: centred(width, root.width), y: centred(height, root.height), scale };
  }

  private fit(): void {
    if (!this.shown) return;
    this.shown.camera = this.firstCamera(FIRST, SMALLEST);
    this.changed();
  }

  private zoom(factor: number, at?: { x: number; y: number }): void {
    const camera = this.shown?.camera;
    if (!camera) return;
    const centre = at ?? { x: this.canvas.clientWidth / 2, y: this.canvas.clientHeight / 2 };
    const scale = Math.min(LARGEST, Math.max(SMALLEST, camera.scale * factor));
    camera.x += centre.x / camera.scale - centre.x / scale;
    camera.y += centre.y / camera.scale - centre.y / scale;
    camera.scale = scale;
    this.changed();
  }

  private wheel(event: WheelEvent): void {
    event.preventDefault();
    this.zoom(event.deltaY > 0 ? 1 / 1.15 : 1.15, { x: event.offsetX, y: event.offsetY });
  }

  private press(start: PointerEvent): void {
    const camera = this.shown?.camera;
    if (!camera || start.button !== 0) return;
    const from = { ...camera };
    let moved = false;
    const move = (event: PointerEvent) => {
      const [dx, dy] = [event.clientX - start.clientX, event.clientY - start.clientY];
      moved ||= Math.hypot(dx, dy) >= DRAG;
      if (!moved) return;
      camera.x = from.x - dx / camera.scale;
      camera.y = from.y - dy / camera.scale;
      this.changed();
    };
    this.canvas.setPointerCapture(start.pointerId);
    this.canvas.addEventListener("pointermove", move);
    const end = (event: PointerEvent) => {
      this.canvas.removeEventListener("pointermove", move);
      if (!moved && event.type === "pointerup") this.select(this.at(event));
    };
    this.canvas.addEventListener("pointerup", end, { once: true });
  }

  /** Returns the innermost box at the pointer. */
  private at(event: MouseEvent): NetBox | undefined {
    const camera = this.shown?.camera;
    if (!this.shown || !camera) return undefined;
    const { net, layout } = this.shown;
    let [x, y] = [camera.x + event.offsetX / camera.scale, camera.y + event.offsetY / camera.scale];
    let [scene, found]: [number, NetBox | undefined] = [0, undefined];
    for (let shown: SceneLayout | undefined = layout.root(); shown; ) {
      const own: SceneLayout = shown;
      const hit = net.boxes[scene]!.find((box) => x >= own.x[box.index]! && y >= own.y[box.index]! && x <= own.x[box.index]! + own.w[box.index]! && y <= own.y[box.index]! + own.h[box.index]!);
      if (!hit) break;
      found = hit;
      x -= own.x[hit.index]! + PAD;
      y -= own.y[hit.index]! + HEAD;
      scene = hit.inner;
      shown = own.inner[hit.index];
    }
    return found;
  }

  /** Selects a box, or one of its flows, and shows its line of the program. */
  select(box: NetBox | undefined, flow = box?.flow ?? null): void {
    if (!this.shown) return;
    this.shown.selected = box;
    this.shown.flow = flow;
    if (box?.file != null && box.line !== null) this.actions.showLine(box.file, box.line);
    this.describe();
    this.changed();
  }

  /** Selects the box of a flow of a command, opens what is around it, and shows it. */
  show(command: string, flow: string): void {
    const net = this.nets.get(command);
    const box = net?.net.boxOf(flow);
    if (!net || !box) return;
    this.shown = net;
    this.revealed(box, [box.flow, ...box.others].includes(flow) ? flow : box.flow);
  }

  private revealed(box: NetBox, flow: string | null): void {
    const shown = this.shown!;
    shown.net.reveal(box);
    shown.layout.changed(box);
    this.select(box, flow);
    this.bringIntoView(box);
  }

  private bringIntoView(box: NetBox): void {
    const shown = this.shown!;
    const place = shown.layout.place(box);
    if (!place || this.canvas.clientWidth === 0) return;
    const camera = (shown.camera ??= this.firstCamera(FIRST));
    const [width, height] = [this.canvas.clientWidth / camera.scale, this.canvas.clientHeight / camera.scale];
    if (place.x < camera.x || place.x + place.w > camera.x + width) camera.x = place.x + place.w / 2 - width / 2;
    if (place.y < camera.y || place.y + Math.min(place.h, height) > camera.y + height) camera.y = place.y + Math.min(place.h, height) / 2 - height / 2;
    this.changed();
  }

  /** Opens or closes a box. Its upper left corner stays where it is. */
  toggle(box: NetBox | undefined): void {
    const shown = this.shown;
    if (!shown || !box || box.inner < 0) return;
    const before = shown.layout.place(box);
    if (!shown.net.open.delete(box)) shown.net.open.add(box);
    shown.layout.changed(box);
    const after = shown.layout.place(box);
    if (before && after && shown.camera) {
      shown.camera.x += after.x - before.x;
      shown.camera.y += after.y - before.y;
    }
    this.describe();
    this.changed();
  }

  private closeAll(): void {
    const shown = this.shown;
    if (!shown) return;
    for (const box of shown.net.open) shown.layout.changed(box);
    shown.net.open.clear();
    shown.selected = undefined;
    this.fit();
    this.describe();
  }

  /** Selects the first flow that fits the search, or the next one. */
  private find(step: -1 | 0 | 1): void {
    if (!this.shown) return;
    if (step === 0) this.found = this.shown.net.find(this.search.value);
    const count = this.found.length;
    this.foundAt = step === 0 || count === 0 ? 0 : (this.foundAt + step + count) % count;
    const found = this.found[this.foundAt];
    this.search.setAttribute("aria-invalid", String(this.search.value !== "" && !found));
    if (found) this.revealed(found.box, found.flow);
  }

  private key(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const { selected } = this.shown ?? {};
    const actions: Record<string, () => void> = {
      ArrowLeft: () => this.move(-1, 0),
      ArrowRight: () => this.move(1, 0),
      ArrowUp: () => this.move(0, -1),
      ArrowDown: () => this.move(0, 1),
      Enter: () => this.toggle(selected),
      " ": () => this.toggle(selected),
      Escape: () => this.select(selected && this.shown!.net.around[selected.scene]),
      f: () => this.fit(),
      "+": () => this.zoom(1.3),
      "-": () => this.zoom(1 / 1.3),
      p: () => this.actionButtons.querySelector<HTMLButtonElement>("[data-action=plot]")?.click(),
      y: () => this.actionButtons.querySelector<HTMLButtonElement>("[data-action=why]")?.click(),
    };
    const action = actions[event.key];
    if (!action) return;
    event.preventDefault();
    // The keys of the page move the cycle.
    event.stopPropagation();
    action();
  }

  /** Selects the nearest box in a direction, within the visible boxes. */
  private move(dx: number, dy: number): void {
    const shown = this.shown;
    if (!shown) return;
    const from = shown.selected && shown.layout.place(shown.selected);
    if (!shown.selected || !from) return this.selectAndShow(shown.net.boxes[0]![shown.net.scenes[0]!.columns[0]?.[0] ?? 0]);
    // From an open box, the key to the right leads inside.
    const inside = dx > 0 && shown.net.open.has(shown.selected) ? shown.selected.inner : -1;
    if (inside >= 0) return this.selectAndShow(shown.net.boxes[inside]![shown.net.scenes[inside]!.columns[0]?.[0] ?? 0]);
    const [x, y] = [from.x + from.w / 2, from.y + from.h / 2];
    let [best, least]: [NetBox | undefined, number] = [undefined, Infinity];
    for (const box of shown.net.boxes[shown.selected.scene]!) {
      const place = box === shown.selected ? undefined : shown.layout.place(box);
      if (!place) continue;
      const [along, across] = [(place.x + place.w / 2 - x) * dx + (place.y + place.h / 2 - y) * dy, Math.abs((place.x + place.w / 2 - x) * dy) + Math.abs((place.y + place.h / 2 - y) * dx)];
      const far = along + 2 * across;
      if (along > 1 && far < least) [best, least] = [box, far];
    }
    this.selectAndShow(best);
  }

  private selectAndShow(box: NetBox | undefined): void {
    if (!box) return;
    this.select(box);
    this.bringIntoView(box);
  }

  /** Fills the line below the graph: what the selected box is, and what can be done with it. */
  private describe(): void {
    this.actionButtons.replaceChildren();
    const { selected, net } = this.shown ?? {};
    if (!selected || !net) return this.showDetails();
    if (selected.inner >= 0) this.addAction("open", net.open.has(selected) ? "Close" : "Open", `${net.open.has(selected) ? "Close" : "Open"} ${selected.name} (Enter)`, () => this.toggle(selected));
    const { flow } = this.shown!;
    const isReplayed = this.state.recording.isServed && !this.state.recording.isLive;
    if (this.values.flows(net, selected, flow).length > 0 || (flow !== null && isReplayed)) {
      this.addAction("plot", "Plot", `Plot ${flow ?? selected.name} (P)`, () => void this.plot(net, selected, flow));
    }
    if (flow !== null && isReplayed) this.addAction("why", "Why", `Causes of the value of ${flow} (Y)`, () => this.actions.why(net.command, flow));
    this.showDetails();
  }

  private addAction(action: string, text: string, label: string, press: () => void): void {
    const made = button(text, label, press);
    made.dataset.action = action;
    this.actionButtons.append(made);
  }

  private async plot(net: NetGraph, box: NetBox, flow: string | null): Promise<void> {
    try {
      await this.actions.plot(this.values.flows(net, box, flow), `${net.command}.${flow}`);
    } catch (error) {
      this.details.textContent = error instanceof Error ? error.message : String(error);
    }
  }

  private showDetails(): void {
    const { selected, net, flow = null } = this.shown ?? {};
    let text = this.values.note;
    if (selected && net) {
      const value = this.values.text(net, selected, flow);
      const active = this.values.isActive(net, net.fragmentOf(selected));
      const parts = [`${flow ?? selected.fragment?.replaceAll("/", ".") ?? selected.name} (${selected.kind})`];
      if (value !== undefined) parts.push(`= ${value}`);
      if (active === false) parts.push("inactive");
      if (selected.line !== null) parts.push(`${selected.file?.split("/").pop()}:${selected.line}`);
      text = parts.join("  ");
    }
    if (this.details.textContent !== text) this.details.textContent = text;
  }
}

function note({ head }: Recording): HTMLElement {
  const text = document.createElement("p");
  text.className = "note";
  text.textContent = head.netsNote === null ? "The recording has no commands." : `No net: ${head.netsNote}`;
  return text;
}
