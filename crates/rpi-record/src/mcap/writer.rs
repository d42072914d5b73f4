//! Writer thread of a recording: takes ticks from the tick log and notes from the host, and writes both as messages.

use std::io;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::Receiver;
use std::sync::{Arc, OnceLock};
use std::time::Duration;

use rpi_core::CommandId;
use rpi_image::Image;
use serde_json::{Value, json};

use super::names::NameTable;
use super::run_output::RunOutput;
use super::{event_json, request_json};
use rpi_runtime::control::{AttributedOverrun, Event, RequestRecord, Ticket};
use rpi_runtime::run::RecordingStats;
use rpi_runtime::tick_log::{EntryKind, LoggedTick, TickLogReader, decode_entries, decode_overrun};

/// Message from the host to the thread that writes the recording.
pub(super) enum RecorderMessage {
    /// A request was sent to the core under this ticket.
    Request(Ticket, RequestRecord),
    /// An event of the core occurred.
    Event(Event),
}

/// Value of the counter of missing ticks while the run is in progress; any other value makes the writer thread finish.
pub(super) const RECORDING: u64 = u64::MAX;
/// Time that the writer thread sleeps when there is nothing to write.
const IDLE_SLEEP: Duration = Duration::from_millis(1);
/// Maximum number of ticks that the writer thread takes from the tick log before it reads the messages of the host.
const MAX_TICKS_PER_TURN: usize = 1024;

/// Number and time of a tick in the recording.
#[derive(Clone, Copy, Debug)]
pub(super) struct TickTime {
    number: u64,
    /// Wall clock of the tick, in nanoseconds since the Unix epoch.
    time: u64,
}

impl TickTime {
    fn of(tick: &LoggedTick<'_>) -> TickTime {
        TickTime {
            number: tick.number,
            time: tick.wall_ns.max(0).cast_unsigned(),
        }
    }
}

/// State of the thread that writes a recording: its inputs, names and topics, and its files.
pub(super) struct RecordingWriter {
    /// Where the messages go: a recording, live viewers, or both. One whose file cannot be written is removed.
    pub(super) outputs: Vec<RunOutput>,
    pub(super) names: NameTable,
    /// First error of a file; the recording ends with it.
    pub(super) error: Option<io::Error>,
    /// Text of this error for the host.
    pub(super) write_error: Arc<OnceLock<String>>,
    pub(super) tick_log: TickLogReader,
    pub(super) notes: Receiver<RecorderMessage>,
    pub(super) written: RecordingStats,
    /// Commands that the core freed since the previous batch of ticks. `freed_last_turn` holds those freed before it.
    pub(super) freed: Vec<CommandId>,
    pub(super) freed_last_turn: Vec<CommandId>,
    /// Number and time of the latest tick; `None` before the first one.
    pub(super) latest: Option<TickTime>,
    /// Length of a tick in nanoseconds.
    pub(super) tick_ns: u64,
    /// Requests and events that arrived before the first tick. They are stored with the time of that tick, so that the
    /// recording begins with the run.
    pub(super) early: Vec<RecorderMessage>,
    /// Number of the tick in which the latest recorded event occurred.
    pub(super) event_tick: u64,
}

impl RecordingWriter {
    /// Writes ticks, requests and events until the run has ended and the tick log is empty. `lost` is set to the number
    /// of missing ticks when the run ends.
    pub(super) fn write(mut self, lost: &AtomicU64) -> io::Result<RecordingStats> {
        loop {
            // Load the end marker before taking ticks: all ticks put in the tick log before the end was signalled are then
            // taken in this turn.
            let lost_ticks = lost.load(Ordering::Acquire);
            let ticks = self.write_batch();
            if self.outputs.is_empty()
                && let Some(error) = self.error
            {
                return Err(error);
            }
            if lost_ticks != RECORDING && ticks == 0 {
                self.written.lost = lost_ticks;
                break;
            }
            if ticks == 0 {
                std::thread::sleep(IDLE_SLEEP);
            }
        }
        self.write_early();
        let (ticks, lost) = (self.written.ticks, self.written.lost);
        let end = [("ticks", ticks.to_string()), ("lost", lost.to_string())];
        for output in std::mem::take(&mut self.outputs) {
            let finished = output.finish(&end);
            self.note_error(finished.err());
        }
        self.error.map_or(Ok(self.written), Err)
    }

    /// Passes each output to `write`. An output whose file cannot be written is removed.
    fn for_each_output(
        &mut self,
        mut write: impl FnMut(&mut RunOutput, &mut NameTable) -> io::Result<()>,
    ) {
        let names = &mut self.names;
        let mut failed = None;
        self.outputs
            .retain_mut(|output| match write(output, names) {
                Ok(()) => true,
                Err(error) => {
                    failed = Some(error);
                    false
                }
            });
        self.note_error(failed);
    }

    /// Stores an error of a file, if it is the first one.
    fn note_error(&mut self, error: Option<io::Error>) {
        if let Some(error) = error {
            // Set once: a second error is a consequence.
            let _ = self.write_error.set(error.to_string());
            self.error.get_or_insert(error);
        }
    }

    /// Writes one batch of ticks and all pending messages of the host. Returns the number of ticks.
    ///
    /// The ticks are taken from the tick log before the messages are read. Messages about the commands of these ticks
    /// are then already in the queue.
    fn write_batch(&mut self) -> usize {
        let mut taken = Vec::new();
        let mut words = Vec::new();
        while taken.len() < MAX_TICKS_PER_TURN && self.tick_log.next(&mut words) {
            taken.push(std::mem::take(&mut words));
        }
        if self.latest.is_none() {
            let first = taken
                .first()
                .and_then(|words| LoggedTick::from_words(words));
            self.latest = first.map(|tick| TickTime::of(&tick));
        }
        while let Ok(note) = self.notes.try_recv() {
            self.early.push(note);
        }
        if self.latest.is_some() {
            self.write_early();
        }
        taken.iter().for_each(|words| self.write_tick(words));
        if taken.len() < MAX_TICKS_PER_TURN {
            self.remove_freed();
        }
        taken.len()
    }

    /// Returns the time of the latest tick, in nanoseconds since the Unix epoch; 0 before the first tick.
    fn now(&self) -> u64 {
        self.latest.map_or(0, |latest| latest.time)
    }

    /// Returns the time of the tick with this number, in nanoseconds since the Unix epoch. The time is computed from
    /// that of the latest tick, because the host reports events before or after the writer takes their ticks.
    fn time_of(&self, tick: u64) -> u64 {
        let Some(latest) = self.latest else {
            return 0;
        };
        let ahead = tick.saturating_sub(latest.number) * self.tick_ns;
        let behind = latest.number.saturating_sub(tick) * self.tick_ns;
        (latest.time + ahead).saturating_sub(behind)
    }

    fn write_early(&mut self) {
        let notes = std::mem::take(&mut self.early);
        notes.into_iter().for_each(|note| self.write_note(note));
    }

    /// Removes the names of commands that were freed before the previous batch. The tick log has no more ticks of them.
    fn remove_freed(&mut self) {
        let recent = std::mem::take(&mut self.freed);
        let old = std::mem::replace(&mut self.freed_last_turn, recent);
        for id in old {
            if let Some(image) = self.names.remove_command(id) {
                let outputs = self.outputs.iter_mut();
                outputs.for_each(|output| output.remove_image(image));
            }
        }
    }

    fn write_note(&mut self, note: RecorderMessage) {
        match note {
            RecorderMessage::Request(ticket, request) => {
                if let RequestRecord::Load(id, image, ..) = &request {
                    self.add_command(*id, image);
                }
                let text = request_json::encode_request(ticket, &request, &self.names);
                let now = self.now();
                self.for_each_output(|output, _| output.request(&text, now));
            }
            RecorderMessage::Event(event) => {
                // An event without a tick gets the tick of the event before it.
                self.event_tick = event_json::event_tick(&event).unwrap_or(self.event_tick);
                let text = event_json::encode_event(&event, self.event_tick, &self.names);
                if let Event::Freed(id) = event {
                    self.freed.push(id);
                }
                self.write_event(&text);
            }
        }
    }

    /// Writes an event, given as JSON.
    fn write_event(&mut self, event: &Value) {
        let tick = event["tick"].as_u64();
        let time = tick.map_or(self.now(), |tick| self.time_of(tick));
        self.for_each_output(|output, _| output.event(event, time));
    }

    /// Adds the name of a command, and its image if it is new.
    fn add_command(&mut self, id: CommandId, image: &Arc<Image>) {
        if !self.names.insert_command(id, image) {
            return;
        }
        let number = self.names.image_index(id).unwrap_or(0);
        let now = self.now();
        self.for_each_output(|output, names| output.image((number, image), names, now));
    }

    fn write_tick(&mut self, words: &[u64]) {
        let Some(tick) = LoggedTick::from_words(words) else {
            return;
        };
        let latest = TickTime::of(&tick);
        let time = latest.time;
        self.latest = Some(latest);
        self.written.ticks += u64::from(tick.ticked);
        if tick.lost > 0 {
            self.write_event(&json!({ "event": "lost", "tick": tick.number, "ticks": tick.lost }));
        }
        self.for_each_output(|output, _| output.tick(words, time));
        self.write_overruns(&tick);
        self.for_each_output(|output, names| output.views(&tick, names, time));
    }

    fn write_overruns(&mut self, tick: &LoggedTick<'_>) {
        for late in decode_entries(tick.observations).filter(|e| e.kind == EntryKind::Overrun) {
            let late = late.words.first().copied().unwrap_or(0);
            let mut event = json!({ "event": "overrun", "tick": tick.number, "late_ns": late });
            if let Some(late) = decode_entries(tick.exchange).find_map(|e| decode_overrun(&e)) {
                self.add_overrun_cause(&late, &mut event);
            }
            self.write_event(&event);
        }
    }

    /// Adds to the JSON of an overrun event the command and the fragment to which the overrun is attributed.
    fn add_overrun_cause(&self, late: &AttributedOverrun, event: &mut Value) {
        let id = late.command;
        let image = self.names.image(id);
        let fragment = image.and_then(|i| i.fragments.get(late.fragment as usize));
        event["command"] = json!(self.names.command_name(id));
        event["id"] = json!(id.to_number());
        event["took_ns"] = json!(late.took_ns);
        event["fragment"] = json!(fragment.map(|f| f.path.as_str()));
    }
}
