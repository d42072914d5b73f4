// Timeline: commands by device, active fragments of the shown command, and events. Drawn on a canvas; the list of
// events has the same content for the keyboard and for screen readers.

import type { ActivityHead } from "./document";
import type { ShownEvent } from "./events";
import { type CommandColours, style } from "./palette";
import type { ViewState } from "./state";

const ROW = 20;
const LABEL = 108;
/** Maximum number of rows with fragments. */
const MAX_FRAGMENTS = 6;

interface Row {
  label: string;
  spans: { from: number; to: number; text: string; command: string }[];
  thin?: boolean;
}

export class Timeline {
  private readonly canvas = document.createElement("canvas");
  private readonly cursor = document.createElement("div");
  private lanes: Row[] = [];
  private rows: Row[] = [];
  /** Height in pixels. */
  private height = 0;
  private shownCommand = "";

  constructor(
    private readonly host: HTMLElement,
    private readonly state: ViewState,
    private readonly colours: CommandColours,
    private readonly events: ShownEvent[],
  ) {
    this.cursor.className = "cursor";
    this.canvas.setAttribute("aria-hidden", "true");
    host.append(this.canvas, this.cursor);
    this.makeRoom();
    host.addEventListener("pointerdown", (event) => this.drag(event));
    host.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
    new ResizeObserver(() => this.draw()).observe(host);
    state.onTick(() => this.update());
    state.onRange(() => this.draw());
    state.onTheme(() => this.draw());
    state.onGrow(() => {
      this.makeRoom();
      this.rows = [];
      this.update();
    });
    this.update();
  }

  private makeRoom(): void {
    const { activity } = this.state.recording.head;
    this.lanes = lanes(activity);
    // Room for the rows of any command, so that the page does not move while the command changes.
    const most = Math.max(...this.colours.names().map((command) => fragments(activity, command).length), 0);
    this.height = (this.lanes.length + 1 + most) * ROW + 2;
    this.host.style.height = `${this.height}px`;
  }

  private update(): void {
    const command = this.state.recording.commandsAt(this.state.tick)[0]?.command ?? "";
    if (command !== this.shownCommand || this.rows.length === 0) {
      this.shownCommand = command;
      this.rows = [...this.lanes, ...fragments(this.state.recording.head.activity, command)];
      this.draw();
    }
    this.moveCursor();
  }

  private x(tick: number): number {
    const [from, to] = this.state.range;
    return LABEL + ((tick - from) / (to - from)) * (this.host.clientWidth - LABEL - 8);
  }

  private tickAt(event: MouseEvent): number {
    const [from, to] = this.state.range;
    const x = event.clientX - this.host.getBoundingClientRect().left;
    return from + ((x - LABEL) / (this.host.clientWidth - LABEL - 8)) * (to - from);
  }

  private moveCursor(): void {
    this.cursor.style.transform = `translateX(${this.x(this.state.tick)}px)`;
  }

  private drag(start: PointerEvent): void {
    const seek = (event: PointerEvent) => this.state.seek(this.tickAt(event));
    seek(start);
    this.host.setPointerCapture(start.pointerId);
    this.host.addEventListener("pointermove", seek);
    this.host.addEventListener("pointerup", () => this.host.removeEventListener("pointermove", seek), { once: true });
  }

  private wheel(event: WheelEvent): void {
    if (!event.ctrlKey && !event.metaKey) return;
    event.preventDefault();
    this.state.zoom(event.deltaY > 0 ? 1.25 : 0.8, this.tickAt(event));
  }

  private draw(): void {
    const [width, scale] = [this.host.clientWidth, devicePixelRatio];
    if (width === 0) return;
    this.canvas.width = width * scale;
    this.canvas.height = this.height * scale;
    const context = this.canvas.getContext("2d");
    if (!context) return;
    context.scale(scale, scale);
    context.font = "12px system-ui, sans-serif";
    context.textBaseline = "middle";
    this.rows.forEach((row, k) => this.drawRow(context, row, k * ROW));
    this.drawEvents(context, this.rows.length * ROW);
    this.moveCursor();
  }

  private drawRow(context: CanvasRenderingContext2D, row: Row, top: number): void {
    const width = this.host.clientWidth;
    label(context, row.label, top);
    const [from, to] = this.state.range;
    context.save();
    context.beginPath();
    context.rect(LABEL, top, width - LABEL - 8, ROW);
    context.clip();
    let drawn = -Infinity;
    for (const span of row.spans) {
      if (span.to < from || span.from > to) continue;
      const [x0, x1] = [this.x(span.from), this.x(span.to)];
      // Spans that end in a column of pixels that is already drawn are not seen.
      if (x1 < drawn + 0.5) continue;
      drawn = x1;
      context.fillStyle = this.colours.of(span.command);
      context.globalAlpha = row.thin ? 0.65 : 1;
      context.fillRect(x0, top + (row.thin ? 6 : 2), Math.max(1, x1 - x0 - 1), ROW - (row.thin ? 12 : 4));
      context.globalAlpha = 1;
      if (!row.thin && x1 - x0 > context.measureText(span.text).width + 8) {
        context.fillStyle = style("--on-colour");
        context.fillText(span.text, Math.max(x0, LABEL) + 4, top + ROW / 2);
      }
    }
    context.restore();
  }

  private drawEvents(context: CanvasRenderingContext2D, top: number): void {
    label(context, "events", top);
    const [from, to] = this.state.range;
    const colours = { info: "--faint", takeover: "--text", warning: "--warning", error: "--error" };
    for (const severity of ["info", "takeover", "warning", "error"] as const) {
      context.fillStyle = style(colours[severity]);
      for (const event of this.events) {
        if (event.severity !== severity || event.tick < from || event.tick > to) continue;
        const [x, y] = [this.x(event.tick), top + ROW / 2];
        context.beginPath();
        if (severity === "takeover") {
          context.moveTo(x - 5, y - 5);
          context.lineTo(x + 5, y);
          context.lineTo(x - 5, y + 5);
        } else if (severity === "info") context.rect(x - 0.75, y - 5, 1.5, 10);
        else context.arc(x, y, 5, 0, 2 * Math.PI);
        context.fill();
      }
    }
  }
}

function label(context: CanvasRenderingContext2D, text: string, top: number): void {
  context.fillStyle = style("--text");
  let shown = text;
  while (shown.length > 2 && context.measureText(shown).width > LABEL - 12) shown = `…${shown.slice(2)}`;
  context.fillText(shown, 8, top + ROW / 2);
}

/** Returns a row for each device that commands drive, and one for commands without a device. */
function lanes(activity: ActivityHead[]): Row[] {
  const rows = new Map<string, Row>();
  for (const { command, devices, spans } of activity.filter((a) => a.path === "")) {
    for (const device of devices.length > 0 ? devices : ["commands"]) {
      const row = rows.get(device) ?? { label: device, spans: [] };
      rows.set(device, row);
      row.spans.push(...spans.map(([from, to]) => ({ from, to, text: command, command })));
    }
  }
  rows.forEach((row) => row.spans.sort((a, b) => a.from - b.from));
  return [...rows.values()];
}

/** Returns rows for the fragments of a command, over all its runs. */
function fragments(activity: ActivityHead[], command: string): Row[] {
  const rows = new Map<string, Row>();
  for (const { path, spans } of activity.filter((a) => a.command === command && a.path !== "")) {
    const row = rows.get(path) ?? { label: path.replaceAll("/", "."), spans: [], thin: true };
    rows.set(path, row);
    row.spans.push(...spans.map(([from, to]) => ({ from, to, text: path, command })));
  }
  return [...rows.values()].slice(0, MAX_FRAGMENTS);
}
