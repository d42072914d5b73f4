// Events of a run in the words of the user, and takeovers, which follow from the ends and starts of commands.

import type { ActivityHead, RecordedEvent, Recording } from "./document";

export type Severity = "info" | "takeover" | "warning" | "error";

export interface ShownEvent {
  tick: number;
  text: string;
  severity: Severity;
  command?: string;
}

/** Kinds of events that only show how the server and the core talk to one another. */
const INTERNAL = new Set(["answer", "freed", "scheduled", "rule"]);

/** Returns the events that concern the user, in the order of time. */
export function shownEvents(recording: Recording): ShownEvent[] {
  const { head } = recording;
  const roots = head.activity.filter((a) => a.path === "");
  const shown: ShownEvent[] = [];
  const moving = new Map<string, boolean>();
  // The core and the devices report apart, so that events arrive in another order.
  const events = [...head.events].sort((a, b) => a.tick - b.tick);
  for (const event of events) {
    if (event.event === "device") moving.set(event.device ?? "", event.moving === true);
    if (event.tick < recording.first || event.tick > recording.last) continue;
    const failed = event.event === "answer" && event.refused !== null;
    if (INTERNAL.has(event.event) && !failed && !(event.event === "rule" && event.outcome !== "fired")) continue;
    shown.push({ tick: event.tick, command: event.command, ...describe(event, roots, moving) });
  }
  return shown;
}

function describe(event: RecordedEvent, roots: ActivityHead[], moving: Map<string, boolean>): { text: string; severity: Severity } {
  const info = (text: string, severity: Severity = "info") => ({ text, severity });
  const name = event.command ?? event.device ?? "";
  switch (event.event) {
    case "started": {
      const before = predecessor(event, roots, moving);
      return before ? info(`${name} takes over from ${before}`, "takeover") : info(`${name} starts`);
    }
    case "ended":
      return ending(event);
    case "device":
      return event.code ? info(`${name}: error ${event.code}`, "error") : info(event.moving ? `${name} moves` : `${name} is at rest`);
    case "braked":
      return info(`${event.device} brakes after ${name}`, "warning");
    case "jumped":
      return info(`${name}: discontinuity of ${event.quantity}: ${event.value}, limit ${event.limit}`, "warning");
    case "overrun":
      return info(`overrun by ${event.late_ns} ns${event.command ? ` in ${event.command} ${event.fragment ?? ""}` : ""}`, "warning");
    case "lost":
      return info(`${event.ticks} ticks lost`, "warning");
    case "answer":
      return info(`request ${event.ticket} rejected: ${event.refused}`, "warning");
    case "rule":
      return info(`rule ${event.rule} ${event.outcome}: ${event.why ?? ""}`, "warning");
    default:
      return info(`${event.event} ${name}`.trim());
  }
}

function ending(event: RecordedEvent): { text: string; severity: Severity } {
  const { command, cause, what } = event;
  const after = `${event.cycles} cycles`;
  if (cause === "result") return { text: `${command} ends with ${what} after ${after}`, severity: event.error ? "error" : "info" };
  if (cause === "terminate") return { text: `${command} ends after ${after}${event.error ? `, error ${event.error}` : ""}`, severity: event.error ? "error" : "info" };
  return { text: `${command}: ${cause}${what ? `, ${what}` : ""} after ${after}`, severity: "error" };
}

/** Returns the command from which a command takes over a device in motion; `undefined` if there is none. */
function predecessor(event: RecordedEvent, roots: ActivityHead[], moving: Map<string, boolean>): string | undefined {
  const own = roots.find((a) => a.id === event.id);
  const devices = own?.devices.filter((device) => moving.get(device)) ?? [];
  const ends = (a: ActivityHead) => a.spans.some(([, to]) => to === event.tick) && a.devices.some((d) => devices.includes(d));
  return own && roots.find((a) => a !== own && ends(a))?.command;
}
