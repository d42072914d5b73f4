//! Maps the numbers on a tick log to names of device ports, images and command flows.

use std::collections::BTreeMap;
use std::sync::Arc;

use rpi_core::CommandId;
use rpi_device::{DeviceBank, PortId, PortKind, PortQuery};
use rpi_image::image::DevicePort;
use rpi_image::{Image, Type};
use rpi_sim::{Cell, SimBank};

use rpi_runtime::run::sampled_flows;

/// Name and type of a device port or of a flow of a command.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) struct FlowName {
    /// Name of the device or command.
    pub(super) owner: String,
    /// Name of the port or flow within its device or command.
    pub(super) name: String,
    /// Type of the values of the port or flow.
    pub(super) ty: Type,
}

impl FlowName {
    /// Returns a value of this port or flow as JSON text.
    pub(super) fn value_to_json(&self, value: Option<&[u64]>) -> String {
        let mut text = String::new();
        super::value_json::write(&mut text, value, self.ty);
        text
    }
}

/// Names of the ports, images and commands that occurred so far.
pub(super) struct NameTable {
    bank: SimBank,
    devices: Vec<String>,
    ports: BTreeMap<u32, FlowName>,
    /// Images in order of first use; `None` once no command runs the image any more.
    images: Vec<Option<Arc<Image>>>,
    /// For each image, its recorded flows.
    flows: Vec<Vec<FlowName>>,
    /// For each command number, the index of its image.
    commands: BTreeMap<u64, usize>,
}

impl NameTable {
    /// Returns the table for a cell, without any commands.
    pub(super) fn new(cell: &Cell, tick_ns: u64) -> NameTable {
        NameTable {
            bank: SimBank::new(cell, tick_ns as f64 * 1e-9),
            devices: cell.devices.iter().map(|d| d.name.clone()).collect(),
            ports: BTreeMap::new(),
            images: Vec::new(),
            flows: Vec::new(),
            commands: BTreeMap::new(),
        }
    }

    /// Adds a command with its image. Returns true if the image is new.
    pub(super) fn insert_command(&mut self, command: CommandId, image: &Arc<Image>) -> bool {
        let same =
            |known: &Option<Arc<Image>>| known.as_ref().is_some_and(|i| Arc::ptr_eq(i, image));
        let known = self.images.iter().position(same);
        let index = known.unwrap_or(self.images.len());
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
        let flows = flows.map(|(name, signal, _)| FlowName {
            owner: image.name.clone(),
            name: name
                .strip_prefix(&format!("{}.", image.name))
                .unwrap_or(&name)
                .to_owned(),
            ty: signal.ty,
        });
        self.flows.push(flows.collect());
        self.images.push(Some(Arc::clone(image)));
    }

    /// Removes a command, and its image unless another command runs it.
    pub(super) fn remove_command(&mut self, command: CommandId) {
        let index = self.commands.remove(&command.to_number());
        let index = index.filter(|index| !self.commands.values().any(|other| other == index));
        if let Some(index) = index {
            (self.images[index], self.flows[index]) = (None, Vec::new());
        }
    }

    /// Adds a device port and returns its number; `None` if the device bank does not have the port.
    fn add_port(&mut self, port: &DevicePort, kind: PortKind) -> Option<u32> {
        let PortId(number) = self.bank.resolve(&PortQuery::new(port, kind)).ok()?;
        self.ports.entry(number).or_insert_with(|| FlowName {
            owner: port.device.clone(),
            name: match port.index {
                0 => port.port.clone(),
                index => format!("{}[{index}]", port.port),
            },
            ty: port.ty,
        });
        Some(number)
    }

    /// Returns the recorded flows of the image with this index.
    pub(super) fn flows(&self, image: usize) -> &[FlowName] {
        self.flows.get(image).map_or(&[], Vec::as_slice)
    }

    /// Returns the sensors that an image reads, grouped by device.
    pub(super) fn sensors_by_device(&mut self, image: &Image) -> BTreeMap<String, Vec<FlowName>> {
        let ports = image.sensors.iter().map(|s| &s.port);
        self.by_device(ports, PortKind::Sensor)
    }

    /// Returns the actuators that an image sets, grouped by device.
    pub(super) fn actuators_by_device(&mut self, image: &Image) -> BTreeMap<String, Vec<FlowName>> {
        let ports = image.actuators.iter().map(|a| &a.port);
        self.by_device(ports, PortKind::Actuator)
    }

    fn by_device<'a>(
        &mut self,
        ports: impl Iterator<Item = &'a DevicePort>,
        kind: PortKind,
    ) -> BTreeMap<String, Vec<FlowName>> {
        let mut devices: BTreeMap<String, Vec<FlowName>> = BTreeMap::new();
        for port in ports {
            let number = self.add_port(port, kind);
            let named = number.and_then(|number| self.ports.get(&number));
            let named = named.cloned().into_iter();
            named.for_each(|n| devices.entry(n.owner.clone()).or_default().push(n));
        }
        devices
    }

    /// Returns the name and type of the device port with this number; `None` if there is none.
    pub(super) fn port_name(&self, number: u32) -> Option<&FlowName> {
        self.ports.get(&number)
    }

    /// Returns the name and type of a flow of a command, by index; `None` if there is none.
    pub(super) fn flow_name(&self, command: u64, flow: u32) -> Option<&FlowName> {
        let image = *self.commands.get(&command)?;
        self.flows.get(image)?.get(flow as usize)
    }

    /// Returns the index of the image that a command runs.
    pub(super) fn image_index(&self, command: CommandId) -> Option<usize> {
        self.commands.get(&command.to_number()).copied()
    }

    /// Returns the image that a command runs.
    pub(super) fn image(&self, command: CommandId) -> Option<&Image> {
        self.images.get(self.image_index(command)?)?.as_deref()
    }

    /// Returns the name of a command; `?` if the command is unknown.
    pub(super) fn command_name(&self, command: CommandId) -> &str {
        self.image(command).map_or("?", |image| &image.name)
    }

    /// Returns the name of the device of an actuator. The upper 16 bits of a resource number are the index of its
    /// device.
    pub(super) fn actuator_device_name(&self, resource: u32) -> &str {
        self.device_name((resource >> 16) as usize)
    }

    /// Returns the name of the device with this index; `?` if there is none.
    pub(super) fn device_name(&self, device: usize) -> &str {
        self.devices.get(device).map_or("?", String::as_str)
    }
}
