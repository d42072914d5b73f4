//! A replay in progress: a core with recorded devices, compared with the recording tick by tick.

use rpi_core::{Command, CommandId, CycleObserver, Notice};
use serde_json::Value;

use super::error::RecordingError;
use super::event_json;
use super::names::NameTable;
use super::reader::Recording;
use super::replay::CycleCallback;
use super::replay_report::{Difference, ReplayReport};
use rpi_runtime::control::{
    Checkpoint, Event, Executive, Options, RawControl, Request, Ticket, open_for_replay,
};
use rpi_runtime::run::FlowProbe;
use rpi_runtime::tick_log::{
    EntryKind, LogEntry, LoggedTick, Mismatch, ReplayBank, decode_entries,
};

/// Observer of a replay: records the flows of commands and passes each command to a callback.
struct ReplayObserver<'a, 'c> {
    probe: &'a mut FlowProbe,
    /// Number of the tick that is replayed.
    tick: u64,
    observe: CycleCallback<'c>,
}

impl CycleObserver for ReplayObserver<'_, '_> {
    fn cycle_finished(&mut self, id: CommandId, command: &Command) {
        self.probe.cycle_finished(id, command);
    }

    fn evaluated(&mut self, id: CommandId, command: &Command) {
        (self.observe)(self.tick, id, command);
    }
}

/// How far a replay has come in the events.
#[derive(Clone, Copy, Default)]
struct EventProgress {
    /// Number of recorded events that the replay has produced.
    produced: usize,
    /// Tick of the latest event that has one.
    tick: u64,
}

/// State of a replay between two ticks.
pub(super) struct ReplayCheckpoint {
    core: Checkpoint,
    progress: EventProgress,
}

impl ReplayCheckpoint {
    /// Returns the number of the next tick.
    pub(super) fn now(&self) -> u64 {
        self.core.now()
    }

    /// Returns the memory of the commands, in bytes.
    pub(super) fn memory(&self) -> usize {
        self.core.memory()
    }
}

/// State of a replay that is in progress: a core with recorded devices, the remaining events, and the report.
pub(super) struct ReplayRun {
    executive: Executive<ReplayBank>,
    control: RawControl<()>,
    probe: FlowProbe,
    pub(super) names: NameTable,
    /// Recorded events of the core.
    expected: Vec<Value>,
    progress: EventProgress,
    /// Whether the recording has the same flows as the images.
    compares_flows: bool,
    pub(super) report: ReplayReport,
}

impl ReplayRun {
    /// Prepares the replay of a recording, which must begin with the run.
    pub(super) fn new(recording: &Recording) -> Result<ReplayRun, RecordingError> {
        recording.check_replayable()?;
        let devices_in_cell = recording.cell.devices.len();
        let player = match recording.is_watched {
            true => ReplayBank::in_any_order(devices_in_cell),
            false => ReplayBank::new(devices_in_cell),
        };
        let (control, executive) = open_for_replay(player, options(recording)?);
        let events = recording.events.iter().filter(|e| is_core_event(e));
        Ok(ReplayRun {
            executive,
            control,
            probe: FlowProbe::new(&recording.images),
            names: NameTable::new(&recording.cell, recording.tick_ns),
            expected: events.cloned().collect(),
            progress: EventProgress::default(),
            compares_flows: !recording.is_watched,
            report: ReplayReport::default(),
        })
    }

    /// Replays a tick after the requests that were carried out in it.
    pub(super) fn tick(
        &mut self,
        tick: &LoggedTick<'_>,
        requests: Vec<(Ticket, Request<()>)>,
        observe: CycleCallback<'_>,
    ) {
        for (ticket, request) in requests {
            // The queue has room: its capacity is at least the number of recorded requests.
            self.control.request(ticket, request);
        }
        self.executive.plant().load_tick(tick.exchange);
        self.apply_halts();
        if tick.ticked {
            self.probe.begin();
            let mut observer = ReplayObserver {
                probe: &mut self.probe,
                tick: tick.number,
                observe,
            };
            self.executive.tick(tick.wall_ns, &mut observer);
            self.executive.plant().end_accesses();
            self.apply_halts();
            self.report.ticks += 1;
        }
        let writes = decode_entries(tick.exchange).filter(|e| e.kind == EntryKind::Write);
        self.report.values += writes.count() as u64;
        let difference = self.executive.plant().mismatch();
        let difference = difference.map(|mismatch| self.exchange_difference(tick.number, mismatch));
        let difference = difference.or_else(|| self.compare_flows(tick));
        let difference = difference.or_else(|| self.compare_events(tick.number));
        self.report.difference = difference;
        self.control.free();
    }

    fn apply_halts(&mut self) {
        while let Some(late) = self.executive.plant().take_overrun() {
            // If the overrun policy stops all commands, the tick log has a halt entry next, which is handled below.
            self.executive.attribute_overrun(&late);
        }
        while let Some(why) = self.executive.plant().take_halt() {
            self.executive.halt(why);
        }
    }

    /// Compares the flows of commands in a tick with the recorded ones. Returns the first difference.
    fn compare_flows(&mut self, tick: &LoggedTick<'_>) -> Option<Difference> {
        if !self.compares_flows {
            return None;
        }
        let recorded = decode_entries(tick.observations).filter(|e| e.kind == EntryKind::Flow);
        let mut now = decode_entries(self.probe.stage().words().unwrap_or(&[]));
        for recorded in recorded {
            self.report.values += 1;
            let same = now.next();
            if same.as_ref() != Some(&recorded) {
                return Some(self.flow_difference(tick.number, &recorded, same.as_ref()));
            }
        }
        None
    }

    fn flow_difference(
        &self,
        tick: u64,
        recorded: &LogEntry<'_>,
        now: Option<&LogEntry<'_>>,
    ) -> Difference {
        let command = recorded.words.first().copied().unwrap_or(0);
        let named = self.names.flow_name(command, recorded.key);
        let text = |entry: &LogEntry<'_>| {
            let cells = entry.words.get(1..).unwrap_or(&[]);
            named.map_or_else(String::new, |n| {
                n.value_to_json(entry.flag.then_some(cells))
            })
        };
        let same_flow = |e: &&LogEntry<'_>| {
            (e.kind, e.key, e.words.first())
                == (EntryKind::Flow, recorded.key, recorded.words.first())
        };
        Difference {
            tick,
            of: named.map_or_else(|| format!("command {command}"), |n| n.owner.clone()),
            what: named.map_or_else(|| format!("flow {}", recorded.key), |n| n.name.clone()),
            recorded: text(recorded),
            now: now
                .filter(same_flow)
                .map_or_else(|| "the command does not run".to_owned(), text),
        }
    }

    fn exchange_difference(&self, tick: u64, mismatch: Mismatch) -> Difference {
        let port = |number: u32| self.names.port_name(number);
        let say = |kind: EntryKind, key: u32| format!("{kind:?} of {key}").to_lowercase();
        let difference =
            |of: Option<u32>, what: String, recorded: String, now: String| Difference {
                tick,
                of: of
                    .and_then(port)
                    .map_or_else(|| "the core".to_owned(), |n| n.owner.clone()),
                what,
                recorded,
                now,
            };
        match mismatch {
            Mismatch::SetPoint {
                port: number,
                recorded,
                now,
            } => {
                let named = port(number);
                let text = |cells: &[u64]| {
                    named.map_or_else(String::new, |n| n.value_to_json(Some(cells)))
                };
                let what = named.map_or_else(String::new, |n| format!("set-point {}", n.name));
                difference(Some(number), what, text(&recorded), text(&now))
            }
            Mismatch::UnexpectedAccess { recorded, now } => {
                let recorded =
                    recorded.map_or_else(|| "nothing more".into(), |(k, key)| say(k, key));
                difference(
                    None,
                    "the next device access".into(),
                    recorded,
                    say(now.0, now.1),
                )
            }
            Mismatch::MissingAccess(kind, key) => difference(
                None,
                "the next device access".into(),
                say(kind, key),
                "nothing more".into(),
            ),
        }
    }

    /// Compares the events of the core in the tick with this number with the next recorded events. Returns the first
    /// difference.
    fn compare_events(&mut self, tick: u64) -> Option<Difference> {
        while let Some(event) = self.control.poll() {
            if matches!(event, Event::Notice(Notice::Started { .. })) {
                self.report.commands += 1;
            }
            let progress = &mut self.progress;
            progress.tick = event_json::event_tick(&event).unwrap_or(progress.tick);
            let now = event_json::encode_event(&event, progress.tick, &self.names);
            let recorded = self.expected.get(progress.produced);
            progress.produced += 1;
            self.report.events += 1;
            if !recorded.is_some_and(|recorded| events_match(recorded, &now)) {
                let recorded = recorded.map_or_else(|| "nothing".to_owned(), Value::to_string);
                return Some(Difference {
                    tick,
                    of: "the core".to_owned(),
                    what: "an event".to_owned(),
                    recorded,
                    now: now.to_string(),
                });
            }
        }
        None
    }

    /// Returns the words of the entries about the flows of commands that the latest tick has computed.
    pub(super) fn flows(&self) -> &[u64] {
        self.probe.stage().words().unwrap_or(&[])
    }

    /// Returns the state between two ticks.
    pub(super) fn checkpoint(&self) -> ReplayCheckpoint {
        ReplayCheckpoint {
            core: self.executive.checkpoint(),
            progress: self.progress,
        }
    }

    /// Returns the ports that commands have read although the recording has no values for them, by their names.
    pub(super) fn unrecorded(&mut self) -> Vec<String> {
        let ports = self.executive.plant().unrecorded().iter();
        let named = ports.map(|port| match self.names.port_name(*port) {
            Some(name) => format!("{}.{}", name.owner, name.name),
            None => format!("port {port}"),
        });
        named.collect()
    }

    /// Returns to the state of a checkpoint of this replay.
    pub(super) fn restore(&mut self, checkpoint: &ReplayCheckpoint) {
        self.executive.restore(&checkpoint.core);
        self.progress = checkpoint.progress;
        self.report.difference = None;
    }

    /// Removes a difference that may result from the end of a recording that was cut off: the recorded events end
    /// before it, so the answer that says in which tick a request was carried out may be missing.
    pub(super) fn forgive_the_cut(&mut self) {
        if self.progress.produced >= self.expected.len() {
            self.report.difference = None;
        }
    }

    /// Reports a difference if the replay has not produced a recorded event. At the end of a recording that was cut out of a longer
    /// one, events without a tick of their own may belong to a tick after the cut.
    pub(super) fn check_missing_events(&mut self, is_excerpt: bool) {
        let rest = self.expected.get(self.progress.produced..);
        let mut rest = rest.unwrap_or_default().iter();
        if let Some(missing) = rest.find(|event| !is_excerpt || has_own_tick(event)) {
            self.report.difference = Some(Difference {
                tick: self.executive.now(),
                of: "the core".to_owned(),
                what: "an event".to_owned(),
                recorded: missing.to_string(),
                now: "nothing".to_owned(),
            });
        }
    }
}

/// Returns the sizes of the core that the requests of a recording need.
fn options(recording: &Recording) -> Result<Options, RecordingError> {
    let requests = recording.requests.len();
    let commands = recording
        .requests
        .iter()
        .filter_map(|r| r["command"].as_u64());
    let places = commands.map(|number| CommandId::from_number(number).slot() + 1);
    let places = places.max().unwrap_or(0);
    // A core fills its lowest free slot, so a higher slot than the number of requests cannot occur.
    if places > requests {
        return Err(RecordingError::Damaged(format!(
            "a command has slot {places}, with {requests} requests"
        )));
    }
    Ok(Options {
        tick_ns: recording.tick_ns,
        continuity: recording.continuity,
        requests: (requests + 1).max(Options::default().requests),
        commands: places.max(Options::default().commands),
        ..Options::default()
    })
}

/// Returns true for an event of the core, false for an event that the host or the writer thread added to the recording.
fn is_core_event(event: &Value) -> bool {
    let own = ["freed", "lost", "overrun"];
    !own.iter().any(|own| event["event"] == *own)
}

/// Kinds of recorded events with a tick of their own.
const EVENTS_WITH_TICK: [&str; 5] = ["answer", "started", "ended", "braked", "device"];

/// Returns whether an event has a tick of its own.
fn has_own_tick(event: &Value) -> bool {
    EVENTS_WITH_TICK.iter().any(|kind| event["event"] == *kind)
}

/// Returns whether a recorded event and an event of the replay are the same.
///
/// Events without a tick of their own carry the tick of an earlier event, which depends on timing, so it is ignored.
fn events_match(recorded: &Value, now: &Value) -> bool {
    let fields = now.as_object().into_iter().flatten();
    let has_own_tick = has_own_tick(now);
    let mut fields = fields.filter(|(key, _)| has_own_tick || *key != "tick");
    fields.all(|(key, value)| recorded[key] == *value)
}
