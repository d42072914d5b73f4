//! Topics of a running recording, and the messages for viewers in each tick.

use std::collections::BTreeMap;
use std::sync::Arc;

use rpi_image::Image;
use rpi_runtime::run::Channel;
use rpi_runtime::tick_log::{EntryKind, LogEntry, LoggedTick, decode_entries};

use super::names::{FlowName, NameTable};
use super::part_writer::EncodedTopic;
use super::profile::{Profile, TopicEncoder};
use super::topic::Topic;

/// Topic with flows or ports for viewers, with the encoder of its messages.
#[derive(Debug)]
pub(super) struct ViewTopic {
    topic: Arc<Topic>,
    encoder: TopicEncoder,
    pub(super) encoded: Arc<EncodedTopic>,
}

impl ViewTopic {
    /// Returns names and types of the fields of the topic.
    pub(super) fn fields(&self) -> &[FlowName] {
        &self.topic.fields
    }

    fn new(profile: Profile, topic: Arc<Topic>) -> Arc<ViewTopic> {
        let encoder = TopicEncoder::new(profile, &topic);
        let encoded = EncodedTopic {
            name: topic.name.clone(),
            encoding: encoder.encoding(&topic),
            metadata: BTreeMap::new(),
        };
        Arc::new(ViewTopic {
            topic,
            encoder,
            encoded: Arc::new(encoded),
        })
    }
}

/// Direction of the device ports in a topic: read or written by commands.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(super) enum PortTopic {
    /// Sensor ports, which commands read.
    Sensors,
    /// Actuator ports, to which commands write set-points.
    SetPoints,
}

impl PortTopic {
    fn name(self) -> &'static str {
        match self {
            PortTopic::Sensors => "sensors",
            PortTopic::SetPoints => "set_points",
        }
    }
}

/// Topic with the ports of one device in one direction.
struct DevicePorts {
    topic: Arc<ViewTopic>,
    /// Number of each port in the device bank, in the order of the topic's fields.
    ports: Vec<u32>,
}

/// Topics for viewers in a running recording, by the command, port or sampled channel from which their values come.
pub(super) struct TopicTable {
    profile: Profile,
    /// Topic with the flows of each image, by the number of the image.
    flows: BTreeMap<usize, Arc<ViewTopic>>,
    ports: BTreeMap<(PortTopic, String), DevicePorts>,
    /// For each sampled device port, its topic and the index of its field in the topic.
    samples: Vec<(Arc<ViewTopic>, usize)>,
}

/// Message for viewers: the values of a topic in one tick.
pub(super) struct ViewMessage<'a> {
    pub(super) topic: Arc<ViewTopic>,
    /// Number of the command from which the values come; 0 for device ports.
    command: u64,
    values: Vec<Option<&'a [u64]>>,
}

impl<'a> ViewMessage<'a> {
    /// Returns the topic of the message.
    pub(super) fn topic(&self) -> &Arc<ViewTopic> {
        &self.topic
    }

    /// Returns the memory words of each field of the topic; `None` for an absent value.
    pub(super) fn values(&self) -> &[Option<&'a [u64]>] {
        &self.values
    }

    /// Encodes the message. `at` is its time in nanoseconds since the Unix epoch, and the number of the cycle.
    pub(super) fn encode(&self, at: (u64, u64)) -> Vec<u8> {
        let ViewTopic { topic, encoder, .. } = &*self.topic;
        encoder.encode(topic, at, &self.values)
    }
}

impl TopicTable {
    /// Creates the table with the topics for the sampled device ports. `channels` are these ports.
    pub(super) fn new(profile: Profile, channels: &[Channel]) -> TopicTable {
        let names: Vec<FlowName> = channels.iter().map(port_name).collect();
        let mut devices: BTreeMap<&str, Vec<FlowName>> = BTreeMap::new();
        let mut fields = Vec::new();
        for name in &names {
            let own = devices.entry(&name.owner).or_default();
            fields.push((&name.owner, own.len()));
            own.push(name.clone());
        }
        let topics = devices.into_iter().map(|(device, own)| {
            let topic = Topic::new("device", device, own);
            (device.to_owned(), ViewTopic::new(profile, topic))
        });
        let topics: BTreeMap<String, Arc<ViewTopic>> = topics.collect();
        let samples = fields
            .into_iter()
            .filter_map(|(device, field)| Some((Arc::clone(topics.get(device)?), field)));
        TopicTable {
            profile,
            flows: BTreeMap::new(),
            samples: samples.collect(),
            ports: BTreeMap::new(),
        }
    }

    /// Adds the topics for the flows of an image, given by its number in the recording, and for the device ports that
    /// it uses.
    pub(super) fn add_image(&mut self, number: usize, image: &Image, names: &mut NameTable) {
        let flows = names.flows(number).to_vec();
        let topic = ViewTopic::new(self.profile, Topic::new("command", &image.name, flows));
        self.flows.insert(number, topic);
        for (device, ports) in names.sensors_by_device(image) {
            self.add_ports(PortTopic::Sensors, device, &ports, names);
        }
        for (device, ports) in names.actuators_by_device(image) {
            self.add_ports(PortTopic::SetPoints, device, &ports, names);
        }
    }

    /// Removes the topic with the flows of an image that no command runs any more. `number` is that of the image.
    pub(super) fn remove_image(&mut self, number: usize) {
        self.flows.remove(&number);
    }

    /// Returns all topics. The topics of commands are in the order in which their images were loaded.
    pub(super) fn encoded(&self) -> impl Iterator<Item = &Arc<EncodedTopic>> {
        let ports = self.ports.values().map(|ports| &ports.topic);
        let samples = self.samples.iter().map(|(topic, _)| topic);
        let all = self.flows.values().chain(ports).chain(samples);
        all.map(|topic| &topic.encoded)
    }

    /// Adds the device ports with the numbers `new` to the topic of a device in one direction. If one of them was not
    /// in the topic yet, later messages have a new schema.
    fn add_ports(&mut self, kind: PortTopic, device: String, new: &[u32], names: &NameTable) {
        let key = (kind, device);
        let known = self.ports.get(&key).map_or(&[][..], |own| &own.ports);
        let mut ports = known.to_vec();
        ports.extend(new.iter().filter(|port| !known.contains(port)));
        if ports.len() > known.len() {
            let fields = ports.iter().filter_map(|port| names.port_name(*port));
            let topic = Topic::new(kind.name(), &key.1, fields.cloned().collect());
            let topic = ViewTopic::new(self.profile, topic);
            self.ports.insert(key, DevicePorts { topic, ports });
        }
    }

    /// Returns the messages for viewers with the values of a tick, in the order of their first values.
    pub(super) fn messages<'a>(
        &self,
        tick: &LoggedTick<'a>,
        names: &NameTable,
    ) -> Vec<ViewMessage<'a>> {
        let mut messages: Vec<ViewMessage<'a>> = Vec::new();
        for entry in decode_entries(tick.exchange).chain(decode_entries(tick.observations)) {
            let Some((topic, field, command)) = self.place(&entry, names) else {
                continue;
            };
            let same = |m: &ViewMessage<'_>| Arc::ptr_eq(&m.topic, topic) && m.command == command;
            let known = messages.iter().position(same);
            let at = known.unwrap_or_else(|| {
                messages.push(ViewMessage {
                    topic: Arc::clone(topic),
                    command,
                    values: vec![None; topic.topic.fields.len()],
                });
                messages.len() - 1
            });
            let present = entry.flag || entry.kind == EntryKind::Write;
            let skip = usize::from(entry.kind == EntryKind::Flow);
            let cells = present.then(|| &entry.words[skip.min(entry.words.len())..]);
            if let Some(value) = messages[at].values.get_mut(field) {
                *value = cells.or(*value);
            }
        }
        messages
    }

    /// Returns the topic of an entry of the tick log, the index of its field, and for a flow the number of its command
    /// (0 for ports). Returns `None` if viewers do not show the entry.
    fn place(
        &self,
        entry: &LogEntry<'_>,
        names: &NameTable,
    ) -> Option<(&Arc<ViewTopic>, usize, u64)> {
        let port = |kind: PortTopic| {
            let device = &names.port_name(entry.key)?.owner;
            let own = self.ports.get(&(kind, device.clone()))?;
            let field = own.ports.iter().position(|port| *port == entry.key)?;
            Some((&own.topic, field, 0))
        };
        match entry.kind {
            EntryKind::Read => port(PortTopic::Sensors),
            EntryKind::Write => port(PortTopic::SetPoints),
            EntryKind::Flow => {
                let command = entry.words.first().copied().unwrap_or(0);
                let topic = self.flows.get(&names.image_of(command)?)?;
                Some((topic, entry.key as usize, command))
            }
            EntryKind::Sample => {
                let (topic, field) = self.samples.get(entry.key as usize)?;
                Some((topic, *field, 0))
            }
            _ => None,
        }
    }
}

/// Returns device, name and type of a sampled device port, from its channel.
fn port_name(channel: &Channel) -> FlowName {
    let (of, name) = channel.name.split_once('.').unwrap_or(("", &channel.name));
    FlowName {
        owner: of.to_owned(),
        name: name.to_owned(),
        ty: channel.ty,
        unit: String::new(),
    }
}
