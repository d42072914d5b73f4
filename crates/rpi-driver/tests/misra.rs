//! Rules of MISRA C:2012 in emitted C, checked by cppcheck with its addon: the rules that the text does not keep are those
//! that the book lists with reasons.
//!
//! A plain run checks programs that together contain every function and construct of the emitted texts.
//! `RPI_MISRA=all` checks all commands and nodes.

mod c_programs;

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::process::Command;

use c_programs::{for_each_command, for_each_node};
use rpi_driver::AnalysedNet;
use rpi_driver::emit::lower_for_c;
use rpi_testkit::{report_skip, workspace_root};

/// Folders of the programs with nodes, and the endings of their files.
const NODE_FOLDERS: &[(&str, &str)] = &[
    ("tests/lustre", ".lus"),
    ("tests/nodes", ".rpi"),
    ("tests/meaning", ".rpi"),
    ("stdlib", ".rpi"),
];

/// Values of the C implementation that the text asks for. Without them, cppcheck takes the text for one that a compiler
/// refuses, because it does not read the headers of the system.
const DEFINITIONS: &[&str] = &[
    "-DDBL_MANT_DIG=53",
    "-DDBL_MAX_EXP=1024",
    "-DDBL_EPSILON=2.2204460492503131e-16",
    "-DFLT_EVAL_METHOD=0",
];

/// Starts of lines that mark constructs, so that a program with each of them is checked.
const CONSTRUCTS: &[&str] = &[
    "if (",
    "for (",
    "while (",
    "switch (",
    "enum ",
    "typedef struct",
    "static const ",
    "static void ",
    "(void)memcpy(",
    "(void)memset(",
    "rpi_fault(",
    "return ",
];

/// Emitted text with what it contains.
struct Program {
    file: String,
    text: String,
    features: BTreeSet<String>,
}

/// All programs.
#[derive(Default)]
struct Selection {
    programs: Vec<Program>,
    count: usize,
}

impl Selection {
    fn add(&mut self, net: &AnalysedNet) {
        self.count += 1;
        let image = lower_for_c(net, 1_000_000).expect("it lowers");
        // A name of its own: the texts are checked as if they were parts of one project.
        let name = format!("p{}_{}", self.count, rpi_codegen::program_name(&image.name));
        let options = rpi_codegen::Options {
            name: &name,
            header: None,
            locate: &|_| None,
            line_directives: false,
            origin: "",
        };
        let text = rpi_codegen::emit(&image, &options).source;
        let features = features(&text, &name);
        self.programs.push(Program {
            file: format!("{name}.c"),
            text,
            features,
        });
    }

    /// Returns the programs to check: those that add most functions and constructs for their length, until none adds any.
    fn cover(mut self) -> Vec<Program> {
        let mut cover = Vec::new();
        let mut seen = BTreeSet::new();
        loop {
            let gain = |program: &Program| {
                let new = program.features.difference(&seen).count();
                (new * 1_000_000) / program.text.len()
            };
            let gains = self.programs.iter().map(gain).enumerate();
            let best = gains.max_by_key(|(_, gain)| *gain);
            let Some((index, _)) = best.filter(|(_, gain)| *gain > 0) else {
                return cover;
            };
            let program = self.programs.swap_remove(index);
            seen.extend(program.features.iter().cloned());
            cover.push(program);
        }
    }
}

/// Returns the functions and constructs of a text that do not depend on the names of the program.
fn features(text: &str, name: &str) -> BTreeSet<String> {
    let lines = text.lines().map(str::trim_start);
    let feature = |line: &str| {
        if line.starts_with("static inline ") {
            return Some(line.to_owned());
        }
        let mut starts = CONSTRUCTS.iter();
        let start = starts.find(|start| line.starts_with(**start))?;
        let is_own = line.contains(name);
        Some(format!("{start} {is_own}"))
    };
    lines.filter_map(feature).collect()
}

/// Checks texts with cppcheck. Returns the places of each rule that they do not keep.
fn check(programs: &[Program]) -> BTreeMap<String, Vec<String>> {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    for program in programs {
        let path = folder.path().join(&program.file);
        std::fs::write(path, &program.text).expect("it can be written");
    }
    let output = Command::new("cppcheck")
        .args(["--std=c99", "--addon=misra", "--enable=style", "-q", "-j2"])
        .args(DEFINITIONS)
        .arg("--template={id} {file}:{line}: {code}")
        .arg(".")
        .current_dir(folder.path())
        .output()
        .expect("cppcheck starts");
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!text.contains("preprocessorErrorDirective"), "{text}");
    let mut rules: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for line in text.lines() {
        let rule = line.strip_prefix("misra-c2012-");
        if let Some((rule, place)) = rule.and_then(|rule| rule.split_once(' ')) {
            rules
                .entry(rule.to_owned())
                .or_default()
                .push(place.to_owned());
        }
    }
    rules
}

/// Returns the rules in the table of the book.
fn listed() -> BTreeSet<String> {
    let path = workspace_root().join("docs/src/c.md");
    let book = std::fs::read_to_string(path).expect("the book has a page on C");
    let is_rule = |text: &str| {
        let mut parts = text.split('.');
        let mut number = || parts.next().is_some_and(|p| p.parse::<u32>().is_ok());
        number() && number()
    };
    let rows = book.lines().filter_map(|line| line.strip_prefix("| "));
    let first = rows.filter_map(|row| row.split(" |").next());
    first
        .filter(|text| is_rule(text))
        .map(str::to_owned)
        .collect()
}

#[test]
fn rules_that_the_text_does_not_keep_are_listed_with_reasons() {
    if Command::new("cppcheck").arg("--version").output().is_err() {
        return report_skip("cppcheck is not installed: the rules of MISRA C are NOT checked");
    }
    let mut selection = Selection::default();
    let mut add = |_: &Path, net: &AnalysedNet| selection.add(net);
    for_each_command(&mut add);
    for (folder, ending) in NODE_FOLDERS {
        for_each_node(folder, ending, &mut add);
    }
    let count = selection.count;
    let takes_all = std::env::var("RPI_MISRA").is_ok_and(|text| text == "all");
    let programs = match takes_all {
        true => selection.programs,
        false => selection.cover(),
    };
    println!("{} of {count} programs", programs.len());
    let found = check(&programs);
    let listed = listed();
    let new = found.iter().filter(|(rule, _)| !listed.contains(*rule));
    let new: Vec<String> = new
        .map(|(rule, places)| format!("{rule}, {} times: {}", places.len(), places[0]))
        .collect();
    assert!(new.is_empty(), "not in docs/src/c.md:\n{}", new.join("\n"));
    let kept: Vec<&String> = listed.iter().filter(|r| !found.contains_key(*r)).collect();
    assert!(kept.is_empty(), "kept, but listed as not kept: {kept:?}");
}
