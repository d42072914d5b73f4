//! Recorded nets outside the repository.
#![allow(dead_code, reason = "each test binary uses a part")]

use rpi_diag::{Diagnostic, FileId, Severity, SourceMap, Style, render};
use rpi_net::Net;
use std::path::PathBuf;

/// Name and text of every net in a folder outside the repository, sorted by name; `None`, with a message, if it is
/// missing.
pub(crate) fn nets_in(folder: &str) -> Option<Vec<(String, String)>> {
    let dir = rpi_testkit::external_data_path(&format!("nets/{folder}"))?;
    let mut paths: Vec<PathBuf> = std::fs::read_dir(dir)
        .expect("the folder can be read")
        .map(|entry| entry.expect("its entries can be read").path())
        .filter(|path| path.to_string_lossy().contains(".rpinet"))
        .collect();
    paths.sort();
    let read = |path: &PathBuf| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let name = name.split(".rpinet").next().unwrap_or_default().to_owned();
        let text = rpi_testkit::read_maybe_gz(path).expect("nets are readable");
        (format!("{folder}/{name}"), text)
    };
    Some(paths.iter().map(read).collect())
}

/// All recorded nets.
pub(crate) fn all() -> Option<Vec<(String, String)>> {
    let folders = ["v1", "v2", "traces", "corpus/nets"].map(nets_in);
    let all: Option<Vec<_>> = folders.into_iter().collect();
    Some(all?.into_iter().flatten().collect())
}

/// Parses a text and returns its net.
///
/// # Panics
/// Panics with all diagnostics if the text has an error.
pub(crate) fn net(name: &str, text: &str) -> Net {
    let (net, diagnostics) = rpi_net::rpinet::parse(name, FileId(0), text);
    net.unwrap_or_else(|| panic!("{}", rendered(name, text, &diagnostics)))
}

/// Renders diagnostics as a user sees them, errors first.
pub(crate) fn rendered(name: &str, text: &str, diagnostics: &[Diagnostic]) -> String {
    let mut sources = SourceMap::new();
    sources.add(name, text);
    let mut diagnostics = diagnostics.to_vec();
    diagnostics.sort_by_key(|f| f.severity() != Severity::Error);
    diagnostics.truncate(20);
    render(&diagnostics, &sources, Style::default())
}
