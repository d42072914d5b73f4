//! Motions of all kinds take each other over at random moments: the arm accepts every set-point, and whatever ends a motion, the
//! next one begins from there. In between, set-points are left out, so that the arm stops on its own.

use rpi_device::{DeviceBank, PortId, PortKind, PortQuery, Rejection};
use rpi_image::{Scalar, Type};
use rpi_sim::error_code::ErrorCode;
use rpi_sim::{Cell, SimBank};

const TICK: f64 = 1e-3;
const AXES: usize = 6;
const HOME: [f64; AXES] = [0.0, -1.57, 1.57, 0.0, 1.57, 0.0];
const SLOTS: usize = AXES + 14;
/// Slots of the result of `follow_chunks`, which reports more.
const CHUNK_SLOTS: usize = SLOTS + 10;
/// Rows of a chunk.
const ROWS: usize = 20;

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

    fn joints(&mut self, most: f64) -> Vec<f64> {
        HOME.iter()
            .map(|home| home + self.between(-most, most))
            .collect()
    }
}

/// Motion functions, and whether their target is read in each cycle.
const FUNCTIONS: [(&str, bool); 11] = [
    ("move_line", false),
    ("move_arc_by_angle", false),
    ("move_spline", false),
    ("move_joints", false),
    ("move_axes", false),
    ("follow_joints", true),
    ("move_at_velocity", true),
    ("hold", false),
    ("follow_chunks", true),
    ("move_tool_in_base", true),
    ("move_tool_in_tool", true),
];

fn slots_of(function: &str) -> usize {
    match function {
        "follow_chunks" => CHUNK_SLOTS,
        _ => SLOTS,
    }
}

/// A random chunk: a walk from a random place, with a number of its own.
fn chunk(random: &mut Random) -> Vec<u64> {
    let mut place = random.joints(0.4);
    let mut positions = Vec::new();
    for _ in 0..ROWS {
        place
            .iter_mut()
            .for_each(|joint| *joint += random.between(-0.02, 0.02));
        positions.extend(place.iter().map(|joint| joint.to_bits()));
    }
    let number = random.between(1.0, 1e12) as u64;
    let (age, weight) = (random.between(0.0, 0.3), random.between(0.0, 0.9));
    let appended = u64::from(random.between(0.0, 1.0) < 0.2);
    let mut slots = vec![
        number,
        ROWS as u64,
        0.03f64.to_bits(),
        age.to_bits(),
        appended,
    ];
    slots.extend([weight.to_bits(), 3, 0.01f64.to_bits(), 0]);
    slots.extend(&positions);
    // Velocities, which are not used.
    slots.extend(vec![0; positions.len()]);
    slots
}

struct Rig {
    bank: SimBank,
    functions: Vec<PortId>,
    joints: PortId,
    pose: PortId,
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
        let functions = FUNCTIONS.map(|(name, _)| {
            let result = Type::Array(Scalar::Real, slots_of(name) as u32);
            port(name, PortKind::Function, result)
        });
        let all = Type::Array(Scalar::Real, AXES as u32);
        Self {
            functions: functions.to_vec(),
            joints: port("joints", PortKind::Actuator, all),
            pose: port("pose", PortKind::Sensor, Type::Scalar(Scalar::Pose)),
            bank,
        }
    }

    fn pose(&mut self) -> [f64; 7] {
        let mut slots = [0; 7];
        assert!(self.bank.read(self.pose, &mut slots));
        slots.map(f64::from_bits)
    }

    /// A random target of a function.
    fn target(&mut self, function: usize, random: &mut Random) -> Vec<u64> {
        let here = self.pose();
        let mut moved = |most: f64| {
            let mut pose = here;
            let by = random.vector(most);
            pose.iter_mut().zip(by).for_each(|(slot, by)| *slot += by);
            pose
        };
        let target: Vec<f64> = match FUNCTIONS[function].0 {
            "move_line" => moved(0.1).to_vec(),
            "move_spline" => [moved(0.06), moved(0.1), moved(0.15)].concat(),
            "move_arc_by_angle" => {
                let (centre, axis) = (moved(0.1), random.vector(1.0));
                [&centre[..3], &axis, &[random.between(-9.0, 9.0), 0.0]].concat()
            }
            "move_joints" | "move_axes" => random.joints(0.4),
            "follow_joints" => [random.joints(0.4), random.vector(0.5).repeat(2)].concat(),
            "move_at_velocity" => random.vector(1.0).repeat(2),
            "hold" => Vec::new(),
            "follow_chunks" => return chunk(random),
            _ => [random.vector(0.2), random.vector(0.5)].concat(),
        };
        let mut slots: Vec<u64> = target.iter().map(|value| value.to_bits()).collect();
        if FUNCTIONS[function].0 == "move_arc_by_angle"
            && let Some(turning) = slots.last_mut()
        {
            *turning = u64::from(random.between(0.0, 1.0) < 0.5);
        }
        slots
    }

    fn call(&mut self, function: usize, number: u64, target: &[u64]) -> Vec<u64> {
        let bounds = match FUNCTIONS[function].0 {
            "move_joints" | "move_axes" | "follow_joints" | "move_at_velocity"
            | "follow_chunks" => [1.5, 4.0, 60.0],
            _ => [0.25, 1.0, 15.0],
        };
        let mut arguments = vec![number];
        arguments.extend(target);
        arguments.extend(bounds.map(f64::to_bits));
        arguments.extend([1f64.to_bits(), 0]);
        // The arm's own tool.
        arguments.extend([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0].map(f64::to_bits));
        let mut result = vec![0; slots_of(FUNCTIONS[function].0)];
        assert!(
            self.bank
                .call(self.functions[function], &arguments, &mut result)
        );
        result
    }
}

/// Runs random motions in turn.
fn chain(seed: u64) {
    let (mut rig, mut random) = (Rig::new(), Random(seed));
    let mut number = 0;
    for motion in 0..30 {
        let function = random.between(0.0, FUNCTIONS.len() as f64) as usize;
        let mut target = rig.target(function, &mut random);
        let most = if random.between(0.0, 1.0) < 0.4 {
            20.0
        } else {
            900.0
        };
        for cycle in 0..random.between(1.0, most) as u32 {
            if FUNCTIONS[function].1 && cycle % 100 == 99 {
                target = rig.target(function, &mut random);
            }
            let result = rig.call(function, if cycle == 0 { 0 } else { number }, &target);
            number = result[0];
            let joints = &result[1..=AXES];
            let name = FUNCTIONS[function].0;
            let rejection = rig.bank.check_set_point(rig.joints, joints);
            let mut reports = Vec::new();
            rig.bank.reports(|_, report| reports.push(report));
            assert_eq!(
                rejection,
                Rejection::NONE,
                "{seed} {motion} {name} {cycle}: {reports:?}"
            );
            rig.bank.write(rig.joints, joints);
            rig.bank.step();
        }
        if random.between(0.0, 1.0) < 0.1 {
            left_alone(&mut rig, seed);
        }
    }
}

/// Sends no set-point until the arm has stopped on its own.
fn left_alone(rig: &mut Rig, seed: u64) {
    (0..3000).for_each(|_| rig.bank.step());
    let before = rig.pose();
    rig.bank.step();
    assert_eq!(before, rig.pose(), "{seed}");
    let mut codes = Vec::new();
    rig.bank.reports(|_, report| codes.push(report.code));
    let limits = [
        ErrorCode::POSITION,
        ErrorCode::VELOCITY,
        ErrorCode::ACCELERATION,
        ErrorCode::JERK,
    ];
    assert!(
        codes.iter().all(|code| !limits.contains(code)),
        "{seed}: {codes:?}"
    );
}

#[test]
fn motions_of_all_kinds_take_each_other_over() {
    (1..=30).for_each(|seed| chain(seed * 7_919));
}
