//! What a task asks of whoever runs it.

use std::fmt;
use std::sync::Arc;

use rpi_core::{CommandId, Refused, Rule, RuleId};
use rpi_image::Image;

use crate::control::{Rejected, Ticket};

/// Why a command of a task does not run.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum NotStarted {
    /// It could not even be asked for.
    Rejected(Rejected),
    /// The core has refused it.
    Refused(Refused),
    /// The rule that was to start it is gone.
    Dropped,
}

impl fmt::Display for NotStarted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            NotStarted::Rejected(why) => why.fmt(f),
            NotStarted::Refused(why) => write!(f, "the core refuses it: {why:?}"),
            NotStarted::Dropped => f.write_str("nothing can start it any more"),
        }
    }
}

/// A control core as a task sees it. Commands are named by their index in the list that the plan was made for; nothing of this
/// waits.
pub trait Workshop {
    /// The image of a command.
    fn image(&self, index: usize) -> Arc<Image>;

    /// Loads a command.
    ///
    /// # Errors
    /// Why it cannot run.
    fn load(&mut self, index: usize) -> Result<CommandId, Rejected>;

    /// Starts a command.
    ///
    /// # Errors
    /// If too much is under way.
    fn start(&mut self, id: CommandId) -> Result<Ticket, Rejected>;

    /// Makes a rule.
    ///
    /// # Errors
    /// If too much is under way.
    fn schedule(&mut self, rule: Rule) -> Result<(RuleId, Ticket), Rejected>;

    /// Asks a command to end.
    fn cancel(&mut self, id: CommandId);

    /// Lets go of a command that does not run.
    fn unload(&mut self, id: CommandId);

    /// Whether what follows a command that began in this tick may be thought of now.
    fn may_plan(&self, first_tick: Option<u64>) -> bool;

    /// A command follows that was not scheduled when the one before it ended; `in_motion` if it could have taken over before.
    fn late(&mut self, in_motion: bool);

    /// A branch is for the error by which a command has ended.
    fn handled(&mut self, id: CommandId);

    /// Commands that were to start together do not run; mostly it is one.
    fn not_started(&mut self, indices: &[usize], why: NotStarted);
}
