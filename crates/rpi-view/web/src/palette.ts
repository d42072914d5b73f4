// Colours. A command has the same colour in the path, the timeline and the program.

/** Colours that people with a colour vision deficiency distinguish (Okabe and Ito, 2008), for both themes. */
const LIGHT = ["#0072b2", "#d55e00", "#009e73", "#b3478c", "#a07800", "#2c8fc9", "#6b4fbb", "#5f6b73"];
const DARK = ["#4fa8e0", "#ff8a3d", "#2fcf9f", "#e68fc4", "#e6c229", "#8bd0f5", "#a993f0", "#aab6be"];

export function isDark(): boolean {
  const chosen = document.documentElement.dataset.theme;
  return chosen ? chosen === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
}

/** Returns the colour with this number, of the present theme. */
export function colour(k: number): string {
  const colours = isDark() ? DARK : LIGHT;
  return colours[((k % colours.length) + colours.length) % colours.length]!;
}

/** Returns the value of a colour of the style sheet. */
export function style(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

/** Numbers of the colours of commands, in the order in which the commands first ran. */
export class CommandColours {
  private readonly numbers = new Map<string, number>();

  constructor(names: Iterable<string>) {
    this.add(names);
  }

  /** Gives colours to further commands. Returns whether there are any. */
  add(names: Iterable<string>): boolean {
    const before = this.numbers.size;
    for (const name of names) if (!this.numbers.has(name)) this.numbers.set(name, this.numbers.size);
    return this.numbers.size > before;
  }

  of(command: string): string {
    return colour(this.numbers.get(command) ?? 7);
  }

  names(): string[] {
    return [...this.numbers.keys()];
  }
}
