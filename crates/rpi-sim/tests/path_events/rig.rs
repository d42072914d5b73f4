//! An arm whose motions have events, called as a program calls it.

use rpi_device::{DeviceBank, PortId, PortKind, PortQuery, Rejection};
use rpi_image::{Scalar, Type};
use rpi_sim::error_code::ErrorCode;
use rpi_sim::{Cell, Report, SimBank};

use crate::{AXES, HOME, SLOTS, TICK};

/// Xorshift generator (Marsaglia 2003).
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        low + (high - low) * ((self.0 >> 11) as f64 / (1u64 << 53) as f64)
    }

    pub(crate) fn vector(&mut self, most: f64) -> [f64; 3] {
        [0; 3].map(|_| self.between(-most, most))
    }
}

/// An arm whose motions have events.
pub(crate) struct Rig {
    pub(crate) bank: SimBank,
    pub(crate) event: PortId,
    pub(crate) joints: PortId,
    pub(crate) pose: PortId,
    /// Joint positions of the last set-point, rad.
    pub(crate) last: [f64; AXES],
}

/// Result of a motion function.
pub(crate) struct Motion {
    pub(crate) number: u64,
    pub(crate) joints: Vec<u64>,
    pub(crate) travelled: f64,
    pub(crate) speed: f64,
    pub(crate) done: bool,
}

/// A motion function and its target.
pub(crate) struct Order {
    pub(crate) function: PortId,
    pub(crate) target: Vec<f64>,
    pub(crate) bounds: [f64; 3],
}

/// Place of an event: origin and point as numbers, offset and share.
#[derive(Clone, Copy)]
pub(crate) struct Place {
    pub(crate) origin: u64,
    pub(crate) point: u64,
    pub(crate) offset: f64,
    pub(crate) share: f64,
}

impl Place {
    pub(crate) fn at(offset: f64) -> Self {
        Self {
            origin: 0,
            point: 0,
            offset,
            share: 0.0,
        }
    }
}

/// Answer of `path_event`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Answer {
    pub(crate) passed: bool,
    pub(crate) time: f64,
    pub(crate) error: ErrorCode,
}

impl Rig {
    pub(crate) fn new() -> Self {
        let text = format!(
            "[devices.arm]\nkind = \"arm\"\nmodel = \"kuka-kr6-r900\"\njoints = {HOME:?}\n"
        );
        let cell = Cell::parse("cell.toml", &text).unwrap_or_else(|errors| panic!("{errors}"));
        let mut bank = SimBank::new(&cell, TICK);
        let mut port = |port, kind, ty| resolve(&mut bank, port, kind, ty);
        let event = port(
            "path_event",
            PortKind::Function,
            Type::Array(Scalar::Real, 3),
        );
        let all = Type::Array(Scalar::Real, AXES as u32);
        let joints = port("joints", PortKind::Actuator, all);
        let pose = port("pose", PortKind::Sensor, Type::Scalar(Scalar::Pose));
        Self {
            event,
            joints,
            pose,
            bank,
            last: HOME,
        }
    }

    pub(crate) fn order(&mut self, name: &str, target: Vec<f64>, bounds: [f64; 3]) -> Order {
        let ty = Type::Array(Scalar::Real, SLOTS as u32);
        Order {
            function: resolve(&mut self.bank, name, PortKind::Function, ty),
            target,
            bounds,
        }
    }

    /// The pose of the tool, moved by an offset, m.
    pub(crate) fn moved(&mut self, by: [f64; 3]) -> Vec<f64> {
        let mut slots = [0; 7];
        assert!(self.bank.read(self.pose, &mut slots));
        let mut pose = slots.map(f64::from_bits).to_vec();
        pose.iter_mut().zip(by).for_each(|(slot, by)| *slot += by);
        pose
    }

    pub(crate) fn call(&mut self, order: &Order, number: u64, share: f64, paused: bool) -> Motion {
        let mut arguments = vec![number];
        let numbers = order.target.iter().chain(&order.bounds);
        arguments.extend(numbers.map(|value| value.to_bits()));
        arguments.extend([share.to_bits(), u64::from(paused)]);
        arguments.extend([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0].map(f64::to_bits));
        let mut result = [0; SLOTS];
        assert!(self.bank.call(order.function, &arguments, &mut result));
        Motion {
            number: result[0],
            joints: result[1..=AXES].to_vec(),
            travelled: f64::from_bits(result[AXES + 8]),
            speed: f64::from_bits(result[AXES + 10]),
            done: result[AXES + 12] != 0,
        }
    }

    pub(crate) fn event(&mut self, motion: u64, place: Place, pending: bool) -> Answer {
        let arguments = [
            motion,
            place.origin,
            place.point,
            place.offset.to_bits(),
            place.share.to_bits(),
            u64::from(pending),
        ];
        let mut result = [0; 3];
        assert!(self.bank.call(self.event, &arguments, &mut result));
        Answer {
            passed: result[0] != 0,
            time: f64::from_bits(result[1]),
            error: ErrorCode(result[2].cast_signed()),
        }
    }

    pub(crate) fn follow(&mut self, motion: &Motion) {
        let rejection = self.bank.check_set_point(self.joints, &motion.joints);
        assert_eq!(rejection, Rejection::NONE, "{:?}", self.reports());
        self.bank.write(self.joints, &motion.joints);
        self.bank.step();
        for (last, joint) in self.last.iter_mut().zip(&motion.joints) {
            *last = f64::from_bits(*joint);
        }
    }

    pub(crate) fn reports(&mut self) -> Vec<Report> {
        let mut reports = Vec::new();
        self.bank.reports(|_, report| reports.push(report));
        reports
    }
}

pub(crate) fn resolve(bank: &mut SimBank, port: &str, kind: PortKind, ty: Type) -> PortId {
    let query = PortQuery {
        device: "arm",
        port,
        index: 0,
        kind,
        ty,
    };
    bank.resolve(&query).expect("the port exists")
}
