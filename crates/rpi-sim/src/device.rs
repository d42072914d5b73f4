//! The interface of one simulated device to the device bank.

use crate::error_code::ErrorCode;
use crate::fault::ScheduledFault;
use core::ops::Range;
use rpi_device::{Discontinuity, PortKind, PortQuery, Rejection, ResolveError};
use rpi_image::{Scalar, Type};

/// Port of one device, by its row in the port table of the device and an index within the row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PortIndex {
    pub(crate) row: u16,
    pub(crate) index: u16,
}

/// The part of [`rpi_device::DeviceBank`] for one device. Resources are numbered from 0 within the device.
pub(crate) trait Device: Send {
    /// Finds a port by name, type and index. Fails if the device has no such port, or has it with another type.
    fn resolve(&self, name: &PortQuery<'_>) -> Result<PortIndex, ResolveError>;
    /// True if the port exists. The methods below are only called with existing ports.
    fn has_port(&self, slot: PortIndex) -> bool;
    /// Resources of an actuator port; empty for other ports.
    fn resources_of(&self, slot: PortIndex) -> Range<u32>;
    /// See [`rpi_device::DeviceBank::read`].
    fn read(&self, slot: PortIndex, value: &mut [u64]) -> bool;
    /// See [`rpi_device::DeviceBank::check_set_point`].
    fn check(&mut self, slot: PortIndex, value: &[u64]) -> Rejection;
    /// See [`rpi_device::DeviceBank::discontinuity`].
    fn jump(&self, slot: PortIndex, value: &[u64]) -> Option<Discontinuity> {
        let _ = (slot, value);
        None
    }
    /// See [`rpi_device::DeviceBank::error_code`].
    fn error(&self, slot: PortIndex) -> i64;
    /// See [`rpi_device::DeviceBank::write`].
    fn write(&mut self, slot: PortIndex, value: &[u64]);
    /// See [`rpi_device::DeviceBank::call`].
    fn call(&mut self, slot: PortIndex, arguments: &[u64], result: &mut [u64]) -> bool {
        let _ = (slot, arguments, result);
        false
    }
    /// See [`rpi_device::DeviceBank::is_moving`].
    fn moving(&self, resource: u32) -> bool {
        let _ = resource;
        false
    }
    /// See [`rpi_device::DeviceBank::stop`].
    fn stop(&mut self, resource: u32) {
        let _ = resource;
    }
    /// See [`rpi_device::DeviceBank::begin_command`].
    fn begin(&mut self, resource: u32, ticks: u32) {
        let _ = (resource, ticks);
    }
    /// Simulates one tick that ends at `time` (s).
    fn step(&mut self, time: f64);
    /// Schedules a fault. Returns false if the device does not support it.
    fn inject(&mut self, fault: ScheduledFault) -> bool {
        let _ = fault;
        false
    }
    /// Returns the error code that the device has now; 0 for no error.
    fn code(&self) -> ErrorCode {
        ErrorCode::OK
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
    /// Code of the reported error.
    pub code: ErrorCode,
    /// The rejected value, in SI units; 0 if not applicable.
    pub value: f64,
    /// The violated limit, in SI units; 0 if not applicable.
    pub limit: f64,
}

/// Type of a port, which may depend on the number of axes or terminals of the device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PortValue {
    /// One value of this type.
    One(Scalar),
    /// A real for each axis.
    PerAxis,
    /// A real for each axis and this number of further slots, of any type: the out-ports of a primitive.
    PerAxisAnd(u32),
    /// A value for each terminal, or for the first terminals.
    PerTerminal(Scalar),
    /// A fixed number of reals: the concatenated in-ports or out-ports of a primitive.
    Reals(u32),
}

impl PortValue {
    /// True if a command can use the port with type `ty`; `size` is the number of axes or terminals. Values composed of
    /// several ports are compared by size only, because their parts are concatenated whatever their types.
    pub(crate) fn fits(self, ty: Type, size: usize) -> bool {
        let real = |ty: Type| match ty {
            Type::Scalar(scalar) | Type::Array(scalar, _) => {
                !matches!(scalar, Scalar::Bool | Scalar::Int | Scalar::Time)
            }
            Type::Matrix(..) => true,
        };
        match self {
            Self::One(scalar) => ty == Type::Scalar(scalar),
            Self::PerAxis => real(ty) && ty.slots() as usize == size,
            Self::PerAxisAnd(more) => real(ty) && ty.slots() as usize == size + more as usize,
            Self::PerTerminal(scalar) => {
                matches!(ty, Type::Array(own, count) if own == scalar && count as usize <= size)
            }
            Self::Reals(cells) => real(ty) && ty.slots() == cells,
        }
    }
}

/// Name, kind and type of a port: the columns that all port tables have.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PortSpec {
    pub(crate) name: &'static str,
    pub(crate) kind: PortKind,
    pub(crate) value: PortValue,
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
    pub ty: String,
    /// True if there is one port for each axis or terminal.
    pub indexed: bool,
}

impl PortSpec {
    pub(crate) fn info(&self) -> PortInfo {
        let carries = match self.value {
            PortValue::One(scalar) => scalar.name().to_owned(),
            PortValue::PerAxis => "real^n".to_owned(),
            PortValue::PerAxisAnd(more) => format!("real^(n+{more})"),
            PortValue::PerTerminal(scalar) => format!("{}^n", scalar.name()),
            PortValue::Reals(cells) => format!("real^{cells}"),
        };
        PortInfo {
            name: self.name,
            kind: self.kind,
            ty: carries,
            indexed: self.indexed,
        }
    }
}

/// Finds a port in a table. `size` returns the number of axes or terminals of a row.
pub(crate) fn find_port<'a>(
    table: impl Iterator<Item = &'a PortSpec>,
    name: &PortQuery<'_>,
    size: impl Fn(usize) -> usize,
) -> Result<PortIndex, ResolveError> {
    let named = table
        .enumerate()
        .filter(|(_, head)| head.name == name.port && head.kind == name.kind);
    let mut error = ResolveError::UnknownPort;
    for (line, head) in named {
        let index = usize::try_from(name.index).unwrap_or(usize::MAX);
        let size = size(line);
        if head.indexed && index >= size {
            error = ResolveError::IndexOutOfRange;
        } else if !head.value.fits(name.ty, size) {
            error = ResolveError::WrongType;
        } else {
            let index = if head.indexed { index } else { 0 };
            let narrow =
                |number: usize| u16::try_from(number).map_err(|_| ResolveError::IndexOutOfRange);
            return Ok(PortIndex {
                row: narrow(line)?,
                index: narrow(index)?,
            });
        }
    }
    Err(error)
}

/// True if a port is within its table row; `size` returns the number of axes or terminals of a row.
pub(crate) fn is_in_row(
    head: Option<&PortSpec>,
    slot: PortIndex,
    size: impl Fn(usize) -> usize,
) -> bool {
    head.is_some_and(|head| match head.indexed {
        true => usize::from(slot.index) < size(usize::from(slot.row)),
        false => slot.index == 0,
    })
}

/// Writer of values to consecutive memory slots. Values beyond the end are dropped.
pub(crate) struct SlotWriter<'a> {
    cells: &'a mut [u64],
    at: usize,
}

impl<'a> SlotWriter<'a> {
    pub(crate) fn new(cells: &'a mut [u64]) -> Self {
        Self { cells, at: 0 }
    }

    pub(crate) fn put_bits(&mut self, bits: u64) {
        if let Some(cell) = self.cells.get_mut(self.at) {
            *cell = bits;
        }
        self.at += 1;
    }

    pub(crate) fn put_real(&mut self, value: f64) {
        self.put_bits(value.to_bits());
    }

    pub(crate) fn put_reals(&mut self, values: impl IntoIterator<Item = f64>) {
        values.into_iter().for_each(|value| self.put_real(value));
    }

    pub(crate) fn put_pose(&mut self, pose: &rpi_kin::Pose) {
        self.put_reals(pose.translation.vector.iter().copied());
        // nalgebra stores quaternions as x, y, z, w, the same order as in memory slots.
        self.put_reals(pose.rotation.coords.iter().copied());
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
pub(crate) fn split_numbered_name(port: &str) -> Option<(&'static str, u32)> {
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

/// Row of the port table of a small device, which has sensors and a single actuator.
pub(crate) struct PortRow<D: 'static> {
    pub(crate) spec: PortSpec,
    /// Reads a sensor; `None` for the actuator.
    read: Option<fn(&D, usize, &mut SlotWriter<'_>)>,
}

impl<D> PortRow<D> {
    /// A row for a sensor.
    pub(crate) const fn sensor(
        name: &'static str,
        scalar: Scalar,
        read: fn(&D, usize, &mut SlotWriter<'_>),
    ) -> Self {
        let head = PortSpec {
            name,
            kind: PortKind::Sensor,
            value: PortValue::One(scalar),
            indexed: false,
        };
        Self {
            spec: head,
            read: Some(read),
        }
    }

    /// A row for an actuator.
    pub(crate) const fn actuator(name: &'static str, scalar: Scalar) -> Self {
        let head = PortSpec {
            name,
            kind: PortKind::Actuator,
            value: PortValue::One(scalar),
            indexed: false,
        };
        Self {
            spec: head,
            read: None,
        }
    }

    /// The same row, with one port for each index.
    pub(crate) const fn indexed(self) -> Self {
        Self {
            spec: PortSpec {
                indexed: true,
                ..self.spec
            },
            ..self
        }
    }
}

/// Reads a port of a small device into `value`; false if the port is not a sensor.
pub(crate) fn read_port<D>(
    table: &[PortRow<D>],
    device: &D,
    slot: PortIndex,
    value: &mut [u64],
) -> bool {
    let read = table.get(usize::from(slot.row)).and_then(|line| line.read);
    read.map(|read| read(device, usize::from(slot.index), &mut SlotWriter::new(value)))
        .is_some()
}

/// True if a port of a small device is an actuator.
pub(crate) fn is_actuator<D>(table: &[PortRow<D>], slot: PortIndex) -> bool {
    table
        .get(usize::from(slot.row))
        .is_some_and(|line| line.read.is_none())
}
