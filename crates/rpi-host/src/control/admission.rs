//! Which commands may run together: what they take at most must fit the share of a tick that is theirs.
//!
//! Two commands that need one actuator never run in one tick. So the commands that run or may yet are put into groups by the first
//! actuator that they need: such a group takes no more than the most expensive of it, and who needs no actuator forms a group
//! alone. The sum over all groups is a bound, whatever rules make of it. All of this is done beside the cycle, before a request leaves.

use std::collections::BTreeMap;
use std::fmt;

use rpi_core::{Command, CommandId, Notice};

use super::event::{Event, Ticket};

/// What commands may take of a tick.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Budget {
    /// Time of an elementary operation at worst, nanoseconds.
    pub ns_per_operation: f64,
    /// What all commands of a tick may take together, nanoseconds.
    pub granted_ns: u64,
}

/// More than commands may take of a tick.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct TooMuch {
    /// What those that are to start may take at most, nanoseconds.
    pub needed_ns: u64,
    /// What those that may run with them take at most, nanoseconds.
    pub taken_ns: u64,
    /// What all may take together, nanoseconds.
    pub granted_ns: u64,
}

impl fmt::Display for TooMuch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [needed, taken, granted] =
            [self.needed_ns, self.taken_ns, self.granted_ns].map(|ns| ns as f64 / 1e3);
        write!(f, "it may take {needed:.1} us of a tick")?;
        if self.taken_ns > 0 {
            write!(f, ", and what may run with it {taken:.1} us")?;
        }
        write!(f, ": commands are granted {granted:.1} us of it")
    }
}

/// What is known of a command.
#[derive(Clone, Copy, Debug)]
struct Claim {
    bound_ns: u64,
    /// The first actuator that it needs.
    actuator: Option<u32>,
    /// It runs or is scheduled, as was last heard.
    is_live: bool,
    /// Requests under way that may start it.
    asked: u32,
}

/// The books.
pub(super) struct Admission {
    budget: Option<Budget>,
    claims: BTreeMap<CommandId, Claim>,
    asked: BTreeMap<Ticket, Box<[CommandId]>>,
}

impl Admission {
    pub(super) fn new(budget: Option<Budget>) -> Admission {
        Admission {
            budget,
            claims: BTreeMap::new(),
            asked: BTreeMap::new(),
        }
    }

    /// What a command that was taken in may take of a tick, nanoseconds.
    pub(super) fn bound_ns(&self, id: CommandId) -> u64 {
        self.claims.get(&id).map_or(0, |claim| claim.bound_ns)
    }

    fn bound_of(&self, command: &Command) -> u64 {
        let each = self.budget.map_or(0.0, |b| b.ns_per_operation);
        (command.work() as f64 * each) as u64
    }

    /// Fails if a command could never start, even alone.
    pub(super) fn fits(&self, command: &Command) -> Result<(), TooMuch> {
        let needed_ns = self.bound_of(command);
        match self.budget {
            Some(Budget { granted_ns, .. }) if needed_ns > granted_ns => Err(TooMuch {
                needed_ns,
                taken_ns: 0,
                granted_ns,
            }),
            _ => Ok(()),
        }
    }

    /// A command is taken in.
    pub(super) fn enter(&mut self, id: CommandId, command: &Command) {
        let claim = Claim {
            bound_ns: self.bound_of(command),
            actuator: command.resources().next(),
            is_live: false,
            asked: 0,
        };
        self.claims.insert(id, claim);
    }

    /// Fails if these could not run with all that runs or may yet.
    pub(super) fn admit(&self, start: &[CommandId]) -> Result<(), TooMuch> {
        let Some(Budget { granted_ns, .. }) = self.budget else {
            return Ok(());
        };
        let counts = |claim: &Claim| claim.is_live || claim.asked > 0;
        let is_new = |id: &CommandId| self.claims.get(id).is_some_and(|c| !counts(c));
        if !start.iter().any(is_new) {
            return Ok(());
        }
        let before = self.claims.values().filter(|c| counts(c));
        let taken_ns = together(before);
        let all = self.claims.iter();
        let all = all.filter(|(id, claim)| counts(claim) || start.contains(id));
        let total_ns = together(all.map(|(_, claim)| claim));
        match total_ns > granted_ns {
            true => Err(TooMuch {
                needed_ns: together(start.iter().filter_map(|id| self.claims.get(id))),
                taken_ns,
                granted_ns,
            }),
            false => Ok(()),
        }
    }

    /// A request that may start these is under way.
    pub(super) fn ask(&mut self, ticket: Ticket, start: &[CommandId]) {
        for id in start {
            if let Some(claim) = self.claims.get_mut(id) {
                claim.asked += 1;
            }
        }
        self.asked.insert(ticket, start.into());
    }

    /// Something has happened.
    pub(super) fn hear(&mut self, event: &Event) {
        match event {
            Event::Answer {
                ticket, refused, ..
            } => self.answered(*ticket, refused.is_none()),
            Event::Notice(notice) => self.note(notice),
            Event::Freed(_) | Event::Device { .. } => {}
        }
    }

    /// A command is no more.
    pub(super) fn forget(&mut self, id: CommandId) {
        self.claims.remove(&id);
    }

    fn answered(&mut self, ticket: Ticket, accepted: bool) {
        for id in self.asked.remove(&ticket).unwrap_or_default() {
            if let Some(claim) = self.claims.get_mut(&id) {
                claim.asked = claim.asked.saturating_sub(1);
                claim.is_live |= accepted;
            }
        }
    }

    fn note(&mut self, notice: &Notice) {
        let (id, is_live) = match *notice {
            Notice::Scheduled { command }
            | Notice::Started { command, .. }
            | Notice::Cancelling { command } => (command, true),
            Notice::Ended { command, .. } | Notice::Orphaned { command, .. } => (command, false),
            Notice::Braked { .. } | Notice::Jumped { .. } | Notice::Rule { .. } => return,
        };
        if let Some(claim) = self.claims.get_mut(&id) {
            claim.is_live = is_live;
        }
    }
}

/// What these take at most in one tick: of those that need an actuator in common only one runs.
fn together<'a>(claims: impl Iterator<Item = &'a Claim>) -> u64 {
    let mut most: BTreeMap<u32, u64> = BTreeMap::new();
    let mut alone = 0_u64;
    for claim in claims {
        match claim.actuator {
            Some(actuator) => {
                let most = most.entry(actuator).or_default();
                *most = claim.bound_ns.max(*most);
            }
            None => alone = alone.saturating_add(claim.bound_ns),
        }
    }
    most.values().fold(alone, |sum, ns| sum.saturating_add(*ns))
}

#[cfg(test)]
mod tests {
    use rpi_core::Refused;

    use super::*;

    const GRANTED: u64 = 100;

    fn id(number: u64) -> CommandId {
        CommandId::from_number(number)
    }

    /// Commands 1, 2, ... with these bounds and first actuators.
    fn books(claims: &[(u64, Option<u32>)]) -> Admission {
        let mut books = Admission::new(Some(Budget {
            ns_per_operation: 1.0,
            granted_ns: GRANTED,
        }));
        for (number, (bound_ns, actuator)) in (1..).zip(claims) {
            let claim = Claim {
                bound_ns: *bound_ns,
                actuator: *actuator,
                is_live: false,
                asked: 0,
            };
            books.claims.insert(id(number), claim);
        }
        books
    }

    fn ask(books: &mut Admission, ticket: u64, start: u64) -> Result<(), TooMuch> {
        books.admit(&[id(start)])?;
        books.ask(Ticket(ticket), &[id(start)]);
        Ok(())
    }

    fn answer(ticket: u64, refused: Option<Refused>) -> Event {
        Event::Answer {
            ticket: Ticket(ticket),
            tick: 0,
            refused,
        }
    }

    #[test]
    fn those_of_one_actuator_take_turns_and_others_add_up() {
        let mut books = books(&[(60, Some(0)), (70, Some(0)), (30, None), (40, Some(7))]);
        for (ticket, start) in [(1, 1), (2, 2), (3, 3)] {
            assert_eq!(ask(&mut books, ticket, start), Ok(()));
        }
        let why = ask(&mut books, 4, 4).unwrap_err();
        assert_eq!(
            (why.needed_ns, why.taken_ns, why.granted_ns),
            (40, 100, 100)
        );
    }

    #[test]
    fn what_was_refused_or_is_over_makes_room() {
        let mut books = books(&[(60, None), (60, None)]);
        ask(&mut books, 1, 1).unwrap();
        assert!(ask(&mut books, 2, 2).is_err(), "the first is on its way");
        books.hear(&answer(1, Some(Refused::Unknown)));
        ask(&mut books, 3, 2).unwrap();
        books.hear(&answer(3, None));
        assert!(ask(&mut books, 4, 1).is_err(), "the second runs");
        let over = Notice::Orphaned {
            command: id(2),
            kept: true,
        };
        books.hear(&Event::Notice(over));
        assert_eq!(ask(&mut books, 5, 1), Ok(()));
    }

    #[test]
    fn who_counts_already_is_not_refused() {
        let mut books = books(&[(90, None)]);
        ask(&mut books, 1, 1).unwrap();
        books.budget = Some(Budget {
            ns_per_operation: 1.0,
            granted_ns: 10,
        });
        assert_eq!(ask(&mut books, 2, 1), Ok(()));
    }
}
