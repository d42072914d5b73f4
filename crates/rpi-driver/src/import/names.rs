//! Names in the program: those of the net where possible, unique in the whole program, so that none shadows another.

use std::collections::BTreeSet;

use rpi_net::{FragmentId, Net, NodeId};
use rpi_syntax::{Dialect, KEYWORDS, is_name};

/// Names that imported flows must not get: predeclared names of the language, and names that the importer itself
/// declares.
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

/// Names in the imported program of the command and of all nodes and fragments of the net.
pub(super) struct Names {
    pub(super) command: String,
    fragments: Vec<String>,
    nodes: Vec<String>,
}

impl Names {
    /// Assigns names to all nodes and fragments of a net. Names of `unused` nodes get a leading `_`, so that the
    /// compiler does not warn about them.
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

/// Returns the name itself, or a valid name derived from it that is not in `taken`: invalid characters are replaced,
/// `prefix` is put before a digit, and a number is appended. The result is added to `taken`.
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
    match begins && is_name(&plain, Dialect::Rpi) {
        true => plain,
        false => format!("{prefix}{plain}"),
    }
}
