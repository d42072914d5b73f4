//! An arm with its ports, for the tests.

use rpi_device::{DeviceBank, PortId, PortKind, PortQuery, Rejection};
use rpi_image::{Scalar, Type};
use rpi_sim::error_code::ErrorCode;
use rpi_sim::{Cell, Report, SimBank};

pub(crate) const TICK: f64 = 1e-3;

/// A simulated arm and the ports of its joints.
pub(crate) struct Rig {
    pub(crate) bank: SimBank,
    pub(crate) joints: [PortId; 7],
    pub(crate) positions: [PortId; 7],
}

impl Rig {
    pub(crate) fn new(extra: &str) -> Self {
        let text = format!("[devices.arm]\nkind = \"arm\"\nmodel = \"kuka-lwr4+\"\n{extra}");
        let cell = Cell::parse("cell.toml", &text).unwrap_or_else(|errors| panic!("{errors}"));
        let mut bank = SimBank::new(&cell, TICK);
        let real = Type::Scalar(Scalar::Real);
        let joints = std::array::from_fn(|axis| {
            port(&mut bank, "joint.position", axis, PortKind::Actuator, real)
        });
        let positions = std::array::from_fn(|axis| {
            port(
                &mut bank,
                "joint.measured_position",
                axis,
                PortKind::Sensor,
                real,
            )
        });
        Self {
            bank,
            joints,
            positions,
        }
    }

    pub(crate) fn sensor(&mut self, name: &str, axis: usize) -> PortId {
        port(
            &mut self.bank,
            name,
            axis,
            PortKind::Sensor,
            Type::Scalar(Scalar::Real),
        )
    }

    pub(crate) fn real(&mut self, port: PortId) -> Option<f64> {
        let mut cell = [0];
        self.bank
            .read(port, &mut cell)
            .then(|| f64::from_bits(cell[0]))
    }

    pub(crate) fn position(&mut self, axis: usize) -> f64 {
        self.real(self.positions[axis]).expect("a sample")
    }

    pub(crate) fn check(&mut self, axis: usize, target: f64) -> Rejection {
        self.bank
            .check_set_point(self.joints[axis], &[target.to_bits()])
    }

    pub(crate) fn error(&self, axis: usize) -> ErrorCode {
        ErrorCode(self.bank.error_code(self.joints[axis]))
    }

    /// Sends a set-point for one axis; the others hold their positions.
    pub(crate) fn set(&mut self, axis: usize, target: f64) {
        assert_eq!(
            self.check(axis, target),
            Rejection::NONE,
            "{target}: {}",
            self.error(axis)
        );
        self.bank.write(self.joints[axis], &[target.to_bits()]);
    }

    /// Sends a set-point for each axis and simulates a tick.
    pub(crate) fn all(&mut self, targets: [f64; 7]) {
        (0..7).for_each(|axis| self.set(axis, targets[axis]));
        self.bank.step();
    }

    pub(crate) fn reports(&mut self) -> Vec<Report> {
        let mut all = Vec::new();
        self.bank.reports(|_, report| all.push(report));
        all
    }
}

fn port(bank: &mut SimBank, name: &str, index: usize, kind: PortKind, ty: Type) -> PortId {
    let name = PortQuery {
        device: "arm",
        port: name,
        index: index as u32,
        kind,
        ty,
    };
    bank.resolve(&name)
        .unwrap_or_else(|error| panic!("{name:?}: {error:?}"))
}

/// Positions of an axis, tick by tick from 0, that accelerates with constant jerk and then holds the speed.
pub(crate) fn speed_up(jerk: f64, ticks: i32) -> impl Iterator<Item = f64> {
    let (mut position, mut velocity, mut acceleration) = (0.0, 0.0, 0.0);
    (0..ticks).map(move |tick| {
        // Positive jerk in the first half and negative in the second, so that it ends at constant speed.
        acceleration += if tick < ticks / 2 {
            jerk * TICK
        } else {
            -jerk * TICK
        };
        velocity += acceleration * TICK;
        position += velocity * TICK;
        position
    })
}
