// Conditions over recorded flows, for breakpoints: `z > 0.45 and abs(/set_points/arm.joints[0]) < 1`.
//
// The operators are those of the language: or, and, not, = <> < <= > >=, + - * /. A name is a flow, or the end of the
// name of exactly one flow. `active(Name)` is true while a command or fragment is active.

import { type Flow, type Recording, isWithin } from "./document";

/** Value of an expression in a tick. Truth values are 0 and 1, an absent value is NaN. */
type Evaluate = (tick: number) => number;

export class ConditionError extends Error {}

const TOKEN = /\s*(?:(\d+(?:\.\d+)?(?:[eE][-+]?\d+)?)|(<>|<=|>=|[=<>+\-*(),])|(\/?[A-Za-z_][\w./]*(?:\[\d+\][\w.]*)*)|(\/))/y;

const FUNCTIONS: Record<string, { arity: number; of: (...values: number[]) => number }> = {
  abs: { arity: 1, of: Math.abs },
  sqrt: { arity: 1, of: Math.sqrt },
  min: { arity: 2, of: Math.min },
  max: { arity: 2, of: Math.max },
};

const COMPARISONS: Record<string, (a: number, b: number) => boolean> = {
  "=": (a, b) => a === b,
  "<>": (a, b) => a < b || a > b,
  "<": (a, b) => a < b,
  "<=": (a, b) => a <= b,
  ">": (a, b) => a > b,
  ">=": (a, b) => a >= b,
};

/** Parser of a condition by recursive descent. */
class Parser {
  private readonly tokens: string[] = [];
  private at = 0;

  constructor(
    text: string,
    private readonly recording: Recording,
  ) {
    const end = text.trimEnd().length;
    TOKEN.lastIndex = 0;
    while (TOKEN.lastIndex < end) {
      const start = TOKEN.lastIndex;
      // A slash after an operand is a division, elsewhere the beginning of a name.
      const found = TOKEN.exec(text);
      if (!found) throw new ConditionError(`unexpected text: ${text.slice(start)}`);
      const token = found[0].trim();
      if (token.length > 1 && token.startsWith("/") && isOperand(this.tokens.at(-1))) {
        this.tokens.push("/");
        TOKEN.lastIndex -= token.length - 1;
      } else this.tokens.push(token);
    }
  }

  parse(): Evaluate {
    const result = this.or();
    if (this.at < this.tokens.length) throw new ConditionError(`unexpected \`${this.tokens[this.at]}\``);
    return result;
  }

  private accept(...words: string[]): string | undefined {
    const token = this.tokens[this.at];
    if (token === undefined || !words.includes(token)) return undefined;
    this.at++;
    return token;
  }

  private expect(word: string): void {
    if (!this.accept(word)) throw new ConditionError(`expected \`${word}\` before ${this.tokens[this.at] ?? "the end"}`);
  }

  private or(): Evaluate {
    let left = this.and();
    while (this.accept("or")) {
      const [a, b] = [left, this.and()];
      left = (tick) => Number(isTrue(a(tick)) || isTrue(b(tick)));
    }
    return left;
  }

  private and(): Evaluate {
    let left = this.not();
    while (this.accept("and")) {
      const [a, b] = [left, this.not()];
      left = (tick) => Number(isTrue(a(tick)) && isTrue(b(tick)));
    }
    return left;
  }

  private not(): Evaluate {
    if (!this.accept("not")) return this.comparison();
    const operand = this.not();
    return (tick) => {
      const value = operand(tick);
      return Number.isNaN(value) ? NaN : Number(value === 0);
    };
  }

  private comparison(): Evaluate {
    const left = this.sum();
    const operator = this.accept(...Object.keys(COMPARISONS));
    if (!operator) return left;
    const [right, holds] = [this.sum(), COMPARISONS[operator]!];
    return (tick) => {
      const [a, b] = [left(tick), right(tick)];
      return Number.isNaN(a) || Number.isNaN(b) ? NaN : Number(holds(a, b));
    };
  }

  private sum(): Evaluate {
    let left = this.product();
    for (let operator; (operator = this.accept("+", "-")); ) {
      const [a, b] = [left, this.product()];
      left = operator === "+" ? (tick) => a(tick) + b(tick) : (tick) => a(tick) - b(tick);
    }
    return left;
  }

  private product(): Evaluate {
    let left = this.unary();
    for (let operator; (operator = this.accept("*", "/")); ) {
      const [a, b] = [left, this.unary()];
      left = operator === "*" ? (tick) => a(tick) * b(tick) : (tick) => a(tick) / b(tick);
    }
    return left;
  }

  private unary(): Evaluate {
    if (!this.accept("-")) return this.operand();
    const operand = this.unary();
    return (tick) => -operand(tick);
  }

  private operand(): Evaluate {
    const token = this.tokens[this.at++];
    if (token === undefined) throw new ConditionError("expected a value at the end");
    if (token === "(") {
      const inner = this.or();
      this.expect(")");
      return inner;
    }
    if (/^\d/.test(token)) return () => Number(token);
    if (token === "true" || token === "false") return () => Number(token === "true");
    if (!/^\/?[A-Za-z_]/.test(token)) throw new ConditionError(`expected a value before \`${token}\``);
    if (this.tokens[this.at] !== "(") return this.flow(token);
    this.at++;
    return token === "active" ? this.active() : this.call(token);
  }

  private call(name: string): Evaluate {
    const known = FUNCTIONS[name];
    if (!known) throw new ConditionError(`undefined function \`${name}\``);
    const values = [this.or()];
    while (this.accept(",")) values.push(this.or());
    this.expect(")");
    if (values.length !== known.arity) throw new ConditionError(`\`${name}\` has ${known.arity} arguments`);
    return (tick) => known.of(...values.map((value) => value(tick)));
  }

  private active(): Evaluate {
    const name = this.tokens[this.at++] ?? "";
    this.expect(")");
    const fits = (a: { command: string; path: string }) => {
      const path = a.path.replaceAll("/", ".");
      return a.command === name || (path !== "" && (path === name || `${a.command}.${path}` === name));
    };
    const found = this.recording.head.activity.filter((a) => (name.includes(".") || a.path !== "" ? fits(a) : a.command === name));
    if (found.length === 0) throw new ConditionError(`no command or fragment \`${name}\` was active`);
    return (tick) => Number(found.some((a) => isWithin(a.spans, tick)));
  }

  private flow(name: string): Evaluate {
    const flow = find(this.recording, name);
    return (tick) => flow.at(tick) ?? NaN;
  }
}

function isOperand(token: string | undefined): boolean {
  return token !== undefined && (token === ")" || /^[\d/A-Za-z_]/.test(token)) && !["and", "or", "not", "/"].includes(token);
}

function isTrue(value: number): boolean {
  return !Number.isNaN(value) && value !== 0;
}

/** Returns the flow with this name, or whose name ends with it. Throws an error if there is none or several. */
function find(recording: Recording, name: string): Flow {
  const exact = recording.flow(name);
  if (exact) return exact;
  const ends = recording.flows.filter((flow) => flow.id.endsWith(name) && /[./]/.test(flow.id[flow.id.length - name.length - 1] ?? "/"));
  if (ends.length === 1) return ends[0]!;
  if (ends.length === 0) throw new ConditionError(`undefined flow \`${name}\``);
  throw new ConditionError(`\`${name}\` is ambiguous: ${ends.slice(0, 3).map((flow) => flow.id).join(", ")}${ends.length > 3 ? ", ..." : ""}`);
}

/** Parses a condition. Throws a {@link ConditionError} if it has an error. */
export function condition(text: string, recording: Recording): (tick: number) => boolean {
  const evaluate = new Parser(text, recording).parse();
  return (tick) => isTrue(evaluate(tick));
}

/** Returns the next tick after `from` in a direction in which a condition begins to hold; `undefined` if there is none. */
export function search(holds: (tick: number) => boolean, recording: Recording, from: number, step: 1 | -1): number | undefined {
  const begins = (tick: number) => holds(tick) && (tick === recording.first || !holds(tick - 1));
  for (let tick = from + step; tick >= recording.first && tick <= recording.last; tick += step) {
    if (begins(tick)) return tick;
  }
  return undefined;
}
