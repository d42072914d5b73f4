//! The table of methods, the documentation and the wrappers of both clients agree.

use std::collections::{BTreeMap, BTreeSet};

use rpi_serve::methods;
use rpi_testkit::{files_below, workspace_root};

/// A client: its name, the folder with its sources, and their extension.
type ClientSources = (&'static str, &'static str, &'static str);

const CLIENTS: [ClientSources; 2] = [
    ("rpi-client", "clients/rust/src", ".rs"),
    ("clients/python", "clients/python/rpi_client", ".py"),
];

/// Methods without wrappers, and why. Both clients have a public `call` that reaches every method.
const NOT_WRAPPED: &[(&str, &str)] = &[
    ("commands", MONITORING),
    ("tasks", MONITORING),
    ("watch.rule", MONITORING),
    ("watch.session", MONITORING),
    ("watch.devices", MONITORING),
    ("watch.emergency", MONITORING),
    ("emergency.state", MONITORING),
    ("motion.state", MONITORING),
    ("watch.motion", MONITORING),
    (
        "task.describe",
        "`watch.task` reports the same to the owner of a task",
    ),
    ("device.add", SIMULATION),
    ("device.remove", SIMULATION),
    (
        "ping",
        "both clients answer the pings of the websocket, which serve the same purpose",
    ),
];

/// Reason for methods that observe what other clients do.
const MONITORING: &str = "for operator panels, which show what all clients do; a program observes its own commands and tasks";

/// Reason for methods that change the simulated cell.
const SIMULATION: &str =
    "for the set-up of simulated cells; a program runs in the cell that there is";

/// Returns the texts in backticks, without those in parentheses, which are explanations.
fn quoted(cell: &str) -> Vec<&str> {
    let mut depth = 0;
    let mut found = Vec::new();
    for (k, part) in cell.split('`').enumerate() {
        match k % 2 {
            0 => {
                depth += part.matches('(').count();
                depth -= part.matches(')').count();
            }
            _ if depth == 0 => found.push(part),
            _ => {}
        }
    }
    found
}

/// Returns the methods in the table of the documentation, each with its parameters.
fn documented() -> BTreeMap<String, Vec<String>> {
    let path = workspace_root().join("docs/src/server.md");
    let text = std::fs::read_to_string(path).unwrap();
    let rows = text
        .lines()
        .skip_while(|line| !line.starts_with("| method | parameters |"))
        .skip(2)
        .take_while(|line| line.starts_with('|'));
    let mut found = BTreeMap::new();
    for row in rows {
        let cells: Vec<&str> = row.split('|').collect();
        let [name] = quoted(cells[1])[..] else {
            panic!("expected one method: {row}");
        };
        let params = quoted(cells[2]).into_iter().map(str::to_owned).collect();
        let before = found.insert(name.to_owned(), params);
        assert!(before.is_none(), "{name} is documented twice");
    }
    found
}

/// Returns the methods that a client calls.
fn called((client, folder, extension): ClientSources) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for path in files_below(folder, &[extension]) {
        let text = std::fs::read_to_string(path).unwrap();
        // `request` (`_ask` in Python) adds the name of the object to the parameters of `call`.
        for way in ["call(", "request(", "_ask("] {
            let arguments = text.split(way).skip(1);
            let named = arguments.filter_map(|rest| rest.trim_start().strip_prefix('"'));
            found.extend(named.filter_map(|name| Some(name.split_once('"')?.0.to_owned())));
        }
    }
    assert!(!found.is_empty(), "{client} calls no method");
    found
}

#[test]
fn each_method_is_documented_with_its_parameters() {
    let table = methods().map(|(name, params)| {
        let params = params.iter().map(|param| (*param).to_owned());
        (name.to_owned(), params.collect::<Vec<_>>())
    });
    let table: BTreeMap<String, Vec<String>> = table.collect();
    assert_eq!(documented(), table);
}

#[test]
fn clients_call_no_method_that_is_not_in_the_table() {
    let known: BTreeSet<&str> = methods().map(|(name, _)| name).collect();
    for client in CLIENTS {
        for name in called(client) {
            assert!(known.contains(name.as_str()), "{}: {name}", client.0);
        }
    }
}

#[test]
fn each_method_is_wrapped_by_both_clients_or_has_a_reason() {
    let reasons: BTreeMap<&str, &str> = NOT_WRAPPED.iter().copied().collect();
    for client in CLIENTS {
        let called = called(client);
        for (name, _) in methods() {
            match (called.contains(name), reasons.contains_key(name)) {
                (true, false) | (false, true) => {}
                (false, false) => panic!("{} does not wrap {name}", client.0),
                (true, true) => panic!("{} wraps {name}, which is listed as not wrapped", client.0),
            }
        }
    }
    for name in reasons.keys() {
        let is_known = methods().any(|(known, _)| known == *name);
        assert!(is_known, "{name} is not in the table");
    }
}
