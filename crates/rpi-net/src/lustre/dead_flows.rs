//! Dead code elimination in the Lustre text: removes local flows that are never used.

use std::collections::{HashMap, HashSet};

/// Removes local flows that are not used, and their equations. A flow is used if an output, a text in `others` or
/// another used flow reads it.
///
/// `locals` are declarations such as `x: int`; `equations` have the form `name = value`.
pub(super) fn remove_dead_flows(
    locals: Vec<String>,
    equations: Vec<String>,
    others: &[String],
) -> (Vec<String>, Vec<String>) {
    let names: HashSet<&str> = locals
        .iter()
        .filter_map(|local| first_token(local))
        .collect();
    let defined = equations
        .iter()
        .filter_map(|equation| first_token(equation));
    let place: HashMap<&str, usize> = defined.zip(0..).collect();
    // Equations of outputs define a name that is not a local flow.
    let is_root =
        |equation: &&String| first_token(equation).is_none_or(|name| !names.contains(name));
    let mut open: Vec<&str> = equations
        .iter()
        .filter(is_root)
        .flat_map(|e| tokens(e))
        .collect();
    open.extend(others.iter().flat_map(|other| tokens(other)));
    let mut read: HashSet<&str> = HashSet::new();
    while let Some(word) = open.pop() {
        if let Some(at) = place.get(word)
            && read.insert(word)
        {
            open.extend(tokens(&equations[*at]));
        }
    }
    let is_read = |text: &String| {
        first_token(text).is_none_or(|name| read.contains(name) || !names.contains(name))
    };
    let kept = |texts: &[String]| texts.iter().map(is_read).collect::<Vec<bool>>();
    let (of_locals, of_equations) = (kept(&locals), kept(&equations));
    (
        filtered(locals, &of_locals),
        filtered(equations, &of_equations),
    )
}

fn filtered(texts: Vec<String>, kept: &[bool]) -> Vec<String> {
    let texts = texts.into_iter().zip(kept);
    texts
        .filter(|(_, kept)| **kept)
        .map(|(text, _)| text)
        .collect()
}

/// Returns the identifiers and numbers in a Lustre text.
fn tokens(text: &str) -> impl Iterator<Item = &str> {
    let words = text.split(|c: char| !c.is_alphanumeric() && c != '_');
    words.filter(|word| !word.is_empty())
}

fn first_token(text: &str) -> Option<&str> {
    tokens(text).next()
}
