//! Bounded queues between host and cycle. No operation blocks.

use std::sync::Arc;

use rpi_core::{
    AbortReason, Command, CommandId, CommandOverrunPolicy, Continuity, MotionControls, Rule, RuleId,
};
use rtrb::{Consumer, Producer, RingBuffer};

use super::admission::Budget;
use super::event::{Event, Ticket};
use super::export_snapshot::ExportSnapshot;
use super::subscription::Subscription;

/// Capacities and policies of a control core.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Options {
    /// Tick length in nanoseconds.
    pub tick_ns: u64,
    /// Maximum number of loaded commands.
    pub commands: usize,
    /// Maximum number of pending requests.
    pub requests: usize,
    /// Maximum number of requests carried out in one tick. The limit keeps a burst of requests from prolonging a tick.
    pub requests_per_tick: usize,
    /// Policy for a takeover in which the first set-points do not continue those of the predecessor.
    pub continuity: Continuity,
    /// Policy for overruns (ticks that end after the next one was due) of commands that are loaded without a policy of
    /// their own.
    pub on_overrun: CommandOverrunPolicy,
    /// Whether the time of each command in a tick is measured. In real time, overruns are attributed to commands by it.
    pub measure_commands: bool,
    /// Time budget of all commands together in a tick; `None` disables admission control.
    pub budget: Option<Budget>,
}

impl Default for Options {
    fn default() -> Self {
        Options {
            tick_ns: 1_000_000,
            commands: 64,
            requests: 256,
            requests_per_tick: 16,
            continuity: Continuity::default(),
            on_overrun: CommandOverrunPolicy::default(),
            measure_commands: false,
            budget: None,
        }
    }
}

impl Options {
    /// Returns the maximum number of rules in the core.
    pub(super) fn rules(&self) -> usize {
        self.commands * 4
    }
}

/// A value for an input of a command.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct InputValue {
    /// Id of the command whose input is set.
    pub command: CommandId,
    /// Index of the input in the image of the command, from 0.
    pub input: usize,
    /// Memory words of the value, as many as the type of the input has.
    pub value: Box<[u64]>,
}

/// Request from the host to the cycle. `T` is the type of a device that can be inserted.
pub enum Request<T> {
    /// Inserts a loaded command under this id, with the snapshot for its exports if there is one.
    Insert(CommandId, Box<Command>, Option<Arc<ExportSnapshot>>),
    /// Starts the loaded command with this id.
    Start(CommandId),
    /// Removes a command from all rules that would start it.
    Unschedule(CommandId),
    /// Cancels a command: its input `cancel` becomes true.
    Cancel(CommandId),
    /// Ends a command at once, for a reason; its devices brake on their own.
    Abort(CommandId, AbortReason),
    /// Removes a command that does not run from the core.
    Unload(CommandId),
    /// Adds a rule, which stops, cancels and starts commands when its condition holds.
    Schedule(RuleId, Box<Rule>),
    /// Removes a rule that has not fired.
    Withdraw(RuleId),
    /// Sets inputs of commands, all of them between the same two cycles.
    Set(Box<[InputValue]>),
    /// Adds a subscription to exported flows of a command.
    Subscribe(Box<Subscription>),
    /// Replaces the device with this index; `None` removes it.
    Device(usize, Option<T>),
    /// Sets the speed override (a factor from 0 to 1) and the pause of all motions.
    SetControls(MotionControls),
    /// Sets these resources (actuators) to their safe values, except those that a command holds.
    MakeSafe(Box<[u32]>),
    /// Aborts all commands, drops all rules and stops all devices.
    EmergencyStop,
}

/// Minimum effort that is counted for a request, in units of about ten nanoseconds. The effort of requests per tick is
/// limited.
const MIN_EFFORT: usize = 256;
/// Additional effort that is counted for a request for each resource that it makes safe, in units of about ten nanoseconds.
const EFFORT_PER_RESOURCE: usize = 64;
/// Additional effort that is counted for a request for each memory word of each rule, in units of about ten
/// nanoseconds.
const EFFORT_PER_RULE_WORD: usize = 8;

impl<T> Request<T> {
    /// Returns the estimated effort to carry out the request, in units of about ten nanoseconds. `rules` is the total
    /// number of memory words of all rules: after most requests the core re-evaluates which rules can still fire.
    pub(super) fn effort(&self, rules: usize) -> usize {
        MIN_EFFORT
            + match self {
                Request::Set(settings) => settings.iter().map(|s| s.value.len() + 1).sum(),
                Request::MakeSafe(resources) => EFFORT_PER_RESOURCE * resources.len(),
                _ => EFFORT_PER_RULE_WORD * rules,
            }
    }
}

/// Object that the cycle no longer uses. The host frees it, because freeing memory in the cycle could block.
pub(super) enum Released<T> {
    Command(CommandId, Box<Command>),
    Rule(Box<Rule>),
    Settings(Box<[InputValue]>),
    Resources(Box<[u32]>),
    Subscription(Box<Subscription>),
    Snapshot(Arc<ExportSnapshot>),
    Device(T),
}

/// Queue ends that the cycle uses: it receives requests, and sends events, samples and released objects.
pub(super) struct CycleQueues<T> {
    pub(super) requests: Consumer<(Ticket, Request<T>)>,
    pub(super) events: Producer<Event>,
    pub(super) samples: Producer<u64>,
    released: Producer<Released<T>>,
    /// Released objects that are sent to the host once all earlier events have been sent.
    staged: Vec<Released<T>>,
}

/// Queue ends that the host uses: it sends requests, and receives events, samples and released objects.
pub(super) struct HostQueues<T> {
    pub(super) requests: Producer<(Ticket, Request<T>)>,
    pub(super) events: Consumer<Event>,
    pub(super) samples: Consumer<u64>,
    pub(super) released: Consumer<Released<T>>,
}

/// Maximum number of objects that one request releases: a command, its subscription and its snapshot.
const MAX_RELEASED_PER_REQUEST: usize = 3;
/// Capacity of the queue of samples (values of exported flows) to the host, in 64-bit words.
const SAMPLE_CAPACITY: usize = 1 << 18;

pub(super) fn queues<T>(options: Options) -> (CycleQueues<T>, HostQueues<T>) {
    let (request_in, requests) = RingBuffer::new(options.requests);
    let (events, event_out) = RingBuffer::new(options.commands * 16 + options.requests);
    let (samples, sample_out) = RingBuffer::new(SAMPLE_CAPACITY);
    // Room for all commands, subscriptions, snapshots and rules released by one tick, and for the objects that one request
    // releases: no request is taken while objects wait to be sent.
    let most = options.commands * 3 + options.rules() + MAX_RELEASED_PER_REQUEST;
    let (released, released_out) = RingBuffer::new(most);
    let cycle = CycleQueues {
        requests,
        events,
        samples,
        released,
        staged: Vec::with_capacity(most),
    };
    let host = HostQueues {
        requests: request_in,
        events: event_out,
        samples: sample_out,
        released: released_out,
    };
    (cycle, host)
}

impl<T> CycleQueues<T> {
    /// Returns true if the queues to the host have room for the answer to a request and for the objects that it
    /// releases.
    pub(super) fn has_room(&self) -> bool {
        self.staged.is_empty() && !self.events.is_full()
    }

    /// Stages an object that the cycle no longer uses, to be sent to the host, which frees it.
    pub(super) fn release(&mut self, released: Released<T>) {
        // The capacity covers all objects that the cycle can own.
        self.staged.push(released);
    }

    /// Sends the staged objects to the host. Must be called after the events about them were sent.
    pub(super) fn send_released(&mut self) {
        while !self.released.is_full() {
            let Some(released) = self.staged.pop() else {
                return;
            };
            let _ = self.released.push(released);
        }
    }
}
