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

/// Lifecycle state of a command.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum State {
    /// Memory and devices are being prepared outside the cycle.
    Loading,
    /// The image cannot run in this cell; the reasons are known.
    Rejected,
    /// The command can be started or scheduled. It holds no resources.
    Ready,
    /// The command waits for a rule to fire. It holds those of its resources that were free.
    Scheduled,
    /// The command runs in every cycle that is due.
    Running,
    /// The command runs and sees `cancel`.
    Cancelling,
    /// The command has ended; its result, error and cause are known.
    Terminated,
}

/// Event in the life of a command.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum Event {
    /// Loading has succeeded.
    Loaded,
    /// Loading has found errors.
    Faulty,
    /// A start request; all needed resources are free.
    Start,
    /// A rule that starts the command is added; its resources are free or come from its predecessors.
    Schedule,
    /// A rule that starts the command fires.
    Fire,
    /// Nothing can start the command any more.
    Orphan {
        /// The command becomes ready again instead of being removed.
        kept: bool,
    },
    /// A cancel request.
    Cancel,
    /// A result, an abort, a fault or a stop by a rule.
    End,
    /// The owner unloads the command.
    Unload,
}

/// Outcome of an event.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Next {
    /// The command enters this state.
    To(State),
    /// The command is removed; it is freed outside the cycle.
    Gone,
    /// The event is not allowed in this state; nothing changes.
    Refused,
}

impl State {
    /// All states.
    pub const ALL: [State; 7] = [
        State::Loading,
        State::Rejected,
        State::Ready,
        State::Scheduled,
        State::Running,
        State::Cancelling,
        State::Terminated,
    ];

    /// Transition function of the lifecycle.
    #[must_use]
    pub const fn next(self, event: Event) -> Next {
        match (self, event) {
            (State::Loading, Event::Loaded) => Next::To(State::Ready),
            (State::Loading, Event::Faulty) => Next::To(State::Rejected),
            (State::Ready, Event::Start) => Next::To(State::Running),
            (State::Ready | State::Scheduled, Event::Schedule) => Next::To(State::Scheduled),
            (State::Scheduled, Event::Fire) => Next::To(State::Running),
            (State::Scheduled, Event::Orphan { kept: true }) => Next::To(State::Ready),
            (State::Scheduled, Event::Orphan { kept: false }) => Next::Gone,
            (State::Running | State::Cancelling, Event::Cancel) => Next::To(State::Cancelling),
            (State::Running | State::Cancelling, Event::End) => Next::To(State::Terminated),
            (
                State::Ready | State::Rejected | State::Terminated | State::Scheduled,
                Event::Unload,
            ) => Next::Gone,
            _ => Next::Refused,
        }
    }

    /// True while the command takes part in cycles.
    #[must_use]
    pub const fn runs(self) -> bool {
        matches!(self, State::Running | State::Cancelling)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const EVENTS: [Event; 10] = [
        Event::Loaded,
        Event::Faulty,
        Event::Start,
        Event::Schedule,
        Event::Fire,
        Event::Orphan { kept: true },
        Event::Orphan { kept: false },
        Event::Cancel,
        Event::End,
        Event::Unload,
    ];

    /// One row per state and one letter per event, in the order of the enum. A letter is the initial of the next state
    /// (`C` for Cancelling, `L` never), `-` is gone, `.` is rejected.
    const TABLE: [(State, &str); 7] = [
        (State::Loading, "DJ........"),
        (State::Rejected, ".........-"),
        (State::Ready, "..RS.....-"),
        (State::Scheduled, "...SRD-..-"),
        (State::Running, ".......CT."),
        (State::Cancelling, ".......CT."),
        (State::Terminated, ".........-"),
    ];

    fn letter(next: Next) -> char {
        match next {
            Next::Gone => '-',
            Next::Refused => '.',
            Next::To(State::Loading) => 'L',
            Next::To(State::Rejected) => 'J',
            Next::To(State::Ready) => 'D',
            Next::To(State::Scheduled) => 'S',
            Next::To(State::Running) => 'R',
            Next::To(State::Cancelling) => 'C',
            Next::To(State::Terminated) => 'T',
        }
    }

    #[test]
    fn every_pair_of_state_and_event_is_decided() {
        for (state, row) in TABLE {
            let got: alloc::string::String = EVENTS.map(|e| letter(state.next(e))).iter().collect();
            assert_eq!(got, row, "{state:?}");
        }
        assert_eq!(TABLE.map(|row| row.0), State::ALL);
    }
}
