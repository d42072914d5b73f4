//! Whether commands fit the share of a tick that is theirs, before any of them runs.

use rpi_core::Command;

use super::job::Failure;
use super::plan::Plan;
use crate::control::Budget;

/// What the commands of a run may take of a tick, and what is known about them.
#[derive(Clone, Copy, Debug)]
pub struct Share<'a> {
    /// What they may take.
    pub budget: Budget,
    /// For each the bound on what its primitives do, in elementary operations, where a compiler has shown one.
    pub work: &'a [Option<u64>],
}

impl Share<'_> {
    /// Fails if one of these commands, in the order of their images, or all that run at once by the plans may take more.
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
        let at_once = || "what runs at once".to_owned();
        grants(&at_once, all.fold(0, u64::saturating_add))
    }
}
