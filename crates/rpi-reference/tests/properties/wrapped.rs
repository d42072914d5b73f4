//! Wrappers of `main`: an additional node at the end of the program.

use rpi_diag::FileId;
use rpi_syntax::ast::ItemKind;
use rpi_syntax::{Dialect, parse};

use crate::program::INPUTS;

/// Adds the node `Again`, which restarts `main` when `r` is true.
pub(crate) fn again(text: &str) -> String {
    let outputs = outputs(text);
    let names = names(&outputs);
    let (given, ports) = (given(), ports());
    let results = outputs.join("; ");
    format!(
        "{text}\nnode Again (r: bool; {ports}) returns ({results})\nlet\n  ({names}) = (restart main every r)({given});\ntel\n"
    )
}

/// Adds the node `Inside`: `main` in a fragment that is active when `on` is true, and a counter beside it.
pub(crate) fn inside(text: &str) -> String {
    let outputs = outputs(text);
    let names = names(&outputs);
    let (given, ports) = (given(), ports());
    let optional: Vec<String> = outputs
        .iter()
        .map(|port| format!("{}?", port.trim_end_matches('?')))
        .collect();
    let results = optional.join("; ");
    let passed: String = names
        .split(", ")
        .map(|name| format!("  {name} = F.in_{name};\n"))
        .collect();
    let inner: Vec<String> = names.split(", ").map(|name| format!("in_{name}")).collect();
    let inner = inner.join(", ");
    format!(
        "{text}\nnode Inside (on: bool; {ports}) returns ({results}; beside: int)\nlet\n  fragment F when on\n  let ({inner}) = main({given}); tel\n{passed}  beside = 0 -> pre beside + 1;\ntel\n"
    )
}

fn ports() -> String {
    let ports: Vec<String> = INPUTS
        .iter()
        .map(|(name, kind)| format!("{name}: {}", kind.text()))
        .collect();
    ports.join("; ")
}

fn given() -> String {
    let names: Vec<&str> = INPUTS.iter().map(|(name, _)| *name).collect();
    names.join(", ")
}

/// Returns the out-ports of `main`, each as declared.
fn outputs(text: &str) -> Vec<String> {
    let parse = parse(FileId(0), text, Dialect::Rpi);
    let main = parse.file.items.iter().find(|item| match &item.kind {
        ItemKind::Node(node) => node.signature.name.name == *"main",
        _ => false,
    });
    let head = main
        .map(|item| rpi_syntax::header(item, Dialect::Rpi))
        .unwrap_or_default();
    let returned = head.split_once("returns (").map_or("", |(_, rest)| rest);
    let returned = returned.trim_end().trim_end_matches(')');
    returned
        .split(';')
        .map(|port| port.trim().to_owned())
        .collect()
}

fn names(outputs: &[String]) -> String {
    let names: Vec<&str> = outputs
        .iter()
        .map(|port| port.split(':').next().unwrap_or(""))
        .collect();
    names.join(", ")
}
