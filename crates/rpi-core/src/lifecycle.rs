//! Lifecycle of a command as a table of states and events.
//!
//! | from | event | to |
//! |---|---|---|
//! | Loading | Loaded | Ready |
//! | Loading | Faulty | Rejected |
//! | Ready | Start | Running |
//! | Ready, Scheduled | Schedule | Scheduled |
//! | Ready, Rejected, Terminated, Scheduled | Unload | gone |
//! | Scheduled | Fire | Running |
//! | Scheduled | Orphan, kept | Ready |
//! | Scheduled | Orphan, not kept | gone |
//! | Running | Cancel | Cancelling |
//! | Cancelling | Cancel | Cancelling |
//! | Running, Cancelling | End | Terminated |
//!
//! Every other pair is rejected and changes nothing.

/// State of a command between loading and removal, as in rules L1 to L6 of the manual.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum CommandState {
    /// Memory and devices are being prepared outside the cycle.
    Loading,
    /// The image cannot run in this cell; the reasons are known.
    Rejected,
    /// The command can be started or scheduled. It holds no resources.
    Ready,
    /// The command waits for a rule to start it. It holds those of its resources that were free.
    Scheduled,
    /// The command runs one cycle in every tick in which it is due.
    Running,
    /// The command runs, and its flow `cancel` is true because a cancel was requested.
    Cancelling,
    /// The command has ended; its result, error and cause are known.
    Terminated,
}

/// Event in the life of a command that may change its state.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum CommandEvent {
    /// The image was loaded without an error.
    Loaded,
    /// Loading has found errors.
    LoadFailed,
    /// The command is started by a request; all needed resources are free.
    Start,
    /// A rule that will start the command is added. The resources of the command are free or come from its
    /// predecessors.
    Schedule,
    /// A rule that starts the command fires: its condition is true.
    Fire,
    /// No rule can start the command any more.
    Orphaned {
        /// True if the command becomes ready again; false if it is removed.
        kept: bool,
    },
    /// A client or a rule asks the command to end in an orderly way.
    Cancel,
    /// The command ends by a result, an abort, a fault, or a rule that stops it.
    End,
    /// The owner unloads the command.
    Unload,
}

/// Effect of an event (start, cancel, end and so on) on the lifecycle state of a command.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Transition {
    /// The command is in this state after the event.
    To(CommandState),
    /// The command is removed from the table. It is freed outside the cycle.
    Removed,
    /// The event is not allowed in this state; nothing changes.
    Rejected,
}

impl CommandState {
    /// All states of a command, in the order of its life.
    pub const ALL: [CommandState; 7] = [
        CommandState::Loading,
        CommandState::Rejected,
        CommandState::Ready,
        CommandState::Scheduled,
        CommandState::Running,
        CommandState::Cancelling,
        CommandState::Terminated,
    ];

    /// Returns the effect of `event` on a command in this state.
    #[must_use]
    pub const fn next(self, event: CommandEvent) -> Transition {
        match (self, event) {
            (CommandState::Loading, CommandEvent::Loaded) => Transition::To(CommandState::Ready),
            (CommandState::Loading, CommandEvent::LoadFailed) => {
                Transition::To(CommandState::Rejected)
            }
            (CommandState::Ready, CommandEvent::Start) => Transition::To(CommandState::Running),
            (CommandState::Ready | CommandState::Scheduled, CommandEvent::Schedule) => {
                Transition::To(CommandState::Scheduled)
            }
            (CommandState::Scheduled, CommandEvent::Fire) => Transition::To(CommandState::Running),
            (CommandState::Scheduled, CommandEvent::Orphaned { kept: true }) => {
                Transition::To(CommandState::Ready)
            }
            (CommandState::Scheduled, CommandEvent::Orphaned { kept: false }) => {
                Transition::Removed
            }
            (CommandState::Running | CommandState::Cancelling, CommandEvent::Cancel) => {
                Transition::To(CommandState::Cancelling)
            }
            (CommandState::Running | CommandState::Cancelling, CommandEvent::End) => {
                Transition::To(CommandState::Terminated)
            }
            (
                CommandState::Ready
                | CommandState::Rejected
                | CommandState::Terminated
                | CommandState::Scheduled,
                CommandEvent::Unload,
            ) => Transition::Removed,
            _ => Transition::Rejected,
        }
    }

    /// True if a command in this state is evaluated in cycles.
    #[must_use]
    pub const fn is_running(self) -> bool {
        matches!(self, CommandState::Running | CommandState::Cancelling)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const EVENTS: [CommandEvent; 10] = [
        CommandEvent::Loaded,
        CommandEvent::LoadFailed,
        CommandEvent::Start,
        CommandEvent::Schedule,
        CommandEvent::Fire,
        CommandEvent::Orphaned { kept: true },
        CommandEvent::Orphaned { kept: false },
        CommandEvent::Cancel,
        CommandEvent::End,
        CommandEvent::Unload,
    ];

    /// One row per state and one letter per event, in the order of the enum. A letter is the initial of the next state
    /// (`C` for Cancelling, `L` never), `-` is gone, `.` is rejected.
    const TABLE: [(CommandState, &str); 7] = [
        (CommandState::Loading, "DJ........"),
        (CommandState::Rejected, ".........-"),
        (CommandState::Ready, "..RS.....-"),
        (CommandState::Scheduled, "...SRD-..-"),
        (CommandState::Running, ".......CT."),
        (CommandState::Cancelling, ".......CT."),
        (CommandState::Terminated, ".........-"),
    ];

    fn letter(next: Transition) -> char {
        match next {
            Transition::Removed => '-',
            Transition::Rejected => '.',
            Transition::To(CommandState::Loading) => 'L',
            Transition::To(CommandState::Rejected) => 'J',
            Transition::To(CommandState::Ready) => 'D',
            Transition::To(CommandState::Scheduled) => 'S',
            Transition::To(CommandState::Running) => 'R',
            Transition::To(CommandState::Cancelling) => 'C',
            Transition::To(CommandState::Terminated) => 'T',
        }
    }

    #[test]
    fn every_pair_of_state_and_event_is_decided() {
        for (state, row) in TABLE {
            let got: alloc::string::String = EVENTS.map(|e| letter(state.next(e))).iter().collect();
            assert_eq!(got, row, "{state:?}");
        }
        assert_eq!(TABLE.map(|row| row.0), CommandState::ALL);
    }
}
