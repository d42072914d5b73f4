//! Static check that the commands of a run fit the time budget of a tick.

use rpi_core::Command;

use super::job::Failure;
use super::plan::Plan;
use crate::control::Budget;

/// Time budget of a run and the known bounds of its commands.
#[derive(Clone, Copy, Debug)]
pub struct Share<'a> {
    /// Time budget of all commands in a tick.
    pub budget: Budget,
    /// For each command, the bound computed by the compiler on the work of its primitives, in elementary operations, if
    /// available.
    pub work: &'a [Option<u64>],
}

impl Share<'_> {
    /// Returns an error if a command, or all commands that may run in parallel, exceed the budget. `commands` is in the
    /// order of the images.
    pub(super) fn admit(&self, commands: &mut [Command], plans: &[Plan]) -> Result<(), Failure> {
        for (command, work) in commands.iter_mut().zip(self.work) {
            work.iter().for_each(|work| command.bound_work(*work));
        }
        let times: Vec<u64> = commands.iter().map(|c| self.budget.time_of(c)).collect();
        let grants = |what: &dyn Fn() -> String, needed_ns| {
            let granted = self.budget.grants(needed_ns);
            granted.map_err(|why| Failure::TooMuch { what: what(), why })
        };
        for (command, time) in commands.iter().zip(&times) {
            grants(&|| command.machine().image().name.clone(), *time)?;
        }
        let all = plans.iter().map(|plan| plan.together(&times));
        let at_once = || "the set of parallel commands".to_owned();
        grants(&at_once, all.fold(0, u64::saturating_add))
    }
}
