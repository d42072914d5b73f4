// Causes of a value: each step leads to its cycle, its line and its box in the net.

import { type ViewState, timeText } from "./state";

interface WhyStep {
  /** Number of the step of which this one is a cause. */
  of: number | null;
  name: string;
  value: string;
  tick: number;
  since: number;
  file: string | null;
  line: number | null;
}

interface WhyAnswer {
  steps: WhyStep[];
  isIncomplete: boolean;
}

/** Shows the place of a step: its flow, and its line in the program. */
type ShowStep = (command: string, flow: string, file: string | null, line: number | null) => void;

export class WhyPanel {
  private readonly text = document.createElement("p");
  private request = 0;

  constructor(
    private readonly panel: HTMLElement,
    private readonly state: ViewState,
    private readonly showStep: ShowStep,
  ) {
    this.text.className = "note";
    this.text.setAttribute("role", "status");
    const { isServed } = state.recording;
    this.text.textContent = isServed
      ? "Select a flow in the net and press Why: the causes of its value at the cursor are listed here."
      : "A report has no causes. Use `rpi view` or `rpi why` with the recording.";
    panel.append(this.text);
  }

  /** Requests and shows the causes of the value of a flow at the shown cycle. */
  async ask(command: string, flow: string): Promise<void> {
    const { tick } = this.state;
    const own = ++this.request;
    this.say(`Looking for the causes of ${command}.${flow} …`);
    const response = await fetch(`why/${tick}/${encodeURIComponent(`${command}.${flow}`)}`);
    if (own !== this.request) return;
    if (!response.ok) return this.say(await response.text());
    const answer = (await response.json()) as WhyAnswer;
    const lists = answer.steps.map(() => list());
    const top = list();
    answer.steps.forEach((step, k) => {
      const item = document.createElement("li");
      item.append(this.step(command, step), lists[k]!);
      (step.of === null ? top : lists[step.of]!).append(item);
    });
    for (const own of lists) if (own.children.length === 0) own.remove();
    this.say(`Why ${command}.${flow} has its value at ${this.time(tick)}${answer.isIncomplete ? "; further causes are left out" : ""}`);
    this.panel.append(top);
  }

  private say(text: string): void {
    this.text.textContent = text;
    this.panel.replaceChildren(this.text);
  }

  private time(tick: number): string {
    return timeText(this.state.seconds(tick), this.state.recording.tickSeconds);
  }

  private step(command: string, step: WhyStep): HTMLElement {
    const [press, place] = [document.createElement("button"), document.createElement("span")];
    press.type = "button";
    const time = step.since < step.tick ? ` from ${this.time(step.since)} to ${this.time(step.tick)}` : ` at ${this.time(step.tick)}`;
    press.textContent = step.value === "" ? step.name : `${step.name} = ${step.value}${time}`;
    place.className = "place";
    place.textContent = step.line === null ? "" : `  ${step.file?.split("/").pop()}:${step.line}`;
    press.append(place);
    press.addEventListener("click", () => {
      this.state.seek(step.tick);
      this.showStep(command, step.name, step.file, step.line);
    });
    return press;
  }
}

function list(): HTMLOListElement {
  const made = document.createElement("ol");
  made.className = "why";
  return made;
}
