//! The life of a command: one table of states and events.
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
//! Everything else is refused and changes nothing.

/// Where a command is in its life.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum State {
    /// Memory and devices are being prepared, off the cycle.
    Loading,
    /// It cannot run here; the reasons are known.
    Rejected,
    /// It can be started or scheduled. It holds nothing.
    Ready,
    /// It waits for a rule to fire, and holds what was free of what it needs.
    Scheduled,
    /// It runs in every cycle that is due.
    Running,
    /// It runs and sees `cancel`.
    Cancelling,
    /// It has ended; result, error and cause are known.
    Terminated,
}

/// What can happen to a command.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum Event {
    /// Loading has succeeded.
    Loaded,
    /// Loading has found faults.
    Faulty,
    /// It is started, and all its resources are free.
    Start,
    /// A rule names it, and its resources are free or come from those who end before.
    Schedule,
    /// Its rule fires.
    Fire,
    /// Nothing can start it any more.
    Orphan {
        /// Its owner wants it back as it is.
        kept: bool,
    },
    /// It is asked to end.
    Cancel,
    /// A result, an abort, a fault, a stop by a rule.
    End,
    /// Its owner lets go of it.
    Unload,
}

/// What an event leads to.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Next {
    /// This state.
    To(State),
    /// The command is no more; it is freed off the cycle.
    Gone,
    /// Nothing: the event does not fit the state.
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

    /// The transition function.
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

    /// True while it takes part in cycles.
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

    /// One row per state, one letter per event in the order above: the first letter of the next state (`C` for
    /// Cancelling, `L` never), `-` for gone, `.` for refused.
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
