// Panels with text: values of all flows, events, and the program.

import type { Flow } from "./document";
import type { ShownEvent } from "./events";
import type { CommandColours } from "./palette";
import { type ViewState, short, timeText } from "./state";

/** Maximum number of rows that a list shows. The filter finds the others. */
const MAX_ROWS = 400;

/** Table of all flows with their values at the shown tick. */
export class ValuesPanel {
  private readonly body = document.createElement("tbody");
  private readonly note = document.createElement("p");
  private readonly filter = document.createElement("input");
  private shown: { flow: Flow; value: HTMLElement; text: string }[] = [];

  constructor(
    private readonly panel: HTMLElement,
    private readonly state: ViewState,
    private readonly plot: (flow: Flow) => void,
  ) {
    const { filter } = this;
    filter.type = "search";
    filter.placeholder = "Filter flows";
    filter.setAttribute("aria-label", "Filter flows");
    filter.addEventListener("input", () => this.list(filter.value));
    const table = document.createElement("table");
    table.innerHTML = "<thead><tr><th>Flow</th><th>Value</th><th>Unit</th><th>Chart</th></tr></thead>";
    table.append(this.body);
    panel.append(filter, table, this.note);
    this.list("");
    state.onTick(() => this.update());
  }

  private list(filter: string): void {
    const words = filter.toLowerCase().split(/\s+/);
    const flows = this.state.recording.flows.filter((flow) => words.every((word) => flow.id.toLowerCase().includes(word)));
    this.shown = flows.slice(0, MAX_ROWS).map((flow) => this.row(flow));
    this.note.textContent = flows.length > MAX_ROWS ? `${flows.length - MAX_ROWS} more flows: use the filter` : "";
    this.update();
  }

  private row(flow: Flow): { flow: Flow; value: HTMLElement; text: string } {
    const row = document.createElement("tr");
    const cells = [flow.id, "", flow.unit(), ""].map((text) => {
      const cell = document.createElement("td");
      cell.textContent = text;
      row.append(cell);
      return cell;
    });
    const plot = document.createElement("button");
    plot.type = "button";
    plot.textContent = "Plot";
    plot.setAttribute("aria-label", `Plot ${flow.id}`);
    plot.addEventListener("click", () => this.plot(flow));
    cells[3]!.append(plot);
    if (this.shown.length === 0) this.body.replaceChildren();
    this.body.append(row);
    return { flow, value: cells[1]!, text: "" };
  }

  private update(): void {
    const ids = new Set(this.shown.map(({ value }) => value.parentElement));
    for (const row of [...this.body.children]) if (!ids.has(row as HTMLElement)) row.remove();
    if (this.panel.hidden) return;
    for (const row of this.shown) {
      const text = short(row.flow.at(this.state.tick), row.flow.kind);
      if (text !== row.text) row.value.textContent = row.text = text;
    }
  }

  /** Shows the values anew after the panel was hidden. */
  opened(): void {
    this.update();
  }

  /** Lists the flows anew after some were added. */
  flowsChanged(): void {
    this.list(this.filter.value);
  }
}

/** List of events; each leads to its tick. */
export class EventsPanel {
  private readonly list = document.createElement("ol");
  private readonly note = document.createElement("p");
  private readonly items: HTMLButtonElement[] = [];
  private current = -1;

  constructor(
    private readonly panel: HTMLElement,
    private readonly state: ViewState,
    private readonly events: ShownEvent[],
  ) {
    this.list.className = "events";
    panel.append(this.list, this.note);
    this.fill();
    state.onTick(() => this.update());
    state.onGrow(() => this.fill());
  }

  /** Adds the events that are not listed yet. */
  private fill(): void {
    const { events, state } = this;
    for (const event of events.slice(this.items.length, MAX_ROWS)) {
      const [item, press] = [document.createElement("li"), document.createElement("button")];
      press.type = "button";
      press.className = event.severity;
      press.textContent = `${timeText(state.seconds(event.tick), state.recording.tickSeconds)}  ${event.text}`;
      press.addEventListener("click", () => state.seek(event.tick));
      item.append(press);
      this.list.append(item);
      this.items.push(press);
    }
    const more = events.length - MAX_ROWS;
    this.note.textContent = more > 0 ? `${more} more events: step through them with N and P` : events.length === 0 ? "No events." : "";
    this.update();
  }

  private update(): void {
    const next = this.events.findIndex((event) => event.tick > this.state.tick);
    const current = Math.min((next < 0 ? this.events.length : next) - 1, this.items.length - 1);
    if (current === this.current) return;
    this.items[this.current]?.removeAttribute("aria-current");
    this.current = current;
    this.items[current]?.setAttribute("aria-current", "true");
    if (!this.panel.hidden) this.opened();
  }

  /** Scrolls to the current event. */
  opened(): void {
    const item = this.items[this.current];
    if (item) this.panel.scrollTop = item.offsetTop - this.panel.clientHeight / 2;
  }
}

/** Text of the program; the declarations of the commands that run are marked. */
export class ProgramPanel {
  private readonly lines: HTMLElement[] = [];
  private readonly ranges = new Map<string, [number, number]>();
  private marked = "";
  private chosen?: HTMLElement;

  constructor(
    private readonly panel: HTMLElement,
    private readonly state: ViewState,
    private readonly colours: CommandColours,
  ) {
    const { source } = state.recording.head;
    if (source === null) {
      panel.append("The recording has no text of the program.");
      return;
    }
    const list = document.createElement("ol");
    list.className = "source";
    const texts = source.replace(/\n$/, "").split("\n");
    texts.forEach((text) => {
      const line = document.createElement("li");
      line.textContent = text || " ";
      list.append(line);
      this.lines.push(line);
    });
    panel.append(list);
    this.findCommands(texts);
    state.onTick(() => this.update());
    state.onTheme(() => this.update(true));
    this.update();
  }

  private findCommands(texts: string[]): void {
    for (let k = 0; k < texts.length; k++) {
      const name = /^command\s+(\w+)/.exec(texts[k]!)?.[1];
      if (name === undefined) continue;
      const end = texts.findIndex((text, j) => j > k && /^tel\b/.test(text));
      this.ranges.set(name, [k, end < 0 ? k : end]);
    }
  }

  private update(again = false): void {
    const running = this.state.recording.commandsAt(this.state.tick).map((a) => a.command);
    const key = running.join(" ");
    if (key === this.marked && !again) return;
    this.marked = key;
    this.lines.forEach((line) => (line.style.boxShadow = line.className = ""));
    for (const command of running) {
      const [from, to] = this.ranges.get(command) ?? [0, -1];
      this.lines.slice(from, to + 1).forEach((line) => {
        line.className = "running";
        line.style.boxShadow = `inset 4px 0 ${this.colours.of(command)}`;
      });
    }
    if (!this.panel.hidden && !this.chosen) this.opened();
  }

  /** Marks a line of a file and scrolls to it. Returns false if the file is another one than the program. */
  showLine(file: string, number: number): boolean {
    this.chosen?.removeAttribute("aria-current");
    this.chosen = undefined;
    const name = (path: string) => path.split(/[\\/]/).pop();
    const line = this.lines[number - 1];
    if (name(file) !== name(this.state.recording.head.program) || !line) return false;
    this.chosen = line;
    line.setAttribute("aria-current", "true");
    this.panel.scrollTop = line.offsetTop - this.panel.clientHeight / 2;
    return true;
  }

  /** Scrolls to the chosen line, or to the first command that runs. */
  opened(): void {
    if (this.chosen) {
      this.panel.scrollTop = this.chosen.offsetTop - this.panel.clientHeight / 2;
      return;
    }
    const line = this.lines.find((line) => line.className === "running");
    if (line) this.panel.scrollTop = line.offsetTop - 40;
  }
}
