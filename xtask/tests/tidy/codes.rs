//! Rule 3: a diagnostic code is declared in one table and has one explanation page. Rule 10: it is reported in one
//! crate.

use std::collections::{BTreeMap, BTreeSet};

use rpi_diag::Code;
use rpi_testkit::files_below;
use xtask::{fences, source_files};

#[test]
fn no_page_without_a_code() {
    let pages: BTreeSet<String> = files_below("crates/rpi-diag/pages", &[".md"])
        .iter()
        .filter_map(|path| Some(path.file_stem()?.to_str()?.to_owned()))
        .collect();
    let codes: BTreeSet<String> = Code::ALL
        .iter()
        .map(|code| code.as_str().to_owned())
        .collect();
    assert_eq!(pages, codes);
}

/// Codes that no known program can cause by itself; their pages have no wrong program.
pub(crate) const NO_PROGRAM: &[Code] = &[
    Code::RPI1018,
    Code::RPI1019,
    Code::RPI7003,
    Code::RPI9021,
    Code::RPI9201,
    Code::RPI9202,
    Code::RPI9901,
];

#[test]
fn pages_carry_their_title_and_both_programs() {
    for code in Code::ALL {
        let heading = format!("# {code}: {}", code.title());
        assert_eq!(code.page().lines().next(), Some(heading.as_str()), "{code}");
        let fences = fences(code.page());
        for info in ["rpi-wrong", "rpi-right"] {
            let programs = fences
                .iter()
                .filter(|f| f.info.split(' ').next() == Some(info));
            let none = info == "rpi-wrong" && NO_PROGRAM.contains(code);
            assert!(
                (programs.count() > 0) != none,
                "{code}: `{info}` programs on the page"
            );
        }
    }
}

/// The message of a diagnostic is written beside the check that has the facts, hence in one crate.
#[test]
fn a_code_is_raised_in_one_crate() {
    let raisers = reporting_crates();
    for code in Code::ALL {
        let crates = raisers.get(code.as_str()).cloned().unwrap_or_default();
        assert!(
            crates.len() < 2,
            "{code} is raised in {crates:?}; one check, one place"
        );
    }
}

/// Filters on diagnostics, and decisions by the text of a code, which only `rpi-diag` may contain: it suppresses by typed
/// causes.
const FILTERS: &[&str] = &["diagnostics.retain(", "starts_with(\"RPI"];

#[test]
fn diagnostics_are_suppressed_in_one_crate() {
    for file in source_files() {
        let mut text = file.without_tests().to_owned();
        text.retain(|c| !c.is_whitespace());
        let filter = FILTERS.iter().find(|filter| text.contains(**filter));
        if file.owner != "rpi-diag" {
            assert_eq!(filter, None, "{}", file.path.display());
        }
    }
}

/// Returns, for each code, the crates that report it.
fn reporting_crates() -> BTreeMap<String, BTreeSet<String>> {
    let mut raisers: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for file in source_files()
        .iter()
        .filter(|file| file.owner != "rpi-diag")
    {
        for (at, _) in file.without_tests().match_indices("Code::RPI") {
            let code = file.text[at + 6..]
                .chars()
                .take_while(char::is_ascii_alphanumeric)
                .collect();
            raisers.entry(code).or_default().insert(file.owner.clone());
        }
    }
    raisers
}
