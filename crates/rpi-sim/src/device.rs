//! Port tables of devices: names, kinds and types of ports, and access to them.

pub(crate) use rpi_device::{Device, PortIndex, Report};
use rpi_device::{PortKind, PortQuery, ResolveError};
use rpi_image::{Scalar, Type};

/// Type of the value of a port, which may depend on the number of axes or terminals of the device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PortValue {
    /// One value of this scalar type.
    One(Scalar),
    /// One real for each axis.
    PerAxis,
    /// One real for each axis, and this number of further slots of any type: the result of a function.
    PerAxisAnd(u32),
    /// One value of this type for each terminal, or for the first terminals.
    PerTerminal(Scalar),
    /// This number of reals: the concatenated in-ports or out-ports of a primitive (a basic operation of a net).
    Reals(u32),
}

impl PortValue {
    /// True if a command can use the port with the type `ty`. `size` is the number of axes or terminals. Values
    /// composed of several parts are compared by size only, because the parts are concatenated whatever their types.
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

/// Name, kind and type of a port: the columns that the port tables of all devices have.
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
    /// Kind of the port: commands read a sensor, write an actuator and call a function.
    pub kind: PortKind,
    /// Type of the value of the port, such as `real`, `Pose` or `real^n`, with n the number of axes.
    pub ty: String,
    /// True if there is one port for each axis or terminal.
    pub indexed: bool,
    /// Meaning of the value with its unit; empty for ports that are explained elsewhere in the manual.
    pub meaning: &'static str,
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
            meaning: "",
        }
    }
}

/// Finds the port with this name, kind and type in a port table. `size` returns the number of axes or terminals for a
/// row.
///
/// # Errors
/// Returns the reason if the table has no such port.
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

/// True if the index of a port is valid in its row `head` of the port table. `size` returns the number of axes or
/// terminals for a row. False if there is no row.
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

/// Reads a real from the slot with index `at`; NaN if the slot is missing, so that no missing value is accepted as a
/// set-point.
pub(crate) fn real_at(slots: &[u64], at: usize) -> f64 {
    slots.get(at).map_or(f64::NAN, |bits| f64::from_bits(*bits))
}

/// Reads a pose from seven slots: position (m), then quaternion as x, y, z, w. Missing slots read as NaN.
pub(crate) fn pose_from(slots: &[u64]) -> rpi_kin::Pose {
    let part = |at: usize| real_at(slots, at);
    let quaternion = nalgebra::Quaternion::new(part(6), part(3), part(4), part(5));
    rpi_kin::Pose::from_parts(
        nalgebra::Translation3::new(part(0), part(1), part(2)),
        nalgebra::UnitQuaternion::new_normalize(quaternion),
    )
}

/// Splits a port name that contains a number into name and index: `joint3.measured_torque` is `joint.measured_torque`
/// with index 2. `None` for other names.
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

/// Row of the port table of a device `D`: a port that is a sensor or an actuator.
pub(crate) struct PortRow<D: 'static> {
    pub(crate) spec: PortSpec,
    /// Function that reads the sensor into slots, for the index of the port; `None` for an actuator.
    read: Option<fn(&D, usize, &mut SlotWriter<'_>)>,
    /// Meaning of the value with its unit, for the manual.
    pub(crate) meaning: &'static str,
}

impl<D> PortRow<D> {
    /// Creates a row for a sensor whose value the function `read` writes.
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
            meaning: "",
        }
    }

    /// Creates a row for an actuator.
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
            meaning: "",
        }
    }

    /// Returns this row with the meaning of the port for the manual.
    pub(crate) const fn means(self, meaning: &'static str) -> Self {
        Self { meaning, ..self }
    }

    /// Returns this row for a port that exists once for each index, such as `input[3]`.
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

/// Reads the sensor with the address `slot` of a device into `value`, as slots; false if there is no such sensor.
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

/// True if the port with the address `slot` is an actuator.
pub(crate) fn is_actuator<D>(table: &[PortRow<D>], slot: PortIndex) -> bool {
    table
        .get(usize::from(slot.row))
        .is_some_and(|line| line.read.is_none())
}
