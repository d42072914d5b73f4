//! Server state: sessions, commands, rules, tasks, devices and subscriptions.
//!
//! The state is one struct behind one lock, which connections, the loader and the `rpi-state` thread hold for short
//! times. The cycle never takes the lock: requests go to it and events come from it through bounded queues.
//!
//! Each part of the state is a type of its own that knows only what it is given. [`ServerState`] routes requests of
//! clients and events of the cycle to the parts:
//!
//! ```text
//! ServerState -- Objects -- Sessions, Commands (CommandRecord, Subscriptions, Completion), Tasks
//!             -- Rules, Devices, Emergency, Recording, EventLog
//!             -- LoadQueue ==> loader threads ==> Compiler
//!             -- CoreLink (PendingRequests, DeferredOps) ==> cycle
//! ```

mod command_events;
mod commands;
mod completion;
mod controls;
mod core_link;
mod defaults;
mod deferred;
mod device_spec;
mod devices;
mod emergency;
mod eval;
mod event_log;
mod events;
mod load_queue;
mod loader;
mod loading;
mod log_file;
mod loss;
mod objects;
mod pending;
mod quota;
mod record;
mod recording;
mod requests;
mod rule_request;
mod rules;
mod sessions;
mod settings;
mod shutdown;
mod source_location;
mod statistics;
mod subscribers;
mod subscriptions;
mod task_core;
mod task_status;
mod tasks;
mod types;

use std::fmt;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use rpi_record::mcap::Recorder;
use rpi_runtime::control::Control;
use rpi_runtime::realtime::CycleMetrics;
use rpi_sim::{Cell, SimBank};

use crate::compile::Compiler;
pub(crate) use crate::fair_share::Client;
use crate::limits::Limits;
use crate::settings::Settings;

pub(crate) use crate::compile::Language;
pub(crate) use completion::{PlainCondition, ResultConditions};
pub(crate) use device_spec::{NewDevice, PARAMETERS};
pub(crate) use emergency::StopOrigin;
pub(crate) use loading::LoadRequest;
pub(crate) use record::{CommandRecord, results};
pub(crate) use rule_request::RuleRequest;
pub(crate) use sessions::SessionPolicy;
pub(crate) use source_location::SourceLocation;
pub(crate) use subscriptions::{TOO_MANY_SUBSCRIPTIONS, WatchRequest};
pub(crate) use task_status::{Step, TaskPhase, TaskStatus};
pub(crate) use types::{
    ApiError, DeviceInfo, Phase, Reply, RuleState, Status, Subscriber, Update, cause_text,
    fault_text,
};

use controls::OperatorControls;
use core_link::CoreLink;
use defaults::CommandDefaults;
use devices::Devices;
use emergency::Emergency;
use event_log::EventLog;
use load_queue::LoadQueue;
use loader::Loader;
use objects::Objects;
use recording::Recording;
use rules::Rules;
use statistics::Statistics;

/// State that all connections share: sessions, commands, tasks, rules and devices.
pub(crate) struct ServerState {
    pub(crate) limits: Limits,
    pub(crate) defaults: CommandDefaults,
    pub(crate) objects: Objects,
    pub(crate) rules: Rules,
    pub(crate) devices: Devices,
    pub(crate) emergency: Emergency,
    pub(crate) controls: OperatorControls,
    pub(crate) log: EventLog,
    /// Counters of the cycle, which the cycle thread writes.
    pub(crate) cycle: Arc<CycleMetrics>,
    pub(crate) statistics: Statistics,
    pub(crate) recording: Recording,
    pub(crate) jobs: Arc<LoadQueue>,
    /// Compiler of the texts of clients.
    pub(crate) compiler: Arc<Compiler>,
    pub(crate) core: CoreLink,
}

/// Shared handle of the server state, by which all threads of the server lock it.
#[derive(Clone)]
pub(crate) struct SharedState(Arc<Mutex<ServerState>>);

impl fmt::Debug for SharedState {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("SharedState")
    }
}

impl SharedState {
    /// Creates the state for the devices of a cell and starts the loader thread. `control` is the handle that controls
    /// the core; `recorder` writes the recording, if there is one.
    ///
    /// # Errors
    /// If the log file or the loader thread cannot be created.
    pub(crate) fn new(
        cell: &Cell,
        (control, recorder): (Control, Option<Recorder>),
        cycle: Arc<CycleMetrics>,
        settings: &Settings,
    ) -> std::io::Result<SharedState> {
        let (limits, tick_ns) = (settings.limits, settings.tick_ns.max(1));
        let devices = Devices::from_cell(cell, &limits, tick_ns);
        let replica = devices.replica();
        let log = EventLog::new(settings.log_file.as_deref())?;
        let jobs = Arc::new(LoadQueue::new(limits.queued_loads));
        let compiler = Arc::new(Compiler::new(&settings.compiler));
        let shared = SharedState(Arc::new(Mutex::new(ServerState {
            limits,
            defaults: CommandDefaults {
                tick_ns,
                arm_axes: cell.arm_axes(),
                on_overrun: settings
                    .real_time
                    .map(|r| r.command_overrun)
                    .unwrap_or_default(),
                continuity: settings.continuity,
            },
            core: CoreLink::new(control),
            objects: Objects::new(limits, settings.on_loss, settings.grace),
            rules: Rules::new(&limits),
            emergency: Emergency::default(),
            controls: OperatorControls::default(),
            devices,
            jobs: Arc::clone(&jobs),
            compiler: Arc::clone(&compiler),
            recording: Recording::new(recorder),
            log,
            cycle,
            statistics: Statistics::default(),
        })));
        // A weak reference: dropping the state closes the queue, which ends the loader threads.
        let weak = Arc::downgrade(&shared.0);
        let done: loader::LoadCallback = Arc::new(move |job, loaded| {
            if let Some(state) = weak.upgrade() {
                SharedState(state).lock().loading().loaded(job, loaded);
            }
        });
        let loader = Loader {
            jobs,
            compiler,
            continuity: settings.continuity,
            replica,
            done,
        };
        loader.start()?;
        Ok(shared)
    }

    /// Locks the state. A lock poisoned by a crashed thread is taken over, so that the crash of one connection does not
    /// end the server.
    pub(crate) fn lock(&self) -> MutexGuard<'_, ServerState> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Creates a device bank with the devices of a cell and empty slots for more, at least `places` slots in total.
pub(crate) fn bank(cell: &Cell, places: usize, tick_ns: u64) -> SimBank {
    let tick = tick_ns as f64 * 1e-9;
    let mut bank = SimBank::empty(places.max(cell.devices.len()), tick);
    for (place, spec) in cell.devices.iter().enumerate() {
        let part = rpi_sim::NamedDevice::new(spec, tick, cell.seed, place);
        bank.swap(place, Some(part));
    }
    bank
}

impl Drop for ServerState {
    fn drop(&mut self) {
        self.jobs.close();
    }
}

/// Returns the number in the name of an object: 12 for `n12` and the letter `n`. Returns `None` if the name has another
/// form, such as `n012` or `n+12`: subscriptions keep the name, which must not be longer than its number.
fn parse_number(name: &str, letter: char) -> Option<u64> {
    let digits = name.strip_prefix(letter)?;
    let is_shortest = digits == "0" || !digits.starts_with(['0', '+']);
    digits.parse().ok().filter(|_| is_shortest)
}
