//! Server state: sessions, commands, rules, tasks, devices and subscriptions.
//!
//! The state is one struct behind one lock, which connections, the loader and the `rpi-desk` thread hold for short
//! times. The cycle never takes the lock: requests go to it and events come from it through bounded queues.

mod commands;
mod completion;
mod devices;
mod emergency;
mod eval;
mod journal;
mod loader;
mod owed;
mod place;
mod queue;
mod reports;
mod rest;
mod room;
mod rules;
mod sessions;
mod shop;
mod tasks;
mod types;
mod watch;

use std::collections::BTreeMap;
use std::fmt;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use rpi_core::{Continuity, OnOverrun};
use rpi_record::recording::Recorder;
use rpi_runtime::control::{CommandId, Control, Rejected, RuleId, Ticket};
use rpi_sim::{Cell, SimBank};

pub(crate) use crate::fair::Client;
use crate::limits::{Limits, OnLoss};
use crate::server::Settings;

pub(crate) use commands::{Load, Record, results};
pub(crate) use devices::{NewDevice, PARAMETERS};
pub(crate) use emergency::Emergency;
pub(crate) use loader::Language;
pub(crate) use place::Place;
pub(crate) use rules::Make;
pub(crate) use tasks::{Step, TaskStatus};
pub(crate) use types::{
    DeviceInfo, Failure, Phase, Reply, RuleState, Sink, Status, Update, cause, why,
};
pub(crate) use watch::{TOO_CURIOUS, Watching};

use devices::Devices;
use journal::Journal;
use loader::Twin;
use owed::Owed;
use queue::Queue;
use rules::RuleRecord;
use sessions::Session;
use tasks::TaskRecord;

/// The server state.
pub(crate) struct Desk {
    pub(crate) limits: Limits,
    pub(crate) tick_ns: u64,
    /// Policy for the commands of a session whose client has disconnected, unless the client specifies one.
    on_loss: OnLoss,
    /// Policy for a command whose cycles take too long, unless its client specifies one.
    on_overrun: OnOverrun,
    control: Control,
    /// Writer of the recording, if the run is recorded.
    recorder: Option<Recorder>,
    /// Whether the recording is still being written.
    recorded: bool,
    errands: BTreeMap<Ticket, Errand>,
    owed: Owed,
    sessions: BTreeMap<u64, Session>,
    commands: BTreeMap<u64, Record>,
    by_id: BTreeMap<CommandId, u64>,
    rules: BTreeMap<RuleId, RuleRecord>,
    tasks: BTreeMap<u64, TaskRecord>,
    emergency: Emergency,
    /// Rules whose outcome was reported to a subscriber in this round.
    told: Vec<RuleId>,
    /// Rules that have fired before the commands they stopped are known to have run. Reported later.
    early: Vec<RuleId>,
    devices: Devices,
    journal: Journal,
    twin: Arc<Mutex<Twin>>,
    jobs: Arc<Queue>,
    /// Policy for a takeover with a jump; `None` for the default of the language.
    continuity: Option<Continuity>,
    /// The last number given to an object.
    last: u64,
}

/// A request to the cycle that is not answered yet.
struct Errand {
    then: Then,
    reply: Option<Reply>,
}

/// Action after a request was carried out.
enum Then {
    Nothing,
    Inserted(u64),
    Made(RuleId),
    /// A command for a single cycle was started.
    Eval(u64),
    Device(DeviceInfo),
    NoDevice(String),
    /// All requests made before an emergency stop were carried out.
    Stopped,
}

/// Shared handle of the server state.
#[derive(Clone)]
pub(crate) struct Office(Arc<Mutex<Desk>>);

impl fmt::Debug for Office {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Office")
    }
}

impl Office {
    /// Creates the state for the devices of a cell and starts the loader.
    ///
    /// # Errors
    /// If the loader thread cannot be created.
    pub(crate) fn open(
        cell: &Cell,
        (control, recorder): (Control, Option<Recorder>),
        settings: &Settings,
    ) -> std::io::Result<Office> {
        let (limits, tick_ns) = (settings.limits, settings.tick_ns.max(1));
        let twin = Arc::new(Mutex::new(Twin {
            bank: bank(cell, limits.devices, tick_ns),
            generation: 0,
        }));
        let jobs = Arc::new(Queue::new(limits.loads));
        let office = Office(Arc::new(Mutex::new(Desk {
            limits,
            tick_ns,
            on_loss: settings.on_loss,
            on_overrun: settings.real_time.map(|r| r.commands).unwrap_or_default(),
            control,
            recorded: recorder.is_some(),
            recorder,
            errands: BTreeMap::new(),
            owed: Owed::default(),
            sessions: BTreeMap::new(),
            commands: BTreeMap::new(),
            by_id: BTreeMap::new(),
            rules: BTreeMap::new(),
            tasks: BTreeMap::new(),
            emergency: Emergency::default(),
            told: Vec::new(),
            early: Vec::new(),
            devices: Devices::of(cell, limits.devices),
            journal: Journal::new(),
            twin: Arc::clone(&twin),
            jobs: Arc::clone(&jobs),
            continuity: settings.continuity,
            last: 0,
        })));
        // A weak reference: dropping the state closes the queue, which ends the loader thread.
        let weak = Arc::downgrade(&office.0);
        let done: loader::Done = Box::new(move |job, loaded| {
            if let Some(desk) = weak.upgrade() {
                Office(desk).desk().loaded(job, loaded);
            }
        });
        loader::start(jobs, settings.continuity, twin, done)?;
        Ok(office)
    }

    /// Locks the state. A poisoned lock is taken over, so that a crashed connection does not end the server.
    pub(crate) fn desk(&self) -> MutexGuard<'_, Desk> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Creates a bank with the devices of a cell and empty slots for more.
pub(crate) fn bank(cell: &Cell, places: usize, tick_ns: u64) -> SimBank {
    let tick = tick_ns as f64 * 1e-9;
    let mut bank = SimBank::empty(places.max(cell.devices.len()), tick);
    for (place, spec) in cell.devices.iter().enumerate() {
        let part = rpi_sim::Part::new(spec, tick, cell.seed, place);
        bank.swap(place, Some(part));
    }
    bank
}

impl Desk {
    /// Returns the latest log lines.
    pub(crate) fn log(&self) -> String {
        self.journal.text()
    }

    /// Writes a log line.
    pub(crate) fn log_line(&mut self, what: fmt::Arguments<'_>) {
        self.journal.note(what);
    }

    /// Writes a log line and keeps it as a warning for the operator.
    pub(crate) fn warn(&mut self, what: &str) {
        self.journal.warn(what);
    }

    /// Takes the pending warnings.
    pub(crate) fn warnings(&mut self) -> Vec<String> {
        self.journal.warnings()
    }

    /// Returns a new number, unique among all objects.
    fn number(&mut self) -> u64 {
        self.last += 1;
        self.last
    }

    /// Registers what follows once the cycle has answered a request. If the request could not be sent, reports the
    /// error to `reply` and returns false.
    fn asked(
        &mut self,
        ticket: Result<Ticket, Rejected>,
        then: Then,
        reply: Option<Reply>,
    ) -> bool {
        match ticket {
            Ok(ticket) => {
                self.errands.insert(ticket, Errand { then, reply });
                true
            }
            Err(why) => {
                answer(reply, Err(why.into()));
                false
            }
        }
    }
}

impl Drop for Desk {
    fn drop(&mut self) {
        self.jobs.close();
    }
}

fn answer(reply: Option<Reply>, result: Result<String, Failure>) {
    if let Some(reply) = reply {
        reply(result);
    }
}

/// Returns the number in a name such as `n12`.
fn number_of(name: &str, letter: char) -> Option<u64> {
    name.strip_prefix(letter)?.parse().ok()
}
