//! The machine that programs are checked for: `machine.toml` beside a program, or a careful default.
//!
//! ```toml
//! ns-per-operation = 4.0     # an elementary operation at worst; `rpic machine` measures it
//! period-us = 1000           # period of a cycle
//! ```

use std::path::Path;

use rpi_net::passes::Machine;
use serde::Deserialize;

use crate::files::Files;

/// The file that describes the machine.
pub const MACHINE: &str = "machine.toml";

#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct Profile {
    ns_per_operation: f64,
    period_us: Option<u64>,
}

/// The machine of a folder. A file that is none, or says what no machine is like, counts as not there.
pub(crate) fn machine(folder: Option<&Path>, files: &dyn Files) -> Machine {
    let text = folder.and_then(|folder| files.text(&folder.join(MACHINE)));
    text.and_then(|text| parse(&text)).unwrap_or_default()
}

/// The machine that a file describes, as [`machine_text`] writes it.
///
/// # Errors
/// If the file cannot be read, or describes none.
pub fn read_machine(path: &Path) -> Result<Machine, String> {
    let name = path.display();
    let text = std::fs::read_to_string(path).map_err(|e| format!("{name}: {e}"))?;
    let wanted = "it has to state `ns-per-operation`, above 0, and may state `period-us`; `rpic machine` writes such a file";
    parse(&text).ok_or_else(|| format!("{name} describes no machine: {wanted}"))
}

fn parse(text: &str) -> Option<Machine> {
    let profile: Profile = toml::from_str(text).ok()?;
    let period = profile.period_us.map(|us| us.saturating_mul(1000));
    let machine = Machine {
        ns_per_operation: profile.ns_per_operation,
        period_ns: period.unwrap_or(Machine::default().period_ns),
    };
    let sound = machine.ns_per_operation.is_finite() && machine.ns_per_operation > 0.0;
    (sound && machine.period_ns > 0).then_some(machine)
}

/// The text of a machine's file.
#[must_use]
pub fn machine_text(ns_per_operation: f64) -> String {
    format!(
        "# Time of an elementary operation at worst, as `rpic machine` measured it here.\nns-per-operation = {ns_per_operation:.2}\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read() {
        let machine = parse(&machine_text(3.25)).expect("it is a profile");
        assert_eq!(
            (machine.ns_per_operation, machine.period_ns),
            (3.25, 1_000_000)
        );
    }

    #[test]
    fn what_no_machine_is_like_is_refused() {
        for text in [
            "",
            "ns-per-operation = 0",
            "ns-per-operation = nan",
            "speed = 3",
        ] {
            assert_eq!(parse(text), None, "{text}");
        }
    }
}
