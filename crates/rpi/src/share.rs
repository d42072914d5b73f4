//! What commands may take of a tick.

use std::path::{Path, PathBuf};

use clap::Args;
use rpi_host::control::Budget;

/// How heavy commands may be.
#[derive(Args, Debug)]
pub(crate) struct ShareArgs {
    /// How many percent of a tick commands may take together at most, by the bounds that the compiler has for them: 80 unless said
    /// otherwise. Those beyond are refused. `off` for no limit.
    #[arg(long, value_name = "PERCENT", value_parser = share)]
    cycle_share: Option<Share>,
    /// What `rpic machine` has measured here, for these bounds: the worst; 2.5 ns an operation without it.
    #[arg(long, value_name = "FILE")]
    machine: Option<PathBuf>,
}

impl ShareArgs {
    /// True if somebody has asked for something.
    pub(crate) fn is_asked_for(&self) -> bool {
        self.cycle_share.is_some() || self.machine.is_some()
    }

    /// The share of a tick, from 0 to 1; none for no limit.
    pub(crate) fn share(&self) -> Option<f64> {
        self.cycle_share
            .map_or(Some(Budget::SHARE), |share| share.0)
    }

    /// Time of an elementary operation, nanoseconds: of the machine that was named, else of the one in this file if there is one.
    pub(crate) fn ns_per_operation(&self, beside: Option<&Path>) -> Result<f64, String> {
        let beside = beside.filter(|path| path.is_file());
        let measured = self.machine.as_deref().or(beside);
        measured.map_or(Ok(Budget::NS_PER_OPERATION), |path| {
            Ok(rpi_driver::read_machine(path)?.ns_per_operation)
        })
    }
}

/// A share of a tick from 0 to 1, or no limit.
#[derive(Clone, Copy, PartialEq, Debug)]
struct Share(Option<f64>);

fn share(text: &str) -> Result<Share, String> {
    if text == "off" {
        return Ok(Share(None));
    }
    let number = text.trim_end_matches('%').parse().ok();
    let usable = number.filter(|percent| (0.0..=100.0).contains(percent) && *percent > 0.0);
    let share = usable.map(|percent: f64| Share(Some(percent / 100.0)));
    share.ok_or_else(|| "a number above 0 and up to 100 is needed, or `off`".to_owned())
}
