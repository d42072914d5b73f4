//! Names in the program: as in the net where that is possible, each only once in the whole program, so that none hides
//! another.

use std::collections::BTreeSet;

use rpi_net::{FragmentId, Net, NodeId};
use rpi_syntax::{KEYWORDS, Mode, is_name};

/// Names that mean something without being declared, or that this importer declares.
const TAKEN: &[&str] = &[
    "cancel",
    "dt",
    "first",
    "outFail",
    "outTerminate",
    "parent",
    "predecessor",
    "takeover",
    "time",
    "_",
];

/// The names of everything in a program.
pub(super) struct Names {
    pub(super) command: String,
    fragments: Vec<String>,
    nodes: Vec<String>,
}

impl Names {
    /// Names for everything in a net. Those of `unused` nodes say so.
    pub(super) fn new(net: &Net, unused: &BTreeSet<NodeId>) -> Self {
        let mut taken: BTreeSet<String> = TAKEN.iter().map(|name| (*name).to_owned()).collect();
        taken.extend(KEYWORDS.iter().map(|word| word.text.to_owned()));
        let command = unique(&net.name, "Net", &mut taken);
        let fragments = net.fragments.iter();
        let fragments = fragments
            .map(|f| unique(&f.name, "f", &mut taken))
            .collect();
        let node = |id: NodeId| {
            let name = &net.node(id).name;
            match unused.contains(&id) {
                true => unique(&format!("_{}", identifier(name, "n")), "_n", &mut taken),
                false => unique(name, "n", &mut taken),
            }
        };
        let nodes = net.node_ids().map(node).collect();
        Names {
            command,
            fragments,
            nodes,
        }
    }

    pub(super) fn fragment(&self, id: FragmentId) -> &str {
        &self.fragments[id.index()]
    }

    pub(super) fn node(&self, id: NodeId) -> &str {
        &self.nodes[id.index()]
    }
}

/// The name itself, else with what a name cannot have replaced, `prefix` before a number, and a number behind it.
fn unique(name: &str, prefix: &str, taken: &mut BTreeSet<String>) -> String {
    let plain = identifier(name, prefix);
    let numbered = (2..).map(|n| format!("{plain}_{n}"));
    let free = std::iter::once(plain.clone())
        .chain(numbered)
        .find(|name| !taken.contains(name))
        .unwrap_or(plain);
    taken.insert(free.clone());
    free
}

fn identifier(name: &str, prefix: &str) -> String {
    let plain: String = name
        .chars()
        .map(|c| if c.is_ascii_alphanumeric() { c } else { '_' })
        .collect();
    let begins = plain.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_');
    match begins && is_name(&plain, Mode::Rpi) {
        true => plain,
        false => format!("{prefix}{plain}"),
    }
}
