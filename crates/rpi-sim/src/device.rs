//! One simulated device, as the bank of devices sees it.

use crate::code::Code;
use crate::fault::Fault;
use core::ops::Range;
use rpi_device::{Jump, PortKind, PortName, Refusal, ResolveError};
use rpi_image::{Scalar, Type};

/// A port of one device: its line in the device's table, and which of several equal ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Slot {
    pub(crate) line: u16,
    pub(crate) index: u16,
}

/// The part of [`rpi_device::DeviceBank`] that concerns one device; resources are counted from 0 within it.
pub(crate) trait Device: Send {
    /// Finds a port.
    fn resolve(&self, name: &PortName<'_>) -> Result<Slot, ResolveError>;
    /// Whether there is such a port; the methods below are asked only about ports that there are.
    fn has(&self, slot: Slot) -> bool;
    /// The actuators that a port belongs to; empty for a port that is none.
    fn resources_of(&self, slot: Slot) -> Range<u32>;
    /// See [`rpi_device::DeviceBank::read`].
    fn read(&self, slot: Slot, value: &mut [u64]) -> bool;
    /// See [`rpi_device::DeviceBank::check`].
    fn check(&mut self, slot: Slot, value: &[u64]) -> Refusal;
    /// See [`rpi_device::DeviceBank::jump`].
    fn jump(&self, slot: Slot, value: &[u64]) -> Option<Jump> {
        let _ = (slot, value);
        None
    }
    /// See [`rpi_device::DeviceBank::error`].
    fn error(&self, slot: Slot) -> i64;
    /// See [`rpi_device::DeviceBank::write`].
    fn write(&mut self, slot: Slot, value: &[u64]);
    /// See [`rpi_device::DeviceBank::call`].
    fn call(&self, slot: Slot, arguments: &[u64], result: &mut [u64]) -> bool {
        let _ = (slot, arguments, result);
        false
    }
    /// See [`rpi_device::DeviceBank::moving`].
    fn moving(&self, resource: u32) -> bool {
        let _ = resource;
        false
    }
    /// See [`rpi_device::DeviceBank::stop`].
    fn stop(&mut self, resource: u32) {
        let _ = resource;
    }
    /// See [`rpi_device::DeviceBank::begin`].
    fn begin(&mut self, resource: u32, ticks: u32) {
        let _ = (resource, ticks);
    }
    /// Lets one tick pass, which ends at `time` (s).
    fn step(&mut self, time: f64);
    /// Adds a fault to those that are planned; false if the device knows no such trouble.
    fn inject(&mut self, fault: Fault) -> bool {
        let _ = fault;
        false
    }
    /// What is wrong with it now.
    fn code(&self) -> Code {
        Code::OK
    }
    /// Gives the reports since the last call, and how many did not fit.
    fn reports(&mut self, each: &mut dyn FnMut(Report)) -> u64 {
        let _ = each;
        0
    }
}

/// Something that a device had against its commands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Report {
    /// When, in s of the cell's time.
    pub time: f64,
    /// Which axis, from 0; `None` if it concerns the whole device.
    pub axis: Option<usize>,
    /// What.
    pub code: Code,
    /// The value that was refused, in SI units; 0 where there is none.
    pub value: f64,
    /// The limit that it broke; 0 where there is none.
    pub limit: f64,
}

/// What a port carries, before the device's size is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Carries {
    /// One value.
    One(Scalar),
    /// A real for each axis.
    PerAxis,
    /// A value for each terminal, or for the first of them.
    PerTerminal(Scalar),
    /// This many cells of reals, the in-ports or out-ports of a primitive one after the other.
    Reals(u32),
}

impl Carries {
    /// Whether a command that sees the port as `ty` can use it; `size` is the number of axes or terminals. Values put
    /// together of several ports are compared by their size, for their parts are laid out in a row whatever they are.
    pub(crate) fn fits(self, ty: Type, size: usize) -> bool {
        let real = |ty: Type| match ty {
            Type::One(scalar) | Type::Array(scalar, _) => {
                !matches!(scalar, Scalar::Bool | Scalar::Int | Scalar::Time)
            }
            Type::Matrix(..) => true,
        };
        match self {
            Self::One(scalar) => ty == Type::One(scalar),
            Self::PerAxis => real(ty) && ty.cells() as usize == size,
            Self::PerTerminal(scalar) => {
                matches!(ty, Type::Array(own, count) if own == scalar && count as usize <= size)
            }
            Self::Reals(cells) => real(ty) && ty.cells() == cells,
        }
    }
}

/// What every line of a device's table of ports has.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Head {
    pub(crate) name: &'static str,
    pub(crate) kind: PortKind,
    pub(crate) carries: Carries,
    /// Whether there is one for each axis or terminal.
    pub(crate) indexed: bool,
}

/// A port of a kind of device, for people.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PortInfo {
    /// Its name.
    pub name: &'static str,
    /// What it is for.
    pub kind: PortKind,
    /// What it carries: `real`, `Pose`, `real^n` with n the number of axes.
    pub carries: String,
    /// Whether there is one for each axis or terminal.
    pub indexed: bool,
}

impl Head {
    pub(crate) fn info(&self) -> PortInfo {
        let carries = match self.carries {
            Carries::One(scalar) => scalar.name().to_owned(),
            Carries::PerAxis => "real^n".to_owned(),
            Carries::PerTerminal(scalar) => format!("{}^n", scalar.name()),
            Carries::Reals(cells) => format!("real^{cells}"),
        };
        PortInfo {
            name: self.name,
            kind: self.kind,
            carries,
            indexed: self.indexed,
        }
    }
}

/// Finds a port in a table. `size` tells how many axes or terminals there are behind a line.
pub(crate) fn find<'a>(
    table: impl Iterator<Item = &'a Head>,
    name: &PortName<'_>,
    size: impl Fn(usize) -> usize,
) -> Result<Slot, ResolveError> {
    let named = table
        .enumerate()
        .filter(|(_, head)| head.name == name.port && head.kind == name.kind);
    let mut error = ResolveError::NoPort;
    for (line, head) in named {
        let index = usize::try_from(name.index).unwrap_or(usize::MAX);
        let size = size(line);
        if head.indexed && index >= size {
            error = ResolveError::NoIndex;
        } else if !head.carries.fits(name.ty, size) {
            error = ResolveError::WrongType;
        } else {
            let index = if head.indexed { index } else { 0 };
            let narrow = |number: usize| u16::try_from(number).map_err(|_| ResolveError::NoIndex);
            return Ok(Slot {
                line: narrow(line)?,
                index: narrow(index)?,
            });
        }
    }
    Err(error)
}

/// Whether a slot lies within its line of a table; `size` tells how many axes or terminals there are behind it.
pub(crate) fn within(head: Option<&Head>, slot: Slot, size: impl Fn(usize) -> usize) -> bool {
    head.is_some_and(|head| match head.indexed {
        true => usize::from(slot.index) < size(usize::from(slot.line)),
        false => slot.index == 0,
    })
}

/// Puts values into cells, one after the other; what does not fit is dropped.
pub(crate) struct Put<'a> {
    cells: &'a mut [u64],
    at: usize,
}

impl<'a> Put<'a> {
    pub(crate) fn into(cells: &'a mut [u64]) -> Self {
        Self { cells, at: 0 }
    }

    pub(crate) fn bits(&mut self, bits: u64) {
        if let Some(cell) = self.cells.get_mut(self.at) {
            *cell = bits;
        }
        self.at += 1;
    }

    pub(crate) fn real(&mut self, value: f64) {
        self.bits(value.to_bits());
    }

    pub(crate) fn reals(&mut self, values: impl IntoIterator<Item = f64>) {
        values.into_iter().for_each(|value| self.real(value));
    }

    pub(crate) fn pose(&mut self, pose: &rpi_kin::Pose) {
        self.reals(pose.translation.vector.iter().copied());
        // Stored as x, y, z, w, which is the order of the cells too.
        self.reals(pose.rotation.coords.iter().copied());
    }
}

/// The pose in seven cells; NaN where there are too few.
pub(crate) fn pose_from(cells: &[u64]) -> rpi_kin::Pose {
    let part = |at: usize| cells.get(at).map_or(f64::NAN, |bits| f64::from_bits(*bits));
    let quaternion = nalgebra::Quaternion::new(part(6), part(3), part(4), part(5));
    rpi_kin::Pose::from_parts(
        nalgebra::Translation3::new(part(0), part(1), part(2)),
        nalgebra::UnitQuaternion::new_normalize(quaternion),
    )
}

/// A name with the index that it carries in itself taken out: `joint3.torque` is `joint.torque` of index 2.
pub(crate) fn spelled_out(port: &str) -> Option<(&'static str, u32)> {
    const NUMBERED: &[(&str, &str)] = &[
        ("measured_torque", "joint.measured_torque"),
        ("external_torque", "joint.external_torque"),
    ];
    let (number, rest) = port.strip_prefix("joint")?.split_once('.')?;
    let number: u32 = number.parse().ok()?;
    let name = NUMBERED
        .iter()
        .find(|(own, _)| *own == rest)
        .map(|(_, name)| *name)?;
    Some((name, number.checked_sub(1)?))
}

/// A line of the table of ports of a small device: something that it tells, or the one thing that it is told.
pub(crate) struct Line<D: 'static> {
    pub(crate) head: Head,
    /// What a sensor tells; nothing for an actuator.
    tell: Option<fn(&D, usize, &mut Put<'_>)>,
}

impl<D> Line<D> {
    /// A sensor.
    pub(crate) const fn sensor(
        name: &'static str,
        scalar: Scalar,
        tell: fn(&D, usize, &mut Put<'_>),
    ) -> Self {
        let head = Head {
            name,
            kind: PortKind::Sensor,
            carries: Carries::One(scalar),
            indexed: false,
        };
        Self {
            head,
            tell: Some(tell),
        }
    }

    /// An actuator.
    pub(crate) const fn actuator(name: &'static str, scalar: Scalar) -> Self {
        let head = Head {
            name,
            kind: PortKind::Actuator,
            carries: Carries::One(scalar),
            indexed: false,
        };
        Self { head, tell: None }
    }

    /// The same port, once for each of several parts.
    pub(crate) const fn indexed(self) -> Self {
        Self {
            head: Head {
                indexed: true,
                ..self.head
            },
            ..self
        }
    }
}

/// Reads a port of a small device; false if it is no sensor.
pub(crate) fn tell<D>(table: &[Line<D>], device: &D, slot: Slot, value: &mut [u64]) -> bool {
    let tell = table.get(usize::from(slot.line)).and_then(|line| line.tell);
    tell.map(|tell| tell(device, usize::from(slot.index), &mut Put::into(value)))
        .is_some()
}

/// Whether a port of a small device is an actuator.
pub(crate) fn is_actuator<D>(table: &[Line<D>], slot: Slot) -> bool {
    table
        .get(usize::from(slot.line))
        .is_some_and(|line| line.tell.is_none())
}
