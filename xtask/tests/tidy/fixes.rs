//! Every fix must remove its diagnostic: it is applied alone and the program is compiled again. A fix that is marked as
//! sure must not cause a new error, and no fix may cause a syntax error.

use std::collections::BTreeMap;
use std::path::PathBuf;

use rpi_diag::{Applicability, Code, CodeGroup, Diagnostic, Fix, Severity, apply};
use xtask::fences;

use crate::compile::{CheckOutput, check};
use crate::ui::{checked_programs, name};

#[test]
fn each_fix_of_a_broken_program_mends_it() {
    let mut wrong = Vec::new();
    let mut count = 0;
    for path in checked_programs() {
        let text = std::fs::read_to_string(&path).expect("it is UTF-8");
        count += try_fixes(&name(&path), &text, &mut wrong);
    }
    assert!(count >= 100, "only {count} fixes are offered");
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

#[test]
fn each_fix_of_a_page_mends_its_wrong_program() {
    let mut wrong = Vec::new();
    for code in Code::ALL {
        for fence in fences(code.page()) {
            if let Some(language) = language(&fence.info) {
                let path = PathBuf::from(format!("{code}.{language}"));
                try_fixes(&path.to_string_lossy(), &fence.code, &mut wrong);
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

/// Returns the file extension for a fence that contains a wrong program.
fn language(info: &str) -> Option<&'static str> {
    match info {
        "rpi-wrong" => Some("rpi"),
        "rpi-wrong lus" => Some("lus"),
        "rpi-wrong net" => Some("rpinet"),
        _ => None,
    }
}

/// Applies each fix alone. Returns the number of fixes.
fn try_fixes(name: &str, text: &str, wrong: &mut Vec<String>) -> usize {
    let CheckOutput { diagnostics, .. } = check(name, text);
    let mut count = 0;
    for diagnostic in &diagnostics {
        for fix in &diagnostic.fixes {
            count += 1;
            let fixed = apply(text, fix.edits.iter());
            if let Err(why) = judge(
                &diagnostics,
                diagnostic,
                fix,
                &check(name, &fixed).diagnostics,
            ) {
                let what = format!("{} {}", diagnostic.code, diagnostic.message);
                wrong.push(format!(
                    "{name}: {what}\n  fix: {}: {why}\n{fixed}",
                    fix.title
                ));
            }
        }
    }
    count
}

/// Returns an error if the diagnostic is still reported, or if the fix causes an error that it must not cause.
fn judge(
    before: &[Diagnostic],
    diagnostic: &Diagnostic,
    fix: &Fix,
    after: &[Diagnostic],
) -> Result<(), String> {
    let (old, new) = (counted(before), counted(after));
    let key = key(diagnostic);
    if new.get(&key) >= old.get(&key) {
        return Err("the diagnostic is still reported".to_owned());
    }
    let is_new = |(key, count): &(&Key, &usize)| {
        key.0.severity() == Severity::Error && Some(*count) > old.get(key)
    };
    let sure = fix.applicability == Applicability::Sure;
    let mut errors = new.iter().filter(is_new);
    match errors.find(|((code, _), _)| sure || code.group() == CodeGroup::Syntax) {
        Some((new, _)) => Err(format!("but then: {} {}", new.0, new.1)),
        None => Ok(()),
    }
}

type Key = (Code, String);

fn key(diagnostic: &Diagnostic) -> Key {
    (diagnostic.code, diagnostic.message.clone())
}

fn counted(diagnostics: &[Diagnostic]) -> BTreeMap<Key, usize> {
    let mut counts = BTreeMap::new();
    for diagnostic in diagnostics {
        *counts.entry(key(diagnostic)).or_default() += 1;
    }
    counts
}
