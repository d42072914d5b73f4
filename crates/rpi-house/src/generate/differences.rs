//! Generator of the chapter on differences to the reference system, from the table that `rpi replay` uses.

use std::fmt::Write;

use rpi_prims::differences::{DIFFERENCES, Difference, When};

use super::MARK;

pub(super) fn chapter() -> String {
    let mut out = format!("{MARK}# Differences to the reference system\n\n");
    out.push_str(
        "Nets of the Robotics API behave as in the reference system, except for the faults below, which are not reproduced. \
         `rpi replay` accepts a differing recorded value only if one of these entries explains it, counts such \
         values and lists them. Everything computed from such a value is still compared.\n",
    );
    for difference in DIFFERENCES {
        out.push_str(&entry(difference));
    }
    out
}

fn entry(difference: &Difference) -> String {
    let mut out = format!("\n## {}\n\n", difference.name);
    // Writing to a string does not fail.
    let _ = writeln!(
        out,
        "- Primitives: {}; out-ports: {}",
        quoted(difference.types),
        quoted(difference.ports)
    );
    let _ = writeln!(out, "- Visible: {}", shows(difference.when));
    let _ = writeln!(out, "- The reference {}.", difference.fault);
    let _ = writeln!(
        out,
        "- Correct behaviour: {}. Checked by the test `{}`.",
        difference.right, difference.test
    );
    out
}

fn quoted(names: &[&str]) -> String {
    let quoted: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
    quoted.join(", ")
}

fn shows(when: When) -> &'static str {
    match when {
        When::Gives(_) => {
            "where the recorded value is exactly what the fault computes from the recorded inputs"
        }
        When::Always => "in every value",
        When::NothingRecorded => "where nothing was recorded although there is a value",
        When::NotAllConnected => "where nothing was recorded and not all in-ports are connected",
        When::AliasedSource => {
            "where parts of the recorded value belong to an object that its producer continues to modify"
        }
        When::ReadsAliased => "where an input is an object that its producer continues to modify",
        When::FirstCycleAfterPause => "in the first cycle in which the fragment is active again",
        When::OtherType => "where the recorded text is not a value of the port's type",
    }
}
