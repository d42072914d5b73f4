//! Commands: a loaded image with its lifecycle state, its resources and the way it ended.

use crate::continuity::Continuity;
use crate::cycle_context::CycleContext;
use crate::ids::RuleId;
use crate::instance::{Instance, Verdict};
use crate::lifecycle::{CommandEvent, CommandState, Transition};
use crate::load::LoadError;
use crate::overrun::{CommandOverrunPolicy, OverrunStats};
use rpi_device::DeviceBank;
use rpi_image::hash::result_id;
use rpi_image::image::{CommandEnd, CommandEndKind, Image};
use rpi_prims::Fault;

use alloc::boxed::Box;
use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;

/// A loaded command: a running image, its lifecycle state and the resources that it needs and holds.
pub struct Command {
    /// Instance of the command's image: its memory and its resolved ports.
    pub(crate) instance: Instance,
    pub(crate) state: CommandState,
    /// Resources that the command needs, in ascending order, each with a flag for whether it is held.
    pub(crate) resource_uses: Box<[ResourceUse]>,
    /// For each result, whether a successor is scheduled that takes over every moving actuator.
    pub(crate) has_successor: Box<[bool]>,
    /// For each export, its Boolean value in the latest cycle; `None` if absent or not a Boolean.
    pub(crate) exported_values: Box<[Option<bool>]>,
    /// Inputs from the core for the current cycle: times, `cancel`, `takeover`, `predecessor`.
    pub(crate) context: CycleContext,
    pub(crate) ending: Option<Ending>,
    pub(crate) continuity: Continuity,
    pub(crate) overrun_policy: CommandOverrunPolicy,
    pub(crate) overruns: OverrunStats,
    /// Upper bound of the work per cycle, in elementary operations (a real addition is 1).
    work: u64,
}

/// A resource (actuator) that a command needs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ResourceUse {
    pub(crate) resource: u32,
    pub(crate) is_held: bool,
    /// The resource comes from a predecessor or is held by an unrelated command, so it cannot be taken now. Recomputed
    /// on each search for free resources.
    pub(crate) is_unavailable: bool,
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
    /// Abort: the command was ended from outside, for this reason.
    Aborted(AbortReason),
    /// The stop set of this rule contained the command.
    Stopped(RuleId),
}

/// Why a command was ended from outside, by the owner or by the core.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum AbortReason {
    /// A request by the owner or on the owner's behalf.
    Request,
    /// Cycles exceeded their time limit.
    Overrun,
    /// An emergency stop of all commands.
    EmergencyStop,
    /// The connection to the owner was lost.
    ClientLost,
    /// The command had not ended within the grace time after a cancel request.
    CancelTimeout,
    /// A discontinuous takeover by another command with [`Continuity::AbortAll`].
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
    ) -> Result<Command, Vec<LoadError>> {
        let machine = Instance::load(image, bank)?;
        let holds = machine
            .resources()
            .map(|resource| ResourceUse {
                resource,
                is_held: false,
                is_unavailable: false,
            })
            .collect();
        let results = match &machine.image().end {
            CommandEnd::Results(results) => results.len(),
            CommandEnd::Ports { .. } => 0,
        };
        let exports = machine.image().exports.len();
        Ok(Command {
            work: machine.work(None),
            exported_values: vec![None; exports].into(),
            instance: machine,
            state: CommandState::Ready,
            resource_uses: holds,
            has_successor: vec![false; results].into(),
            context: CycleContext::default(),
            ending: None,
            continuity: Continuity::default(),
            overrun_policy: CommandOverrunPolicy::default(),
            overruns: OverrunStats::default(),
        })
    }

    /// Upper bound of the work per cycle, in elementary operations (a real addition is 1).
    #[must_use]
    pub fn work(&self) -> u64 {
        self.work
    }

    /// Tightens the bound of [`Command::work`]: the primitives do at most `primitives` elementary operations per cycle.
    /// The compiler proves this bound from its knowledge of mutually exclusive fragments.
    pub fn set_work_bound(&mut self, primitives: u64) {
        self.work = self.instance.work(Some(primitives));
    }

    /// Current lifecycle state.
    #[must_use]
    pub fn state(&self) -> CommandState {
        self.state
    }

    /// The instance of the command's image.
    #[must_use]
    pub fn instance(&self) -> &Instance {
        &self.instance
    }

    /// Sets an input between two cycles. Returns false if the index is out of range or the value has the wrong size.
    pub fn set_input(&mut self, index: usize, value: &[u64]) -> bool {
        let net_ns = self.context.net_ns;
        self.instance.set_input(index, value, net_ns)
    }

    /// Cause, error number and circumstances of the end; `None` while the command has not ended.
    #[must_use]
    pub fn ending(&self) -> Option<&Ending> {
        self.ending.as_ref()
    }

    /// Name of the result with which the command ended; `None` if it did not end by a result.
    #[must_use]
    pub fn result(&self) -> Option<&str> {
        match (self.ending?.cause, &self.instance.image().end) {
            (Cause::Result(k), CommandEnd::Results(results)) => {
                results.get(k).map(|r| r.name.as_str())
            }
            _ => None,
        }
    }

    /// Resources that the command needs, in ascending order.
    pub fn resources(&self) -> impl Iterator<Item = u32> + '_ {
        self.resource_uses.iter().map(|h| h.resource)
    }

    /// Resources that the command holds now, in ascending order.
    pub fn held(&self) -> impl Iterator<Item = u32> + '_ {
        self.resource_uses
            .iter()
            .filter(|h| h.is_held)
            .map(|h| h.resource)
    }

    /// Hash of the command's name and its result, as carried by the `predecessor` flow of a successor.
    pub(crate) fn result_id(&self) -> Option<i64> {
        // The image name `moves.MoveTo(arm, home) #2` denotes the command MoveTo of a module with these arguments.
        // Results are identified by the bare name MoveTo.
        let called = self.instance.image().name.split(['(', ' ']).next();
        let command = called.and_then(|name| name.rsplit('.').next());
        Some(result_id(command.unwrap_or_default(), self.result()?))
    }

    /// Applies a lifecycle event; the state does not change if the event is not allowed in it.
    pub(crate) fn apply_event(&mut self, event: CommandEvent) -> Transition {
        let next = self.state.next(event);
        if let Transition::To(state) = next {
            self.state = state;
        }
        next
    }

    pub(crate) fn needs(&self, resource: u32) -> bool {
        self.resource_uses
            .binary_search_by_key(&resource, |h| h.resource)
            .is_ok()
    }

    pub(crate) fn holds(&self, resource: u32) -> bool {
        let found = self
            .resource_uses
            .binary_search_by_key(&resource, |h| h.resource);
        found.is_ok_and(|k| self.resource_uses[k].is_held)
    }

    /// First resource (actuator) that this command needs but does not hold, and that `other` holds.
    pub(crate) fn first_conflict(&self, other: &Command) -> Option<u32> {
        // Both lists are sorted by resource, so one merge pass finds the first common one in linear time.
        let mut theirs = other
            .resource_uses
            .iter()
            .filter(|hold| hold.is_held)
            .peekable();
        let mut mine = self.resource_uses.iter().filter(|hold| !hold.is_held);
        mine.find_map(|need| {
            while theirs
                .next_if(|hold| hold.resource < need.resource)
                .is_some()
            {}
            let same = |hold: &&ResourceUse| hold.resource == need.resource;
            theirs
                .peek()
                .copied()
                .filter(same)
                .map(|hold| hold.resource)
        })
    }

    /// Releases those of the command's resources that are in `needs`, the list of another command that takes them.
    pub(crate) fn release_to(&mut self, needs: &[ResourceUse]) {
        let mut needs = needs.iter().peekable();
        for hold in &mut self.resource_uses {
            while needs
                .next_if(|need| need.resource < hold.resource)
                .is_some()
            {}
            let is_taken = needs
                .peek()
                .is_some_and(|need| need.resource == hold.resource);
            hold.is_held &= !is_taken;
        }
    }

    /// True if the result with this index is a `yield`.
    pub(crate) fn yields(&self, result: usize) -> bool {
        match &self.instance.image().end {
            CommandEnd::Results(results) => results
                .get(result)
                .is_some_and(|r| r.kind == CommandEndKind::Yield),
            CommandEnd::Ports { .. } => false,
        }
    }

    pub(crate) fn set_all_held(&mut self, held: bool) {
        self.resource_uses.iter_mut().for_each(|h| h.is_held = held);
    }

    /// Sends the staged set-points to the devices. A moving actuator without a set-point is a fault, unless the command
    /// ends in this cycle.
    pub(crate) fn hand_over(&mut self, bank: &mut dyn DeviceBank) {
        self.check_continuity();
        if !self.instance.hand_over(bank) && self.ending_now().is_none() {
            self.instance.fail_uncontrolled();
        }
    }

    /// The end of the command if it ends in this cycle.
    pub(crate) fn ending_now(&self) -> Option<Ending> {
        let verdict = self.instance.verdict(&self.has_successor)?;
        let (cause, error) = match verdict {
            Verdict::Result(k) => (Cause::Result(k), self.error_number(k)),
            Verdict::Terminate(error) => (Cause::Terminate, error),
            Verdict::Fault(fault) => (Cause::Fault(fault), -1),
        };
        Some(self.make_ending(cause, error))
    }

    pub(crate) fn make_ending(&self, cause: Cause, error: i64) -> Ending {
        Ending {
            cause,
            error,
            cycles: self.instance.cycle(),
            cancelled: self.state == CommandState::Cancelling,
            left_moving: false,
        }
    }

    /// Error number of a result: the position of a `fail` in text order, counted from 1; 0 for other results.
    fn error_number(&self, result: usize) -> i64 {
        let CommandEnd::Results(results) = &self.instance.image().end else {
            return 0;
        };
        let fails = |r: &&rpi_image::image::NamedResult| r.kind == CommandEndKind::Fail;
        match results.get(result).filter(fails) {
            Some(_) => results[..=result].iter().filter(fails).count() as i64,
            None => 0,
        }
    }
}
