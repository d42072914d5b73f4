//! Compiles the programs in documents. Correct examples must compile without diagnostics, wrong examples must give
//! exactly the documented code.
//!
//! A fence `rpi` contains a whole program that compiles without diagnostics, `lus` one in Lustre, `rpinet` a net. On an
//! explanation page, `rpi-right` is the same, and `rpi-wrong` gives the code of the page and no other.

use std::path::PathBuf;

use rpi_diag::{Code, Style, render};
use rpi_testkit::files_below;
use xtask::{Fence, fences};

use crate::compile::{CheckOutput, check};

/// Languages of fences that contain whole programs.
const RIGHT: &[&str] = &["rpi", "lus", "rpinet"];

#[test]
fn programs_in_documents_compile() {
    let mut count = 0;
    let mut wrong = Vec::new();
    for path in documents() {
        let text = std::fs::read_to_string(&path).unwrap_or_default();
        for mut fence in fences(&text) {
            // A block may also name a file: `rpi lamp.rpi`.
            fence.info = fence.info.split(' ').next().unwrap_or_default().to_owned();
            if !RIGHT.contains(&fence.info.as_str()) {
                continue;
            }
            count += 1;
            wrong.extend(unexpected_diagnostics(
                &format!("{}:{}", path.display(), fence.line),
                &fence,
            ));
        }
    }
    assert!(count > 0, "no document shows a program");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn pages_say_what_the_compiler_says() {
    let mut wrong = Vec::new();
    for code in Code::ALL {
        for fence in fences(code.page()) {
            match fence.info.split(' ').next() {
                Some("rpi-right") => wrong.extend(unexpected_diagnostics(
                    &format!("{code}, right program"),
                    &fence,
                )),
                Some("rpi-wrong") => wrong.extend(other_than(*code, &fence)),
                _ => {}
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Compiles the standard library and the examples.
#[test]
fn programs_of_the_project_compile() {
    let mut wrong = Vec::new();
    let examples = files_below("examples", &[".rpi", ".lus"]);
    assert!(!examples.is_empty(), "no examples");
    for path in examples {
        // By its path, because a program may read the taught points beside it.
        let code = std::fs::read_to_string(&path).unwrap_or_default();
        let output = check(&path.to_string_lossy(), &code);
        let shown = render(&output.diagnostics, &output.sources, Style::PLAIN);
        if !output.diagnostics.is_empty() {
            wrong.push(format!("{}: should be right\n{shown}", path.display()));
        }
    }
    let library = files_below("stdlib", &[".rpi"]);
    assert!(!library.is_empty(), "no standard library");
    for path in library {
        let code = std::fs::read_to_string(&path).unwrap_or_default();
        let info = path
            .extension()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        wrong.extend(unexpected_diagnostics(
            &path.display().to_string(),
            &Fence {
                info,
                line: 1,
                code,
            },
        ));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Returns the diagnostics of a program that should have none.
fn unexpected_diagnostics(place: &str, fence: &Fence) -> Option<String> {
    let CheckOutput {
        diagnostics,
        sources,
    } = check(file_name(fence)?, &fence.code);
    let shown = render(&diagnostics, &sources, Style::PLAIN);
    (!diagnostics.is_empty()).then(|| format!("{place}: should be right\n{shown}"))
}

/// Returns the diagnostics of a wrong program unless they are exactly one with the expected code.
fn other_than(code: Code, fence: &Fence) -> Option<String> {
    let CheckOutput {
        diagnostics,
        sources,
    } = check(file_name(fence)?, &fence.code);
    let codes: Vec<Code> = diagnostics
        .iter()
        .map(|diagnostic| diagnostic.code)
        .collect();
    let shown = render(&diagnostics, &sources, Style::PLAIN);
    (codes != [code]).then(|| format!("{code}, wrong program: gives {codes:?}\n{shown}"))
}

/// Returns a file name whose extension decides the language, if the fence contains a whole program.
fn file_name(fence: &Fence) -> Option<&'static str> {
    match fence.info.as_str() {
        "rpi" | "rpi-right" | "rpi-wrong" => Some("example.rpi"),
        "lus" | "rpi-right lus" | "rpi-wrong lus" => Some("example.lus"),
        "rpinet" | "rpi-right rpinet" | "rpi-wrong rpinet" => Some("example.rpinet"),
        _ => None,
    }
}

/// Returns all documents: at the root, in the book, beside the examples.
fn documents() -> Vec<PathBuf> {
    files_below("", &[".md"])
        .into_iter()
        .filter(|path| !path.to_string_lossy().contains("/pages/"))
        .collect()
}
