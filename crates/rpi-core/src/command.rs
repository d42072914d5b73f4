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
#[derive(Clone)]
pub struct Command {
    /// Loaded instance of the command's compiled program (image): its memory and its resolved device ports.
    pub(crate) instance: Instance,
    pub(crate) state: CommandState,
    /// Resources that the command needs, in ascending order, each with a flag for whether it is held.
    pub(crate) resource_uses: Box<[ResourceUse]>,
    /// For each named result of the command, by index: true if a successor is scheduled that takes over every moving
    /// actuator when the command ends by this result.
    pub(crate) has_successor: Box<[bool]>,
    /// For each exported flow of the command, by index: its Boolean value in the latest cycle; `None` if the flow is
    /// absent or not a Boolean.
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
    /// True if the command cannot take the resource now, because a predecessor will pass it on or an unrelated command
    /// holds it. Computed anew on each search for free resources.
    pub(crate) is_unavailable: bool,
}

/// Cause of a command's end.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Cause {
    /// The command ended by one of its named results, given by its index in the list of results of the image.
    Result(usize),
    /// The net of the command set its port `terminate` to true. Nets in the format of the reference system end in this
    /// way instead of by named results.
    Terminate,
    /// A fault in a cycle, such as a division by zero: its code and where it occurred.
    Fault(Fault),
    /// The command was aborted: ended from outside, for this reason.
    Aborted(AbortReason),
    /// A rule with this id fired and stopped the command.
    Stopped(RuleId),
}

/// Reason for which a command was ended from outside, by the owner or by the core.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum AbortReason {
    /// The owner of the command, or someone on the owner's behalf, requested the abort.
    Request,
    /// The overruns (cycles that took too long) reached the threshold of an overrun policy.
    Overrun,
    /// All commands were aborted by an emergency stop.
    EmergencyStop,
    /// The connection to the owner was lost.
    ClientLost,
    /// The command had not ended within the grace time after a cancel request.
    CancelTimeout,
    /// Another command with the policy [`Continuity::AbortAll`] started with set-points that jump from those of its
    /// predecessor; this policy aborts all commands.
    Discontinuity,
}

/// Record of the end of a command: cause, error number and circumstances.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Ending {
    /// Cause of the end of the command: a result, a fault, an abort or the emergency stop.
    pub cause: Cause,
    /// Error number, 0 for none. For an end by a `fail` result: its position among the `fail` results in text order,
    /// counted from 1. For an end by the port `terminate`: the value of the port `fail`. For faults and aborts: -1.
    pub error: i64,
    /// Number of cycles that the command ran.
    pub cycles: u64,
    /// True if a cancel was requested before the command ended.
    pub cancelled: bool,
    /// True if an actuator was still moving and no successor took it over, so that its device was stopped.
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

    /// Returns the present lifecycle state of the command.
    #[must_use]
    pub fn state(&self) -> CommandState {
        self.state
    }

    /// Returns the loaded instance of the command's compiled program (image), to read its flows.
    #[must_use]
    pub fn instance(&self) -> &Instance {
        &self.instance
    }

    /// Sets the input with index `index` in the image's list of inputs, between two cycles. `value` holds its 64-bit
    /// slots. Returns false if the index is out of range or the number of slots is wrong.
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

    /// Returns the numbers of the resources (actuators) that the command needs, in ascending order.
    pub fn resources(&self) -> impl Iterator<Item = u32> + '_ {
        self.resource_uses.iter().map(|h| h.resource)
    }

    /// Returns the numbers of the resources (actuators) that the command holds now, in ascending order.
    pub fn held(&self) -> impl Iterator<Item = u32> + '_ {
        self.resource_uses
            .iter()
            .filter(|h| h.is_held)
            .map(|h| h.resource)
    }

    /// Returns a hash of the command's name and its result, which a successor reads as its flow `predecessor`; `None`
    /// if the command has not ended by a named result.
    pub(crate) fn result_id(&self) -> Option<i64> {
        // The image name `moves.MoveTo(arm, home) #2` denotes the command MoveTo of a module with these arguments.
        // Results are identified by the bare name MoveTo.
        let called = self.instance.image().name.split(['(', ' ']).next();
        let command = called.and_then(|name| name.rsplit('.').next());
        Some(result_id(command.unwrap_or_default(), self.result()?))
    }

    /// Applies a lifecycle event and returns its effect. An event that is not allowed in the present state changes
    /// nothing.
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

    /// Returns the first resource (actuator) that this command needs but does not hold, and that `other` holds; `None`
    /// if there is none.
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

    /// Releases those of the command's resources that are also in `needs`, the list of another command that takes them.
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

    /// True if the result with index `result` is a `yield`: it ends the command only if a successor takes over its
    /// moving actuators.
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

    /// Sends the set-points of this cycle to the devices. A moving actuator without a set-point is a fault, unless the
    /// command ends in this cycle.
    pub(crate) fn hand_over(&mut self, bank: &mut dyn DeviceBank) {
        self.check_continuity();
        if !self.instance.hand_over(bank) && self.ending_now().is_none() {
            self.instance.fail_uncontrolled();
        }
    }

    /// Returns the end of the command if it ends in this cycle, else `None`.
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

    /// Returns the error number of the result with index `result`. A `fail` has its position among the `fail` results
    /// in text order, counted from 1; other results have 0.
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
