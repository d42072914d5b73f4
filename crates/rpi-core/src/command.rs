//! A machine with a life: its state, what it holds, how it has ended.

use crate::continuity::Continuity;
use crate::id::RuleId;
use crate::lifecycle::{Event, Next, State};
use crate::load::LoadFault;
use crate::machine::{Machine, Moment, Verdict};
use crate::overrun::{OnOverrun, Overruns};
use rpi_device::DeviceBank;
use rpi_image::hash::result_id;
use rpi_image::image::{End, EndKind, Image};
use rpi_prims::Fault;

use alloc::boxed::Box;
use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;

/// A loaded command.
pub struct Command {
    /// What it computes.
    pub(crate) machine: Machine,
    pub(crate) state: State,
    /// The actuators that it needs, ascending, and whether it holds them.
    pub(crate) holds: Box<[Hold]>,
    /// For each result whether a successor is scheduled for it that covers what may be moving.
    pub(crate) covered: Box<[bool]>,
    /// The exported Booleans of its latest cycle, by export.
    pub(crate) shown: Box<[Option<bool>]>,
    /// What it is told in the current cycle.
    pub(crate) moment: Moment,
    pub(crate) ending: Option<Ending>,
    pub(crate) continuity: Continuity,
    pub(crate) on_overrun: OnOverrun,
    pub(crate) overruns: Overruns,
    /// The most that it does in a cycle, in elementary operations.
    work: u64,
}

/// An actuator that a command needs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hold {
    pub(crate) resource: u32,
    pub(crate) held: bool,
    /// It comes to it from somebody before, or is somebody else's: noted while it is looked for what is free.
    pub(crate) unfree: bool,
}

/// Why a command has ended.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Cause {
    /// By its named result of this index.
    Result(usize),
    /// By its port `terminate`.
    Terminate,
    /// By a fault in a cycle.
    Fault(Fault),
    /// By force, for this reason.
    Aborted(Why),
    /// By a rule.
    Stopped(RuleId),
}

/// Why a command was ended by force.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Why {
    /// Its owner, or somebody in its name, wanted it.
    Request,
    /// Its cycles took too long.
    Overrun,
    /// Everything was to stop.
    EmergencyStop,
    /// Its owner has disappeared.
    ClientLost,
    /// Another command took over with a jump, which was to stop everything.
    Discontinuity,
}

/// How a command has ended.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Ending {
    /// Why.
    pub cause: Cause,
    /// Its error number, 0 for none: the number of the `fail` in text order from 1, or what `fail` gave. -1 for a fault
    /// or an abort.
    pub error: i64,
    /// Number of its cycles.
    pub cycles: u64,
    /// It had been asked to end.
    pub cancelled: bool,
    /// It left an actuator in motion that no successor took: the device was stopped.
    pub left_moving: bool,
}

impl Ending {
    /// True if it has ended by itself, without an error, and was not cancelled: what is scheduled on it may follow.
    #[must_use]
    pub fn is_regular(&self) -> bool {
        let by_itself = matches!(self.cause, Cause::Result(_) | Cause::Terminate);
        by_itself && self.error == 0 && !self.cancelled
    }
}

impl Command {
    /// Loads an image: verifies it, resolves its devices, allocates everything that it will ever need.
    ///
    /// # Errors
    /// Every reason why it cannot run here.
    pub fn load(
        image: impl Into<Arc<Image>>,
        bank: &mut dyn DeviceBank,
    ) -> Result<Command, Vec<LoadFault>> {
        let machine = Machine::load(image, bank)?;
        let holds = machine
            .held()
            .map(|resource| Hold {
                resource,
                held: false,
                unfree: false,
            })
            .collect();
        let results = match &machine.image().end {
            End::Results(results) => results.len(),
            End::Ports { .. } => 0,
        };
        let exports = machine.image().exports.len();
        Ok(Command {
            work: machine.work(None),
            shown: vec![None; exports].into(),
            machine,
            state: State::Ready,
            holds,
            covered: vec![false; results].into(),
            moment: Moment::default(),
            ending: None,
            continuity: Continuity::default(),
            on_overrun: OnOverrun::default(),
            overruns: Overruns::default(),
        })
    }

    /// The most that it may have to do in a cycle, in elementary operations (a real addition is 1).
    #[must_use]
    pub fn work(&self) -> u64 {
        self.work
    }

    /// Its primitives never do more than this in a cycle, in elementary operations: as a compiler has shown that knows which fragments
    /// exclude one another.
    pub fn bound_work(&mut self, primitives: u64) {
        self.work = self.machine.work(Some(primitives));
    }

    /// Where it is in its life.
    #[must_use]
    pub fn state(&self) -> State {
        self.state
    }

    /// What it computes.
    #[must_use]
    pub fn machine(&self) -> &Machine {
        &self.machine
    }

    /// Sets an input between cycles; false if there is no such input or the value does not fit.
    pub fn set_input(&mut self, index: usize, value: &[u64]) -> bool {
        let net_ns = self.moment.net_ns;
        self.machine.set_input(index, value, net_ns)
    }

    /// How it has ended.
    #[must_use]
    pub fn ending(&self) -> Option<&Ending> {
        self.ending.as_ref()
    }

    /// The name of the result with which it has ended.
    #[must_use]
    pub fn result(&self) -> Option<&str> {
        match (self.ending?.cause, &self.machine.image().end) {
            (Cause::Result(k), End::Results(results)) => results.get(k).map(|r| r.name.as_str()),
            _ => None,
        }
    }

    /// The actuators that it needs, ascending.
    pub fn resources(&self) -> impl Iterator<Item = u32> + '_ {
        self.holds.iter().map(|h| h.resource)
    }

    /// The actuators that it holds now, ascending.
    pub fn held(&self) -> impl Iterator<Item = u32> + '_ {
        self.holds.iter().filter(|h| h.held).map(|h| h.resource)
    }

    /// Identity of its result, as its successor's `predecessor` flow carries it.
    pub(crate) fn result_id(&self) -> Option<i64> {
        // `moves.MoveTo(arm, home) #2` is the command MoveTo of a module, for these arguments: its results are those of
        // MoveTo.
        let called = self.machine.image().name.split(['(', ' ']).next();
        let command = called.and_then(|name| name.rsplit('.').next());
        Some(result_id(command.unwrap_or_default(), self.result()?))
    }

    /// Lets an event happen, if it fits the state.
    pub(crate) fn happen(&mut self, event: Event) -> Next {
        let next = self.state.next(event);
        if let Next::To(state) = next {
            self.state = state;
        }
        next
    }

    pub(crate) fn needs(&self, resource: u32) -> bool {
        self.holds
            .binary_search_by_key(&resource, |h| h.resource)
            .is_ok()
    }

    pub(crate) fn holds(&self, resource: u32) -> bool {
        let found = self.holds.binary_search_by_key(&resource, |h| h.resource);
        found.is_ok_and(|k| self.holds[k].held)
    }

    /// The first actuator that another command holds and this one needs and does not hold.
    pub(crate) fn lacks_of(&self, other: &Command) -> Option<u32> {
        let mut theirs = other.holds.iter().filter(|hold| hold.held).peekable();
        let mut mine = self.holds.iter().filter(|hold| !hold.held);
        mine.find_map(|need| {
            while theirs
                .next_if(|hold| hold.resource < need.resource)
                .is_some()
            {}
            let same = |hold: &&Hold| hold.resource == need.resource;
            theirs
                .peek()
                .copied()
                .filter(same)
                .map(|hold| hold.resource)
        })
    }

    /// Gives up what another command takes.
    pub(crate) fn yield_to(&mut self, needs: &[Hold]) {
        let mut needs = needs.iter().peekable();
        for hold in &mut self.holds {
            while needs
                .next_if(|need| need.resource < hold.resource)
                .is_some()
            {}
            let is_taken = needs
                .peek()
                .is_some_and(|need| need.resource == hold.resource);
            hold.held &= !is_taken;
        }
    }

    /// True if its result of this index is a `yield`.
    pub(crate) fn yields(&self, result: usize) -> bool {
        match &self.machine.image().end {
            End::Results(results) => results
                .get(result)
                .is_some_and(|r| r.kind == EndKind::Yield),
            End::Ports { .. } => false,
        }
    }

    pub(crate) fn hold_all(&mut self, held: bool) {
        self.holds.iter_mut().for_each(|h| h.held = held);
    }

    /// Hands its set-points over. A moving actuator that got none is a fault, unless the command ends here anyway.
    pub(crate) fn hand_over(&mut self, bank: &mut dyn DeviceBank) {
        self.watch_switch();
        if !self.machine.hand_over(bank) && self.ends().is_none() {
            self.machine.lose_control();
        }
    }

    /// How it ends with this cycle, if it does.
    pub(crate) fn ends(&self) -> Option<Ending> {
        let verdict = self.machine.verdict(&self.covered)?;
        let (cause, error) = match verdict {
            Verdict::Result(k) => (Cause::Result(k), self.error_of(k)),
            Verdict::Terminate(error) => (Cause::Terminate, error),
            Verdict::Fault(fault) => (Cause::Fault(fault), -1),
        };
        Some(self.ending_by(cause, error))
    }

    pub(crate) fn ending_by(&self, cause: Cause, error: i64) -> Ending {
        Ending {
            cause,
            error,
            cycles: self.machine.cycle(),
            cancelled: self.state == State::Cancelling,
            left_moving: false,
        }
    }

    /// The number of a `fail` in text order from 1; 0 for other results.
    fn error_of(&self, result: usize) -> i64 {
        let End::Results(results) = &self.machine.image().end else {
            return 0;
        };
        let fails = |r: &&rpi_image::image::EndResult| r.kind == EndKind::Fail;
        match results.get(result).filter(fails) {
            Some(_) => results[..=result].iter().filter(fails).count() as i64,
            None => 0,
        }
    }
}
