// State that all parts of the page share: the shown tick, the visible range of ticks, and the theme.

import type { Recording } from "./document";

type Listener = () => void;

/** Time in s that is visible while a run is followed, if it was not changed. */
const FOLLOWED = 10;

/** The shown tick and the visible range of ticks. Parts of the page are notified of changes in the next frame. */
export class ViewState {
  private tickListeners: Listener[] = [];
  private rangeListeners: Listener[] = [];
  private themeListeners: Listener[] = [];
  private growListeners: Listener[] = [];
  private pending = new Set<Listener>();
  private current: number;
  private visible: [number, number];
  /** Script time of the last update in ms, for the tests. */
  updateMs = 0;
  /** Whether the shown tick is the last one of a run that goes on. */
  private follows: boolean;

  constructor(readonly recording: Recording) {
    this.follows = recording.isLive;
    this.current = this.follows ? recording.last : recording.first;
    this.visible = [recording.first, recording.last + 1];
    if (this.follows) this.showEnd();
  }

  get isFollowing(): boolean {
    return this.follows;
  }

  /** Shows the last tick of a run, and those that follow. */
  follow(): void {
    this.follows = true;
    this.moveTo(this.recording.last);
    this.showEnd();
    this.schedule(this.tickListeners);
  }

  onGrow(listener: Listener): void {
    this.growListeners.push(listener);
  }

  /** Notes that the run has gone on. */
  grown(): void {
    this.schedule(this.growListeners);
    if (!this.follows) return;
    this.moveTo(this.recording.last);
    this.showEnd();
  }

  /** Makes the end of the run visible, with as much time as was visible before, at least some seconds. */
  private showEnd(): void {
    const width = Math.max(this.visible[1] - this.visible[0], FOLLOWED / this.recording.tickSeconds);
    const end = this.recording.last + 1;
    this.visible = [Math.max(this.recording.first, end - width), end];
    this.schedule(this.rangeListeners);
  }

  get tick(): number {
    return this.current;
  }

  get range(): [number, number] {
    return this.visible;
  }

  onTick(listener: Listener): void {
    this.tickListeners.push(listener);
  }

  onRange(listener: Listener): void {
    this.rangeListeners.push(listener);
  }

  onTheme(listener: Listener): void {
    this.themeListeners.push(listener);
  }

  themeChanged(): void {
    this.schedule(this.themeListeners);
  }

  /** Shows a tick. The visible range moves so that it contains the tick. A run that goes on is no longer followed. */
  seek(tick: number): void {
    this.follows = false;
    this.moveTo(tick);
  }

  private moveTo(tick: number): void {
    const { first, last } = this.recording;
    const next = Math.min(last, Math.max(first, Math.round(tick)));
    if (next === this.current) return;
    this.current = next;
    this.schedule(this.tickListeners);
    const [from, to] = this.visible;
    if (next < from || next >= to) this.show(next - (to - from) / 2, next + (to - from) / 2);
  }

  /** Makes a range of ticks visible, at least ten, within the recording. */
  show(from: number, to: number): void {
    const { first, last } = this.recording;
    const width = Math.min(Math.max(10, to - from), last + 1 - first);
    const start = Math.min(Math.max(first, from), last + 1 - width);
    if (start === this.visible[0] && start + width === this.visible[1]) return;
    this.visible = [start, start + width];
    this.schedule(this.rangeListeners);
  }

  /** Multiplies the visible range by a factor, so that `centre` stays in its place. */
  zoom(factor: number, centre = this.current): void {
    const [from, to] = this.visible;
    this.show(centre - (centre - from) * factor, centre + (to - centre) * factor);
  }

  showAll(): void {
    this.show(this.recording.first, this.recording.last + 1);
  }

  /** Returns the time of a tick in seconds since the start of the run. */
  seconds(tick: number): number {
    return tick * this.recording.tickSeconds;
  }

  private schedule(listeners: Listener[]): void {
    if (this.pending.size === 0) requestAnimationFrame(() => this.update());
    listeners.forEach((listener) => this.pending.add(listener));
  }

  private update(): void {
    const start = performance.now();
    const due = [...this.pending];
    this.pending.clear();
    due.forEach((listener) => listener());
    this.updateMs = performance.now() - start;
  }
}

/** Returns a number with few digits, for people. */
export function short(value: number | undefined, kind: "bool" | "int" | "real" = "real"): string {
  if (value === undefined || Number.isNaN(value)) return value === undefined ? "absent" : "–";
  if (kind === "bool") return value !== 0 ? "true" : "false";
  if (kind === "int" || value === 0) return String(value);
  const size = Math.abs(value);
  return size >= 1e-4 && size < 1e6 ? value.toFixed(Math.max(0, 5 - Math.floor(Math.log10(Math.max(size, 1))))) : value.toExponential(4);
}

/** Returns the text of a time, such as `12.345 s`. `tickSeconds` decides the number of digits. */
export function timeText(seconds: number, tickSeconds: number): string {
  const digits = Math.min(9, Math.max(0, Math.ceil(-Math.log10(tickSeconds) - 1e-9)));
  return `${seconds.toFixed(digits)} s`;
}
