//! Recorded exchanges with the client of the reference system: see `tests/exchanges/README.md`.

use std::collections::BTreeMap;
use std::path::PathBuf;

use crate::client::{Client, open};

type Names = BTreeMap<String, String>;

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/exchanges")
}

fn lines(file: &str) -> Vec<String> {
    let text = std::fs::read_to_string(folder().join(file)).unwrap();
    let lines = text
        .lines()
        .filter(|l| !l.is_empty() && !l.starts_with('#'));
    lines.map(str::to_owned).collect()
}

fn nets() -> Names {
    let split = |line: &String| {
        let (name, net) = line.split_once(" = ").unwrap();
        (name.to_owned(), net.to_owned())
    };
    lines("nets.txt").iter().map(split).collect()
}

/// Substitutes nets and known names in a message.
fn filled(message: &str, nets: &Names, names: &Names) -> String {
    let mut text = message.to_owned();
    for (name, net) in nets {
        text = text.replace(&format!("<<{name}>>"), net);
    }
    for (name, value) in names.iter().rev() {
        text = text.replace(&format!("${name}"), value);
    }
    text
}

/// Matches a text against a pattern of fixed parts separated by `*`. Returns the name and text of at most one `$name`.
fn match_pattern(text: &str, pattern: &str) -> Option<Option<(String, String)>> {
    if let Some((before, rest)) = pattern.split_once('$') {
        let end = rest
            .find(|c: char| !c.is_alphanumeric())
            .unwrap_or(rest.len());
        let (name, after) = rest.split_at(end);
        let value = text.strip_prefix(before)?.strip_suffix(after)?;
        return Some(Some((name.to_owned(), value.to_owned())));
    }
    let mut parts = pattern.split('*');
    let mut rest = text.strip_prefix(parts.next()?)?;
    for part in parts {
        let at = match part {
            "" => rest.len(),
            part => rest.find(part)?,
        };
        rest = &rest[at + part.len()..];
    }
    rest.is_empty().then_some(None)
}

fn replay(file: &str) {
    let (server, nets) = (open(), nets());
    let address = server.address();
    let mut connections = [
        ("control", Client::dio(address)),
        ("data", Client::dio(address)),
    ];
    let mut names = Names::new();
    for line in lines(file) {
        let (who, message) = line.split_at(line.find(['>', '<']).unwrap());
        let (_, client) = connections
            .iter_mut()
            .find(|(name, _)| *name == who)
            .unwrap();
        let (direction, message) = message.split_once(' ').unwrap();
        let message = filled(message, &nets, &names);
        match direction {
            ">" => client.send(&message),
            "<" => names.extend(client.wait(&line, |text| match_pattern(text, &message))),
            "<!" => names.extend(client.wait_for_next(&line, |text| match_pattern(text, &message))),
            _ => panic!("what is {line}?"),
        }
    }
}

#[test]
fn a_motion_is_loaded_run_and_ended_as_the_client_expects() {
    replay("motion.txt");
}

#[test]
fn a_blend_ends_the_predecessor() {
    replay("blend.txt");
}

#[test]
fn a_blend_completes_the_predecessor() {
    replay("takeover.txt");
}

#[test]
fn patterns_fit_what_they_say() {
    assert_eq!(match_pattern("c1=ok()", "c1=ok()"), Some(None));
    assert_eq!(match_pattern("c1=ok(1)", "c1=ok()"), None);
    assert_eq!(match_pattern("a(x,b,y)", "a(*b*)"), Some(None));
    assert_eq!(match_pattern("a(x,y)", "a(*b*)"), None);
    let taken = Some(Some(("n".to_owned(), "n7".to_owned())));
    assert_eq!(match_pattern("c1=ok(\"n7\")", "c1=ok(\"$n\")"), taken);
}
