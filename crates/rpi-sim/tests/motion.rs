//! Motions planned by a simulated arm, called as a program calls them: limits, takeover, the stop on the path, and the
//! way back from beyond a range.

use rpi_device::{DeviceBank, PortId, PortKind, PortQuery, Rejection};
use rpi_image::{Scalar, Type};
use rpi_sim::error_code::ErrorCode;
use rpi_sim::{Cell, Report, SimBank};

const TICK: f64 = 1e-3;
const AXES: usize = 6;
const HOME: [f64; AXES] = [0.0, -1.57, 1.57, 0.0, 1.57, 0.0];
/// Slots of a result: number, joints, pose, travelled, progress, speed, on the path, done, error.
const SLOTS: usize = AXES + 14;

struct Rig {
    bank: SimBank,
    move_line: PortId,
    move_joints: PortId,
    joints: PortId,
    pose: PortId,
}

/// Result of a call.
struct Motion {
    number: u64,
    joints: Vec<u64>,
    speed: f64,
    done: bool,
    error: ErrorCode,
}

impl Rig {
    fn new() -> Self {
        let text = format!(
            "[devices.arm]\nkind = \"arm\"\nmodel = \"kuka-kr6-r900\"\njoints = {HOME:?}\n"
        );
        let cell = Cell::parse("cell.toml", &text).unwrap_or_else(|errors| panic!("{errors}"));
        let mut bank = SimBank::new(&cell, TICK);
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
        let result = Type::Array(Scalar::Real, SLOTS as u32);
        let [move_line, move_joints] =
            ["move_line", "move_joints"].map(|name| port(name, PortKind::Function, result));
        let all = Type::Array(Scalar::Real, AXES as u32);
        let joints = port("joints", PortKind::Actuator, all);
        let pose = port("pose", PortKind::Sensor, Type::Scalar(Scalar::Pose));
        Self {
            bank,
            move_line,
            move_joints,
            joints,
            pose,
        }
    }

    fn call(&mut self, port: PortId, number: u64, target: &[f64], bounds: [f64; 3]) -> Motion {
        let mut arguments = vec![number];
        arguments.extend(target.iter().chain(&bounds).map(|value| value.to_bits()));
        arguments.extend([1f64.to_bits(), 0]);
        // The arm's own tool.
        arguments.extend([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0].map(f64::to_bits));
        let mut result = [0; SLOTS];
        assert!(self.bank.call(port, &arguments, &mut result));
        Motion {
            number: result[0],
            joints: result[1..=AXES].to_vec(),
            speed: f64::from_bits(result[AXES + 10]),
            done: result[AXES + 12] != 0,
            error: ErrorCode(result[AXES + 13].cast_signed()),
        }
    }

    fn line(&mut self, number: u64, to: &[f64]) -> Motion {
        self.call(self.move_line, number, to, [0.25, 0.5, 5.0])
    }

    fn point_to_point(&mut self, number: u64, to: &[f64]) -> Motion {
        self.call(self.move_joints, number, to, [0.8, 1.6, 16.0])
    }

    fn pose(&mut self) -> Vec<f64> {
        let mut slots = [0; 7];
        assert!(self.bank.read(self.pose, &mut slots));
        slots.map(f64::from_bits).to_vec()
    }

    /// Sends the set-point of a motion, which the arm must accept.
    fn follow(&mut self, motion: &Motion) {
        let rejection = self.bank.check_set_point(self.joints, &motion.joints);
        assert_eq!(rejection, Rejection::NONE, "{:?}", self.reports());
        self.bank.write(self.joints, &motion.joints);
        self.bank.step();
    }

    fn reports(&mut self) -> Vec<Report> {
        let mut reports = Vec::new();
        self.bank.reports(|_, report| reports.push(report));
        reports
    }
}

/// The pose moved by an offset in y and z, m.
fn moved(pose: &[f64], y: f64, z: f64) -> Vec<f64> {
    let mut to = pose.to_vec();
    (to[1], to[2]) = (to[1] + y, to[2] + z);
    to
}

#[test]
fn a_line_takes_over_in_motion_within_all_limits_and_arrives() {
    let mut rig = Rig::new();
    let home = rig.pose();
    let (first, second) = (moved(&home, 0.3, 0.0), moved(&home, 0.1, -0.2));
    let mut number = 0;
    for _ in 0..700 {
        let motion = rig.line(number, &first);
        number = motion.number;
        rig.follow(&motion);
    }
    let mut motion = rig.line(0, &second);
    assert_ne!(motion.number, number);
    let old = rig.line(number, &first);
    assert_eq!(old.error, ErrorCode::SUPERSEDED);
    for _ in 0..5000 {
        rig.follow(&motion);
        motion = rig.line(motion.number, &second);
        if motion.done {
            break;
        }
    }
    assert!(motion.done && motion.error == ErrorCode::OK);
    for (at, to) in rig.pose().iter().zip(&second).take(3) {
        assert!((at - to).abs() < 1e-9, "{at} {to}");
    }
    assert!(rig.reports().is_empty());
}

#[test]
fn a_path_out_of_reach_is_refused_before_the_arm_moves() {
    let mut rig = Rig::new();
    let home = rig.pose();
    let motion = rig.line(0, &moved(&home, 2.0, 0.0));
    assert_eq!(motion.error, ErrorCode::PATH_OUT_OF_REACH);
    assert_eq!(motion.speed, 0.0);
    rig.follow(&motion);
    assert_eq!(rig.pose(), home);
    let [report] = rig.reports()[..] else {
        panic!("one report");
    };
    assert!(
        report.value > 0.1 && report.value < report.limit,
        "{report:?}"
    );
}

/// Without set-points the arm stops on the line that it was on.
#[test]
fn an_arm_left_alone_stays_on_its_path() {
    let mut rig = Rig::new();
    let home = rig.pose();
    let to = moved(&home, 0.3, -0.3);
    let mut number = 0;
    for _ in 0..600 {
        let motion = rig.line(number, &to);
        number = motion.number;
        rig.follow(&motion);
    }
    let resource = rig.bank.resource(rig.joints);
    let start = rig.pose();
    for _ in 0..3000 {
        rig.bank.step();
        let at = rig.pose();
        let off = (at[1] - home[1]) + (at[2] - home[2]);
        assert!(off.abs() < 1e-9 && (at[0] - home[0]).abs() < 1e-9, "{off}");
    }
    assert!(!rig.bank.is_moving(resource));
    assert!(rig.pose()[1] > start[1] + 0.01, "it needed a way to stop");
    let codes: Vec<ErrorCode> = rig.reports().iter().map(|report| report.code).collect();
    assert!(
        codes
            .iter()
            .all(|code| *code == ErrorCode::SET_POINT_MISSING),
        "{codes:?}"
    );
}

/// An axis that was driven up to its end by set-points, and braked beyond it, can be moved back.
#[test]
fn an_axis_beyond_its_range_can_move_back() {
    let mut rig = Rig::new();
    let mut joints = HOME;
    let (mut velocity, mut acceleration) = (0.0f64, 0.0f64);
    loop {
        acceleration = (acceleration + 20.0 * TICK).min(2.0);
        velocity += acceleration * TICK;
        joints[4] += velocity * TICK;
        let value: Vec<u64> = joints.map(f64::to_bits).to_vec();
        if rig.bank.check_set_point(rig.joints, &value) != Rejection::NONE {
            break;
        }
        rig.bank.write(rig.joints, &value);
        rig.bank.step();
    }
    for _ in 0..3000 {
        rig.bank.step();
    }
    let codes: Vec<ErrorCode> = rig.reports().iter().map(|report| report.code).collect();
    assert!(codes.contains(&ErrorCode::POSITION), "{codes:?}");
    let mut motion = rig.point_to_point(0, &HOME);
    for _ in 0..5000 {
        rig.follow(&motion);
        motion = rig.point_to_point(motion.number, &HOME);
        if motion.done {
            break;
        }
    }
    assert!(motion.done, "{:?}", motion.error);
}
