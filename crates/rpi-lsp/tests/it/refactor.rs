//! Refactorings at random places of real programs: the changed program has the same steps in its images. Inlining a flow
//! with several uses repeats its computation, so that only the steps with a state or a possible fault are compared then.

use std::collections::BTreeMap;
use std::path::Path;

use rpi_driver::{compile, emit, read};
use rpi_image::StateSize;
use rpi_testkit::files_below;
use serde_json::{Value, json};

use crate::edits::{apply, changes};
use crate::support::{connect, position_of};

/// Number of refactorings that are applied. `RPI_REFACTORINGS=200` applies more.
const APPLIED: usize = 12;

/// Pseudo-random numbers (a linear congruential generator, Knuth): the same on every machine.
struct Random(u64);

impl Random {
    fn below(&mut self, bound: usize) -> usize {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        ((self.0 >> 33) % bound.max(1) as u64) as usize
    }
}

#[test]
fn refactorings_of_real_programs_keep_the_steps_of_their_images() {
    let wanted = std::env::var("RPI_REFACTORINGS")
        .ok()
        .and_then(|text| text.parse().ok());
    let wanted = wanted.unwrap_or(APPLIED);
    let programs = [
        files_below("examples", &[".rpi"]),
        files_below("stdlib", &[".rpi"]),
    ]
    .concat();
    let mut random = Random(17);
    let mut titles: BTreeMap<String, usize> = BTreeMap::new();
    let (mut applied, mut tried) = (0, 0);
    while applied < wanted {
        tried += 1;
        assert!(
            tried < 60 * wanted,
            "only {applied} refactorings at {tried} places"
        );
        let path = &programs[random.below(programs.len())];
        let text = std::fs::read_to_string(path).unwrap();
        let spans = selections(path, &text);
        let (start, end) = spans[random.below(spans.len())];
        let found = actions(path, &text, start, end);
        if found.is_empty() {
            continue;
        }
        let action = &found[random.below(found.len())];
        applied += 1;
        let title = action["title"]
            .as_str()
            .unwrap()
            .split('`')
            .next()
            .unwrap()
            .to_owned();
        *titles.entry(title).or_default() += 1;
        check(path, &text, action);
    }
    println!("{applied} refactorings at {tried} places: {titles:?}");
}

/// Returns the ranges of the names, quantities and expressions of a program.
fn selections(path: &Path, text: &str) -> Vec<(usize, usize)> {
    let seen = rpi_driver::inspect(path, text, &rpi_driver::DiskLoader);
    let names = seen
        .index()
        .references_in(rpi_diag::Span::new(rpi_diag::FileId(0), 0, u32::MAX));
    let names = names
        .iter()
        .map(|name| (name.span.start as usize, name.span.start as usize));
    let names: Vec<(usize, usize)> = names.collect();
    let numbers = text.match_indices('[').map(|(at, _)| (at, at));
    // Right sides of equations, which are expressions.
    let values = text.match_indices(" = ").filter_map(|(at, _)| {
        let length = text[at..].find(';')?;
        Some((at + 3, at + length))
    });
    let statements = text.match_indices("\n  ").filter_map(|(at, _)| {
        let length = text[at..].find(';')?;
        Some((at + 3, at + length + 1))
    });
    names
        .into_iter()
        .chain(numbers)
        .chain(values)
        .chain(statements)
        .collect()
}

fn actions(path: &Path, text: &str, start: usize, end: usize) -> Vec<Value> {
    let uri = format!("file://{}", path.display());
    let mut session = connect();
    session.client.initialize(json!({}));
    session.client.open(&uri, text);
    let [start, end] = [start, end].map(|at| position_of(text, at));
    let params = json!({
        "textDocument": { "uri": uri },
        "range": { "start": start, "end": end },
        "context": { "diagnostics": [], "only": ["refactor"] },
    });
    let found = session.client.result("textDocument/codeAction", params);
    session.shut_down().unwrap();
    found.as_array().cloned().unwrap_or_default()
}

fn check(path: &Path, text: &str, action: &Value) {
    let edits = changes(&action["edit"]);
    assert_eq!(edits.len(), 1);
    let new = apply(text, &edits[0].1);
    assert_ne!(text, new);
    let title = &action["title"];
    let is_inlining = title.as_str().unwrap().starts_with("inline");
    let [before, after] = [text, new.as_str()].map(|text| steps(path, text, is_inlining));
    assert_eq!(
        before.len(),
        after.len(),
        "{title} in {}:\n{new}",
        path.display()
    );
    for ((name, before), (_, after)) in before.iter().zip(&after) {
        assert_eq!(
            before,
            after,
            "{name}: {title} in {}:\n{new}",
            path.display()
        );
    }
}

/// Returns whether a step of this kind has a state or can fault, so that repeating it would change the program.
fn has_effect(kind: &str) -> bool {
    let prim = rpi_prims::PrimId::from_name(kind);
    prim.is_some_and(|prim| prim.desc().may_fault || !matches!(prim.desc().state, StateSize::None))
}

/// Returns the number of steps of each kind in the image of each command and test of a program; only of those with an
/// effect, if `effects` is true.
fn steps(path: &Path, text: &str, effects: bool) -> Vec<(String, BTreeMap<String, usize>)> {
    let dir = tempfile::tempdir().unwrap();
    let beside = std::fs::read_dir(path.parent().unwrap()).unwrap();
    for entry in beside.map(|entry| entry.unwrap()) {
        if entry.path().is_file() {
            std::fs::copy(entry.path(), dir.path().join(entry.file_name())).unwrap();
        }
    }
    let copy = dir.path().join(path.file_name().unwrap());
    std::fs::write(&copy, text).unwrap();
    let compiled = compile(&read(&copy).unwrap()).unwrap();
    assert!(!compiled.has_errors(), "{:?}\n{text}", compiled.diagnostics);
    let tests = compiled.tests.iter().map(|test| &test.net);
    let nets = compiled.nets().iter().chain(tests);
    let kinds = |image: String| {
        let mut kinds: BTreeMap<String, usize> = BTreeMap::new();
        let words = image
            .split(|c: char| c.is_whitespace() || "()[],".contains(c))
            .map(str::to_owned);
        let steps = words.filter(|word| word.contains("::"));
        for word in steps.filter(|word| !effects || has_effect(word)) {
            *kinds.entry(word).or_default() += 1;
        }
        kinds
    };
    nets.map(|net| {
        (
            net.name.to_string(),
            kinds(emit::image(net, 1_000_000).unwrap()),
        )
    })
    .collect()
}
