//! Writer thread of a recording: takes ticks from the tape and notes from the host, and writes both as messages.

use std::collections::BTreeMap;
use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::Receiver;
use std::time::Duration;

use rpi_core::CommandId;
use rpi_image::Image;
use serde_json::{Map, Value, json};

use super::file::File;
use super::json::{self, Object};
use super::names::{Named, Names};
use super::{asked, told};
use rpi_runtime::control::{Asked, Event, Late, Ticket};
use rpi_runtime::run::{Channel, Written};
use rpi_runtime::tape::{Kind, TapeOut, Tick, entries, late_of};

/// A note from the host to the writer.
pub(super) enum Note {
    /// A request was sent to the cycle.
    Asked(Ticket, Asked),
    /// An event occurred.
    Event(Event),
}

pub(super) const TAPE: &str = "/rpi/tape";
pub(super) const REQUESTS: &str = "/rpi/requests";
pub(super) const EVENTS: &str = "/events";
/// Format name of the tape messages.
pub(super) const FORM: &str = "rpi-tape-1";
/// Documentation of the tape format. It is stored in every recording as the schema of the tape topic.
const FORM_TEXT: &str = include_str!("form.txt");

/// Value of the lost-tick counter until the recording ends.
pub(super) const UNDER_WAY: u64 = u64::MAX;
/// Sleep time of the writer when there is nothing to write.
const PAUSE: Duration = Duration::from_millis(1);
/// Maximum number of ticks taken from the tape before the notes of the host are read.
const TURN: usize = 1024;

/// State of the writer thread.
pub(super) struct Scribe {
    pub(super) file: File,
    pub(super) names: Names,
    /// Device ports that are sampled after each tick.
    pub(super) channels: Vec<Channel>,
    pub(super) tape: TapeOut,
    pub(super) notes: Receiver<Note>,
    pub(super) written: Written,
    /// Commands freed in the current turn. `freed_before` holds those of the previous turn.
    pub(super) freed: Vec<CommandId>,
    pub(super) freed_before: Vec<CommandId>,
    /// Wall clock of the latest tick, nanoseconds since the Unix epoch.
    pub(super) latest: u64,
    /// Tick of the last recorded event.
    pub(super) told: u64,
}

impl Scribe {
    /// Adds the topics that every recording has.
    pub(super) fn begin(&mut self) -> io::Result<()> {
        self.file.binary_topic(TAPE, FORM, FORM_TEXT)?;
        let ticket = json!({ "ticket": { "type": "integer" }, "ask": { "type": "string" } });
        self.file.json_topic(REQUESTS, ticket)?;
        let event = json!({ "tick": { "type": "integer" }, "event": { "type": "string" } });
        self.file.json_topic(EVENTS, event)?;
        let mut devices: BTreeMap<String, Vec<Named>> = BTreeMap::new();
        for channel in &self.channels {
            let named = device_port(channel);
            devices.entry(named.of.clone()).or_default().push(named);
        }
        devices
            .iter()
            .try_for_each(|(device, ports)| self.topic_of("device", device, ports))
    }

    /// Writes until the recording ends and the tape is empty.
    pub(super) fn write(mut self, lost: &AtomicU64) -> io::Result<Written> {
        loop {
            // Load the end marker before taking ticks: all ticks put on the tape before the end was signalled are then
            // taken in this turn.
            let told = lost.load(Ordering::Acquire);
            let ticks = self.turn()?;
            if told != UNDER_WAY && ticks == 0 {
                self.written.lost = told;
                break;
            }
            if ticks == 0 {
                std::thread::sleep(PAUSE);
            }
        }
        let (ticks, lost) = (self.written.ticks, self.written.lost);
        let end = [("ticks", ticks.to_string()), ("lost", lost.to_string())];
        self.file.metadata("rpi-end", &end)?;
        self.file.finish()?;
        Ok(self.written)
    }

    /// Writes one batch of ticks and all pending notes. Returns the number of ticks.
    ///
    /// The ticks are taken from the tape before the notes are read. Notes about the commands of these ticks are then
    /// already in the queue.
    fn turn(&mut self) -> io::Result<usize> {
        let mut taken = Vec::new();
        let mut words = Vec::new();
        while taken.len() < TURN && self.tape.next(&mut words) {
            taken.push(std::mem::take(&mut words));
        }
        while let Ok(note) = self.notes.try_recv() {
            self.note(note)?;
        }
        taken.iter().try_for_each(|words| self.tick(words))?;
        if taken.len() < TURN {
            self.forget();
        }
        Ok(taken.len())
    }

    /// Removes the names of commands that were freed before the previous turn. The tape holds no more ticks of them.
    fn forget(&mut self) {
        let recent = std::mem::take(&mut self.freed);
        let old = std::mem::replace(&mut self.freed_before, recent);
        old.into_iter().for_each(|id| self.names.forget(id));
    }

    fn note(&mut self, note: Note) -> io::Result<()> {
        let time = self.latest;
        match note {
            Note::Asked(ticket, asked) => {
                if let Asked::Load(id, image, ..) = &asked {
                    self.insert(*id, image)?;
                }
                let text = asked::write(ticket, &asked, &self.names).to_string();
                self.file.message(REQUESTS, time, text.as_bytes())
            }
            Note::Event(event) => {
                // An event without a tick gets the tick of the event before it.
                self.told = told::tick_of(&event).unwrap_or(self.told);
                let text = told::event(&event, self.told, &self.names).to_string();
                if let Event::Freed(id) = event {
                    self.freed.push(id);
                }
                self.file.message(EVENTS, time, text.as_bytes())
            }
        }
    }

    /// Adds a command. A new image is attached to the file, and topics are added for its flows and ports.
    fn insert(&mut self, id: CommandId, image: &Arc<Image>) -> io::Result<()> {
        if !self.names.insert(id, image) {
            return Ok(());
        }
        let number = self.names.image_of(id).unwrap_or(0);
        let name = format!("images/{number:08}.rpib");
        let media = "application/octet-stream";
        self.file.attach(&name, media, &image.to_bytes())?;
        let flows = self.names.flows(number).to_vec();
        self.topic_of("command", &image.name, &flows)?;
        for (kind, ports) in [
            ("sensors", self.names.sensors_of(image)),
            ("set_points", self.names.actuators_of(image)),
        ] {
            for (device, ports) in ports {
                self.topic_of(kind, &device, &ports)?;
            }
        }
        Ok(())
    }

    fn topic_of(&mut self, kind: &str, of: &str, named: &[Named]) -> io::Result<()> {
        let mut properties = Map::new();
        properties.insert("cycle".into(), json!({ "type": "integer" }));
        let fields = named.iter().map(|n| (n.name.clone(), json::schema(n.ty)));
        properties.extend(fields);
        let topic = format!("/{kind}/{of}");
        self.file.json_topic(&topic, Value::Object(properties))
    }

    fn tick(&mut self, words: &[u64]) -> io::Result<()> {
        let Some(tick) = Tick::of(words) else {
            return Ok(());
        };
        let time = tick.wall_ns.max(0).cast_unsigned();
        self.latest = time;
        self.written.ticks += u64::from(tick.ticked);
        if tick.lost > 0 {
            let text = json!({ "event": "lost", "tick": tick.number, "ticks": tick.lost });
            self.file
                .message(EVENTS, time, text.to_string().as_bytes())?;
        }
        let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
        self.file.message(TAPE, time, &bytes)?;
        for late in entries(tick.sights).filter(|e| e.kind == Kind::Overrun) {
            let late = late.words.first().copied().unwrap_or(0);
            let mut text = json!({ "event": "overrun", "tick": tick.number, "late_ns": late });
            if let Some(late) = entries(tick.exchange).find_map(|e| late_of(&e)) {
                self.blame(&late, &mut text);
            }
            self.file
                .message(EVENTS, time, text.to_string().as_bytes())?;
        }
        for (topic, text) in self.views(&tick) {
            self.file.message(&topic, time, text.as_bytes())?;
        }
        Ok(())
    }

    /// Adds to an overrun event the command and fragment that caused it.
    fn blame(&self, late: &Late, text: &mut Value) {
        let id = late.command;
        let image = self.names.image(id);
        let fragment = image.and_then(|i| i.fragments.get(late.fragment as usize));
        text["command"] = json!(self.names.of_command(id));
        text["id"] = json!(id.number());
        text["took_ns"] = json!(late.took_ns);
        text["fragment"] = json!(fragment.map(|f| f.path.as_str()));
    }

    /// Returns the messages for viewers of one tick as pairs of topic and JSON text, in order of first occurrence.
    fn views(&self, tick: &Tick<'_>) -> Vec<(String, String)> {
        let mut views: Vec<(String, u64, Object)> = Vec::new();
        for entry in entries(tick.exchange).chain(entries(tick.sights)) {
            let (command, cells) = match entry.kind {
                Kind::Flow => (entry.words.first().copied().unwrap_or(0), &entry.words[1..]),
                _ => (0, entry.words),
            };
            let (kind, named) = match entry.kind {
                Kind::Read => ("sensors", self.names.of_port(entry.key).cloned()),
                Kind::Write => ("set_points", self.names.of_port(entry.key).cloned()),
                Kind::Flow => ("command", self.names.of_flow(command, entry.key).cloned()),
                Kind::Sample => (
                    "device",
                    self.channels.get(entry.key as usize).map(device_port),
                ),
                _ => continue,
            };
            let Some(named) = named else { continue };
            let topic = format!("/{kind}/{}", named.of);
            let known = views.iter().position(|v| (&v.0, v.1) == (&topic, command));
            let at = known.unwrap_or_else(|| {
                views.push((topic, command, Object::of_cycle(tick.number)));
                views.len() - 1
            });
            let present = entry.flag || entry.kind == Kind::Write;
            let value = present.then_some(cells);
            views[at].2.field(&named.name, value, named.ty);
        }
        let done = views.into_iter();
        done.map(|(topic, _, object)| (topic, object.finish()))
            .collect()
    }
}

/// Returns the names and type of a sampled device port.
fn device_port(channel: &Channel) -> Named {
    let (of, name) = channel.name.split_once('.').unwrap_or(("", &channel.name));
    Named {
        of: of.to_owned(),
        name: name.to_owned(),
        ty: channel.ty,
    }
}
