//! Initial corpus, generated from every program of the project instead of being stored twice.

use std::fs;
use std::path::Path;

use rpi_driver::{
    AnalysedNet, ClaimPolicy, Input, InputKind, compile, compile_node, emit, lower_for_execution,
};
use rpi_testkit::{files_below, workspace_root};

use crate::texts::LUSTRE;

/// Input of the initial corpus of a fuzzer, from which mutations are made.
#[derive(Clone, Debug)]
pub struct Seed {
    /// Name of the file from which the input was made, with `-` between folders.
    pub name: String,
    /// Content of the input.
    pub bytes: Vec<u8>,
}

/// Folders whose programs become inputs of the initial corpus.
const FOLDERS: &[&str] = &["examples", "stdlib", "tests", "crates/rpi-diag/pages"];
/// Folders whose cell descriptions become inputs of the initial corpus.
const CELL_FOLDERS: &[&str] = &["examples", "tests"];
/// Folder with the inputs for which a fuzzer once found an error, one folder for each entry point.
const SAVED_FOLDER: &str = "tests/fuzz";
/// Maximum size in bytes of an input made from a net (16 KiB). A larger input slows the fuzzer down without covering
/// more code.
const MAX_SEED_BYTES: usize = 1 << 14;

/// Returns the program texts of the initial corpus: all programs of the project, and the correct and wrong programs on
/// the explanation pages of diagnostics.
pub(crate) fn texts() -> Vec<Seed> {
    let files = |extension| {
        let below = |folder: &&str| files_below(folder, &[extension]);
        FOLDERS.iter().flat_map(below).collect::<Vec<_>>()
    };
    let mut seeds: Vec<Seed> = files(".rpi").iter().filter_map(|p| text(p, "")).collect();
    seeds.extend(files(".lus").iter().filter_map(|p| text(p, LUSTRE)));
    for page in files(".md").iter().filter_map(|path| text(path, "")) {
        seeds.extend(blocks(&page));
    }
    seeds
}

/// Returns the nets of the initial corpus in text form: those of all programs that compile.
pub(crate) fn nets() -> Vec<Seed> {
    seeds_from_nets(|net| emit::rpinet(net).0.into_bytes())
}

/// Returns the images of the initial corpus: those of all programs that compile.
pub(crate) fn images() -> Vec<Seed> {
    seeds_from_nets(|net| {
        lower_for_execution(net, 1_000_000).map_or(Vec::new(), |image| image.to_bytes())
    })
}

/// Returns the cell descriptions of the initial corpus: those of the project and those in its book.
pub(crate) fn cells() -> Vec<Seed> {
    let files = CELL_FOLDERS
        .iter()
        .flat_map(|folder| files_below(folder, &[".toml"]));
    let mut seeds: Vec<Seed> = files.filter_map(|path| text(&path, "")).collect();
    let pages = files_below("docs/src", &["devices.md"]);
    seeds.extend(
        pages
            .iter()
            .filter_map(|path| text(path, ""))
            .flat_map(|page| blocks(&page)),
    );
    seeds
}

/// Returns the tables and traces of the initial corpus: those of the tests of the project.
pub(crate) fn traces() -> Vec<Seed> {
    let files = files_below("tests", &[".csv", ".trace", ".tsv"]);
    files.iter().filter_map(|path| text(path, "")).collect()
}

/// Returns the inputs for which a fuzzer once found an error in the entry point `entry`. They are stored permanently as
/// regression tests.
#[must_use]
pub fn saved_inputs(entry: &str) -> Vec<Seed> {
    let paths = files_below(&format!("{SAVED_FOLDER}/{entry}"), &[""]);
    paths.iter().filter_map(|path| text(path, "")).collect()
}

fn text(path: &Path, before: &str) -> Option<Seed> {
    let name = path.strip_prefix(workspace_root()).unwrap_or(path);
    let name = name.display().to_string().replace('/', "-");
    let mut bytes = before.as_bytes().to_vec();
    bytes.extend(fs::read(path).ok()?);
    Some(Seed { name, bytes })
}

/// Returns the programs in the code blocks of a Markdown page.
fn blocks(page: &Seed) -> Vec<Seed> {
    let text = String::from_utf8_lossy(&page.bytes).into_owned();
    let parts = text.split("\n```").skip(1).step_by(2);
    let code = parts.filter_map(|part| part.split_once('\n'));
    let seed = |(k, (_, code)): (usize, (&str, &str))| Seed {
        name: format!("{}-{k}", page.name),
        bytes: code.as_bytes().to_vec(),
    };
    code.enumerate().map(seed).collect()
}

fn seeds_from_nets(form: impl Fn(&AnalysedNet) -> Vec<u8>) -> Vec<Seed> {
    let mut seeds = Vec::new();
    for text in texts() {
        for (k, net) in nets_of(&text).iter().enumerate() {
            let (name, bytes) = (format!("{}-{k}", text.name), form(net));
            if (1..MAX_SEED_BYTES).contains(&bytes.len()) {
                seeds.push(Seed { name, bytes });
            }
        }
    }
    seeds
}

fn nets_of(seed: &Seed) -> Vec<AnalysedNet> {
    let kind = match seed.bytes.starts_with(LUSTRE.as_bytes()) {
        true => InputKind::Lustre,
        false => InputKind::Rpi,
    };
    let input = Input {
        path: seed.name.clone().into(),
        kind,
        bytes: seed.bytes.clone(),
    };
    let commands = compile(&input).map_or(Vec::new(), |made| made.nets().to_vec());
    let node = compile_node(&input, None, ClaimPolicy::Report, false)
        .ok()
        .and_then(|made| made.node);
    commands
        .into_iter()
        .chain(node.map(|node| node.net))
        .collect()
}
