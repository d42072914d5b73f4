//! Kinds of devices that a cell can name.

use super::collector::ErrorCollector;
use super::reader::TableReader;
use super::shape::TableShape;
use super::{ArmSpec, BaseSpec, Cell, IoSpec, arm, arm_driver, io, simple_devices};
use crate::device::PortInfo;
use crate::kinds::{SMALL_KINDS, SmallKind, SmallSpec};
use std::rc::Rc;

/// Kind of a device with the settings that the cell gives it.
#[derive(Clone, Debug, PartialEq)]
pub enum DeviceKind {
    /// Robot arm, linear unit or positioner.
    Arm(ArmSpec),
    /// Block of digital or analogue inputs and outputs, or both.
    Io(IoSpec),
    /// Mobile base with two driven wheels.
    Base(BaseSpec),
    /// Small device: a sensor, or a device with one actuator, such as a gripper.
    Small(SmallSpec),
}

impl DeviceKind {
    /// Returns one line about the device: its kind, and for an arm the model and the number of axes.
    #[must_use]
    pub fn summary(&self) -> String {
        match self {
            Self::Arm(arm) => {
                let model = arm.model;
                let axes = model.axes();
                let plural = if axes == 1 { "axis" } else { "axes" };
                format!("arm {} ({}), {axes} {plural}", model.id, model.display_name)
            }
            Self::Io(_) => "inputs and outputs".to_owned(),
            Self::Base(_) => "mobile base".to_owned(),
            Self::Small(small) => small.kind.title.to_owned(),
        }
    }
}

/// Function that reads the keys of one kind of device; `None` after an error.
type ReadKind = fn(&mut TableReader<'_>) -> Option<DeviceKind>;

/// Kind of devices, a value of the key `kind`, with its documentation and the tables of its keys and ports.
#[derive(Clone, Copy, Debug)]
pub struct KindInfo {
    /// Value of the key `kind` in a cell, such as `light-barrier`.
    pub name: &'static str,
    /// Name of the kind in words, such as "light barrier".
    pub title: &'static str,
    /// Device types of the standard library that a program uses for devices of this kind.
    pub device_types: &'static [&'static str],
    source: KindSource,
}

/// Place where the keys and ports of a kind of devices are declared.
#[derive(Clone, Copy, Debug)]
enum KindSource {
    /// Function that reads the keys, and function that lists the ports.
    Functions(ReadKind, fn() -> Vec<PortInfo>),
    /// Tables of keys and ports of a small device.
    Small(&'static SmallKind),
}

/// Kinds of devices with code of their own: arms, terminal blocks and mobile bases.
const LARGE_KINDS: &[KindInfo] = &[
    large(
        "arm",
        "robot arm",
        &["Arm"],
        |reader| arm::read(reader).map(DeviceKind::Arm),
        arm_ports,
    ),
    large(
        "udp-arm",
        "robot arm behind a controller, by UDP",
        &["Arm"],
        |reader| arm_driver::read_udp(reader).map(DeviceKind::Arm),
        arm_ports,
    ),
    large(
        "ur-arm",
        "robot arm of Universal Robots, by RTDE",
        &["Arm"],
        |reader| arm_driver::read_ur(reader).map(DeviceKind::Arm),
        arm_ports,
    ),
    large(
        "digital-io",
        "digital inputs and outputs",
        &["DigitalIo"],
        |reader| io::read_digital(reader).map(DeviceKind::Io),
        io_ports,
    ),
    large(
        "analogue-io",
        "analogue inputs and outputs",
        &["AnalogueIo"],
        |reader| io::read_analogue(reader).map(DeviceKind::Io),
        io_ports,
    ),
    large(
        "io",
        "digital and analogue inputs and outputs",
        &["DigitalIo", "AnalogueIo"],
        |reader| io::read_both(reader).map(DeviceKind::Io),
        io_ports,
    ),
    large(
        "linear-unit",
        "carriage on a rail",
        &["LinearUnit"],
        |reader| arm::read_built_in(reader, "linear-unit").map(DeviceKind::Arm),
        arm_ports,
    ),
    large(
        "positioner",
        "positioner with two axes, tilt and rotation",
        &["Positioner"],
        |reader| arm::read_built_in(reader, "positioner-2").map(DeviceKind::Arm),
        arm_ports,
    ),
    large(
        "base",
        "mobile base with two driven wheels",
        &["MobileBase"],
        |reader| simple_devices::read_base(reader).map(DeviceKind::Base),
        base_ports,
    ),
];

const fn large(
    name: &'static str,
    title: &'static str,
    device_types: &'static [&'static str],
    read: ReadKind,
    ports: fn() -> Vec<PortInfo>,
) -> KindInfo {
    KindInfo {
        name,
        title,
        device_types,
        source: KindSource::Functions(read, ports),
    }
}

fn arm_ports() -> Vec<PortInfo> {
    crate::arm::ports().collect()
}

fn io_ports() -> Vec<PortInfo> {
    crate::io::ports().collect()
}

fn base_ports() -> Vec<PortInfo> {
    crate::base::ports().collect()
}

/// Returns all kinds of devices, in the order of the manual.
pub(super) fn all() -> impl Iterator<Item = KindInfo> {
    let small = SMALL_KINDS.iter().map(|kind| KindInfo {
        name: kind.name,
        title: kind.title,
        device_types: core::slice::from_ref(&kind.device_type),
        source: KindSource::Small(kind),
    });
    LARGE_KINDS.iter().copied().chain(small)
}

impl KindInfo {
    /// Returns the tables of the kind if it is a small device; `None` for other kinds.
    #[must_use]
    pub fn small(&self) -> Option<&'static SmallKind> {
        match self.source {
            KindSource::Small(kind) => Some(kind),
            KindSource::Functions(..) => None,
        }
    }

    pub(super) fn read(&self, reader: &mut TableReader<'_>) -> Option<DeviceKind> {
        reader.record_title(self.title);
        match self.source {
            KindSource::Functions(read, _) => read(reader),
            KindSource::Small(kind) => {
                Some(DeviceKind::Small(simple_devices::read_small(kind, reader)))
            }
        }
    }

    /// Returns the descriptions of the ports of devices of this kind.
    #[must_use]
    pub fn ports(&self) -> Vec<PortInfo> {
        match self.source {
            KindSource::Functions(_, ports) => ports(),
            KindSource::Small(kind) => (kind.ports)(),
        }
    }

    /// Returns the keys that a cell may give to devices of this kind, besides `kind`, in the order in which they are
    /// read.
    #[must_use]
    pub fn keys(&self) -> Vec<&'static str> {
        let errors = ErrorCollector::default();
        let shape = Rc::new(TableShape::default());
        let _ = self.read(&mut TableReader::recording(Rc::clone(&shape), &errors));
        shape.keys().iter().map(|key| key.name).collect()
    }
}

impl Cell {
    /// Returns all kinds of devices that a cell can name.
    pub fn kinds() -> impl Iterator<Item = KindInfo> {
        all()
    }
}
