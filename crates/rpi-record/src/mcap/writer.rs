//! Writer thread of a recording: takes ticks from the tick log and notes from the host, and writes both as messages.

use std::collections::BTreeMap;
use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::Receiver;
use std::time::Duration;

use rpi_core::CommandId;
use rpi_image::Image;
use serde_json::{Map, Value, json};

use super::mcap_file::McapFile;
use super::names::{FlowName, NameTable};
use super::value_json::{self, JsonObjectWriter};
use super::{event_json, request_json};
use rpi_runtime::control::{AttributedOverrun, Event, RequestRecord, Ticket};
use rpi_runtime::run::{Channel, RecordingStats};
use rpi_runtime::tick_log::{EntryKind, LoggedTick, TickLogReader, decode_entries, decode_overrun};

/// Message from the host to the writer thread of a recording.
pub(super) enum RecorderMessage {
    /// A request was sent to the cycle.
    Request(Ticket, RequestRecord),
    /// An event occurred.
    Event(Event),
}

pub(super) const TAPE: &str = "/rpi/tape";
pub(super) const REQUESTS: &str = "/rpi/requests";
pub(super) const EVENTS: &str = "/events";
/// Name of the binary format of the messages with the logged words of a tick.
pub(super) const TAPE_FORMAT: &str = "rpi-tape-1";
/// Documentation of the binary format of logged ticks. It is stored in every recording as the schema of their topic.
const TAPE_FORMAT_DOC: &str = include_str!("form.txt");

/// Value of the lost-tick counter while the recording is in progress.
pub(super) const RECORDING: u64 = u64::MAX;
/// Sleep time of the writer when there is nothing to write.
const IDLE_SLEEP: Duration = Duration::from_millis(1);
/// Maximum number of ticks that the writer takes from the tick log before it reads the queue of the host.
const MAX_TICKS_PER_TURN: usize = 1024;

/// State of the writer thread of a recording.
pub(super) struct RecordingWriter {
    pub(super) file: McapFile,
    pub(super) names: NameTable,
    /// Device ports that are sampled after each tick.
    pub(super) channels: Vec<Channel>,
    pub(super) tick_log: TickLogReader,
    pub(super) notes: Receiver<RecorderMessage>,
    pub(super) written: RecordingStats,
    /// Commands freed in the current turn. `freed_before` holds those of the previous turn.
    pub(super) freed: Vec<CommandId>,
    pub(super) freed_last_turn: Vec<CommandId>,
    /// Wall clock of the latest tick, nanoseconds since the Unix epoch.
    pub(super) latest: u64,
    /// Tick of the last recorded event.
    pub(super) event_tick: u64,
}

impl RecordingWriter {
    /// Adds the topics that every recording has.
    pub(super) fn add_topics(&mut self) -> io::Result<()> {
        self.file
            .add_binary_topic(TAPE, TAPE_FORMAT, TAPE_FORMAT_DOC)?;
        let ticket = json!({ "ticket": { "type": "integer" }, "ask": { "type": "string" } });
        self.file.add_json_topic(REQUESTS, ticket)?;
        let event = json!({ "tick": { "type": "integer" }, "event": { "type": "string" } });
        self.file.add_json_topic(EVENTS, event)?;
        let mut devices: BTreeMap<String, Vec<FlowName>> = BTreeMap::new();
        for channel in &self.channels {
            let named = device_port_name(channel);
            devices.entry(named.owner.clone()).or_default().push(named);
        }
        devices
            .iter()
            .try_for_each(|(device, ports)| self.add_topic("device", device, ports))
    }

    /// Writes until the recording ends and the tick log is empty.
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
        let (ticks, lost) = (self.written.ticks, self.written.lost);
        let end = [("ticks", ticks.to_string()), ("lost", lost.to_string())];
        self.file.write_metadata("rpi-end", &end)?;
        self.file.finish()?;
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
        while let Ok(note) = self.notes.try_recv() {
            self.write_note(note)?;
        }
        taken.iter().try_for_each(|words| self.write_tick(words))?;
        if taken.len() < MAX_TICKS_PER_TURN {
            self.remove_freed();
        }
        Ok(taken.len())
    }

    /// Removes the names of commands that were freed before the previous turn. The tick log holds no more ticks of them.
    fn remove_freed(&mut self) {
        let recent = std::mem::take(&mut self.freed);
        let old = std::mem::replace(&mut self.freed_last_turn, recent);
        old.into_iter().for_each(|id| self.names.remove_command(id));
    }

    fn write_note(&mut self, note: RecorderMessage) -> io::Result<()> {
        let time = self.latest;
        match note {
            RecorderMessage::Request(ticket, request) => {
                if let RequestRecord::Load(id, image, ..) = &request {
                    self.add_command(*id, image)?;
                }
                let text = request_json::encode_request(ticket, &request, &self.names).to_string();
                self.file.write_message(REQUESTS, time, text.as_bytes())
            }
            RecorderMessage::Event(event) => {
                // An event without a tick gets the tick of the event before it.
                self.event_tick = event_json::event_tick(&event).unwrap_or(self.event_tick);
                let text =
                    event_json::encode_event(&event, self.event_tick, &self.names).to_string();
                if let Event::Freed(id) = event {
                    self.freed.push(id);
                }
                self.file.write_message(EVENTS, time, text.as_bytes())
            }
        }
    }

    /// Adds a command. A new image is attached to the file, and topics are added for its flows and ports.
    fn add_command(&mut self, id: CommandId, image: &Arc<Image>) -> io::Result<()> {
        if !self.names.insert_command(id, image) {
            return Ok(());
        }
        let number = self.names.image_index(id).unwrap_or(0);
        let name = format!("images/{number:08}.rpib");
        let media = "application/octet-stream";
        self.file.attach(&name, media, &image.to_bytes())?;
        let flows = self.names.flows(number).to_vec();
        self.add_topic("command", &image.name, &flows)?;
        for (kind, ports) in [
            ("sensors", self.names.sensors_by_device(image)),
            ("set_points", self.names.actuators_by_device(image)),
        ] {
            for (device, ports) in ports {
                self.add_topic(kind, &device, &ports)?;
            }
        }
        Ok(())
    }

    fn add_topic(&mut self, kind: &str, of: &str, named: &[FlowName]) -> io::Result<()> {
        let mut properties = Map::new();
        properties.insert("cycle".into(), json!({ "type": "integer" }));
        let fields = named
            .iter()
            .map(|n| (n.name.clone(), value_json::schema(n.ty)));
        properties.extend(fields);
        let topic = format!("/{kind}/{of}");
        self.file.add_json_topic(&topic, Value::Object(properties))
    }

    fn write_tick(&mut self, words: &[u64]) -> io::Result<()> {
        let Some(tick) = LoggedTick::from_words(words) else {
            return Ok(());
        };
        let time = tick.wall_ns.max(0).cast_unsigned();
        self.latest = time;
        self.written.ticks += u64::from(tick.ticked);
        if tick.lost > 0 {
            let text = json!({ "event": "lost", "tick": tick.number, "ticks": tick.lost });
            self.file
                .write_message(EVENTS, time, text.to_string().as_bytes())?;
        }
        let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
        self.file.write_message(TAPE, time, &bytes)?;
        for late in decode_entries(tick.observations).filter(|e| e.kind == EntryKind::Overrun) {
            let late = late.words.first().copied().unwrap_or(0);
            let mut text = json!({ "event": "overrun", "tick": tick.number, "late_ns": late });
            if let Some(late) = decode_entries(tick.exchange).find_map(|e| decode_overrun(&e)) {
                self.add_overrun_cause(&late, &mut text);
            }
            self.file
                .write_message(EVENTS, time, text.to_string().as_bytes())?;
        }
        for (topic, text) in self.viewer_messages(&tick) {
            self.file.write_message(&topic, time, text.as_bytes())?;
        }
        Ok(())
    }

    /// Adds to the text of an overrun event the command and fragment that caused the overrun.
    fn add_overrun_cause(&self, late: &AttributedOverrun, text: &mut Value) {
        let id = late.command;
        let image = self.names.image(id);
        let fragment = image.and_then(|i| i.fragments.get(late.fragment as usize));
        text["command"] = json!(self.names.command_name(id));
        text["id"] = json!(id.to_number());
        text["took_ns"] = json!(late.took_ns);
        text["fragment"] = json!(fragment.map(|f| f.path.as_str()));
    }

    /// Returns the messages of one tick for viewers of recordings, as pairs of topic and JSON text, in order of first
    /// occurrence.
    fn viewer_messages(&self, tick: &LoggedTick<'_>) -> Vec<(String, String)> {
        let mut views: Vec<(String, u64, JsonObjectWriter)> = Vec::new();
        for entry in decode_entries(tick.exchange).chain(decode_entries(tick.observations)) {
            let (command, cells) = match entry.kind {
                EntryKind::Flow => (entry.words.first().copied().unwrap_or(0), &entry.words[1..]),
                _ => (0, entry.words),
            };
            let (kind, named) = match entry.kind {
                EntryKind::Read => ("sensors", self.names.port_name(entry.key).cloned()),
                EntryKind::Write => ("set_points", self.names.port_name(entry.key).cloned()),
                EntryKind::Flow => ("command", self.names.flow_name(command, entry.key).cloned()),
                EntryKind::Sample => (
                    "device",
                    self.channels.get(entry.key as usize).map(device_port_name),
                ),
                _ => continue,
            };
            let Some(named) = named else { continue };
            let topic = format!("/{kind}/{}", named.owner);
            let known = views.iter().position(|v| (&v.0, v.1) == (&topic, command));
            let at = known.unwrap_or_else(|| {
                views.push((topic, command, JsonObjectWriter::for_cycle(tick.number)));
                views.len() - 1
            });
            let present = entry.flag || entry.kind == EntryKind::Write;
            let value = present.then_some(cells);
            views[at].2.field(&named.name, value, named.ty);
        }
        let done = views.into_iter();
        done.map(|(topic, _, object)| (topic, object.finish()))
            .collect()
    }
}

/// Returns the name and type of a sampled device port.
fn device_port_name(channel: &Channel) -> FlowName {
    let (of, name) = channel.name.split_once('.').unwrap_or(("", &channel.name));
    FlowName {
        owner: of.to_owned(),
        name: name.to_owned(),
        ty: channel.ty,
    }
}
