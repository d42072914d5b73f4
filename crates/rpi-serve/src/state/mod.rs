//! Server state: sessions, commands, rules, tasks, devices and subscriptions.
//!
//! The state is one struct behind one lock, which connections, the loader and the `rpi-state` thread hold for short
//! times. The cycle never takes the lock: requests go to it and events come from it through bounded queues.
//!
//! Each part of the state is a type of its own that knows only what it is given. [`ServerState`] routes requests of
//! clients and events of the cycle to the parts:
//!
//! ```text
//! ServerState -- Objects -- Sessions, Commands (Record, Subscriptions, Completion), Tasks
//!             -- Rules, Devices, Emergency, Recording, Journal
//!             -- Queue ==> loader thread
//!             -- CoreLink (PendingRequests, Owed) ==> cycle
//! ```

mod command_events;
mod commands;
mod completion;
mod core_link;
mod defaults;
mod device_spec;
mod devices;
mod emergency;
mod eval;
mod journal;
mod loader;
mod loading;
mod loss;
mod objects;
mod owed;
mod pending;
mod place;
mod queue;
mod record;
mod recording;
mod reports;
mod requests;
mod rest;
mod room;
mod rule_request;
mod rules;
mod sessions;
mod settings;
mod shop;
mod subscribers;
mod task_status;
mod tasks;
mod types;
mod watch;

use std::fmt;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use rpi_record::recording::Recorder;
use rpi_runtime::control::Control;
use rpi_sim::{Cell, SimBank};

pub(crate) use crate::fair::Client;
use crate::limits::Limits;
use crate::settings::Settings;

pub(crate) use device_spec::{NewDevice, PARAMETERS};
pub(crate) use loader::Language;
pub(crate) use loading::Load;
pub(crate) use place::Place;
pub(crate) use record::{Record, results};
pub(crate) use rule_request::Make;
pub(crate) use task_status::{Step, TaskStatus};
pub(crate) use types::{
    DeviceInfo, Failure, Phase, Reply, RuleState, Sink, Status, Update, cause, why,
};
pub(crate) use watch::{TOO_CURIOUS, Watching};

use core_link::CoreLink;
use defaults::CommandDefaults;
use devices::Devices;
use emergency::Emergency;
use journal::Journal;
use objects::Objects;
use queue::Queue;
use recording::Recording;
use rules::Rules;

/// The server state.
pub(crate) struct ServerState {
    limits: Limits,
    pub(crate) defaults: CommandDefaults,
    pub(crate) objects: Objects,
    pub(crate) rules: Rules,
    pub(crate) devices: Devices,
    pub(crate) emergency: Emergency,
    pub(crate) log: Journal,
    recording: Recording,
    jobs: Arc<Queue>,
    pub(crate) core: CoreLink,
}

/// Shared handle of the server state.
#[derive(Clone)]
pub(crate) struct Office(Arc<Mutex<ServerState>>);

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
        let devices = Devices::of(cell, &limits, tick_ns);
        let twin = devices.twin();
        let jobs = Arc::new(Queue::new(limits.loads));
        let office = Office(Arc::new(Mutex::new(ServerState {
            limits,
            defaults: CommandDefaults {
                tick_ns,
                on_overrun: settings.real_time.map(|r| r.commands).unwrap_or_default(),
                continuity: settings.continuity,
            },
            core: CoreLink::new(control),
            objects: Objects::new(limits, settings.on_loss),
            rules: Rules::new(&limits),
            emergency: Emergency::default(),
            devices,
            jobs: Arc::clone(&jobs),
            recording: Recording::new(recorder),
            log: Journal::new(),
        })));
        // A weak reference: dropping the state closes the queue, which ends the loader thread.
        let weak = Arc::downgrade(&office.0);
        let done: loader::Done = Box::new(move |job, loaded| {
            if let Some(state) = weak.upgrade() {
                Office(state).desk().loading().loaded(job, loaded);
            }
        });
        loader::start(jobs, settings.continuity, twin, done)?;
        Ok(office)
    }

    /// Locks the state. A poisoned lock is taken over, so that a crashed connection does not end the server.
    pub(crate) fn desk(&self) -> MutexGuard<'_, ServerState> {
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

impl Drop for ServerState {
    fn drop(&mut self) {
        self.jobs.close();
    }
}

/// Returns the number in a name such as `n12`.
fn number_of(name: &str, letter: char) -> Option<u64> {
    name.strip_prefix(letter)?.parse().ok()
}
