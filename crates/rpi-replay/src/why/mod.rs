//! Why a flow has its value: the part of the net, back over the cycles, from which the value results (a dynamic backward slice:
//! Korel and Laski, Dynamic program slicing, 1988).
//!
//! A cause is an input without which the value could be another one: of an `if`, the condition and the chosen branch; of a false `and`, a
//! false operand; of an absent value, an absent operand; of an inactive fragment, its condition. Causes are followed through delays to earlier
//! cycles, down to inputs, sensors, constants and first values. The earlier value of a flow on its own way back, as of a counter, ends the way.

mod causes;
mod history;

use std::collections::{BTreeSet, VecDeque};

use rpi_diag::Span;
use rpi_net::{Net, PortRef, strip_unnamed_calls};

use causes::{Causes, causes};
pub use history::History;

/// Maximum number of values that are followed. What lies behind further ones is left out.
const MAX_VALUES: usize = 100_000;

/// Maximum number of steps of an answer.
const MAX_STEPS: usize = 200;

/// Step of an answer: a flow with its value in a cycle, or something that has no further cause.
#[derive(Clone, PartialEq, Debug)]
pub struct WhyStep {
    /// Number of the step of which this one is a cause; `None` for the flow in question.
    pub of: Option<usize>,
    /// Name of the flow in the program, or what else the value comes from.
    pub name: String,
    /// Number of the cycle of the command, counted from 0.
    pub cycle: u64,
    /// First of the cycles, up to `cycle`, in which the flow had this value without a break because it was kept by a delay.
    pub since: u64,
    /// Value as text, or `absent`; empty for a step that has none of its own.
    pub value: String,
    /// Place of the flow in the program.
    pub span: Span,
    /// Whether the step has no further cause.
    pub is_root: bool,
}

/// Answer to the question why a flow has its value.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Why {
    /// Steps, each after the one of which it is a cause.
    pub steps: Vec<WhyStep>,
    /// Whether some causes were left out because there are too many.
    pub is_incomplete: bool,
}

/// Returns why a port of a net has its value in a cycle. `name` is the name of its flow.
#[must_use]
pub fn why(net: &Net, history: &History, port: PortRef, name: &str, cycle: u64) -> Why {
    let mut slice = Slice {
        net,
        history,
        seen: BTreeSet::new(),
        answer: Why::default(),
        open: VecDeque::new(),
    };
    let first = slice.step(None, name.to_owned(), port, cycle);
    slice.open.push_back((port, cycle, first));
    slice.run();
    slice.answer
}

/// Search for causes.
struct Slice<'a> {
    net: &'a Net,
    history: &'a History,
    /// Values that have been followed: node, port and cycle.
    seen: BTreeSet<(u32, u8, u64)>,
    answer: Why,
    /// Values to be followed, with the step to which their causes belong.
    open: VecDeque<(PortRef, u64, usize)>,
}

impl Slice<'_> {
    fn run(&mut self) {
        while let Some((port, cycle, step)) = self.open.pop_front() {
            if !self.seen.insert((port.node.0, port.port, cycle)) {
                continue;
            }
            if self.seen.len() > MAX_VALUES || self.answer.steps.len() >= MAX_STEPS {
                self.answer.is_incomplete = true;
                return;
            }
            self.follow(port, cycle, step);
        }
    }

    fn follow(&mut self, port: PortRef, cycle: u64, step: usize) {
        match causes(self.net, self.history, port, cycle) {
            Causes::Ports(ports) if ports.is_empty() => {}
            Causes::Ports(ports) => {
                for (cause, cycle) in ports {
                    self.add_cause(cause, cycle, step);
                }
            }
            Causes::Root(text) => self.root(step, text, (port, cycle)),
            Causes::Inactive {
                fragment,
                condition,
            } => {
                let fragment = self.net.fragment(fragment);
                let name = fragment
                    .origin
                    .flow
                    .clone()
                    .unwrap_or_else(|| fragment.name.clone());
                let inactive = self.push(WhyStep {
                    of: Some(step),
                    name: format!("the fragment {name} is inactive"),
                    cycle,
                    since: cycle,
                    value: String::new(),
                    span: fragment.origin.span,
                    is_root: condition.is_none(),
                });
                if let Some(condition) = condition {
                    self.add_cause(condition, cycle, inactive);
                }
            }
        }
    }

    /// Adds a value as a cause of a step: to the step if it belongs to the same flow, else as a step of its own.
    fn add_cause(&mut self, port: PortRef, cycle: u64, of: usize) {
        if self.seen.contains(&(port.node.0, port.port, cycle)) {
            return;
        }
        let Some(name) = self.flow_name(port) else {
            return self.open.push_back((port, cycle, of));
        };
        let value = value_text(self.net, self.history, port, cycle);
        let parent = &mut self.answer.steps[of];
        // A value that a delay has kept is one step.
        if parent.name == name
            && (cycle == parent.cycle || (value == parent.value && cycle + 1 >= parent.since))
        {
            parent.since = parent.since.min(cycle);
            return self.open.push_back((port, cycle, of));
        }
        let is_listed = |step: &WhyStep| step.name == name && step.cycle == cycle;
        if self.answer.steps.iter().any(is_listed) {
            return;
        }
        let is_own_past = self.explains(of, &name);
        let step = self.step(Some(of), name, port, cycle);
        if is_own_past {
            // A counter or a filter: the question can be put again for the earlier cycle.
            self.answer.steps[step].is_root = true;
            self.seen.insert((port.node.0, port.port, cycle));
        } else {
            self.open.push_back((port, cycle, step));
        }
    }

    /// Returns whether a step is a cause, directly or not, of a value of the flow called `name`, or such a value itself.
    fn explains(&self, step: usize, name: &str) -> bool {
        let mut next = Some(step);
        while let Some(step) = next.map(|next| &self.answer.steps[next]) {
            if step.name == name {
                return true;
            }
            next = step.of;
        }
        false
    }

    /// Returns the name of the flow that a node defines, with the fragments around it; `None` for a part of an expression.
    fn flow_name(&self, port: PortRef) -> Option<String> {
        let node = self.net.node(port.node);
        let flow = node.origin.flow.as_deref()?;
        let is_part = node
            .name
            .rsplit('.')
            .next()
            .is_some_and(|name| name.contains('#'));
        (!is_part).then(|| {
            let flow = strip_unnamed_calls(flow);
            let names = self.net.fragment_names(node.fragment).into_iter();
            names.chain([flow.as_str()]).collect::<Vec<_>>().join(".")
        })
    }

    fn step(&mut self, of: Option<usize>, name: String, port: PortRef, cycle: u64) -> usize {
        let step = WhyStep {
            of,
            name,
            cycle,
            since: cycle,
            value: value_text(self.net, self.history, port, cycle),
            span: self.net.node(port.node).origin.span,
            is_root: false,
        };
        self.push(step)
    }

    /// Adds what has no further cause: the value of a port in a cycle.
    fn root(&mut self, step: usize, text: String, (port, cycle): (PortRef, u64)) {
        let own = self.net.node(port.node).origin.span;
        let span = if own.is_none() {
            self.answer.steps[step].span
        } else {
            own
        };
        let is_known =
            |known: &WhyStep| known.of == Some(step) && known.is_root && known.name == text;
        if text == "a constant" || self.answer.steps.iter().any(is_known) {
            return;
        }
        self.push(WhyStep {
            of: Some(step),
            name: text,
            cycle,
            since: cycle,
            value: String::new(),
            span,
            is_root: true,
        });
    }

    fn push(&mut self, step: WhyStep) -> usize {
        self.answer.steps.push(step);
        self.answer.steps.len() - 1
    }
}

fn value_text(net: &Net, history: &History, port: PortRef, cycle: u64) -> String {
    let ty = net
        .node(port.node)
        .outputs
        .get(usize::from(port.port))
        .copied();
    if let Some(reason) = history.fault(port, cycle) {
        return format!("a fault, {reason},");
    }
    match (history.value(port, cycle), ty) {
        (Some(words), Some(ty)) => rpi_literal::write(words, ty),
        _ => "absent".to_owned(),
    }
}
