//! Writer thread of a recording: takes ticks from the tick log and notes from the host, and writes both as messages.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::Receiver;
use std::time::Duration;

use rpi_core::CommandId;
use rpi_image::Image;
use serde_json::{Value, json};

use super::names::NameTable;
use super::own_topics::OwnTopics;
use super::part_writer::PartWriter;
use super::scene::{Scene, SceneMessage};
use super::topic_table::TopicTable;
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
    pub(super) parts: PartWriter,
    pub(super) own: OwnTopics,
    pub(super) names: NameTable,
    pub(super) topics: TopicTable,
    /// Arms of the cell as viewers show them; `None` in a profile without messages about robots.
    pub(super) scene: Option<Scene>,
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
            let ticks = self.write_batch()?;
            if lost_ticks != RECORDING && ticks == 0 {
                self.written.lost = lost_ticks;
                break;
            }
            if ticks == 0 {
                std::thread::sleep(IDLE_SLEEP);
            }
        }
        self.write_early()?;
        let (ticks, lost) = (self.written.ticks, self.written.lost);
        let end = [("ticks", ticks.to_string()), ("lost", lost.to_string())];
        self.parts.finish(&end)?;
        Ok(self.written)
    }

    /// Writes one batch of ticks and all pending messages of the host. Returns the number of ticks.
    ///
    /// The ticks are taken from the tick log before the messages are read. Messages about the commands of these ticks
    /// are then already in the queue.
    fn write_batch(&mut self) -> io::Result<usize> {
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
            self.write_early()?;
        }
        taken.iter().try_for_each(|words| self.write_tick(words))?;
        if taken.len() < MAX_TICKS_PER_TURN {
            self.remove_freed();
        }
        Ok(taken.len())
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

    fn write_early(&mut self) -> io::Result<()> {
        let notes = std::mem::take(&mut self.early);
        notes.into_iter().try_for_each(|note| self.write_note(note))
    }

    /// Removes the names of commands that were freed before the previous batch. The tick log has no more ticks of them.
    fn remove_freed(&mut self) {
        let recent = std::mem::take(&mut self.freed);
        let old = std::mem::replace(&mut self.freed_last_turn, recent);
        for id in old {
            let image = self.names.remove_command(id);
            image
                .into_iter()
                .for_each(|image| self.topics.remove_image(image));
        }
    }

    fn write_note(&mut self, note: RecorderMessage) -> io::Result<()> {
        match note {
            RecorderMessage::Request(ticket, request) => {
                if let RequestRecord::Load(id, image, ..) = &request {
                    self.add_command(*id, image)?;
                }
                let text = request_json::encode_request(ticket, &request, &self.names);
                let (topic, data) = self.own.request(&text);
                self.parts.write(topic, self.now(), &data)
            }
            RecorderMessage::Event(event) => {
                // An event without a tick gets the tick of the event before it.
                self.event_tick = event_json::event_tick(&event).unwrap_or(self.event_tick);
                let text = event_json::encode_event(&event, self.event_tick, &self.names);
                if let Event::Freed(id) = event {
                    self.freed.push(id);
                }
                self.write_event(&text)
            }
        }
    }

    /// Writes an event, given as JSON, and its entry in the log that viewers show.
    fn write_event(&mut self, event: &Value) -> io::Result<()> {
        let tick = event["tick"].as_u64();
        let time = tick.map_or(self.now(), |tick| self.time_of(tick));
        let (topic, data) = self.own.event(event);
        self.parts.write(topic, time, &data)?;
        let messages = self
            .scene
            .as_ref()
            .map(|scene| scene_messages(scene, time, event));
        self.write_scene(time, messages.unwrap_or_default())
    }

    fn write_scene(&mut self, time: u64, messages: Vec<SceneMessage>) -> io::Result<()> {
        let mut messages = messages.iter();
        messages.try_for_each(|(topic, data)| self.parts.write(topic, time, data))
    }

    /// Adds the name of a command. If its image is new, the image is written to the recording, and topics are added for
    /// its flows and ports.
    fn add_command(&mut self, id: CommandId, image: &Arc<Image>) -> io::Result<()> {
        if !self.names.insert_command(id, image) {
            return Ok(());
        }
        let number = self.names.image_index(id).unwrap_or(0);
        let (topic, data) = self.own.image(number, image);
        self.parts.write(topic, self.now(), &data)?;
        self.topics.add_image(number, image, &mut self.names);
        Ok(())
    }

    fn write_tick(&mut self, words: &[u64]) -> io::Result<()> {
        let Some(tick) = LoggedTick::from_words(words) else {
            return Ok(());
        };
        let latest = TickTime::of(&tick);
        let time = latest.time;
        self.latest = Some(latest);
        self.written.ticks += u64::from(tick.ticked);
        if tick.lost > 0 {
            self.write_event(&json!({ "event": "lost", "tick": tick.number, "ticks": tick.lost }))?;
        }
        let (topic, data) = self.own.tick(words);
        self.parts.write(topic, time, &data)?;
        self.write_overruns(&tick)?;
        for message in self.topics.messages(&tick, &self.names) {
            let data = message.encode((time, tick.number));
            self.parts.write(&message.topic.encoded, time, &data)?;
        }
        let scene = self.scene.as_mut().map(|scene| scene.messages(&tick, time));
        self.write_scene(time, scene.unwrap_or_default())?;
        if self.parts.end_tick(time)? {
            let scene = self.scene.as_ref().map(Scene::descriptions);
            self.write_scene(time, scene.unwrap_or_default())?;
        }
        Ok(())
    }

    fn write_overruns(&mut self, tick: &LoggedTick<'_>) -> io::Result<()> {
        for late in decode_entries(tick.observations).filter(|e| e.kind == EntryKind::Overrun) {
            let late = late.words.first().copied().unwrap_or(0);
            let mut event = json!({ "event": "overrun", "tick": tick.number, "late_ns": late });
            if let Some(late) = decode_entries(tick.exchange).find_map(|e| decode_overrun(&e)) {
                self.add_overrun_cause(&late, &mut event);
            }
            self.write_event(&event)?;
        }
        Ok(())
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

/// Returns the messages about an event for viewers: an entry of their log, and the state of a device if it has changed.
/// `time` is in nanoseconds since the Unix epoch.
fn scene_messages(scene: &Scene, time: u64, event: &Value) -> Vec<SceneMessage> {
    let kind = event["event"].as_str().unwrap_or_default();
    let of = ["command", "device"]
        .iter()
        .find_map(|key| event[*key].as_str());
    let of = of.unwrap_or("core");
    let text = event.to_string();
    let mut messages = vec![scene.log(time, event_json::event_level(event), (of, &text))];
    if kind == "device" {
        let (code, moving) = (event["code"].as_i64(), event["moving"].as_bool());
        messages.extend(scene.device(time, of, code.unwrap_or(0), moving.unwrap_or(false)));
    }
    messages
}
