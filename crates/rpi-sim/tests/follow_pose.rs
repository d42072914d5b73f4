//! A line of the tool with the way of a belt added to it, for random arms, starts and belts: the arm accepts every set-point of
//! `follow_pose`, although neither the line nor the belt knows of the other, and the belt may jump.

use rpi_device::{DeviceBank, PortId, PortKind, PortQuery, Rejection};
use rpi_image::{Scalar, Type};
use rpi_sim::error_code::ErrorCode;
use rpi_sim::{Cell, SimBank};

const TICK: f64 = 1e-3;

/// Models with their joint positions in the middle of the workspace.
const ARMS: [(&str, &[f64]); 3] = [
    ("kuka-lwr4+", &[0.0, -0.5, 0.0, 1.6, 0.0, -1.0, 0.0]),
    ("ur5e", &[3.1, -1.57, 1.57, -1.57, -1.57, 0.0]),
    ("kuka-kr6-r900", &[0.0, -1.57, 1.57, 0.0, 1.57, 0.0]),
];

/// Xorshift generator (Marsaglia 2003).
struct Random(u64);

impl Random {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        low + (high - low) * ((self.0 >> 11) as f64 / (1u64 << 53) as f64)
    }

    fn vector(&mut self, most: f64) -> [f64; 3] {
        [0; 3].map(|_| self.between(-most, most))
    }
}

struct Rig {
    bank: SimBank,
    line: PortId,
    follow: PortId,
    joints: PortId,
    pose: PortId,
    axes: usize,
}

impl Rig {
    fn new(model: &str, start: &[f64]) -> Self {
        let text =
            format!("[devices.arm]\nkind = \"arm\"\nmodel = \"{model}\"\njoints = {start:?}\n");
        let cell = Cell::parse("cell.toml", &text).unwrap_or_else(|errors| panic!("{errors}"));
        let mut bank = SimBank::new(&cell, TICK);
        let axes = start.len();
        let reals = |count: usize| Type::Array(Scalar::Real, count as u32);
        let mut port = |port, kind, ty| {
            let query = PortQuery {
                device: "arm",
                port,
                index: 0,
                kind,
                ty,
            };
            bank.resolve(&query).expect("the port exists")
        };
        Self {
            line: port("move_line", PortKind::Function, reals(axes + 14)),
            follow: port("follow_pose", PortKind::Function, reals(axes + 8)),
            joints: port("joints", PortKind::Actuator, reals(axes)),
            pose: port("pose", PortKind::Sensor, Type::Scalar(Scalar::Pose)),
            axes,
            bank,
        }
    }

    fn pose(&mut self) -> [f64; 7] {
        let mut slots = [0; 7];
        assert!(self.bank.read(self.pose, &mut slots));
        slots.map(f64::from_bits)
    }

    /// Returns the number of the motion on the line, and the pose of its tool.
    fn line(&mut self, number: u64, to: &[f64; 7], bounds: [f64; 3]) -> (u64, [f64; 7]) {
        let mut arguments = vec![number];
        arguments.extend(to.map(f64::to_bits));
        arguments.extend(bounds.map(f64::to_bits));
        arguments.extend([1f64.to_bits(), 0]);
        // The arm's own tool.
        arguments.extend([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0].map(f64::to_bits));
        let mut result = vec![0; self.axes + 14];
        assert!(self.bank.call(self.line, &arguments, &mut result));
        let pose = core::array::from_fn(|k| f64::from_bits(result[1 + self.axes + k]));
        (result[0], pose)
    }

    /// Follows a pose for a cycle. Returns the error code.
    fn follow(&mut self, to: &[f64; 7]) -> i64 {
        let mut result = vec![0; self.axes + 8];
        let found = self
            .bank
            .call(self.follow, &to.map(f64::to_bits), &mut result);
        assert!(found);
        let joints = &result[..self.axes];
        assert_eq!(
            self.bank.check_set_point(self.joints, joints),
            Rejection::NONE
        );
        self.bank.write(self.joints, joints);
        self.bank.step();
        result[self.axes + 7].cast_signed()
    }
}

/// Returns the number of cycles in which the arm could not reach the pose.
fn run((model, middle): (&str, &[f64]), seed: u64) -> usize {
    let mut random = Random(seed * 7919 + 1);
    let start: Vec<f64> = middle
        .iter()
        .map(|joint| joint + random.between(-0.4, 0.4))
        .collect();
    let mut rig = Rig::new(model, &start);
    let direction = random.vector(1.0);
    let bounds = [0.4, random.between(0.5, 4.0), random.between(5.0, 80.0)];
    let (mut ride, mut speed, mut wanted) = (0.0, 0.0, random.between(-0.3, 0.3));
    let is_smooth = random.between(0.0, 1.0) < 0.7;
    let (mut number, mut out_of_reach) = (0, 0);
    let mut to = rig.pose();
    for cycle in 0..2500 {
        if cycle % 900 == 0 {
            to = rig.pose();
            let by = random.vector(0.15);
            to.iter_mut().zip(by).for_each(|(slot, by)| *slot += by);
            number = 0;
            ride = 0.0;
        }
        if cycle % 700 == 350 {
            wanted = random.between(-0.3, 0.3);
        }
        speed = match is_smooth {
            true => speed + f64::clamp(wanted - speed, -1e-3, 1e-3),
            false => wanted,
        };
        ride += speed * TICK;
        let (next, mut pose) = rig.line(number, &to, bounds);
        number = next;
        pose.iter_mut()
            .zip(direction)
            .for_each(|(slot, part)| *slot += part * ride);
        let code = rig.follow(&pose);
        out_of_reach += usize::from(code != ErrorCode::OK.0);
    }
    out_of_reach
}

#[test]
fn every_set_point_on_a_random_belt_is_accepted() {
    for arm in ARMS {
        let runs: Vec<usize> = (1..=12).map(|seed| run(arm, seed)).collect();
        let reached = runs.iter().filter(|count| **count == 0).count();
        assert!(reached >= 3, "{}: {runs:?}", arm.0);
    }
}
