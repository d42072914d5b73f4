//! Decomposition of a Boolean flow into a conjunction of other flows, each plain or negated.
//!
//! Only the gates themselves are used: and, not, and negated or (De Morgan). The conjunction is true exactly if its
//! flow is true. This includes absent values, since an absent part makes neither true.

use crate::net::{Input, Net, Node, PortRef};
use crate::prim;
use rpi_image::{CommandFlow, Role, Value};
use std::collections::BTreeSet;

/// Boolean flow as a conjunction: it is true exactly if all these flows have their required values.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Default, Debug)]
pub struct Conjunction {
    /// Required value of the cancel request: `Some(true)` if the command must have been cancelled, `None` if the
    /// request does not matter.
    pub cancelled: Option<bool>,
    /// Other Boolean flows, each with its required value.
    pub flows: BTreeSet<(PortRef, bool)>,
}

impl Conjunction {
    /// Decomposes a Boolean flow into the conditions whose conjunction (`and`) it is; `None` if the flow can never be
    /// true.
    #[must_use]
    pub fn from_flow(net: &Net, flow: &Input) -> Option<Conjunction> {
        let mut found = Conjunction::default();
        let mut open = vec![(flow, true)];
        let mut seen = BTreeSet::new();
        while let Some((input, polarity)) = open.pop() {
            let port = match input {
                Input::Port(port) => *port,
                Input::Const(value) if value.as_bool() == Some(polarity) => continue,
                Input::Const(_) | Input::Unconnected => return None,
            };
            if seen.insert((port, polarity)) {
                match part(net.node(port.node), polarity) {
                    Part::Always => {}
                    Part::Never => return None,
                    Part::AllInputs(inputs, polarity) => {
                        open.extend(inputs.iter().map(|i| (i, polarity)))
                    }
                    Part::Cancelled => found.add_cancelled(polarity)?,
                    Part::Literal => found.add_literal(port, polarity)?,
                }
            }
        }
        Some(found)
    }

    fn add_cancelled(&mut self, polarity: bool) -> Option<()> {
        let before = self.cancelled.replace(polarity);
        before.is_none_or(|b| b == polarity).then_some(())
    }

    fn add_literal(&mut self, flow: PortRef, polarity: bool) -> Option<()> {
        self.flows.insert((flow, polarity));
        (!self.flows.contains(&(flow, !polarity))).then_some(())
    }
}

/// Contribution of a node to a conjunction that requires a value of its output.
enum Part<'a> {
    /// The output always has the required value.
    Always,
    /// The output never has the required value.
    Never,
    /// The output has the required value exactly if all these inputs have the given value.
    AllInputs(&'a [Input], bool),
    /// The output is the cancel request of the command.
    Cancelled,
    /// The output is a literal of the conjunction, as it cannot be decomposed further.
    Literal,
}

fn part(node: &Node, polarity: bool) -> Part<'_> {
    let constant = || node.params.first().and_then(Value::as_bool);
    match node.desc().role {
        Role::Flow(CommandFlow::Cancel) => Part::Cancelled,
        Role::Constant if constant() == Some(polarity) => Part::Always,
        Role::Constant => Part::Never,
        _ if node.prim == prim!("Core::BooleanNot") => Part::AllInputs(&node.inputs, !polarity),
        _ if node.prim == prim!("Core::BooleanAnd") && polarity => {
            Part::AllInputs(&node.inputs, true)
        }
        _ if node.prim == prim!("Core::BooleanOr") && !polarity => {
            Part::AllInputs(&node.inputs, false)
        }
        _ => Part::Literal,
    }
}
