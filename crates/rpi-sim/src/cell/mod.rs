//! What `cell.toml` says: the devices of a cell by name.
//!
//! Reading never stops at the first fault; what is returned is either a complete cell or all faults with their places.

mod arm;
mod error;
mod faults;
mod io;
mod nearest;
mod other;
mod quantity;
mod reader;

pub use arm::{ArmSpec, Enforced, Surface};
pub use error::{CellError, CellErrors};
pub use io::{Change, IoSpec, Signal};
pub use other::{BaseSpec, ForceSpec, GripperSpec};

use reader::{Faults, Reader};
use toml::de::DeTable;

/// The devices of a cell and what they have in common.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Cell {
    /// What people call it; empty if it was not said.
    pub name: String,
    /// Where the noise of all devices starts; the same seed gives the same bits.
    pub seed: u64,
    /// The devices, in the order of the text.
    pub devices: Vec<DeviceSpec>,
}

/// One device.
#[derive(Clone, Debug, PartialEq)]
pub struct DeviceSpec {
    /// Its name, by which programs ask for it.
    pub name: String,
    /// What it is.
    pub kind: Kind,
}

/// What a device is.
#[derive(Clone, Debug, PartialEq)]
pub enum Kind {
    /// A robot arm, or an axis that slides.
    Arm(ArmSpec),
    /// Digital or analogue inputs and outputs, or both.
    Io(IoSpec),
    /// A platform with two driven wheels.
    Base(BaseSpec),
    /// A gripper with two fingers.
    Gripper(GripperSpec),
    /// A force and torque sensor.
    Force(ForceSpec),
}

/// Reads the keys of one kind of device.
type ReadKind = fn(&mut Reader<'_>) -> Option<Kind>;

/// The kinds that `kind = "..."` may name.
const KINDS: &[(&str, ReadKind)] = &[
    ("arm", |reader| arm::read(reader).map(Kind::Arm)),
    ("digital-io", |reader| {
        io::read_digital(reader).map(Kind::Io)
    }),
    ("analogue-io", |reader| {
        io::read_analogue(reader).map(Kind::Io)
    }),
    ("io", |reader| io::read_both(reader).map(Kind::Io)),
    ("linear-unit", |reader| {
        arm::read_linear(reader).map(Kind::Arm)
    }),
    ("base", |reader| other::read_base(reader).map(Kind::Base)),
    ("gripper", |reader| {
        other::read_gripper(reader).map(Kind::Gripper)
    }),
    ("force-torque", |reader| {
        other::read_force(reader).map(Kind::Force)
    }),
];

impl Cell {
    /// Reads a description. `file` is only for messages.
    ///
    /// # Errors
    /// Every fault of the description, with its place.
    pub fn parse(file: &str, text: &str) -> Result<Self, CellErrors> {
        let faults = Faults::default();
        let (document, broken) = DeTable::parse_recoverable(text);
        for error in &broken {
            let span = error.span().unwrap_or(0..0);
            faults.add(span, error.message().replace('\n', ": "), None);
        }
        let cell = if broken.is_empty() {
            Some(Self::read(Reader::new(document.get_ref(), 0..0, &faults)))
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

    /// What people call an actuator of a bank of these devices: the device, and the number within it.
    #[must_use]
    pub fn actuator(&self, resource: u32) -> Option<(&str, u32)> {
        let (place, own) = crate::bank::split(resource);
        self.devices.get(place).map(|d| (d.name.as_str(), own))
    }

    /// The kinds of devices and the keys that each of them knows: what the manual has to tell.
    #[must_use]
    pub fn kinds_and_keys() -> Vec<(&'static str, Vec<&'static str>)> {
        let faults = Faults::default();
        let keys = |(kind, read): &(&'static str, ReadKind)| {
            let mut reader = Reader::empty(&faults);
            let _ = read(&mut reader);
            (*kind, reader.asked())
        };
        KINDS.iter().map(keys).collect()
    }

    /// The device of this name.
    #[must_use]
    pub fn device(&self, name: &str) -> Option<&DeviceSpec> {
        self.devices.iter().find(|device| device.name == name)
    }

    fn read(mut reader: Reader<'_>) -> Self {
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

fn read_devices(devices: &Reader<'_>) -> Vec<DeviceSpec> {
    let mut all = Vec::new();
    for (name, span, node) in devices.entries() {
        match Reader::of(node, devices.faults()) {
            Some(device) => all.extend(read_device(name, device)),
            None => {
                let message = format!("`{name}` is a device and needs a table of its own");
                devices
                    .faults()
                    .add(span, message, Some(format!("write [devices.{name}]")));
            }
        }
    }
    all
}

fn read_device(name: &str, mut reader: Reader<'_>) -> Option<DeviceSpec> {
    let kinds: Vec<&'static str> = KINDS.iter().map(|(kind, _)| *kind).collect();
    let Some(kind) = reader.word("kind", &kinds) else {
        if !reader.has("kind") {
            let help = format!("known are {}", kinds.join(", "));
            reader.fault_at("kind", format!("device `{name}` has no `kind`"), Some(help));
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
