//! Interface between a task and the control core that runs it.

use std::fmt;
use std::sync::Arc;

use rpi_core::{CommandError, CommandId, Rule, RuleId};
use rpi_image::Image;

use crate::control::{RequestError, Ticket};

/// Reason for which a command of a task was not started.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum NotStartedError {
    /// The request was rejected before it was sent.
    Rejected(RequestError),
    /// The core refused the request.
    Refused(CommandError),
    /// The rule that would start the command was dropped, because it can no longer fire or was withdrawn.
    Dropped,
}

impl fmt::Display for NotStartedError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            NotStartedError::Rejected(why) => why.fmt(f),
            NotStartedError::Refused(why) => write!(f, "refused by the core: {why:?}"),
            NotStartedError::Dropped => f.write_str("no rule can start the command any more"),
        }
    }
}

/// Operations of the control core that a running task uses. A command that is not loaded is given by its index in the
/// list of images, a loaded one by its id. No method blocks.
pub trait TaskCore {
    /// Returns the image with this index.
    fn image(&self, index: usize) -> Arc<Image>;

    /// Loads the command with this index and returns its id.
    ///
    /// # Errors
    /// Returns an error if the command cannot run in the cell or there is no room for it.
    fn load(&mut self, index: usize) -> Result<CommandId, RequestError>;

    /// Requests the start of a loaded command. The ticket identifies the answer.
    ///
    /// # Errors
    /// Returns an error if there are too many pending requests.
    fn start(&mut self, id: CommandId) -> Result<Ticket, RequestError>;

    /// Adds a rule that starts commands when its condition holds. Returns its id, and the ticket that identifies the
    /// answer.
    ///
    /// # Errors
    /// Returns an error if there are too many rules or pending requests.
    fn schedule(&mut self, rule: Rule) -> Result<(RuleId, Ticket), RequestError>;

    /// Requests a command to end: its input `cancel` becomes true.
    fn cancel(&mut self, id: CommandId);

    /// Removes a command that does not run from the core.
    fn unload(&mut self, id: CommandId);

    /// Returns true if the successors of a command may be scheduled now. `first_tick` is the number of the tick in
    /// which the command started; `None` if it has not started. Runs with a simulated planning time wait for this time.
    fn can_plan(&self, first_tick: Option<u64>) -> bool;

    /// Reports a successor that was not scheduled when its predecessor ended. `in_motion` is true if the successor
    /// could have taken over while the devices moved.
    fn report_late(&mut self, in_motion: bool);

    /// Reports that a branch of the task handles the error with which the command ended.
    fn report_handled(&mut self, id: CommandId);

    /// Reports commands that could not be started, given by index, and the reason. `indices` has several entries if
    /// they were to start together.
    fn report_not_started(&mut self, indices: &[usize], why: NotStartedError);
}
