//! C names of registers, taken from the source where possible.

use crate::flat_net::FlatNet;
use crate::registers::{Region, Register};
use rpi_net::{Net, NodeId};
use std::collections::{HashMap, HashSet};

/// Names of the C variables into which registers are translated, derived from the names of nodes. A register without an
/// entry is named by its number.
pub(super) struct VariableNames {
    names: HashMap<Register, String>,
}

impl VariableNames {
    /// Derives the names from the paths of the nodes whose out-ports the registers hold. A number is appended to a name
    /// that is already used.
    pub(super) fn new(net: &Net, flat: &FlatNet) -> Self {
        let mut taken = HashSet::new();
        let mut names = HashMap::new();
        for (node, port, signal) in &flat.tables.probes {
            let slot = Register(signal.start);
            if flat.registers.region(slot) == Region::Constant || names.contains_key(&slot) {
                continue;
            }
            let node = net.node(NodeId(*node));
            let path = net.path(node.fragment, &node.name);
            let name = match node.outputs.len() {
                0 | 1 => identifier(&path),
                _ => identifier(&format!(
                    "{path}_{}",
                    node.desc().outputs[usize::from(*port)].name
                )),
            };
            let name = unique(name, &mut taken);
            names.insert(slot, name);
        }
        VariableNames { names }
    }

    /// Returns the C expression for the memory slot with index `k` of a register: a local variable, or a field of `in`
    /// or `state`.
    pub(super) fn cell(&self, flat: &FlatNet, slot: Register, k: u32) -> String {
        let name = match self.names.get(&slot) {
            Some(name) => name.clone(),
            None => format!("t{}", slot.0),
        };
        let name = match flat.registers.region(slot) {
            Region::Constant | Region::Value => name,
            Region::External => format!("in->{name}"),
            Region::State(_) => format!("state->s{}", slot.0),
        };
        match flat.registers.size(slot) {
            1 => name,
            _ => format!("{name}_{k}"),
        }
    }
}

/// Converts a text to a C identifier of letters, digits and underscores. The result is never a C keyword, because it
/// contains an underscore or ends in a digit.
pub(super) fn identifier(text: &str) -> String {
    let plain = text
        .chars()
        .map(|c| if c.is_ascii_alphanumeric() { c } else { '_' });
    let plain: String = plain.collect();
    let starts_well = plain.starts_with(|c: char| c.is_ascii_alphabetic());
    let prefix = if starts_well { "" } else { "v" };
    let suffix = if plain.contains('_') || plain.ends_with(|c: char| c.is_ascii_digit()) {
        ""
    } else {
        "_"
    };
    format!("{prefix}{plain}{suffix}")
}

/// Returns the name of the C variable for element `k` of a value with `cells` elements: `name_k`, or `name` alone for a
/// single element.
pub(super) fn indexed(name: &str, cells: u32, k: u32) -> String {
    match cells {
        1 => name.to_owned(),
        _ => format!("{name}_{k}"),
    }
}

fn unique(name: String, taken: &mut HashSet<String>) -> String {
    let mut candidate = name.clone();
    let mut k = 2;
    while !taken.insert(candidate.clone()) {
        candidate = format!("{name}_{k}");
        k += 1;
    }
    candidate
}
