// A run that goes on: requests its new values, and loads the recording when it has ended.

import { loadSince } from "./document";
import { button } from "./button";
import type { ViewState } from "./state";

/** Time between two requests in ms. */
const INTERVAL = 150;
/** Time after which a server that does not answer is asked again, in ms. */
const RETRY = 1000;
/** Number of requests without an answer after which the run counts as ended. */
const MAX_RETRIES = 5;

/** Follows a run. `grown` is called after each change, with whether there are new flows. */
export class LiveRun {
  private failures = 0;
  private readonly press: HTMLButtonElement;

  constructor(
    host: HTMLElement,
    private readonly state: ViewState,
    private readonly grown: (hasNewFlows: boolean) => void,
    private readonly say: (text: string) => void,
  ) {
    this.press = button("Live", "Follow the end of the run (L)", () => state.follow());
    this.press.id = "follow";
    host.append(this.press);
    state.onTick(() => this.show());
    this.show();
    document.addEventListener("keydown", (event) => {
      const isField = /^(INPUT|SELECT|TEXTAREA)$/.test((event.target as HTMLElement).tagName);
      if (event.key === "l" && !isField && !event.ctrlKey && !event.metaKey && !event.altKey) state.follow();
    });
    void this.poll();
  }

  private show(): void {
    this.press.setAttribute("aria-pressed", String(this.state.isFollowing));
  }

  private async poll(): Promise<void> {
    let delay = INTERVAL;
    try {
      const { recording } = this.state;
      const later = await loadSince(recording.last + 1);
      if (!later) return this.ended();
      this.failures = 0;
      if (later.head.ticks[1] > recording.head.ticks[1]) this.grown(recording.append(later));
    } catch (error) {
      this.failures++;
      delay = RETRY;
      if (this.failures > MAX_RETRIES) {
        this.press.remove();
        return this.say(`The run is no longer served: ${error instanceof Error ? error.message : error}`);
      }
    }
    setTimeout(() => void this.poll(), delay);
  }

  /** Loads the recording, which has the activity of fragments, too. The shown cycle stays. */
  private ended(): void {
    location.hash = `tick=${this.state.tick}`;
    location.reload();
  }
}

/** Returns the tick that was shown before the page was loaded again; `undefined` if there is none. */
export function shownBefore(): number | undefined {
  const tick = /^#tick=(\d+)$/.exec(location.hash)?.[1];
  return tick === undefined ? undefined : Number(tick);
}
