//! Cell descriptions (`cell.toml`): the devices of a robot cell by name.
//!
//! Parsing does not stop at the first error. The result is either a complete cell or all errors with their positions.

mod arm;
mod error;
mod faults;
mod io;
mod quantity;
mod reader;
mod simple_devices;
mod suggestion;

pub use arm::{ArmSpec, EnforcedLimits, Surface};
pub use error::{CellError, CellErrors};
pub use io::{InputChange, IoSpec, TerminalSpec};
pub use simple_devices::{BaseSpec, ForceSpec, GripperSpec};

use reader::{ErrorCollector, TableReader};
use toml::de::DeTable;

/// A robot cell: its devices and common settings.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Cell {
    /// Display name; empty if not set.
    pub name: String,
    /// Seed for the noise of all devices. The same seed gives the same bits.
    pub seed: u64,
    /// The devices, in text order.
    pub devices: Vec<DeviceSpec>,
}

/// Device of a cell as `cell.toml` describes it.
#[derive(Clone, Debug, PartialEq)]
pub struct DeviceSpec {
    /// Name by which programs refer to the device.
    pub name: String,
    /// Kind of the device, with its settings.
    pub kind: DeviceKind,
}

/// Kind of a device, with its settings.
#[derive(Clone, Debug, PartialEq)]
pub enum DeviceKind {
    /// A robot arm or a linear axis.
    Arm(ArmSpec),
    /// Digital or analogue inputs and outputs, or both.
    Io(IoSpec),
    /// A mobile base with two driven wheels.
    Base(BaseSpec),
    /// A gripper with two fingers.
    Gripper(GripperSpec),
    /// A force/torque sensor.
    Force(ForceSpec),
}

/// Function that reads the keys of one kind of device.
type ReadKind = fn(&mut TableReader<'_>) -> Option<DeviceKind>;

/// Kinds of devices by the value of the key `kind`, each with the function that reads its other keys.
const KINDS: &[(&str, ReadKind)] = &[
    ("arm", |reader| arm::read(reader).map(DeviceKind::Arm)),
    ("digital-io", |reader| {
        io::read_digital(reader).map(DeviceKind::Io)
    }),
    ("analogue-io", |reader| {
        io::read_analogue(reader).map(DeviceKind::Io)
    }),
    ("io", |reader| io::read_both(reader).map(DeviceKind::Io)),
    ("linear-unit", |reader| {
        arm::read_linear(reader).map(DeviceKind::Arm)
    }),
    ("base", |reader| {
        simple_devices::read_base(reader).map(DeviceKind::Base)
    }),
    ("gripper", |reader| {
        simple_devices::read_gripper(reader).map(DeviceKind::Gripper)
    }),
    ("force-torque", |reader| {
        simple_devices::read_force(reader).map(DeviceKind::Force)
    }),
];

impl Cell {
    /// Parses a description. `file` is used in messages only.
    ///
    /// # Errors
    /// Returns all errors of the description, with their positions.
    pub fn parse(file: &str, text: &str) -> Result<Self, CellErrors> {
        let faults = ErrorCollector::default();
        let (document, broken) = DeTable::parse_recoverable(text);
        for error in &broken {
            let span = error.span().unwrap_or(0..0);
            faults.add(span, error.message().replace('\n', ": "), None);
        }
        let cell = if broken.is_empty() {
            Some(Self::read(TableReader::new(
                document.get_ref(),
                0..0,
                &faults,
            )))
        } else {
            None
        };
        let errors = faults.sorted();
        match cell {
            Some(cell) if errors.is_empty() => Ok(cell),
            _ => Err(CellErrors {
                file: file.to_owned(),
                text: text.to_owned(),
                errors,
            }),
        }
    }

    /// Name of the device that owns a resource of a bank with these devices, and the resource within the device.
    #[must_use]
    pub fn resource_owner(&self, resource: u32) -> Option<(&str, u32)> {
        let (place, own) = crate::bank::split_resource(resource);
        self.devices.get(place).map(|d| (d.name.as_str(), own))
    }

    /// All kinds of devices with their keys, for the manual.
    #[must_use]
    pub fn kinds_and_keys() -> Vec<(&'static str, Vec<&'static str>)> {
        let faults = ErrorCollector::default();
        let keys = |(kind, read): &(&'static str, ReadKind)| {
            let mut reader = TableReader::empty(&faults);
            let _ = read(&mut reader);
            (*kind, reader.known_keys())
        };
        KINDS.iter().map(keys).collect()
    }

    /// Returns the description of the device that the cell has under this name.
    #[must_use]
    pub fn device(&self, name: &str) -> Option<&DeviceSpec> {
        self.devices.iter().find(|device| device.name == name)
    }

    fn read(mut reader: TableReader<'_>) -> Self {
        let name = reader.text("name").unwrap_or_default().to_owned();
        let seed = reader.index("seed", u64::MAX).unwrap_or(0);
        let devices = match reader.table("devices") {
            Some(devices) => read_devices(&devices),
            None => Vec::new(),
        };
        reader.finish();
        Self {
            name,
            seed,
            devices,
        }
    }
}

fn read_devices(devices: &TableReader<'_>) -> Vec<DeviceSpec> {
    let mut all = Vec::new();
    for (name, span, node) in devices.entries() {
        match TableReader::from_node(node, devices.errors()) {
            Some(device) => all.extend(read_device(name, device)),
            None => {
                let message = format!("device `{name}` must be a table");
                devices
                    .errors()
                    .add(span, message, Some(format!("write [devices.{name}]")));
            }
        }
    }
    all
}

fn read_device(name: &str, mut reader: TableReader<'_>) -> Option<DeviceSpec> {
    let kinds: Vec<&'static str> = KINDS.iter().map(|(kind, _)| *kind).collect();
    let Some(kind) = reader.keyword("kind", &kinds) else {
        if !reader.has("kind") {
            let help = format!("expected one of {}", kinds.join(", "));
            reader.error_at("kind", format!("device `{name}` has no `kind`"), Some(help));
        }
        return None;
    };
    let read = KINDS
        .iter()
        .find(|(known, _)| *known == kind)
        .map(|(_, read)| read)?;
    let found = read(&mut reader);
    reader.finish();
    Some(DeviceSpec {
        name: name.to_owned(),
        kind: found?,
    })
}
