//! Commands and nodes of the repository that tests translate to C.

use std::path::Path;

use rpi_driver::{AnalysedNet, ClaimPolicy, compile, compile_node, read};
use rpi_testkit::files_below;

/// Calls `visit` with the path and the net of each command of the examples.
pub(crate) fn for_each_command(visit: &mut dyn FnMut(&Path, &AnalysedNet)) {
    for path in files_below("examples", &[".rpi"]) {
        let compiled = compile(&read(&path).expect("it can be read")).expect("it compiles");
        compiled.nets().iter().for_each(|net| visit(&path, net));
    }
}

/// Calls `visit` with the path and the net of each node in a folder that can run alone.
pub(crate) fn for_each_node(
    folder: &str,
    ending: &str,
    visit: &mut dyn FnMut(&Path, &AnalysedNet),
) {
    for path in files_below(folder, &[ending]) {
        let input = read(&path).expect("it can be read");
        let text = input.text().expect("it is text").to_owned();
        for name in declared_nodes(&text) {
            // Nodes with static parameters cannot run alone.
            let compiled = compile_node(&input, Some(&name), ClaimPolicy::Fault, false);
            let node = compiled.ok().and_then(|compiled| compiled.node);
            node.iter().for_each(|node| visit(&path, &node.net));
        }
    }
}

/// Returns the names that follow `node` or `function` in a program.
fn declared_nodes(text: &str) -> Vec<String> {
    let words: Vec<&str> = text.split_whitespace().collect();
    let after = words
        .windows(2)
        .filter(|w| ["node", "function"].contains(&w[0]));
    let name = |word: &str| {
        word.split(['(', '<', ';', ':'])
            .next()
            .unwrap_or("")
            .to_owned()
    };
    after
        .map(|w| name(w[1]))
        .filter(|name| !name.is_empty())
        .collect()
}
