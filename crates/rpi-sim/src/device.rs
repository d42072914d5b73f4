//! The interface of one simulated device to the device bank.

use crate::code::Code;
use crate::fault::Fault;
use core::ops::Range;
use rpi_device::{Jump, PortKind, PortName, Refusal, ResolveError};
use rpi_image::{Scalar, Type};

/// A port of one device: a row of the device's port table, and an index within the row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Slot {
    pub(crate) line: u16,
    pub(crate) index: u16,
}

/// The part of [`rpi_device::DeviceBank`] for one device. Resources are numbered from 0 within the device.
pub(crate) trait Device: Send {
    /// Resolves a port name.
    fn resolve(&self, name: &PortName<'_>) -> Result<Slot, ResolveError>;
    /// True if the port exists. The methods below are only called with existing ports.
    fn has(&self, slot: Slot) -> bool;
    /// Resources of an actuator port; empty for other ports.
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
    /// Simulates one tick that ends at `time` (s).
    fn step(&mut self, time: f64);
    /// Schedules a fault. Returns false if the device does not support it.
    fn inject(&mut self, fault: Fault) -> bool {
        let _ = fault;
        false
    }
    /// Present error code of the device.
    fn code(&self) -> Code {
        Code::OK
    }
    /// Passes all new reports to `each`. Returns the number of reports lost for lack of space.
    fn reports(&mut self, each: &mut dyn FnMut(Report)) -> u64 {
        let _ = each;
        0
    }
}

/// A report of a device about a rejected set-point or a failure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Report {
    /// Simulated time of the report, in s.
    pub time: f64,
    /// Axis, from 0; `None` if the report concerns the whole device.
    pub axis: Option<usize>,
    /// Error code.
    pub code: Code,
    /// The rejected value, in SI units; 0 if not applicable.
    pub value: f64,
    /// The violated limit, in SI units; 0 if not applicable.
    pub limit: f64,
}

/// Type of a port as a function of the size of the device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Carries {
    /// One value.
    One(Scalar),
    /// A real for each axis.
    PerAxis,
    /// A value for each terminal, or for the first terminals.
    PerTerminal(Scalar),
    /// A fixed number of reals: the concatenated in-ports or out-ports of a primitive.
    Reals(u32),
}

impl Carries {
    /// True if a command can use the port with type `ty`; `size` is the number of axes or terminals. Values composed of
    /// several ports are compared by size only, because their parts are concatenated whatever their types.
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

/// Common columns of all port tables.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Head {
    pub(crate) name: &'static str,
    pub(crate) kind: PortKind,
    pub(crate) carries: Carries,
    /// True if there is one port for each axis or terminal.
    pub(crate) indexed: bool,
}

/// Description of a port, for the manual.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PortInfo {
    /// Name of the port.
    pub name: &'static str,
    /// Use of the port.
    pub kind: PortKind,
    /// Type of the port: `real`, `Pose`, `real^n` with n the number of axes.
    pub carries: String,
    /// True if there is one port for each axis or terminal.
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

/// Finds a port in a table. `size` returns the number of axes or terminals of a row.
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

/// True if a port is within its table row; `size` returns the number of axes or terminals of a row.
pub(crate) fn within(head: Option<&Head>, slot: Slot, size: impl Fn(usize) -> usize) -> bool {
    head.is_some_and(|head| match head.indexed {
        true => usize::from(slot.index) < size(usize::from(slot.line)),
        false => slot.index == 0,
    })
}

/// Writes values to consecutive memory slots. Values beyond the end are dropped.
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
        // nalgebra stores quaternions as x, y, z, w, the same order as in memory slots.
        self.reals(pose.rotation.coords.iter().copied());
    }
}

/// Reads a pose from seven memory slots: position, then quaternion as x, y, z, w. Missing slots read as NaN.
pub(crate) fn pose_from(cells: &[u64]) -> rpi_kin::Pose {
    let part = |at: usize| cells.get(at).map_or(f64::NAN, |bits| f64::from_bits(*bits));
    let quaternion = nalgebra::Quaternion::new(part(6), part(3), part(4), part(5));
    rpi_kin::Pose::from_parts(
        nalgebra::Translation3::new(part(0), part(1), part(2)),
        nalgebra::UnitQuaternion::new_normalize(quaternion),
    )
}

/// Splits a port name that contains a number: `joint3.measured_torque` is `joint.measured_torque` with index 2.
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

/// A row of the port table of a small device: a sensor, or the single actuator.
pub(crate) struct Line<D: 'static> {
    pub(crate) head: Head,
    /// Reads a sensor; `None` for the actuator.
    tell: Option<fn(&D, usize, &mut Put<'_>)>,
}

impl<D> Line<D> {
    /// A row for a sensor.
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

    /// A row for an actuator.
    pub(crate) const fn actuator(name: &'static str, scalar: Scalar) -> Self {
        let head = Head {
            name,
            kind: PortKind::Actuator,
            carries: Carries::One(scalar),
            indexed: false,
        };
        Self { head, tell: None }
    }

    /// The same row, with one port for each index.
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

/// Reads a port of a small device; false if it is not a sensor.
pub(crate) fn tell<D>(table: &[Line<D>], device: &D, slot: Slot, value: &mut [u64]) -> bool {
    let tell = table.get(usize::from(slot.line)).and_then(|line| line.tell);
    tell.map(|tell| tell(device, usize::from(slot.index), &mut Put::into(value)))
        .is_some()
}

/// True if a port of a small device is an actuator.
pub(crate) fn is_actuator<D>(table: &[Line<D>], slot: Slot) -> bool {
    table
        .get(usize::from(slot.line))
        .is_some_and(|line| line.tell.is_none())
}
