//! Static check that the commands of a run fit the time budget of a tick.

use rpi_core::Command;

use super::job::RunError;
use super::plan::ExecutablePlan;
use crate::control::Budget;

/// Time budget of all commands of a run in a tick, and the upper bounds on the work of the commands.
#[derive(Clone, Copy, Debug)]
pub struct RunBudget<'a> {
    /// Time that all commands together may use in a tick.
    pub budget: Budget,
    /// For each command, the compiler's upper bound on the work of its primitives in a cycle, in elementary operations;
    /// `None` if unknown.
    pub work: &'a [Option<u64>],
}

impl RunBudget<'_> {
    /// Returns an error if a single command, or the commands of all plans that may run in parallel, exceed the budget.
    /// `commands` has the same order as the indices in the plans.
    pub(super) fn check(
        &self,
        commands: &mut [Command],
        plans: &[ExecutablePlan],
    ) -> Result<(), RunError> {
        for (command, work) in commands.iter_mut().zip(self.work) {
            work.iter().for_each(|work| command.set_work_bound(*work));
        }
        let times: Vec<u64> = commands
            .iter()
            .map(|c| self.budget.worst_case_ns(c))
            .collect();
        let grants = |what: &dyn Fn() -> String, needed_ns| {
            let granted = self.budget.check(needed_ns);
            granted.map_err(|why| RunError::BudgetExceeded { what: what(), why })
        };
        for (command, time) in commands.iter().zip(&times) {
            grants(&|| command.instance().image().name.clone(), *time)?;
        }
        let all = plans.iter().map(|plan| plan.worst_case_ns(&times));
        let at_once = || "the set of parallel commands".to_owned();
        grants(&at_once, all.fold(0, u64::saturating_add))
    }
}
