//! The cell of the tests, and access to its ports.

use rpi_device::{DeviceBank, PortId, PortKind, PortQuery, ResolveError};
use rpi_image::{Scalar, Type};
use rpi_sim::{Cell, SimBank};

pub(crate) const CELL: &str = "
[devices.left]
kind = \"arm\"
model = \"kuka-lwr4+\"
joints = [0.1, -0.5, 0.2, 1.5, -0.3, -1.0, 0.4]
noise = 1e-5
latency = 0.003
tool = { position = [0, 0, 0.15] }

[devices.right]
kind = \"arm\"
model = \"kuka-iiwa-7\"

[devices.io]
kind = \"io\"
digital = { inputs = [true, false], outputs = 3, safe = [{ output = 1, value = true }], repeat = 1, script = [{ at = 0.25, input = 1, value = true }] }
analogue = { inputs = [1.5], outputs = [2.5], safe = [{ output = 0, value = -1 }] }
";

pub(crate) const REAL: Type = Type::Scalar(Scalar::Real);

pub(crate) const BOOL: Type = Type::Scalar(Scalar::Bool);

pub(crate) const POSE: Type = Type::Scalar(Scalar::Pose);

pub(crate) const JOINTS: Type = Type::Array(Scalar::Real, 7);

pub(crate) fn bank() -> SimBank {
    let cell = Cell::parse("cell.toml", CELL).unwrap_or_else(|errors| panic!("{errors}"));
    SimBank::new(&cell, 1e-3)
}

pub(crate) fn find(
    bank: &mut SimBank,
    device: &str,
    port: &str,
    index: u32,
    kind: PortKind,
    ty: Type,
) -> Result<PortId, ResolveError> {
    bank.resolve(&PortQuery {
        device,
        port,
        index,
        kind,
        ty,
    })
}

pub(crate) fn sensor(bank: &mut SimBank, device: &str, port: &str, index: u32, ty: Type) -> PortId {
    find(bank, device, port, index, PortKind::Sensor, ty)
        .unwrap_or_else(|error| panic!("{device}.{port}: {error:?}"))
}

pub(crate) fn actuator(
    bank: &mut SimBank,
    device: &str,
    port: &str,
    index: u32,
    ty: Type,
) -> PortId {
    find(bank, device, port, index, PortKind::Actuator, ty)
        .unwrap_or_else(|error| panic!("{device}.{port}: {error:?}"))
}

pub(crate) fn reals(bank: &mut SimBank, port: PortId, count: usize) -> Vec<f64> {
    let mut cells = vec![0; count];
    assert!(bank.read(port, &mut cells));
    cells.into_iter().map(f64::from_bits).collect()
}

pub(crate) fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|value| value.to_bits()).collect()
}
