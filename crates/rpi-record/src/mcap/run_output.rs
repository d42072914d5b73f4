//! Output of the messages of a run in one profile: the files of a recording, live viewers, or the readers of its values.

use std::io;
use std::sync::Arc;

use rpi_image::Image;
use rpi_runtime::tick_log::LoggedTick;
use serde_json::Value;

use super::event_json;
use super::live::{LiveOutput, LiveViewers};
use super::live_run::{LiveRun, LiveRunOutput};
use super::names::NameTable;
use super::own_topics::OwnTopics;
use super::part_writer::{EncodedTopic, PartWriter};
use super::profile::Profile;
use super::scene::{Scene, SceneMessage};
use super::topic_table::TopicTable;
use rpi_runtime::run::Recorded;

/// Where the messages go.
enum Destination {
    Files(Box<PartWriter>),
    Live(LiveOutput),
    Values(Box<LiveRunOutput>),
}

/// Output of the messages of a run, with the topics and encoders of its profile.
pub(super) struct RunOutput {
    destination: Destination,
    own: OwnTopics,
    topics: TopicTable,
    /// Arms of the cell as viewers show them; `None` in a profile without messages about robots.
    scene: Option<Scene>,
}

impl RunOutput {
    /// Creates the output to the files of a recording.
    pub(super) fn files(profile: Profile, run: &Recorded<'_>, parts: PartWriter) -> RunOutput {
        RunOutput::new(profile, run, Destination::Files(Box::new(parts)))
    }

    /// Creates the output to live viewers, which get the messages of the profile `foxglove`.
    pub(super) fn live(run: &Recorded<'_>, viewers: Box<dyn LiveViewers>) -> RunOutput {
        let live = Destination::Live(LiveOutput::new(viewers));
        let mut output = RunOutput::new(Profile::Foxglove, run, live);
        output.update_live_topics();
        output
    }

    /// Creates the output to the readers of the values of a run.
    pub(super) fn values(run: &Recorded<'_>, shared: LiveRun) -> RunOutput {
        let values = Destination::Values(Box::new(LiveRunOutput::new(run, shared)));
        RunOutput::new(Profile::Json, run, values)
    }

    fn new(profile: Profile, run: &Recorded<'_>, destination: Destination) -> RunOutput {
        RunOutput {
            destination,
            own: OwnTopics::new(profile),
            topics: TopicTable::new(profile, run.channels),
            scene: Scene::new(profile, run.cell, run.channels, run.tick_ns),
        }
    }

    /// Returns whether the output is a file, which can be full.
    pub(super) fn is_file(&self) -> bool {
        matches!(self.destination, Destination::Files(_))
    }

    /// Announces the topics that viewers can choose from.
    fn update_live_topics(&mut self) {
        if let Destination::Live(live) = &mut self.destination {
            let scene = self.scene.iter().flat_map(Scene::topics);
            live.set_topics(
                self.topics
                    .encoded()
                    .chain(self.own.for_viewers())
                    .chain(scene),
            );
        }
    }

    /// Writes a request to the core, given as JSON.
    pub(super) fn request(&mut self, request: &Value, time: u64) -> io::Result<()> {
        let Destination::Files(parts) = &mut self.destination else {
            return Ok(());
        };
        let (topic, data) = self.own.request(request);
        parts.write(topic, time, &data)
    }

    /// Writes an event, given as JSON, and its entry in the log that viewers show.
    pub(super) fn event(&mut self, event: &Value, time: u64) -> io::Result<()> {
        if let Destination::Values(values) = &mut self.destination {
            values.event(event);
            return Ok(());
        }
        let (topic, data) = self.own.event(event);
        write(&mut self.destination, topic, time, &data)?;
        let scene = self.scene.as_ref();
        let messages = scene.map(|scene| scene_messages(scene, time, event));
        self.write_scene(time, messages.unwrap_or_default())
    }

    /// Writes an image that no earlier command had, and adds the topics for its flows and ports.
    pub(super) fn image(
        &mut self,
        (number, image): (usize, &Image),
        names: &mut NameTable,
        time: u64,
    ) -> io::Result<()> {
        match &mut self.destination {
            Destination::Files(parts) => {
                let (topic, data) = self.own.image(number, image);
                parts.write(topic, time, &data)?;
            }
            Destination::Values(values) => values.image(image),
            Destination::Live(_) => {}
        }
        self.topics.add_image(number, image, names);
        self.update_live_topics();
        Ok(())
    }

    /// Removes the topic with the flows of an image that no command runs any more.
    pub(super) fn remove_image(&mut self, number: usize) {
        self.topics.remove_image(number);
        self.update_live_topics();
    }

    /// Writes the words of a tick, from which it is replayed.
    pub(super) fn tick(&mut self, words: &[u64], time: u64) -> io::Result<()> {
        match &mut self.destination {
            Destination::Files(parts) => {
                let (topic, data) = self.own.tick(words);
                parts.write(topic, time, &data)
            }
            Destination::Live(_) | Destination::Values(_) => Ok(()),
        }
    }

    /// Writes the messages about a tick for viewers, after [`RunOutput::tick`].
    pub(super) fn views(
        &mut self,
        tick: &LoggedTick<'_>,
        names: &NameTable,
        time: u64,
    ) -> io::Result<()> {
        if let Destination::Values(values) = &mut self.destination {
            values.tick(tick.number, &self.topics.messages(tick, names));
            return Ok(());
        }
        for message in self.topics.messages(tick, names) {
            let topic = &message.topic.encoded;
            if needs(&self.destination, topic) {
                let data = message.encode((time, tick.number));
                write(&mut self.destination, topic, time, &data)?;
            }
        }
        let destination = &self.destination;
        let scene = self.scene.as_mut();
        let scene =
            scene.map(|scene| scene.messages(tick, time, |topic| needs(destination, topic)));
        self.write_scene(time, scene.unwrap_or_default())?;
        let begins = match &mut self.destination {
            Destination::Files(parts) => parts.end_tick(time)?,
            Destination::Live(live) => !std::mem::replace(&mut live.has_begun, true),
            Destination::Values(_) => false,
        };
        match (&self.scene, begins) {
            (Some(scene), true) => self.write_scene(time, scene.descriptions()),
            _ => Ok(()),
        }
    }

    fn write_scene(&mut self, time: u64, messages: Vec<SceneMessage>) -> io::Result<()> {
        let mut messages = messages.iter();
        messages.try_for_each(|(topic, data)| write(&mut self.destination, topic, time, data))
    }

    /// Ends the output. `end` has the keys and values of the metadata at the end of a recording.
    pub(super) fn finish(self, end: &[(&str, String)]) -> io::Result<()> {
        match self.destination {
            Destination::Files(parts) => parts.finish(end),
            Destination::Live(mut live) => {
                live.set_topics(std::iter::empty());
                Ok(())
            }
            Destination::Values(values) => {
                values.finish();
                Ok(())
            }
        }
    }
}

fn needs(destination: &Destination, topic: &Arc<EncodedTopic>) -> bool {
    match destination {
        Destination::Files(_) => true,
        Destination::Live(live) => live.needs(topic),
        Destination::Values(_) => false,
    }
}

fn write(
    destination: &mut Destination,
    topic: &Arc<EncodedTopic>,
    time: u64,
    data: &[u8],
) -> io::Result<()> {
    match destination {
        Destination::Files(parts) => parts.write(topic, time, data),
        Destination::Live(live) => {
            live.write(topic, time, data);
            Ok(())
        }
        // These get values, and no messages.
        Destination::Values(_) => Ok(()),
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
