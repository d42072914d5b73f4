// One chart: flows of a family over time, with limits, derivatives and the values at the shown tick.

import uPlot from "uplot";
import { button } from "./button";
import type { ArmHead, Flow } from "./document";
import { grid, sample } from "./decimate";
import { colour, style } from "./palette";
import { type ViewState, short, timeText } from "./state";

export interface Line {
  flow: Flow;
  label: string;
  /** Measured values are dashed, beside the commanded ones of the same colour. */
  measured: boolean;
  /** Number of the colour. */
  colour: number;
}

export interface ChartContent {
  title: string;
  lines: Line[];
}

/** Derivatives by their order: name, and text of the button. */
const ORDERS = [
  ["Value", "Value"],
  ["Velocity", "Velocity"],
  ["Acceleration", "Accel."],
  ["Jerk", "Jerk"],
] as const;
const HEIGHT = 190;

/** Returns the limits of a flow for a derivative; an infinite limit is left out. */
function limits(arms: ArmHead[], flow: Flow, order: number): [number, number] | undefined {
  const arm = arms.find((a) => flow.topic.name.endsWith(`/${a.name}`));
  if (!arm || !/^joints?[.[]/.test(flow.name)) return undefined;
  const joint = arm.joints[Math.max(0, flow.index)];
  if (!joint) return undefined;
  const derived = order + (/velocity/.test(flow.name) ? 1 : /acceleration/.test(flow.name) ? 2 : 0);
  if (derived === 0) return joint.range;
  const limit = joint.limits[derived - 1];
  return limit == null ? undefined : [-limit, limit];
}

export class Chart {
  readonly element = document.createElement("section");
  private readonly host = document.createElement("div");
  private readonly legend = document.createElement("ul");
  private readonly cursor = document.createElement("div");
  private readonly values: HTMLElement[] = [];
  private readonly visible: boolean[];
  private plot?: uPlot;
  private order = 0;
  /** True while the chart is on the screen. */
  private onScreen = false;
  private stale = true;

  constructor(
    private readonly state: ViewState,
    readonly content: ChartContent,
    close: (chart: Chart) => void,
  ) {
    this.visible = content.lines.map(() => true);
    this.element.className = "chart";
    this.element.append(this.header(close), this.legend, this.host);
    this.legend.className = "legend";
    this.host.className = "plot";
    this.cursor.className = "cursor";
    new ResizeObserver(() => this.markStale()).observe(this.host);
    new IntersectionObserver(([entry]) => {
      this.onScreen = entry?.isIntersecting ?? false;
      this.refresh();
    }).observe(this.element);
    state.onTick(() => this.showTick());
    state.onRange(() => this.markStale());
    state.onGrow(() => this.markStale());
    state.onTheme(() => this.rebuild());
    this.rebuild();
  }

  private header(close: (chart: Chart) => void): HTMLElement {
    const header = document.createElement("header");
    const title = document.createElement("h3");
    title.textContent = this.content.title;
    this.element.setAttribute("aria-label", this.content.title);
    header.append(title);
    if (this.content.lines.some((line) => line.flow.kind === "real")) header.append(this.orders());
    header.append(
      button("CSV", `Export ${this.content.title} as CSV`, () => this.exportCsv()),
      button("×", `Close ${this.content.title}`, () => close(this)),
    );
    return header;
  }

  /** Buttons that choose the derivative. */
  private orders(): HTMLElement {
    const group = document.createElement("span");
    group.className = "orders";
    group.setAttribute("role", "group");
    group.setAttribute("aria-label", `Derivative of ${this.content.title}`);
    const buttons = ORDERS.map(([name, text], order) =>
      button(text, `${name} of ${this.content.title}`, () => {
        this.order = order;
        show();
        this.rebuild();
      }),
    );
    const show = () => buttons.forEach((made, order) => made.setAttribute("aria-pressed", String(order === this.order)));
    show();
    group.append(...buttons);
    return group;
  }

  private colour(line: Line): string {
    return colour(line.colour);
  }

  /** Builds the plot anew: for another derivative, theme or choice of lines. */
  private rebuild(): void {
    this.plot?.destroy();
    this.plot = undefined;
    this.legend.replaceChildren();
    this.values.length = 0;
    this.content.lines.forEach((line, k) => this.legend.append(this.legendItem(line, k)));
    this.markStale();
    this.showTick();
  }

  private legendItem(line: Line, k: number): HTMLElement {
    const item = document.createElement("li");
    const toggle = document.createElement("button");
    const [swatch, value] = [document.createElement("span"), document.createElement("output")];
    swatch.className = line.measured ? "swatch dashed" : "swatch";
    swatch.style.borderColor = this.colour(line);
    toggle.type = "button";
    toggle.title = `${line.flow.id}: click to hide or show, double click to show alone`;
    toggle.setAttribute("aria-pressed", String(this.visible[k]));
    toggle.append(swatch, `${line.label} `, value);
    toggle.addEventListener("click", () => this.toggle(k, toggle));
    toggle.addEventListener("dblclick", () => this.showAlone(k));
    this.values.push(value);
    item.append(toggle);
    return item;
  }

  private toggle(k: number, button: HTMLElement): void {
    this.visible[k] = !this.visible[k];
    button.setAttribute("aria-pressed", String(this.visible[k]));
    this.plot?.destroy();
    this.plot = undefined;
    this.markStale();
  }

  private showAlone(k: number): void {
    const alone = this.visible.every((visible, j) => visible === (j === k));
    this.visible.forEach((_, j) => (this.visible[j] = alone || j === k));
    this.rebuild();
  }

  private markStale(): void {
    this.stale = true;
    this.refresh();
  }

  private refresh(): void {
    if (!this.stale || !this.onScreen || this.host.clientWidth === 0) return;
    this.stale = false;
    const data = this.data();
    const [from, to] = this.state.range.map((tick) => this.state.seconds(tick)) as [number, number];
    this.plot ??= new uPlot(this.options(), data, this.host);
    this.plot.setSize({ width: this.host.clientWidth, height: HEIGHT });
    this.plot.batch(() => {
      this.plot!.setData(data, false);
      this.plot!.setScale("x", { min: from, max: to });
      const [low, high] = extent([...(data.slice(1) as (number | null)[][]), this.shadedLimits()]);
      this.plot!.setScale("y", { min: low, max: high });
    });
    if (this.cursor.parentElement !== this.plot.over) this.plot.over.append(this.cursor);
    this.moveCursor();
  }

  private data(): uPlot.AlignedData {
    const points = grid(...this.state.range, this.host.clientWidth);
    const lines = this.content.lines.map((line, k) =>
      this.visible[k] ? sample(line.flow.topic, line.flow.values(this.order), points) : [],
    );
    return [points.ticks.map((tick) => this.state.seconds(tick)), ...lines] as unknown as uPlot.AlignedData;
  }

  private options(): uPlot.Options {
    const [text, line] = [style("--text"), style("--grid")];
    const axis = { stroke: text, grid: { stroke: line, width: 1 }, ticks: { stroke: line, width: 1 } };
    return {
      width: this.host.clientWidth,
      height: HEIGHT,
      legend: { show: false },
      cursor: { y: false, drag: { x: true, y: false, setScale: false } },
      scales: { x: { time: false, auto: false }, y: { auto: false } },
      axes: [
        { ...axis, size: 32, values: (_, ticks) => ticks.map((t) => `${+t.toFixed(6)} s`) },
        { ...axis, size: 64, label: this.unit(), labelSize: 18, values: (_, ticks) => ticks.map(axisText) },
      ],
      series: [
        {},
        ...this.content.lines.map((line, k) => ({
          stroke: this.colour(line),
          width: 1.5,
          dash: line.measured ? [5, 4] : undefined,
          show: this.visible[k],
          points: { show: false },
          pxAlign: 0,
        })),
      ],
      hooks: {
        drawClear: [(plot) => this.drawLimits(plot)],
        setSelect: [(plot) => this.zoomToSelection(plot)],
        ready: [(plot) => this.listen(plot)],
      },
    };
  }

  private unit(): string {
    const units = new Set(this.content.lines.map((line) => line.flow.unit(this.order)));
    return units.size === 1 ? [...units][0]! : "";
  }

  /** Returns the limits of the only visible axis, which its chart contains; empty for several axes. */
  private shadedLimits(): number[] {
    const shown = this.content.lines.filter((_, k) => this.visible[k]);
    const isOne = new Set(shown.map((line) => line.flow.index)).size === 1;
    return (isOne && limits(this.state.recording.head.arms, shown[0]!.flow, this.order)) || [];
  }

  /** Shades what lies outside of the limits of all visible lines, and draws the limits of each. */
  private drawLimits(plot: uPlot): void {
    const { ctx, bbox } = plot;
    const limited = this.content.lines.flatMap((line, k) => {
      const range = this.visible[k] ? limits(this.state.recording.head.arms, line.flow, this.order) : undefined;
      return range ? [{ line, range: range.map((value) => plot.valToPos(value, "y", true)) as [number, number] }] : [];
    });
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    if (limited.length > 0 && limited.length === this.visible.filter(Boolean).length) {
      // The largest value has the smallest ordinate.
      const [low, high] = [Math.max(...limited.map(({ range }) => range[0])), Math.min(...limited.map(({ range }) => range[1]))];
      ctx.fillStyle = style("--limit");
      ctx.fillRect(bbox.left, bbox.top, bbox.width, high - bbox.top);
      ctx.fillRect(bbox.left, low, bbox.width, bbox.top + bbox.height - low);
    }
    for (const { line, range } of limited) {
      ctx.strokeStyle = this.colour(line);
      ctx.setLineDash([2, 4]);
      for (const y of range) {
        ctx.beginPath();
        ctx.moveTo(bbox.left, y);
        ctx.lineTo(bbox.left + bbox.width, y);
        ctx.stroke();
      }
    }
    ctx.restore();
  }

  private zoomToSelection(plot: uPlot): void {
    const { left, width } = plot.select;
    if (width < 4) return;
    const tick = (x: number) => plot.posToVal(x, "x") / this.state.recording.tickSeconds;
    this.state.show(tick(left), tick(left + width));
    plot.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
  }

  private listen(plot: uPlot): void {
    const tick = (event: MouseEvent) => {
      const x = event.clientX - plot.over.getBoundingClientRect().left;
      return plot.posToVal(x, "x") / this.state.recording.tickSeconds;
    };
    plot.over.addEventListener("click", (event) => this.state.seek(tick(event)));
    plot.over.addEventListener("dblclick", () => this.state.showAll());
    plot.over.addEventListener(
      "wheel",
      (event) => {
        if (!event.ctrlKey && !event.metaKey) return;
        event.preventDefault();
        this.state.zoom(event.deltaY > 0 ? 1.25 : 0.8, tick(event));
      },
      { passive: false },
    );
  }

  private showTick(): void {
    this.moveCursor();
    if (!this.onScreen && this.plot) return;
    this.content.lines.forEach((line, k) => {
      this.values[k]!.textContent = short(line.flow.at(this.state.tick, this.order), line.flow.kind);
    });
  }

  private moveCursor(): void {
    if (!this.plot) return;
    const x = this.plot.valToPos(this.state.seconds(this.state.tick), "x");
    this.cursor.style.transform = `translateX(${x}px)`;
  }

  private exportCsv(): void {
    const { recording } = this.state;
    const lines = this.content.lines.filter((_, k) => this.visible[k]);
    const unit = (line: Line) => (line.flow.unit(this.order) ? ` [${line.flow.unit(this.order)}]` : "");
    const suffix = this.order > 0 ? ` ${ORDERS[this.order]![0].toLowerCase()}` : "";
    const rows = [["cycle", "time [s]", ...lines.map((line) => `${line.flow.id}${suffix}${unit(line)}`)].map(quoted).join(",")];
    const [from, to] = this.state.range;
    for (let tick = Math.ceil(from); tick < to; tick++) {
      const values = lines.map((line) => line.flow.at(tick, this.order));
      if (values.every((value) => value === undefined)) continue;
      rows.push([tick, timeText(this.state.seconds(tick), recording.tickSeconds).slice(0, -2), ...values.map((value) => value ?? "")].join(","));
    }
    download(`${this.content.title.replace(/[^\w.-]+/g, "-").replace(/^-|-$/g, "")}.csv`, `${rows.join("\r\n")}\r\n`);
  }
}

/** Returns the lowest and highest value of lines, with a margin. */
function extent(lines: (number | null)[][]): [number, number] {
  let [low, high] = [Infinity, -Infinity];
  for (const line of lines) {
    for (const value of line) {
      if (value === null) continue;
      if (value < low) low = value;
      if (value > high) high = value;
    }
  }
  if (low > high) return [0, 1];
  const margin = high - low > 1e-12 * Math.max(Math.abs(low), Math.abs(high)) ? 0.06 * (high - low) : Math.max(1e-6, 0.1 * Math.abs(high));
  return [low - margin, high + margin];
}

function axisText(value: number): string {
  const size = Math.abs(value);
  return size !== 0 && (size >= 1e5 || size < 1e-4) ? value.toExponential(1) : String(+value.toPrecision(6));
}

/** Returns a field of a CSV file (RFC 4180). */
function quoted(text: string): string {
  return /[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}

function download(name: string, text: string): void {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([text], { type: "text/csv" }));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}
