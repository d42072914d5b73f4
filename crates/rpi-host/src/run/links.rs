//! The queues between the two sides: bounded, and nobody ever waits at them.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use rpi_core::{Command, Ending, Refused};
use rtrb::{Consumer, Producer, RingBuffer};

/// A command that is loaded and waits for its turn.
pub(super) struct Ready {
    /// Its number in the run, from 0.
    pub(super) serial: u64,
    pub(super) command: Box<Command>,
}

/// What happens to a command.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) enum Event {
    /// Its first cycle is this tick.
    Started { serial: u64, tick: u64 },
    /// It has ended with the cycle of this tick.
    Ended {
        serial: u64,
        tick: u64,
        ending: Ending,
    },
    /// It could not be started or scheduled.
    Refused { serial: u64, why: Refused },
}

/// Commands loaded ahead.
const AHEAD: usize = 2;
const EVENTS: usize = 1024;

/// The cycle's ends.
pub(super) struct CycleEnds {
    pub(super) ready: Consumer<Ready>,
    events: Producer<Event>,
    dead: Producer<Box<Command>>,
    all_loaded: Arc<AtomicBool>,
}

/// The host's ends.
pub(super) struct HostEnds {
    pub(super) ready: Producer<Ready>,
    pub(super) events: Consumer<Event>,
    pub(super) dead: Consumer<Box<Command>>,
    all_loaded: Arc<AtomicBool>,
}

pub(super) fn links() -> (CycleEnds, HostEnds) {
    let (ready_in, ready) = RingBuffer::new(AHEAD);
    let (events, events_out) = RingBuffer::new(EVENTS);
    let (dead, dead_out) = RingBuffer::new(EVENTS);
    let all_loaded = Arc::new(AtomicBool::new(false));
    let cycle = CycleEnds {
        ready,
        events,
        dead,
        all_loaded: Arc::clone(&all_loaded),
    };
    let host = HostEnds {
        ready: ready_in,
        events: events_out,
        dead: dead_out,
        all_loaded,
    };
    (cycle, host)
}

impl CycleEnds {
    /// Tells the host; an event for which there is no room is lost, as the cycle never waits.
    pub(super) fn tell(&mut self, event: Event) {
        let _ = self.events.push(event);
    }

    /// Gives a command away, to be freed by the host.
    pub(super) fn bury(&mut self, command: Box<Command>) {
        if let Err(rtrb::PushError::Full(command)) = self.dead.push(command) {
            // Freeing here would block other threads' allocations; leaking a command does not.
            std::mem::forget(command);
        }
    }

    /// True if no further command will come.
    pub(super) fn is_exhausted(&self) -> bool {
        // In this order: the flag is set after the last command was pushed.
        self.all_loaded.load(Ordering::Acquire) && self.ready.is_empty()
    }
}

impl HostEnds {
    pub(super) fn all_loaded(&self) {
        self.all_loaded.store(true, Ordering::Release);
    }
}
