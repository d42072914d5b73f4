//! Generator of the chapter on differences to the reference system, from the table that `rpi replay` uses.

use std::fmt::Write;

use rpi_prims::differences::{Condition, DIFFERENCES, Difference};

use super::GENERATED_NOTICE;

pub(super) fn chapter() -> String {
    let mut out = format!("{GENERATED_NOTICE}# Differences to the reference system\n\n");
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
    let _ = writeln!(out, "- Visible: {}", visibility(difference.condition));
    let _ = writeln!(out, "- The reference {}.", difference.fault);
    let _ = writeln!(
        out,
        "- Correct behaviour: {}. Checked by the test `{}`.",
        difference.correct, difference.test
    );
    out
}

fn quoted(names: &[&str]) -> String {
    let quoted: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
    quoted.join(", ")
}

fn visibility(when: Condition) -> &'static str {
    match when {
        Condition::FaultModel(_) => {
            "where the recorded value is exactly what the fault computes from the recorded inputs"
        }
        Condition::Always => "in every value",
        Condition::NothingRecorded => "where nothing was recorded although there is a value",
        Condition::NotAllConnected => {
            "where nothing was recorded and not all in-ports are connected"
        }
        Condition::AliasedSource => {
            "where parts of the recorded value belong to an object that its producer continues to modify"
        }
        Condition::ReadsAliased => {
            "where an input is an object that its producer continues to modify"
        }
        Condition::FirstCycleAfterPause => {
            "in the first cycle in which the fragment is active again"
        }
        Condition::OtherType => "where the recorded text is not a value of the port's type",
    }
}
