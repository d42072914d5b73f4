// Values and activity of the boxes of a net at the shown cycle: from the server, which replays the recording with all flows, or, in a report, from
// the recorded flows.

import { type Flow, type Recording, isWithin, type Span } from "../document";
import { type ViewState, short } from "../state";
import type { NetBox, NetGraph } from "./graph";

/** Values of the commands in a cycle, as the server sends them. */
interface CycleAnswer {
  tick: number;
  commands: { name: string; id: number; cycle: number; values: Record<string, string | null> }[];
}

/** Maximum number of numbers of a structured value that a box shows. */
const MAX_PARTS = 3;

export class NetValues {
  private answer?: CycleAnswer;
  private pending = false;
  /** Recorded numbers by flow, and the number of all flows when they were looked up. */
  private readonly recorded = new Map<string, { count: number; flows: Flow[] }>();
  private readonly structure = new Map<string, Map<string, string[]>>();
  private readonly spans = new Map<string, Span[] | undefined>();
  /** Reason why the server has no values; empty if it has them. */
  note = "";

  constructor(
    private readonly state: ViewState,
    private readonly changed: () => void,
  ) {}

  private get recording(): Recording {
    return this.state.recording;
  }

  /** Requests the values of the shown cycle, one request at a time. */
  async update(): Promise<void> {
    if (!this.recording.isServed || this.recording.isLive || this.pending || this.note !== "") return;
    const { tick } = this.state;
    if (this.answer?.tick === tick) return;
    this.pending = true;
    try {
      const response = await fetch(`cycle/${tick}`);
      if (response.ok) this.answer = { ...((await response.json()) as CycleAnswer), tick };
      else this.note = await response.text();
    } catch {
      this.note = "the server does not answer";
    }
    this.pending = false;
    this.changed();
    if (this.state.tick !== tick) await this.update();
  }

  /** Returns the value of a flow of a box as text; `undefined` if it is not known. */
  text(net: NetGraph, box: NetBox, name = box.flow): string | undefined {
    const { tick } = this.state;
    if (name !== null && this.answer?.tick === tick) {
      const command = this.answer.commands.find((command) => command.name === net.command);
      if (command) return this.flowValue(command, name);
    }
    const parts = this.flows(net, box, name);
    if (parts.length === 0) return undefined;
    const texts = parts.slice(0, MAX_PARTS).map((flow) => short(flow.at(tick), flow.kind));
    return parts.length === 1 ? texts[0] : `(${texts.join(", ")}${parts.length > MAX_PARTS ? ", …" : ""})`;
  }

  private flowValue({ name, values }: CycleAnswer["commands"][number], flow: string): string {
    const own = values[flow];
    if (own !== undefined) return own === null ? "absent" : shortText(own);
    // A list or a call has one value for each of its parts.
    const parts = this.parts(name, values).get(flow);
    if (!parts) return "absent";
    const texts = parts.slice(0, MAX_PARTS).map((part) => shortText(values[part] ?? "absent"));
    return `(${texts.join(", ")}${parts.length > MAX_PARTS ? ", …" : ""})`;
  }

  /** Returns the names of the parts of each list or call of a command, which are the same in every cycle. */
  private parts(command: string, values: Record<string, string | null>): Map<string, string[]> {
    const known = this.structure.get(command);
    if (known) return known;
    const made = new Map<string, string[]>();
    for (const name of Object.keys(values)) {
      for (const { index } of name.matchAll(/[.[]/g)) {
        const whole = name.slice(0, index);
        const parts = made.get(whole);
        if (parts) parts.push(name);
        else made.set(whole, [name]);
      }
    }
    this.structure.set(command, made);
    return made;
  }

  /** Returns the recorded numbers of a flow of a box. */
  flows(net: NetGraph, box: NetBox, name = box.flow): Flow[] {
    const key = `${net.command} ${name ?? `${box.kind} ${box.name}`}`;
    const known = this.recorded.get(key);
    if (known && known.count === this.recording.flows.length) return known.flows;
    const names = { sensor: `/sensors/${box.name}`, actuator: `/set_points/${box.name}` };
    const id = box.kind === "sensor" || box.kind === "actuator" ? names[box.kind] : name === null ? undefined : `/command/${net.command}.${name}`;
    const fits = (flow: Flow) => id !== undefined && flow.id.startsWith(id) && /^($|[.[])/.test(flow.id.slice(id.length));
    const found = this.recording.flows.filter(fits);
    this.recorded.set(key, { count: this.recording.flows.length, flows: found });
    return found;
  }

  /** Returns whether the fragment around a box is active; `undefined` if the activity is not known. */
  isActive(net: NetGraph, path: string): boolean | undefined {
    // The activity of fragments comes from a replay, after the run.
    if (path !== "" && this.recording.isLive) return undefined;
    const key = `${net.command}:${path}`;
    if (!this.spans.has(key) || this.recording.isLive) {
      const own = this.recording.head.activity.filter((a) => a.command === net.command);
      const found = own.filter((a) => a.path === path).flatMap((a) => a.spans);
      this.spans.set(key, own.length > 0 ? found.sort((a, b) => a[0] - b[0]) : undefined);
    }
    const spans = this.spans.get(key);
    return spans && isWithin(spans, this.state.tick);
  }
}

/** Shortens a literal of the language: numbers get few digits, and long texts end early. */
function shortText(text: string): string {
  // Of a pose, the position.
  const position = /^\{pos:\{x:([^,]*),y:([^,]*),z:([^}]*)\}/.exec(text);
  const shown = (position ? `(${position.slice(1).join(", ")})` : text).replace(/-?\d+\.\d+(?:[eE][-+]?\d+)?/g, (number) => short(Number(number)));
  return shown.length > 40 ? `${shown.slice(0, 39)}…` : shown;
}
