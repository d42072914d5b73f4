//! What must hold for a Boolean flow to be true: the flow as a conjunction of other flows, each as it is or negated.
//!
//! Only what follows from the gates themselves is used (and; not; or, under a negation, by De Morgan): a conjunction is
//! true exactly if its flow is, absent values included, as an absent part makes neither true.

use crate::net::{Input, Net, Node, PortRef};
use crate::prim;
use rpi_image::{CommandFlow, Role, Value};
use std::collections::BTreeSet;

/// The parts of a conjunction. All of them hold exactly if the flow is true.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Default, Debug)]
pub struct Conjunction {
    /// Whether the command must have been asked to end, or must not; nothing if that does not matter.
    pub cancelled: Option<bool>,
    /// The other flows, and what each of them must be.
    pub flows: BTreeSet<(PortRef, bool)>,
}

impl Conjunction {
    /// The parts of which a Boolean flow consists; none if it can never be true.
    #[must_use]
    pub fn of(net: &Net, flow: &Input) -> Option<Conjunction> {
        let mut found = Conjunction::default();
        let mut open = vec![(flow, true)];
        let mut seen = BTreeSet::new();
        while let Some((input, wanted)) = open.pop() {
            let port = match input {
                Input::Port(port) => *port,
                Input::Const(value) if value.as_bool() == Some(wanted) => continue,
                Input::Const(_) | Input::Open => return None,
            };
            if seen.insert((port, wanted)) {
                match part(net.node(port.node), wanted) {
                    Part::Always => {}
                    Part::Never => return None,
                    Part::Both(inputs, wanted) => open.extend(inputs.iter().map(|i| (i, wanted))),
                    Part::Cancelled => found.take_cancelled(wanted)?,
                    Part::Flow => found.take(port, wanted)?,
                }
            }
        }
        Some(found)
    }

    fn take_cancelled(&mut self, wanted: bool) -> Option<()> {
        let before = self.cancelled.replace(wanted);
        before.is_none_or(|b| b == wanted).then_some(())
    }

    fn take(&mut self, flow: PortRef, wanted: bool) -> Option<()> {
        self.flows.insert((flow, wanted));
        (!self.flows.contains(&(flow, !wanted))).then_some(())
    }
}

/// What a node's output is in a conjunction.
enum Part<'a> {
    /// It is what is wanted.
    Always,
    /// It is never what is wanted.
    Never,
    /// It is if all inputs are this.
    Both(&'a [Input], bool),
    /// Whether the command was asked to end.
    Cancelled,
    /// A part of its own.
    Flow,
}

fn part(node: &Node, wanted: bool) -> Part<'_> {
    let constant = || node.params.first().and_then(Value::as_bool);
    match node.desc().role {
        Role::Flow(CommandFlow::Cancel) => Part::Cancelled,
        Role::Constant if constant() == Some(wanted) => Part::Always,
        Role::Constant => Part::Never,
        _ if node.prim == prim!("Core::BooleanNot") => Part::Both(&node.inputs, !wanted),
        _ if node.prim == prim!("Core::BooleanAnd") && wanted => Part::Both(&node.inputs, true),
        _ if node.prim == prim!("Core::BooleanOr") && !wanted => Part::Both(&node.inputs, false),
        _ => Part::Flow,
    }
}
