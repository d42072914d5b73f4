//! Options for the share of a cycle that commands may take.

use std::error::Error;
use std::path::{Path, PathBuf};

use clap::Args;
use rpi_runtime::control::Budget;

/// Options that limit the computing time of commands in a cycle.
#[derive(Args, Debug)]
pub(crate) struct BudgetArgs {
    /// Maximum share of a cycle for all commands together, in percent, by the work bounds of the compiler; default 80,
    /// `off` for no limit. A command that would exceed the share is rejected.
    #[arg(long, value_name = "PERCENT", value_parser = share)]
    cycle_share: Option<CycleShare>,
    /// File with the measurements of `rpic machine`, from which work bounds become times; without it, 2.5 ns per
    /// operation.
    #[arg(long, value_name = "FILE")]
    machine: Option<PathBuf>,
}

impl BudgetArgs {
    /// Returns true if one of the options is present on the command line.
    pub(crate) fn is_present(&self) -> bool {
        self.cycle_share.is_some() || self.machine.is_some()
    }

    /// Returns the maximum share of a cycle for all commands together, from 0 to 1; `None` for no limit.
    pub(crate) fn parse_share(&self) -> Option<f64> {
        self.cycle_share
            .map_or(Some(Budget::SHARE), |share| share.0)
    }

    /// Returns the time of an elementary operation in nanoseconds: from the file that the option names, else from the
    /// file `beside` if it exists, else the default of 2.5 ns.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read or is invalid.
    pub(crate) fn ns_per_operation(&self, beside: Option<&Path>) -> Result<f64, Box<dyn Error>> {
        let beside = beside.filter(|path| path.is_file());
        let measured = self.machine.as_deref().or(beside);
        measured.map_or(Ok(Budget::NS_PER_OPERATION), |path| {
            let machine = rpi_driver::read_machine(path).map_err(|error| error.to_string())?;
            Ok(machine.ns_per_operation)
        })
    }
}

/// Maximum share of a cycle for all commands together, from 0 to 1; `None` for no limit.
#[derive(Clone, Copy, PartialEq, Debug)]
struct CycleShare(Option<f64>);

fn share(text: &str) -> Result<CycleShare, String> {
    if text == "off" {
        return Ok(CycleShare(None));
    }
    let number = text.trim_end_matches('%').parse().ok();
    let usable = number.filter(|percent| (0.0..=100.0).contains(percent) && *percent > 0.0);
    let share = usable.map(|percent: f64| CycleShare(Some(percent / 100.0)));
    share.ok_or_else(|| "expected a number above 0 and up to 100, or `off`".to_owned())
}
