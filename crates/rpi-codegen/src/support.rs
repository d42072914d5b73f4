//! Common functions that the generated text uses.

use crate::identifiers::tokens;
use rpi_prims::c_code::support;
use std::collections::{BTreeMap, BTreeSet};

/// Start of the line before each definition in [`support`].
const MARK: &str = "/*# ";

/// Returns the definitions in [`support`]: names and texts, each after those that it uses.
fn definitions() -> Vec<(&'static str, &'static str)> {
    let chunks = support().flat_map(|text| text.split(MARK).skip(1));
    let named = chunks.filter_map(|chunk| chunk.split_once(" */\n"));
    named.collect()
}

/// Returns the definitions of all common functions that `text` uses, directly or not.
pub(crate) fn needed(text: &str) -> String {
    let definitions = definitions();
    let known: BTreeMap<&str, &str> = definitions.iter().copied().collect();
    let mut found = BTreeSet::new();
    let mut open = vec![text];
    while let Some(text) = open.pop() {
        for name in tokens(text) {
            if let Some((name, definition)) = known.get_key_value(name)
                && found.insert(*name)
            {
                open.push(definition);
            }
        }
    }
    let used = definitions.iter().filter(|d| found.contains(d.0));
    used.map(|d| format!("{}\n", d.1)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// C needs a declaration before a use, and the definitions are written in their order.
    #[test]
    fn definitions_come_before_their_uses() {
        let definitions = definitions();
        let place: BTreeMap<&str, usize> = (0..).zip(&definitions).map(|(k, d)| (d.0, k)).collect();
        assert_eq!(place.len(), definitions.len(), "a name is defined twice");
        for (k, (name, text)) in definitions.iter().enumerate() {
            assert!(tokens(text).contains(name), "{name} is not defined");
            for used in tokens(text).iter().filter_map(|t| place.get(t)) {
                assert!(*used <= k, "{name} uses {}", definitions[*used].0);
            }
        }
    }
}
