//! The queues between host and cycle: bounded, and nobody ever waits at them.

use std::sync::Arc;

use rpi_core::{Command, CommandId, Continuity, OnOverrun, Rule, RuleId, Why};
use rtrb::{Consumer, Producer, RingBuffer};

use super::admission::Budget;
use super::board::Board;
use super::event::{Event, Ticket};
use super::subscription::Subscription;

/// How large a control core is.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Options {
    /// Length of a tick, nanoseconds.
    pub tick_ns: u64,
    /// Commands that can be there at once.
    pub commands: usize,
    /// Requests that can be under way at once.
    pub requests: usize,
    /// Requests that are carried out in one tick at most, so that no flood of them makes a tick long.
    pub requests_per_tick: usize,
    /// What happens if a command takes over with a jump.
    pub continuity: Continuity,
    /// What becomes of a command whose cycles take too long.
    pub on_overrun: OnOverrun,
    /// Whether it is measured who takes the longest in a tick: where time is real.
    pub timed: bool,
    /// What all commands of a tick may take together, where somebody sees to that.
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
            on_overrun: OnOverrun::default(),
            timed: false,
            budget: None,
        }
    }
}

impl Options {
    /// Rules that can be there at once.
    pub(super) fn rules(&self) -> usize {
        self.commands * 4
    }
}

/// A value for an input of a command.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Setting {
    /// The command.
    pub command: CommandId,
    /// The input's index in its image.
    pub input: usize,
    /// The value's cells.
    pub value: Box<[u64]>,
}

/// What the host asks of the cycle.
pub(crate) enum Request<T> {
    Insert(CommandId, Box<Command>, Option<Arc<Board>>),
    Start(CommandId),
    Unschedule(CommandId),
    Cancel(CommandId),
    Abort(CommandId, Why),
    Unload(CommandId),
    Schedule(RuleId, Box<Rule>),
    Withdraw(RuleId),
    Set(Box<[Setting]>),
    Subscribe(Box<Subscription>),
    Device(usize, Option<T>),
    EmergencyStop,
}

/// What the least of requests takes.
const LEAST: usize = 256;
/// What each word of each rule adds to it.
const PER_WORD: usize = 8;

impl<T> Request<T> {
    /// About how much it takes to carry it out, where there is so much to look at in all rules: after most of them the core finds
    /// out anew which rules may still fire.
    pub(super) fn effort(&self, rules: usize) -> usize {
        LEAST
            + match self {
                Request::Set(settings) => settings.iter().map(|s| s.value.len() + 1).sum(),
                _ => PER_WORD * rules,
            }
    }
}

/// What is over and must be freed by the host.
pub(crate) enum Dead<T> {
    Command(CommandId, Box<Command>),
    Rule(Box<Rule>),
    Settings(Box<[Setting]>),
    Subscription(Box<Subscription>),
    Board(Arc<Board>),
    Device(T),
}

/// The cycle's ends.
pub(super) struct CycleEnds<T> {
    pub(super) requests: Consumer<(Ticket, Request<T>)>,
    pub(super) events: Producer<Event>,
    pub(super) samples: Producer<u64>,
    dead: Producer<Dead<T>>,
    /// What goes there once all that happened before has been told.
    staged: Vec<Dead<T>>,
}

/// The host's ends.
pub(crate) struct HostEnds<T> {
    pub(crate) requests: Producer<(Ticket, Request<T>)>,
    pub(crate) events: Consumer<Event>,
    pub(crate) samples: Consumer<u64>,
    pub(crate) dead: Consumer<Dead<T>>,
}

/// What a request can leave over at once: a command with what was to look at it.
const LEFT_OVER: usize = 3;
/// Words of samples between two visits of the host.
const SAMPLES: usize = 1 << 18;

pub(super) fn queues<T>(options: Options) -> (CycleEnds<T>, HostEnds<T>) {
    let (request_in, requests) = RingBuffer::new(options.requests);
    let (events, event_out) = RingBuffer::new(options.commands * 16 + options.requests);
    let (samples, sample_out) = RingBuffer::new(SAMPLES);
    // Room for commands, subscriptions, boards and rules, all ended by one tick, and for what one request leaves over: no
    // request is taken while anything still waits to be sent.
    let most = options.commands * 3 + options.rules() + LEFT_OVER;
    let (dead, dead_out) = RingBuffer::new(most);
    let cycle = CycleEnds {
        requests,
        events,
        samples,
        dead,
        staged: Vec::with_capacity(most),
    };
    let host = HostEnds {
        requests: request_in,
        events: event_out,
        samples: sample_out,
        dead: dead_out,
    };
    (cycle, host)
}

impl<T> CycleEnds<T> {
    /// Whether there is room for the answer to a request and what it leaves over.
    pub(super) fn have_room(&self) -> bool {
        self.staged.is_empty() && !self.events.is_full()
    }

    /// Gives something away, to be freed by the host.
    pub(super) fn bury(&mut self, dead: Dead<T>) {
        // There is room for all that can be with the cycle.
        self.staged.push(dead);
    }

    /// Sends what was given away, after the events that tell why.
    pub(super) fn send_dead(&mut self) {
        while !self.dead.is_full() {
            let Some(dead) = self.staged.pop() else {
                return;
            };
            let _ = self.dead.push(dead);
        }
    }
}
