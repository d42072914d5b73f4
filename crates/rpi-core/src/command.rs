//! Commands: a loaded image with its lifecycle state, its resources and the way it ended.

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

/// A loaded command: a running image, its lifecycle state and the resources that it needs and holds.
pub struct Command {
    /// The running image.
    pub(crate) machine: Machine,
    pub(crate) state: State,
    /// Resources that the command needs, in ascending order, each with a flag for whether it is held.
    pub(crate) holds: Box<[Hold]>,
    /// For each result, whether a successor is scheduled that takes over every moving actuator.
    pub(crate) covered: Box<[bool]>,
    /// For each export, its Boolean value in the latest cycle; `None` if absent or not a Boolean.
    pub(crate) shown: Box<[Option<bool>]>,
    /// Inputs from the core for the current cycle: times, `cancel`, `takeover`, `predecessor`.
    pub(crate) moment: Moment,
    pub(crate) ending: Option<Ending>,
    pub(crate) continuity: Continuity,
    pub(crate) on_overrun: OnOverrun,
    pub(crate) overruns: Overruns,
    /// Upper bound of the work per cycle, in elementary operations (a real addition is 1).
    work: u64,
}

/// A resource (actuator) that a command needs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hold {
    pub(crate) resource: u32,
    pub(crate) held: bool,
    /// The resource comes from a predecessor or is held by an unrelated command, so it cannot be taken now. Recomputed
    /// on each search for free resources.
    pub(crate) unfree: bool,
}

/// Cause of a command's end.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Cause {
    /// The named result with this index.
    Result(usize),
    /// The port `terminate`.
    Terminate,
    /// A fault in a cycle.
    Fault(Fault),
    /// An abort, with its reason.
    Aborted(Why),
    /// A stop by a rule.
    Stopped(RuleId),
}

/// Reason for an abort.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Why {
    /// A request by the owner or on the owner's behalf.
    Request,
    /// Cycles exceeded their time limit.
    Overrun,
    /// An emergency stop of all commands.
    EmergencyStop,
    /// The connection to the owner was lost.
    ClientLost,
    /// A discontinuous takeover by another command with [`Continuity::Stop`].
    Discontinuity,
}

/// The end of a command: cause, error number and circumstances.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Ending {
    /// Cause of the end.
    pub cause: Cause,
    /// Error number, 0 for none. It is the position of the `fail` in text order, counted from 1, or the value of the
    /// port `fail`. Faults and aborts have -1.
    pub error: i64,
    /// Number of cycles that the command ran.
    pub cycles: u64,
    /// The command was cancelled before it ended.
    pub cancelled: bool,
    /// An actuator was still moving and no successor took it over, so its device was stopped.
    pub left_moving: bool,
}

impl Ending {
    /// True for an end by a result or by `terminate`, without an error and without a cancel. Successors scheduled by
    /// [`crate::Rule::follow`] start only after such an end.
    #[must_use]
    pub fn is_regular(&self) -> bool {
        let by_itself = matches!(self.cause, Cause::Result(_) | Cause::Terminate);
        by_itself && self.error == 0 && !self.cancelled
    }
}

impl Command {
    /// Loads an image: verifies it, resolves its devices and allocates all memory that the command will need.
    ///
    /// # Errors
    /// Returns every reason why the image cannot run in this cell.
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

    /// Upper bound of the work per cycle, in elementary operations (a real addition is 1).
    #[must_use]
    pub fn work(&self) -> u64 {
        self.work
    }

    /// Tightens the bound of [`Command::work`]: the primitives do at most `primitives` elementary operations per cycle.
    /// The compiler proves this bound from its knowledge of mutually exclusive fragments.
    pub fn bound_work(&mut self, primitives: u64) {
        self.work = self.machine.work(Some(primitives));
    }

    /// Current lifecycle state.
    #[must_use]
    pub fn state(&self) -> State {
        self.state
    }

    /// The running image.
    #[must_use]
    pub fn machine(&self) -> &Machine {
        &self.machine
    }

    /// Sets an input between two cycles. Returns false if the index is out of range or the value has the wrong size.
    pub fn set_input(&mut self, index: usize, value: &[u64]) -> bool {
        let net_ns = self.moment.net_ns;
        self.machine.set_input(index, value, net_ns)
    }

    /// Cause, error number and circumstances of the end; `None` while the command has not ended.
    #[must_use]
    pub fn ending(&self) -> Option<&Ending> {
        self.ending.as_ref()
    }

    /// Name of the result with which the command ended; `None` if it did not end by a result.
    #[must_use]
    pub fn result(&self) -> Option<&str> {
        match (self.ending?.cause, &self.machine.image().end) {
            (Cause::Result(k), End::Results(results)) => results.get(k).map(|r| r.name.as_str()),
            _ => None,
        }
    }

    /// Resources that the command needs, in ascending order.
    pub fn resources(&self) -> impl Iterator<Item = u32> + '_ {
        self.holds.iter().map(|h| h.resource)
    }

    /// Resources that the command holds now, in ascending order.
    pub fn held(&self) -> impl Iterator<Item = u32> + '_ {
        self.holds.iter().filter(|h| h.held).map(|h| h.resource)
    }

    /// Hash of the command's name and its result, as carried by the `predecessor` flow of a successor.
    pub(crate) fn result_id(&self) -> Option<i64> {
        // The image name `moves.MoveTo(arm, home) #2` denotes the command MoveTo of a module with these arguments.
        // Results are identified by the bare name MoveTo.
        let called = self.machine.image().name.split(['(', ' ']).next();
        let command = called.and_then(|name| name.rsplit('.').next());
        Some(result_id(command.unwrap_or_default(), self.result()?))
    }

    /// Applies a lifecycle event; the state does not change if the event is not allowed in it.
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

    /// First resource that this command lacks and `other` holds.
    pub(crate) fn lacks_of(&self, other: &Command) -> Option<u32> {
        // Both lists are sorted by resource, so one merge pass finds the first common one in linear time.
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

    /// Releases the resources in `needs`, which another command takes.
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

    /// True if the result with this index is a `yield`.
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

    /// Sends the staged set-points to the devices. A moving actuator without a set-point is a fault, unless the command
    /// ends in this cycle.
    pub(crate) fn hand_over(&mut self, bank: &mut dyn DeviceBank) {
        self.watch_switch();
        if !self.machine.hand_over(bank) && self.ends().is_none() {
            self.machine.lose_control();
        }
    }

    /// The end of the command if it ends in this cycle.
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

    /// Error number of a result: the position of a `fail` in text order, counted from 1; 0 for other results.
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
