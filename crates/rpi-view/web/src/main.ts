// Page that shows a recording: the cell in 3D, charts, a timeline, and the program.

import { button } from "./button";
import { Chart, type ChartContent } from "./chart";
import { ConditionError, condition, search } from "./condition";
import { type Flow, type Recording, load } from "./document";
import { type ShownEvent, shownEvents } from "./events";
import { LiveRun, shownBefore } from "./live";
import { NetPanel } from "./net/panel";
import { CommandColours } from "./palette";
import { EventsPanel, ProgramPanel, ValuesPanel } from "./panels";
import { CellView } from "./scene";
import { ViewState, timeText } from "./state";
import { Timeline } from "./timeline";
import { WhyPanel } from "./why";

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
  private readonly titles = new Set<string>();

  constructor(private readonly state: ViewState) {
    this.addNew();
  }

  /** Adds charts for the flows with which the page opens, except those that it has had. */
  addNew(): void {
    for (const content of firstCharts(this.state.recording)) {
      if (this.titles.has(content.title)) continue;
      this.titles.add(content.title);
      this.add(content);
    }
  }

  add(content: ChartContent): Chart {
    const chart = new Chart(this.state, content, (closed) => closed.element.remove());
    this.host.append(chart.element);
    return chart;
  }

  /** Adds a chart with flows and scrolls to it. */
  plot(flows: Flow[]): void {
    const lines = flows.slice(0, MAX_LINES).map((flow, k) => ({ flow, label: lineLabel(flow), measured: false, colour: k }));
    if (flows.length === 0) return;
    const title = flows.length === 1 ? flows[0]!.id : flows[0]!.family;
    const { element } = this.add({ title: title.replace(/^\//, ""), lines });
    element.scrollIntoView({ block: "nearest" });
  }
}

/** Tabs that show one panel of several. Returns the function that opens one. */
function tabs(names: string[], opened: Record<string, () => void>, first = names[0]!): (name: string) => void {
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
  select(first);
  return select;
}

/** Button that shows the cell or the net in place of the charts. */
function enlarge(): void {
  const press = element<HTMLButtonElement>("enlarge");
  press.addEventListener("click", () => {
    const isLarge = document.querySelector("main")!.classList.toggle("large");
    press.setAttribute("aria-pressed", String(isLarge));
  });
}

/** Slider, buttons and keys that move through the recording. */
class Transport {
  private readonly slider = element<HTMLInputElement>("slider");
  private readonly readout = element<HTMLOutputElement>("readout");
  private readonly play = element<HTMLButtonElement>("play");
  private playing?: { tick: number; at: number };

  constructor(
    private readonly state: ViewState,
    private readonly events: ShownEvent[],
  ) {
    this.setEnds();
    state.onGrow(() => {
      this.setEnds();
      this.update();
    });
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

  private setEnds(): void {
    const { first, last } = this.state.recording;
    Object.assign(this.slider, { min: String(first), max: String(last), step: "1" });
  }

  private step(ticks: number): void {
    this.state.seek(this.state.tick + ticks);
  }

  private toEvent(direction: 1 | -1): void {
    const { tick } = this.state;
    const next = direction > 0 ? this.events.find((event) => event.tick > tick) : this.events.findLast((event) => event.tick < tick);
    if (next) this.state.seek(next.tick);
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
  state.onGrow(fill);
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
  if (head.live) notes.push("the run goes on");
  if (!head.exact) notes.push("values rounded to 31 bits");
  element("summary").textContent = notes.join(" · ");
}

/** The net of a command, the causes of values, and what leads from one to the other. */
function netAndCauses(state: ViewState, charts: Charts, panels: { program: ProgramPanel; values: ValuesPanel }, openText: (name: string) => void): { net: NetPanel; why: WhyPanel } {
  const { recording } = state;
  const why: WhyPanel = new WhyPanel(element("panel-why"), state, (command, flow, file, line) => {
    net.show(command, flow);
    if (file !== null && line !== null) panels.program.showLine(file, line);
  });
  const net = new NetPanel(element("panel-net"), state, {
    showLine: (file, line) => panels.program.showLine(file, line),
    why: (command, flow) => {
      openText("why");
      void why.ask(command, flow);
    },
    plot: async (recorded, name) => {
      if (recorded.length > 0) return charts.plot(recorded);
      charts.plot(await recording.loadFlow(name));
      panels.values.flowsChanged();
    },
  });
  return { net, why };
}

/** Follows a run that goes on. */
function live(state: ViewState, parts: { colours: CommandColours; events: ShownEvent[]; charts: Charts; values: ValuesPanel }): void {
  const { recording } = state;
  const grown = (hasNewFlows: boolean) => {
    parts.colours.add(commandNames(recording));
    parts.events.splice(0, Infinity, ...shownEvents(recording));
    if (hasNewFlows) {
      parts.charts.addNew();
      parts.values.flowsChanged();
    }
    summary(recording);
    state.grown();
  };
  new LiveRun(element("live"), state, grown, (text) => (element("summary").textContent = text));
}

function commandNames(recording: Recording): string[] {
  return recording.head.activity.filter((a) => a.path === "").map((a) => a.command);
}

async function main(): Promise<void> {
  const recording = await load();
  summary(recording);
  const state = new ViewState(recording);
  const colours = new CommandColours(commandNames(recording));
  const events = shownEvents(recording);
  const charts = new Charts(state);
  const values = new ValuesPanel(element("panel-values"), state, (flow) => charts.plot([flow]));
  const list = new EventsPanel(element("panel-events"), state, events);
  const program = new ProgramPanel(element("panel-program"), state, colours);
  const opened = { program: () => program.opened(), values: () => values.opened(), events: () => list.opened() };
  const openText = tabs(["program", "values", "events", "why"], opened);
  new Timeline(element("timeline"), state, colours, events);
  new Transport(state, events);
  breakpoints(state);
  themes(state);
  legend(colours, state);
  const { net } = netAndCauses(state, charts, { program, values }, openText);
  const view = cell(state, colours);
  tabs(["cell", "net"], { net: () => net.opened() }, recording.head.arms.length > 0 ? "cell" : "net");
  enlarge();
  if (recording.isLive) live(state, { colours, events, charts, values });
  const tick = shownBefore();
  if (tick !== undefined) state.seek(tick);
  element("page").dataset.ready = "true";
  // Entry for scripts and tests.
  Object.assign(window, { rpiView: { recording, state, cell: view, net } });
}

main().catch((error: unknown) => {
  element("summary").textContent = `The recording cannot be shown: ${error instanceof Error ? error.message : error}`;
  element("page").dataset.ready = "failed";
});
