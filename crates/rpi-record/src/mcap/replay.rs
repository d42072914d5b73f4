//! Replays a recording: the same requests in the same ticks, with the tick log in place of the devices.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use rpi_core::{Command, CommandId, CycleObserver, Notice};
use rpi_sim::SimBank;
use serde_json::Value;

use super::error::RecordingError;
use super::event_json;
use super::names::NameTable;
use super::reader::Recording;
use super::replay_report::{Difference, ReplayReport};
use super::request_json::RequestDecoder;
use rpi_runtime::control::{
    Event, Executive, Options, RawControl, Request, Ticket, open_for_replay,
};
use rpi_runtime::run::FlowProbe;
use rpi_runtime::tick_log::{
    EntryKind, LogEntry, LoggedTick, Mismatch, ReplayBank, decode_entries,
};

/// Runs the core again with the requests and device answers of a recording, and compares every flow, set-point and
/// event, up to the first difference.
///
/// # Errors
/// Returns an error if the recording is not complete enough to be replayed.
pub fn replay(recording: &Recording) -> Result<ReplayReport, RecordingError> {
    replay_observed(recording, &mut |_, _, _| {})
}

/// Callback for a command in each of its cycles in a replay, after the evaluation and before the delays are stored: number
/// of the tick, id and state of the command.
pub type CycleCallback<'a> = &'a mut dyn FnMut(u64, CommandId, &Command);

/// Callback for a tick of a replay: the recorded tick, and the words of the entries about the flows of commands that the
/// replay has computed in it.
type TickCallback<'a> = &'a mut dyn FnMut(&LoggedTick<'_>, &[u64]) -> Result<(), RecordingError>;

/// Replays a recording as [`replay`] does, and passes each command to `observe` in each of its cycles.
///
/// # Errors
/// Returns an error if the recording is not complete enough to be replayed.
pub fn replay_observed(
    recording: &Recording,
    observe: CycleCallback<'_>,
) -> Result<ReplayReport, RecordingError> {
    run_replay(recording, observe, &mut |_, _| Ok(()))
}

/// Replays a recording as [`replay`] does, and passes each tick with its flows to `each`.
pub(super) fn replay_flows(
    recording: &Recording,
    each: TickCallback<'_>,
) -> Result<ReplayReport, RecordingError> {
    run_replay(recording, &mut |_, _, _| {}, each)
}

fn run_replay(
    recording: &Recording,
    observe: CycleCallback<'_>,
    each: TickCallback<'_>,
) -> Result<ReplayReport, RecordingError> {
    let mut stage = ReplayRun::new(recording)?;
    stage.report.lost = recording.lost;
    stage.report.cut.clone_from(&recording.cut);
    stage.report.functions =
        (recording.functions != rpi_math::REVISION).then_some(recording.functions);
    recording.for_each_tick(|words| {
        let tick = LoggedTick::from_words(words);
        let tick =
            tick.ok_or_else(|| RecordingError::Damaged("invalid tick on the tape".into()))?;
        let unknown = stage.report.devices.is_some_and(|from| tick.number >= from);
        if tick.lost > 0 || unknown || stage.report.difference.is_some() {
            return Ok(false);
        }
        stage.tick(&tick, observe);
        each(&tick, stage.probe.stage().words().unwrap_or(&[]))?;
        Ok(true)
    })?;
    if recording.cut.is_some() {
        stage.forgive_the_cut();
    } else if stage.report.agrees() {
        stage.check_missing_events();
    }
    Ok(stage.report)
}

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

/// State of a replay that is in progress: a core with recorded devices, the remaining requests and events, and the
/// report.
struct ReplayRun<'a> {
    executive: Executive<ReplayBank>,
    control: RawControl<()>,
    /// Remaining requests by the number of the tick that carries them out, in recorded order.
    requests: BTreeMap<u64, Vec<(Ticket, Request<()>)>>,
    probe: FlowProbe,
    names: NameTable,
    /// Recorded events that the replay has not produced yet.
    expected: VecDeque<&'a Value>,
    latest: u64,
    /// Whether the recording has the same flows as the images.
    compares_flows: bool,
    report: ReplayReport,
}

impl<'a> ReplayRun<'a> {
    fn new(recording: &'a Recording) -> Result<ReplayRun<'a>, RecordingError> {
        let mut names = NameTable::new(&recording.cell, recording.tick_ns);
        let devices = first_device_change(recording);
        let requests = requests(recording, devices.unwrap_or(u64::MAX), &mut names)?;
        let most = recording.requests.len() + 1;
        let places = recording
            .requests
            .iter()
            .filter_map(|r| r["command"].as_u64());
        let places = places.map(|number| CommandId::from_number(number).slot() + 1);
        let places = places.max().unwrap_or(0);
        // A core fills its lowest free slot, so a higher slot than the number of requests cannot occur.
        if places > recording.requests.len() {
            return Err(RecordingError::Damaged(format!(
                "a command has slot {places}, with {} requests",
                recording.requests.len()
            )));
        }
        let options = Options {
            tick_ns: recording.tick_ns,
            continuity: recording.continuity,
            requests: most.max(Options::default().requests),
            commands: places.max(Options::default().commands),
            ..Options::default()
        };
        let devices_in_cell = recording.cell.devices.len();
        let player = match recording.is_watched {
            true => ReplayBank::in_any_order(devices_in_cell),
            false => ReplayBank::new(devices_in_cell),
        };
        let (control, executive) = open_for_replay(player, options);
        Ok(ReplayRun {
            executive,
            control,
            requests,
            probe: FlowProbe::new(&recording.images),
            names,
            expected: recording
                .events
                .iter()
                .filter(|e| is_core_event(e))
                .collect(),
            latest: 0,
            compares_flows: !recording.is_watched,
            report: ReplayReport {
                devices,
                ..ReplayReport::default()
            },
        })
    }

    fn tick(&mut self, tick: &LoggedTick<'_>, observe: CycleCallback<'_>) {
        for request in self.requests.remove(&tick.number).unwrap_or_default() {
            // The queue has room: its capacity is at least the number of recorded requests.
            self.control.request(request.0, request.1);
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
            self.latest = event_json::event_tick(&event).unwrap_or(self.latest);
            let now = event_json::encode_event(&event, self.latest, &self.names);
            let recorded = self.expected.pop_front();
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

    /// Removes a difference that may result from the end of a recording that was cut off: the recorded events end
    /// before it, so the answer that says in which tick a request was carried out may be missing.
    fn forgive_the_cut(&mut self) {
        if self.expected.is_empty() {
            self.report.difference = None;
        }
    }

    /// Reports a difference if the replay has not produced a recorded event.
    fn check_missing_events(&mut self) {
        if let Some(missing) = self.expected.pop_front() {
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

/// Returns true for an event of the core, false for an event that the host or the writer thread added to the recording.
fn is_core_event(event: &Value) -> bool {
    let own = ["freed", "lost", "overrun"];
    !own.iter().any(|own| event["event"] == *own)
}

/// Kinds of recorded events with a tick of their own.
const EVENTS_WITH_TICK: [&str; 5] = ["answer", "started", "ended", "braked", "device"];

/// Returns whether a recorded event and an event of the replay are the same.
///
/// Events without a tick of their own carry the tick of an earlier event, which depends on timing, so it is ignored.
fn events_match(recorded: &Value, now: &Value) -> bool {
    let fields = now.as_object().into_iter().flatten();
    let has_own_tick = EVENTS_WITH_TICK.iter().any(|e| now["event"] == *e);
    let mut fields = fields.filter(|(key, _)| has_own_tick || *key != "tick");
    fields.all(|(key, value)| recorded[key] == *value)
}

/// Requests by the number of the tick in which they were carried out, in the order of execution.
type RequestsByTick = BTreeMap<u64, Vec<(Ticket, Request<()>)>>;

/// Returns the ticket number of each answered request in the recording, with the number of the tick of the answer.
fn answers(recording: &Recording) -> impl Iterator<Item = Result<(u64, u64), RecordingError>> {
    let answers = recording.events.iter().filter(|e| e["event"] == "answer");
    answers.map(|answer| {
        let ids = answer["ticket"].as_u64().zip(answer["tick"].as_u64());
        ids.ok_or_else(|| RecordingError::Damaged(format!("invalid answer: {answer}")))
    })
}

/// Returns the number of the first tick in which a device was inserted or removed; `None` if there is none. The
/// recording does not store the inserted device.
fn first_device_change(recording: &Recording) -> Option<u64> {
    let changes = recording.requests.iter().filter(|r| r["ask"] == "device");
    let tickets: BTreeSet<u64> = changes.filter_map(|r| r["ticket"].as_u64()).collect();
    let mut answers = answers(recording).flatten();
    answers
        .find(|(ticket, _)| tickets.contains(ticket))
        .map(|(_, tick)| tick)
}

/// Returns the requests that were carried out before the tick with the number `until`, and adds their commands to
/// `names`.
fn requests(
    recording: &Recording,
    until: u64,
    names: &mut NameTable,
) -> Result<RequestsByTick, RecordingError> {
    let mut bank = SimBank::new(&recording.cell, recording.tick_ns as f64 * 1e-9);
    let mut maker = RequestDecoder {
        images: &recording.images,
        bank: &mut bank,
        continuity: recording.continuity,
    };
    let by_ticket = recording.requests.iter();
    let by_ticket: BTreeMap<u64, &Value> = by_ticket
        .filter_map(|object| Some((object["ticket"].as_u64()?, object)))
        .collect();
    let mut by_tick = RequestsByTick::new();
    for answer in answers(recording) {
        let (ticket, tick) = answer?;
        if tick >= until {
            break;
        }
        let object = by_ticket.get(&ticket);
        let object = object.ok_or_else(|| RecordingError::Missing(format!("request {ticket}")))?;
        let request = maker.decode(object);
        let request =
            request.ok_or_else(|| RecordingError::Damaged(format!("invalid request: {object}")))?;
        if let Request::Insert(id, command, _) = &request.1 {
            names.insert_command(*id, command.instance().image());
        }
        by_tick.entry(tick).or_default().push(request);
    }
    Ok(by_tick)
}
