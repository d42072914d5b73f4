// Page that shows a recording: the cell in 3D, charts, a timeline, and the program.

import { Chart, type ChartContent, button } from "./chart";
import { ConditionError, condition, search } from "./condition";
import { type Flow, type Recording, load } from "./document";
import { shownEvents } from "./events";
import { CommandColours } from "./palette";
import { EventsPanel, ProgramPanel, ValuesPanel } from "./panels";
import { CellView } from "./scene";
import { ViewState, timeText } from "./state";
import { Timeline } from "./timeline";

/** Maximum number of lines in a chart. */
const MAX_LINES = 12;
/** Maximum number of charts when the page opens. */
const MAX_CHARTS = 8;

function element<T extends HTMLElement>(id: string): T {
  const found = document.getElementById(id);
  if (found === null) throw new Error(`the page has no element ${id}`);
  return found as T;
}

/** Returns the charts with which the page opens: positions of arms, then states and exports with numbers. */
function firstCharts(recording: Recording): ChartContent[] {
  const families = new Map<string, Flow[]>();
  for (const flow of recording.flows) {
    if (flow.isAbsent || flow.topic.name.startsWith("/set_points/") || /\.orientation\.\w$/.test(flow.name)) continue;
    const family = flow.family.replace(/\.position\.[xyz]$/, ".position");
    families.set(family, [...(families.get(family) ?? []), flow]);
  }
  const rank = (family: string) => (family.startsWith("/device/") ? 0 : family.startsWith("/command/") ? 1 : 2);
  const sorted = [...families].sort(([a], [b]) => rank(a) - rank(b));
  const charts: ChartContent[] = [];
  for (const [family, flows] of sorted) {
    const commanded = commandedBeside(family);
    const beside = charts.find((chart) => chart.title === commanded);
    const lines = flows.slice(0, MAX_LINES).map((flow, k) => ({ flow, label: lineLabel(flow), measured: false, colour: k }));
    if (beside) beside.lines.push(...lines.map((line) => ({ ...line, label: `${line.label} measured`, measured: true })));
    else charts.push({ title: family.replace(/^\//, ""), lines });
  }
  return charts.slice(0, MAX_CHARTS);
}

/** Returns the title of the chart with the commanded values of a family of measured ones; empty for another family. */
function commandedBeside(family: string): string {
  const [, device, name] = /^\/sensors\/([^.]+)\.(.*)$/.exec(family) ?? [];
  if (name === "joint.measured_position") return `device/${device}.joint.commanded_position`;
  const isTool = name === "measured.position" || name === "tcp.measured_position.position";
  return isTool ? `device/${device}.tcp.commanded_position.position` : "";
}

function lineLabel(flow: Flow): string {
  const index = /\[(\d+)\]$/.exec(flow.name)?.[1];
  if (index !== undefined) return /joint/.test(flow.name) ? `axis ${Number(index) + 1}` : `[${index}]`;
  return flow.name.split(".").pop()!;
}

/** The charts of the page, in a column. */
class Charts {
  private readonly host = element("charts");

  constructor(private readonly state: ViewState) {
    firstCharts(state.recording).forEach((content) => this.add(content));
  }

  add(content: ChartContent): Chart {
    const chart = new Chart(this.state, content, (closed) => closed.element.remove());
    this.host.append(chart.element);
    return chart;
  }

  plot(flow: Flow): void {
    const { element } = this.add({ title: flow.id.replace(/^\//, ""), lines: [{ flow, label: lineLabel(flow), measured: false, colour: 0 }] });
    element.scrollIntoView({ block: "nearest" });
  }
}

/** Tabs of the panels with text. */
function tabs(names: string[], opened: Record<string, () => void>): void {
  const select = (name: string) => {
    for (const other of names) {
      const tab = element(`tab-${other}`);
      tab.setAttribute("aria-selected", String(other === name));
      tab.tabIndex = other === name ? 0 : -1;
      element(`panel-${other}`).hidden = other !== name;
    }
    opened[name]?.();
  };
  names.forEach((name, k) => {
    const tab = element(`tab-${name}`);
    tab.addEventListener("click", () => select(name));
    tab.addEventListener("keydown", (event) => {
      const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
      if (step === undefined) return;
      event.preventDefault();
      event.stopPropagation();
      const next = names[(k + step + names.length) % names.length]!;
      select(next);
      element(`tab-${next}`).focus();
    });
  });
  select(names[0]!);
}

/** Slider, buttons and keys that move through the recording. */
class Transport {
  private readonly slider = element<HTMLInputElement>("slider");
  private readonly readout = element<HTMLOutputElement>("readout");
  private readonly play = element<HTMLButtonElement>("play");
  private playing?: { tick: number; at: number };

  constructor(
    private readonly state: ViewState,
    private readonly eventTicks: number[],
  ) {
    const { first, last } = state.recording;
    Object.assign(this.slider, { min: String(first), max: String(last), step: "1", value: String(first) });
    this.slider.addEventListener("input", () => state.seek(Number(this.slider.value)));
    this.play.addEventListener("click", () => this.toggle());
    const press = (id: string, action: () => void) => element(id).addEventListener("click", action);
    press("back", () => this.step(-1));
    press("forward", () => this.step(1));
    press("zoom-in", () => state.zoom(0.5));
    press("zoom-out", () => state.zoom(2));
    press("zoom-all", () => state.showAll());
    state.onTick(() => this.update());
    document.addEventListener("keydown", (event) => this.key(event));
    this.update();
  }

  private step(ticks: number): void {
    this.state.seek(this.state.tick + ticks);
  }

  private toEvent(direction: 1 | -1): void {
    const { tick } = this.state;
    const next = direction > 0 ? this.eventTicks.find((t) => t > tick) : this.eventTicks.findLast((t) => t < tick);
    if (next !== undefined) this.state.seek(next);
  }

  private key(event: KeyboardEvent): void {
    const target = event.target as HTMLElement;
    if (event.ctrlKey || event.metaKey || event.altKey || /^(INPUT|SELECT|TEXTAREA)$/.test(target.tagName) && target !== this.slider) return;
    const size = event.shiftKey ? 10 : 1;
    const actions: Record<string, () => void> = {
      ArrowLeft: () => this.step(-size),
      ArrowRight: () => this.step(size),
      PageUp: () => this.step(-100),
      PageDown: () => this.step(100),
      Home: () => this.state.seek(this.state.recording.first),
      End: () => this.state.seek(this.state.recording.last),
      n: () => this.toEvent(1),
      p: () => this.toEvent(-1),
      "+": () => this.state.zoom(0.5),
      "-": () => this.state.zoom(2),
      "0": () => this.state.showAll(),
    };
    if (target.tagName !== "BUTTON") actions[" "] = () => this.toggle();
    const action = actions[event.key];
    if (!action) return;
    event.preventDefault();
    action();
  }

  private update(): void {
    const { tick, recording } = this.state;
    const time = timeText(this.state.seconds(tick), recording.tickSeconds);
    const commands = recording.commandsAt(tick).map((a) => a.command).join(", ") || "no command";
    this.slider.value = String(tick);
    this.slider.setAttribute("aria-valuetext", `cycle ${tick}, ${time}, ${commands}`);
    this.readout.textContent = `cycle ${tick}   ${time}   ${commands}`;
  }

  private toggle(): void {
    if (this.playing) this.stop();
    else {
      if (this.state.tick === this.state.recording.last) this.state.seek(this.state.recording.first);
      this.playing = { tick: this.state.tick, at: performance.now() };
      this.play.textContent = "❚❚";
      this.play.setAttribute("aria-label", "Pause");
      requestAnimationFrame((now) => this.frame(now));
    }
  }

  private stop(): void {
    this.playing = undefined;
    this.play.textContent = "▶";
    this.play.setAttribute("aria-label", "Play");
  }

  private frame(now: number): void {
    if (!this.playing) return;
    const speed = Number(element<HTMLSelectElement>("speed").value);
    const passed = ((now - this.playing.at) * 1e-3 * speed) / this.state.recording.tickSeconds;
    // Time that has not yet filled a cycle is kept, so that slow motion advances.
    const cycles = Math.floor(passed);
    if (cycles > 0) {
      this.playing.at = now - ((passed - cycles) * this.state.recording.tickSeconds * 1e3) / speed;
      this.step(cycles);
    }
    if (this.state.tick >= this.state.recording.last) this.stop();
    else requestAnimationFrame((next) => this.frame(next));
  }
}

/** Field for a condition: steps to the cycles in which it begins to hold. */
function breakpoints(state: ViewState): void {
  const [input, message] = [element<HTMLInputElement>("condition"), element("condition-message")];
  const go = (step: 1 | -1) => {
    input.removeAttribute("aria-invalid");
    try {
      const found = search(condition(input.value, state.recording), state.recording, state.tick, step);
      message.textContent = found === undefined ? `no ${step > 0 ? "later" : "earlier"} cycle` : `cycle ${found}`;
      if (found !== undefined) state.seek(found);
    } catch (error) {
      if (!(error instanceof ConditionError)) throw error;
      input.setAttribute("aria-invalid", "true");
      message.textContent = error.message;
    }
  };
  element("condition-next").addEventListener("click", () => go(1));
  element("condition-previous").addEventListener("click", () => go(-1));
  input.addEventListener("keydown", (event) => {
    if (event.key === "Enter") go(event.shiftKey ? -1 : 1);
  });
}

function themes(state: ViewState): void {
  const select = element<HTMLSelectElement>("theme");
  select.addEventListener("change", () => {
    if (select.value === "") delete document.documentElement.dataset.theme;
    else document.documentElement.dataset.theme = select.value;
    state.themeChanged();
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => state.themeChanged());
}

function legend(colours: CommandColours, state: ViewState): void {
  const list = element("commands");
  const fill = () =>
    list.replaceChildren(
      ...colours.names().map((name) => {
        const [item, swatch] = [document.createElement("li"), document.createElement("span")];
        swatch.className = "swatch";
        swatch.style.borderColor = colours.of(name);
        item.append(swatch, name);
        return item;
      }),
    );
  fill();
  state.onTheme(fill);
}

function cell(state: ViewState, colours: CommandColours): CellView | undefined {
  const host = element("cell");
  try {
    const view = new CellView(host, state, colours);
    host.addEventListener("keydown", (event) => {
      const turns: Record<string, [number, number, number]> = {
        a: [-0.1, 0, 1],
        d: [0.1, 0, 1],
        w: [0, 0.1, 1],
        s: [0, -0.1, 1],
        e: [0, 0, 0.9],
        q: [0, 0, 1.1],
      };
      const turn = turns[event.key];
      if (turn) view.orbit(...turn);
    });
    element("cell-tools").append(button("⌂", "Show the whole cell", () => view.lookAtAll()));
    return view;
  } catch (error) {
    // Browsers without a graphics driver have no WebGL. The rest of the page works without it.
    host.textContent = `No view in 3D: ${error instanceof Error ? error.message : error}`;
    return undefined;
  }
}

function summary(recording: Recording): void {
  const { head } = recording;
  document.title = `${head.program} - rpi view`;
  element("title").textContent = head.program;
  const seconds = timeText((recording.last + 1 - recording.first) * recording.tickSeconds, recording.tickSeconds);
  const notes = [`${recording.last + 1 - recording.first} cycles, ${seconds}`, ...head.arms.map((arm) => `${arm.name}: ${arm.model}`)];
  if (head.lost > 0) notes.push(`${head.lost} ticks lost`);
  if (head.cut !== null) notes.push(`cut off: ${head.cut}`);
  if (!head.exact) notes.push("values rounded to 31 bits");
  element("summary").textContent = notes.join(" · ");
}

async function main(): Promise<void> {
  const recording = await load();
  summary(recording);
  const state = new ViewState(recording);
  const colours = new CommandColours(recording.head.activity.filter((a) => a.path === "").map((a) => a.command));
  const events = shownEvents(recording);
  const charts = new Charts(state);
  const values = new ValuesPanel(element("panel-values"), state, (flow) => charts.plot(flow));
  const list = new EventsPanel(element("panel-events"), state, events);
  const program = new ProgramPanel(element("panel-program"), state, colours);
  tabs(["program", "values", "events"], { program: () => program.opened(), values: () => values.opened(), events: () => list.opened() });
  new Timeline(element("timeline"), state, colours, events);
  new Transport(state, [...new Set(events.map((event) => event.tick))]);
  breakpoints(state);
  themes(state);
  legend(colours, state);
  const view = cell(state, colours);
  element("page").dataset.ready = "true";
  // Entry for scripts and tests.
  Object.assign(window, { rpiView: { recording, state, cell: view } });
}

main().catch((error: unknown) => {
  element("summary").textContent = `The recording cannot be shown: ${error instanceof Error ? error.message : error}`;
  element("page").dataset.ready = "failed";
});
