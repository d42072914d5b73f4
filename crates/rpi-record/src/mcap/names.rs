//! Maps the numbers on a tick log to names of device ports, images and command flows.

use std::collections::BTreeMap;
use std::sync::Arc;

use rpi_core::CommandId;
use rpi_device::{DeviceBank, PortId, PortKind, PortQuery};
use rpi_image::image::DevicePort;
use rpi_image::{Image, Type};
use rpi_sim::{Cell, SimBank};

use rpi_runtime::run::sampled_flows;

/// Name and type of a device port, or of a flow of a command, whose values are recorded.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) struct FlowName {
    /// Name of the device or command.
    pub(super) owner: String,
    /// Name of the port or flow within its device or command, such as `joint.position[2]`.
    pub(super) name: String,
    /// Type of the values of the port or flow.
    pub(super) ty: Type,
    /// Unit of the values of a flow, such as `m/s`; empty if they have none, and for ports.
    pub(super) unit: String,
}

impl FlowName {
    /// Returns a value of this port or flow as JSON text. `value` holds its memory words; `None` is an absent value.
    pub(super) fn value_to_json(&self, value: Option<&[u64]>) -> String {
        let mut text = String::new();
        super::value_json::write(&mut text, value, self.ty);
        text
    }
}

/// Names and types of the device ports, images and flows of commands that occurred so far. The tick log refers to them
/// by number.
pub(super) struct NameTable {
    bank: SimBank,
    devices: Vec<String>,
    ports: BTreeMap<u32, FlowName>,
    /// Images that commands run, with their recorded flows, by number. Images are numbered from 0 in the order of first
    /// use.
    images: BTreeMap<usize, (Arc<Image>, Vec<FlowName>)>,
    /// Number that the next new image receives.
    next_image: usize,
    /// For each command number, the number of the image that the command runs.
    commands: BTreeMap<u64, usize>,
}

impl NameTable {
    /// Creates the table for the devices of a cell, without any commands. `tick_ns` is the tick length in nanoseconds.
    pub(super) fn new(cell: &Cell, tick_ns: u64) -> NameTable {
        NameTable {
            bank: SimBank::new(cell, tick_ns as f64 * 1e-9),
            devices: cell.devices.iter().map(|d| d.name.clone()).collect(),
            ports: BTreeMap::new(),
            images: BTreeMap::new(),
            next_image: 0,
            commands: BTreeMap::new(),
        }
    }

    /// Adds a command with its image. Returns true if no earlier command had this image.
    pub(super) fn insert_command(&mut self, command: CommandId, image: &Arc<Image>) -> bool {
        let same = self
            .images
            .iter()
            .find(|(_, (known, _))| Arc::ptr_eq(known, image));
        let known = same.map(|(number, _)| *number);
        let index = known.unwrap_or(self.next_image);
        self.commands.insert(command.to_number(), index);
        if known.is_none() {
            self.add_image(image);
        }
        known.is_none()
    }

    fn add_image(&mut self, image: &Arc<Image>) {
        let sensors = image.sensors.iter().map(|s| (&s.port, PortKind::Sensor));
        let actuators = image
            .actuators
            .iter()
            .map(|a| (&a.port, PortKind::Actuator));
        for (port, kind) in sensors.chain(actuators) {
            self.add_port(port, kind);
        }
        let flows = sampled_flows(image).into_iter();
        let units: BTreeMap<&str, &str> = image
            .exports
            .iter()
            .map(|export| (export.key.as_str(), export.unit.as_str()))
            .collect();
        let prefix = format!("{}.", image.name);
        let flows = flows.map(|(name, signal, _)| {
            let name = name.strip_prefix(&prefix).unwrap_or(&name).to_owned();
            FlowName {
                owner: image.name.clone(),
                unit: units.get(name.as_str()).copied().unwrap_or("").to_owned(),
                name,
                ty: signal.ty,
            }
        });
        let known = (Arc::clone(image), flows.collect());
        self.images.insert(self.next_image, known);
        self.next_image += 1;
    }

    /// Removes a command, and its image unless another command runs it. Returns the number of the removed image; `None`
    /// if no image was removed.
    pub(super) fn remove_command(&mut self, command: CommandId) -> Option<usize> {
        let index = self.commands.remove(&command.to_number());
        let index = index.filter(|index| !self.commands.values().any(|other| other == index))?;
        self.images.remove(&index);
        Some(index)
    }

    /// Adds a device port and returns its number in the device bank; `None` if the bank does not have the port.
    fn add_port(&mut self, port: &DevicePort, kind: PortKind) -> Option<u32> {
        let PortId(number) = self.bank.resolve(&PortQuery::new(port, kind)).ok()?;
        if !self.ports.contains_key(&number) {
            let name = match self.is_indexed(port, kind) {
                true => format!("{}[{}]", port.port, port.index),
                false => port.port.clone(),
            };
            let named = FlowName {
                owner: port.device.clone(),
                name,
                ty: port.ty,
                unit: String::new(),
            };
            self.ports.insert(number, named);
        }
        Some(number)
    }

    /// Returns whether a device has several ports with this name, which an index distinguishes.
    fn is_indexed(&mut self, port: &DevicePort, kind: PortKind) -> bool {
        let mut second = PortQuery::new(port, kind);
        second.index = 1;
        port.index > 0 || self.bank.resolve(&second).is_ok()
    }

    /// Returns the recorded flows of the image with this number, in the order of their indices; empty if it is unknown.
    pub(super) fn flows(&self, image: usize) -> &[FlowName] {
        self.images.get(&image).map_or(&[], |(_, flows)| flows)
    }

    /// Returns the numbers of the sensor ports that an image reads, by the name of the device.
    pub(super) fn sensors_by_device(&mut self, image: &Image) -> BTreeMap<String, Vec<u32>> {
        let ports = image.sensors.iter().map(|s| &s.port);
        self.by_device(ports, PortKind::Sensor)
    }

    /// Returns the numbers of the actuator ports that an image sets, by the name of the device.
    pub(super) fn actuators_by_device(&mut self, image: &Image) -> BTreeMap<String, Vec<u32>> {
        let ports = image.actuators.iter().map(|a| &a.port);
        self.by_device(ports, PortKind::Actuator)
    }

    fn by_device<'a>(
        &mut self,
        ports: impl Iterator<Item = &'a DevicePort>,
        kind: PortKind,
    ) -> BTreeMap<String, Vec<u32>> {
        let mut devices: BTreeMap<String, Vec<u32>> = BTreeMap::new();
        for port in ports {
            let number = self.add_port(port, kind).into_iter();
            number.for_each(|n| devices.entry(port.device.clone()).or_default().push(n));
        }
        devices
    }

    /// Returns the name and type of the device port with this number; `None` if there is none.
    pub(super) fn port_name(&self, number: u32) -> Option<&FlowName> {
        self.ports.get(&number)
    }

    /// Returns the name and type of the flow with this index of the command with this number; `None` if there is none.
    pub(super) fn flow_name(&self, command: u64, flow: u32) -> Option<&FlowName> {
        self.flows(self.image_of(command)?).get(flow as usize)
    }

    /// Returns the number of the image that the command with this number runs; `None` if the command is unknown.
    pub(super) fn image_of(&self, command: u64) -> Option<usize> {
        self.commands.get(&command).copied()
    }

    /// Returns the number of the image that a command runs; `None` if the command is unknown.
    pub(super) fn image_index(&self, command: CommandId) -> Option<usize> {
        self.image_of(command.to_number())
    }

    /// Returns the image that a command runs; `None` if the command is unknown.
    pub(super) fn image(&self, command: CommandId) -> Option<&Image> {
        let (image, _) = self.images.get(&self.image_index(command)?)?;
        Some(image)
    }

    /// Returns the name of the image that a command runs; `?` if the command is unknown.
    pub(super) fn command_name(&self, command: CommandId) -> &str {
        self.image(command).map_or("?", |image| &image.name)
    }

    /// Returns the name of the device to which an actuator belongs. The upper 16 bits of the resource number are the
    /// index of the device.
    pub(super) fn actuator_device_name(&self, resource: u32) -> &str {
        self.device_name((resource >> 16) as usize)
    }

    /// Returns the name of the device with this index; `?` if there is none.
    pub(super) fn device_name(&self, device: usize) -> &str {
        self.devices.get(device).map_or("?", String::as_str)
    }
}
