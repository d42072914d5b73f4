//! Description of the machine for which programs are checked: `machine.toml` beside a program, or a conservative
//! default.
//!
//! ```toml
//! ns-per-operation = 4.0     # worst-case time of an elementary operation; `rpic machine` measures it
//! period-us = 1000           # period of a cycle
//! ```

use std::fmt;
use std::path::Path;

use rpi_net::passes::MachineProfile;
use serde::Deserialize;

use crate::file_loader::FileLoader;
use crate::input::InputError;

/// File name of the machine description.
pub const MACHINE: &str = "machine.toml";

/// Help text for errors in a machine description, which states the required content.
const FORMAT_HELP: &str = "required is `ns-per-operation` above 0, optional is `period-us` above 0; `rpic machine` writes such a file";

#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct Profile {
    ns_per_operation: f64,
    period_us: Option<u64>,
}

/// Reads the description of the machine (`machine.toml`) in a folder, from which time budgets are checked. Returns the
/// default if the folder has none.
///
/// # Errors
/// If the file exists but is invalid.
pub(crate) fn load_machine(
    folder: Option<&Path>,
    files: &dyn FileLoader,
) -> Result<MachineProfile, InputError> {
    let path = folder.unwrap_or(Path::new("")).join(MACHINE);
    let text = folder.and_then(|_| files.text(&path));
    let machine = match text {
        None if folder.is_some() && path.exists() => Err("not a text file".to_owned()),
        text => text.map(|text| parse(&text)).transpose(),
    };
    machine
        .map(Option::unwrap_or_default)
        .map_err(|why| InputError {
            help: Some(FORMAT_HELP.to_owned()),
            ..InputError::new(&path, why)
        })
}

/// Error: a machine description cannot be read. It has the reason.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct MachineError(String);

impl fmt::Display for MachineError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for MachineError {}

/// Reads a machine description: the time of an elementary operation and the period of a cycle.
///
/// # Errors
/// If the file cannot be read or is invalid.
pub fn read_machine(path: &Path) -> Result<MachineProfile, MachineError> {
    let name = path.display();
    let text = rpi_files::read_text(path, rpi_files::MAX_DESCRIPTION);
    let text = text.map_err(|e| MachineError(format!("{name}: {e}")))?;
    parse(&text).map_err(|why| MachineError(format!("{name}: {why}: {FORMAT_HELP}")))
}

/// Parses the text of a machine description; the error is a message.
fn parse(text: &str) -> Result<MachineProfile, String> {
    let no_machine = |why: &str| format!("invalid machine description{why}");
    let profile: Profile = toml::from_str(text).map_err(|e| {
        let begin = e.span().map_or(0, |span| span.start);
        let line = 1 + text.as_bytes()[..begin]
            .iter()
            .filter(|b| **b == b'\n')
            .count();
        no_machine(&format!(": line {line}: {}", e.message()))
    })?;
    let period = profile.period_us.map(|us| us.saturating_mul(1000));
    let machine = MachineProfile {
        ns_per_operation: profile.ns_per_operation,
        period_ns: period.unwrap_or(MachineProfile::default().period_ns),
    };
    let sound = machine.ns_per_operation.is_finite() && machine.ns_per_operation > 0.0;
    let sound = sound && machine.period_ns > 0;
    sound.then_some(machine).ok_or_else(|| no_machine(""))
}

/// Returns the text of a machine description with this worst-case time of an elementary operation in nanoseconds.
#[must_use]
pub fn machine_text(ns_per_operation: f64) -> String {
    format!(
        "# Worst-case time of an elementary operation, measured by `rpic machine` on this machine.\nns-per-operation = {ns_per_operation:.2}\n"
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
        let why = parse("# mine\nspeed = 3").unwrap_err();
        assert!(why.contains("line 2: unknown field `speed`"), "{why}");
        for text in [
            "",
            "period-us = 0\nns-per-operation = 2",
            "ns-per-operation = 0",
            "ns-per-operation = nan",
            "speed = 3",
        ] {
            assert!(parse(text).is_err(), "{text}");
        }
    }
}
