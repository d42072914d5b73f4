//! Possible values of an integer flow that only forwards constants, such as the lowered state of an automaton.

use crate::net::{Input, Net, PortRef};
use rpi_image::{Role, Value};
use std::collections::BTreeSet;

/// Maximum number of flows that the search for the possible values of one flow visits. Bounds the compile time.
const EFFORT: usize = 2_000;

/// Primitives that return one of several inputs unchanged, each with the index of the first such in-port.
const FORWARDING: &[(&str, usize)] = &[
    ("Core::IntConditional", 1),
    ("Rpi::IntCoalesce", 0),
    ("Rpi::IntPre", 0),
];

/// Returns all values that an integer flow can have, found by following its sources to constants; `None` if a source is
/// no constant or the search is too large.
pub(super) fn possible_values(net: &Net, flow: PortRef) -> Option<BTreeSet<i64>> {
    let mut found = BTreeSet::new();
    let mut seen = BTreeSet::from([flow]);
    let mut open = vec![flow];
    while let Some(port) = open.pop() {
        let node = net.node(port.node);
        let desc = node.desc();
        if desc.role == Role::Constant {
            found.insert(node.params.first()?.as_int()?);
            continue;
        }
        let (_, first) = FORWARDING.iter().find(|(name, _)| *name == desc.name)?;
        if desc.role == Role::Delay {
            // Initial value of the delay.
            found.insert(0);
            found.extend(node.params.iter().filter_map(Value::as_int));
        }
        for input in node.inputs.iter().skip(*first) {
            match input {
                Input::Unconnected => {}
                Input::Const(value) => {
                    found.insert(value.as_int()?);
                }
                Input::Port(port) if seen.insert(*port) => open.push(*port),
                Input::Port(_) => {}
            }
        }
        if seen.len() > EFFORT {
            return None;
        }
    }
    Some(found)
}
