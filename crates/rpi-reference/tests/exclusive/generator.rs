//! Random programs with two optional set-points, mutually exclusive by construction or not.

use crate::random::Random;
use std::fmt::Write as _;

/// In-ports of all programs.
pub(crate) const INPUTS: &str = "b, c, e: bool; n, k: int; x, y: real";

/// Program: equations for the optional flows `f` and `p`.
#[derive(Clone, Debug)]
pub(crate) struct GeneratedProgram {
    /// Equations.
    body: String,
    /// Whether `f` and `p` are mutually exclusive by construction.
    pub(crate) is_exclusive: bool,
}

impl GeneratedProgram {
    /// Returns a node that outputs in each cycle whether both are present.
    pub(crate) fn node(&self) -> String {
        format!(
            "type Mode = enum {{ A, B, G }};\nnode main ({INPUTS}) returns (both: bool)\nlet\n{}  both = present(f) and present(p);\ntel\n",
            self.body
        )
    }

    /// Returns a command that drives two ports of one actuator with them.
    pub(crate) fn command(&self) -> String {
        let inputs = ["b", "c", "e", "n", "k", "x", "y"];
        let reads: String = inputs.iter().map(|i| format!("  {i} = d.{i};\n")).collect();
        format!(
            "device D\n  actuator f: real | p: real;\n  sensor {INPUTS}; stop: bool;\ntype Mode = enum {{ A, B, G }};\ncommand Run (d: D)\nlet\n{reads}{}  d.f = f;\n  d.p = p;\n  finish done when d.stop;\ntel\n",
            self.body
        )
    }
}

/// Generates the program of a seed.
pub(crate) fn generate(seed: u64) -> GeneratedProgram {
    let mut maker = Generator {
        random: Random::new(seed),
        body: String::new(),
        names: 0,
    };
    let is_exclusive = maker.random.one_in(2);
    let conditions = match is_exclusive {
        true => maker.exclusive(),
        false => [maker.flow(2), maker.flow(2)],
    };
    for (name, condition) in ["f", "p"].into_iter().zip(conditions) {
        let set_point = maker.set_point(&condition);
        maker.equation(name, &set_point);
    }
    GeneratedProgram {
        body: maker.body,
        is_exclusive,
    }
}

struct Generator {
    random: Random,
    body: String,
    names: usize,
}

impl Generator {
    fn name(&mut self) -> String {
        self.names += 1;
        format!("v{}", self.names)
    }

    fn equation(&mut self, name: &str, value: &str) {
        let _ = writeln!(self.body, "  {name} = {value};");
    }

    /// Adds a flow with this value and returns its name.
    fn named(&mut self, value: &str) -> String {
        let name = self.name();
        self.equation(&name, value);
        name
    }

    fn small(&mut self) -> usize {
        self.random.below(5)
    }

    fn input(&mut self) -> &'static str {
        ["b", "c", "e"][self.random.below(3)]
    }

    /// Returns a Boolean expression.
    fn flow(&mut self, depth: usize) -> String {
        let kinds = if depth == 0 { 5 } else { 18 };
        let kind = self.random.below(kinds);
        match kind {
            0 => self.input().to_owned(),
            1 | 2 => self.comparison(),
            3 => self.real_comparison(),
            4 => format!("(false -> pre {})", self.input()),
            5 => format!("not ({})", self.flow(depth - 1)),
            6..=8 => {
                let operator = *self.random.pick(&["and", "or", "xor"]);
                format!(
                    "(({}) {operator} ({}))",
                    self.flow(depth - 1),
                    self.flow(depth - 1)
                )
            }
            9 => self.toggle(),
            10 => self.latch(),
            11 => {
                let edges = self.edges(depth);
                self.random.pick(&edges).clone()
            }
            12 => {
                let (counter, last) = self.counter();
                format!("({counter} < {})", 1 + self.random.below(last))
            }
            13 => {
                let ring = self.rotation();
                self.random.pick(&ring).clone()
            }
            14 => {
                let state = self.automaton();
                format!("({state} = {})", self.random.below(3))
            }
            15 => {
                let mode = self.mode();
                format!("({mode} = {})", self.random.pick(&["A", "B", "G"]))
            }
            16 => {
                let (clock, least) = (self.input(), self.small());
                format!("(hold(n when {clock}, 0) < {least})")
            }
            _ => {
                let before = self.flow(depth - 1);
                format!("(false -> pre ({before}))")
            }
        }
    }

    fn integer(&mut self) -> String {
        let (flow, other) = *self.random.pick(&[("n", "k"), ("k", "n")]);
        match self.random.below(8) {
            0..=2 => flow.to_owned(),
            3 => format!("({flow} + {})", self.small()),
            4 => format!("(2 * {flow})"),
            5 => format!("({flow} - {other})"),
            6 => format!("({flow} mod {})", 2 + self.small()),
            _ => format!("abs({flow})"),
        }
    }

    fn comparison(&mut self) -> String {
        let (integer, operator) = (
            self.integer(),
            *self.random.pick(&["<", "<=", "=", ">", ">=", "<>"]),
        );
        format!("({integer} {operator} {})", self.small())
    }

    fn real(&mut self) -> String {
        let (flow, other) = *self.random.pick(&[("x", "y"), ("y", "x")]);
        let number = self.small();
        match self.random.below(8) {
            0..=2 => flow.to_owned(),
            3 => format!("({flow} + {number}.5)"),
            4 => format!("abs({flow})"),
            5 => format!("min({flow}, {number}.0)"),
            6 => format!("({flow} - {other})"),
            _ => format!("(0.5 * {flow})"),
        }
    }

    fn real_comparison(&mut self) -> String {
        let (real, operator) = (self.real(), *self.random.pick(&["<", "<=", ">", ">="]));
        format!("({real} {operator} {}.0)", self.small())
    }

    fn toggle(&mut self) -> String {
        let name = self.name();
        let by = self.input();
        self.equation(
            &name,
            &format!("false -> (if {by} then not pre {name} else pre {name})"),
        );
        name
    }

    fn latch(&mut self) -> String {
        let name = self.name();
        let (set, reset) = (self.input(), self.comparison());
        self.equation(
            &name,
            &format!("if {set} then true else if {reset} then false else (false -> pre {name})"),
        );
        name
    }

    /// Returns the conditions for both edges of a flow.
    fn edges(&mut self, depth: usize) -> Vec<String> {
        let flow = self.flow(depth - 1);
        let flow = self.named(&flow);
        vec![
            format!("({flow} and not (false -> pre {flow}))"),
            format!("(not {flow} and (false -> pre {flow}))"),
        ]
    }

    /// Adds a counter that wraps after its last value.
    fn counter(&mut self) -> (String, usize) {
        let (name, last) = (self.name(), 2 + self.random.below(6));
        let condition = match self.random.one_in(2) {
            true => format!("pre {name} >= {last}"),
            false => format!("pre {name} >= {last} or {}", self.input()),
        };
        self.equation(
            &name,
            &format!("0 -> if {condition} then 0 else pre {name} + 1"),
        );
        (name, last)
    }

    /// Adds three flows of which exactly one is true, in rotation.
    fn rotation(&mut self) -> Vec<String> {
        let names: Vec<String> = (0..3).map(|_| self.name()).collect();
        for k in 0..3 {
            let before = &names[(k + 2) % 3];
            let value = format!("{} -> pre {before}", k == 0);
            self.equation(&names[k].clone(), &value);
        }
        names
    }

    /// Adds an automaton with three states and returns the flow with the number of its state.
    fn automaton(&mut self) -> String {
        let name = self.name();
        let leave = *self.random.pick(&["until", "unless"]);
        let mut text = "  automaton\n".to_owned();
        for state in 0..3 {
            let initial = if state == 0 { "initial " } else { "" };
            let (condition, next) = (self.input(), (state + 1 + self.random.below(2)) % 3);
            let own = format!("let {name} = {state}; tel");
            let _ = match leave {
                "until" => writeln!(
                    text,
                    "    {initial}state {name}S{state} {own} until {condition} then {name}S{next};"
                ),
                _ => writeln!(
                    text,
                    "    {initial}state {name}S{state} unless {condition} then {name}S{next}; {own}"
                ),
            };
        }
        self.body += &text;
        self.body += "  end\n";
        name
    }

    fn mode(&mut self) -> String {
        let (first, second) = (self.comparison(), self.comparison());
        self.named(&format!("if {first} then A else if {second} then B else G"))
    }

    /// Returns two mutually exclusive conditions.
    fn exclusive(&mut self) -> [String; 2] {
        let mut both = match self.random.below(14) {
            0..=2 => self.negated(),
            3 => self.ranges(),
            4 => self.real_ranges(),
            5 => {
                let edges = self.edges(2);
                [edges[0].clone(), edges[1].clone()]
            }
            6 => {
                let (counter, last) = self.counter();
                let limit = 1 + self.random.below(last);
                [
                    format!("({counter} < {limit})"),
                    format!("({counter} >= {limit})"),
                ]
            }
            7 => {
                let ring = self.rotation();
                let first = self.random.below(3);
                [ring[first].clone(), ring[(first + 1) % 3].clone()]
            }
            8 | 9 => {
                let state = self.automaton();
                [format!("({state} = 0)"), format!("({state} = 2)")]
            }
            10 => {
                let mode = self.mode();
                [format!("({mode} = A)"), format!("({mode} = B)")]
            }
            11 => {
                let parts = 2 + self.small();
                [
                    format!("(n mod {parts} = 1)"),
                    format!("(n mod {parts} = 0)"),
                ]
            }
            12 => self.interlock(),
            _ => self.delayed(),
        };
        if self.random.one_in(3) {
            let more = self.flow(1);
            both[0] = format!("({} and {more})", both[0]);
        }
        if self.random.one_in(2) {
            both.reverse();
        }
        both
    }

    fn negated(&mut self) -> [String; 2] {
        let flow = self.flow(2);
        let flow = self.named(&flow);
        [flow.clone(), format!("not {flow}")]
    }

    fn ranges(&mut self) -> [String; 2] {
        let (integer, limit, shift) = (self.integer(), self.small(), self.small());
        match self.random.below(3) {
            0 => [
                format!("({integer} < {limit})"),
                format!("({integer} >= {limit})"),
            ],
            1 => [
                format!("({integer} <= {limit})"),
                format!("({integer} - {shift} > {limit})"),
            ],
            _ => ["(n < k)".to_owned(), format!("(n - k >= {shift})")],
        }
    }

    fn real_ranges(&mut self) -> [String; 2] {
        let (real, limit) = (self.real(), self.small());
        match self.random.below(3) {
            0 => [
                format!("({real} < {limit}.0)"),
                format!("({real} >= {limit}.0)"),
            ],
            1 => ["(x < y)".to_owned(), "(y < x)".to_owned()],
            _ => [format!("(abs(x) <= {limit}.0)"), format!("(x > {limit}.5)")],
        }
    }

    /// Adds two latches, each of which prevents the other from being set.
    fn interlock(&mut self) -> [String; 2] {
        let (left, right) = (self.name(), self.name());
        self.equation(
            &left,
            &format!("false -> (pre {left} and not c) or (b and not pre {right})"),
        );
        self.equation(
            &right,
            &format!("false -> (pre {right} and not c) or (e and not b and not pre {left})"),
        );
        [left, right]
    }

    /// Returns two mutually exclusive conditions, delayed.
    fn delayed(&mut self) -> [String; 2] {
        let flow = self.flow(1);
        let flow = self.named(&flow);
        let later = |name: &str| format!("(false -> pre {name})");
        let second = self.named(&format!("not {flow}"));
        [later(&flow), later(&second)]
    }

    /// Returns a set-point that is present where a condition holds.
    fn set_point(&mut self, condition: &str) -> String {
        let more = self.input();
        match self.random.below(6) {
            0 => format!("if {condition} then 1.0 else none"),
            1 => format!("if not ({condition}) then none else x"),
            2 => format!(
                "if {more} then (if {condition} then 1.0 else none) else (if {condition} then y else none)"
            ),
            3 => {
                let clock = self.named(condition);
                format!("x when {clock}")
            }
            4 => format!(
                "(if {condition} and {more} then 1.0 else none) ?? (if {condition} then 2.0 else none)"
            ),
            _ => {
                let (clock, name) = (self.named(condition), self.name());
                let _ = writeln!(
                    self.body,
                    "  fragment F{name} when {clock} let w = x + 1.0; tel"
                );
                format!("F{name}.w")
            }
        }
    }
}
