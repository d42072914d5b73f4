//! Arms by the pose of their tool: set-points, kinematic functions, tool load.

use rpi_device::{DeviceBank, PortKind, Rejection};
use rpi_image::{Scalar, Type};
use rpi_sim::{Cell, SimBank};

use crate::cell::{JOINTS, POSE, REAL, actuator, bank, bits, find, reals, sensor};

#[test]
fn the_tool_can_be_set_as_a_pose_and_stands_where_it_was_told() {
    let mut bank = bank();
    let (tcp, pose) = (
        actuator(&mut bank, "left", "tcp", 0, POSE),
        sensor(&mut bank, "left", "pose", 0, POSE),
    );
    let twist = sensor(&mut bank, "left", "twist", 0, Type::Scalar(Scalar::Twist));
    let start = reals(&mut bank, pose, 7);
    let (mut velocity, mut acceleration) = (0.0, 0.0_f64);
    let mut target = start.clone();
    for _ in 0..300 {
        acceleration = (acceleration + 1e-3).min(0.05);
        velocity += 1e-3 * acceleration;
        target[0] += 1e-3 * velocity;
        assert_eq!(
            bank.check_set_point(tcp, &bits(&target)),
            Rejection::NONE,
            "{}",
            bank.error_code(tcp)
        );
        bank.write(tcp, &bits(&target));
        bank.step();
        let now = reals(&mut bank, pose, 7);
        assert!(
            now.iter()
                .zip(&target)
                .all(|(now, target)| (now - target).abs() < 1e-9),
            "{now:?} {target:?}"
        );
    }
    let moving = reals(&mut bank, twist, 6);
    assert!(
        (moving[0] - velocity).abs() < 1e-4,
        "{moving:?} at {velocity}"
    );
    assert!(moving[1..].iter().all(|part| part.abs() < 1e-4));
}

#[test]
fn a_pose_that_cannot_be_reached_is_refused() {
    let mut bank = bank();
    let tcp = actuator(&mut bank, "left", "tcp.position", 0, POSE);
    let far = bits(&[3.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
    assert_eq!(bank.check_set_point(tcp, &far), Rejection::ILLEGAL_VALUE);
    assert_eq!(
        bank.error_code(tcp),
        rpi_sim::error_code::ErrorCode::OUT_OF_REACH.0
    );
    assert_eq!(
        bank.check_set_point(tcp, &bits(&[f64::NAN; 7])),
        Rejection::ILLEGAL_VALUE
    );
    assert_eq!(
        bank.error_code(tcp),
        rpi_sim::error_code::ErrorCode::NOT_A_NUMBER.0
    );
    let mut reports = Vec::new();
    bank.reports(|device, report| reports.push((device.to_owned(), report.code.to_string())));
    let rejected: Vec<(&str, &str)> = reports
        .iter()
        .map(|(device, code)| (device.as_str(), code.as_str()))
        .collect();
    assert_eq!(
        rejected,
        [("left", "out-of-reach"), ("left", "not-a-number")]
    );
}

#[test]
fn kinematics_and_its_inverse_undo_each_other() {
    let mut bank = bank();
    let joints = [0.3, -0.6, 0.2, 1.2, -0.4, -0.8, 0.5];
    let forward =
        find(&mut bank, "left", "kinematics", 0, PortKind::Function, POSE).expect("a function");
    let inverse = find(
        &mut bank,
        "left",
        "inverse_kinematics",
        0,
        PortKind::Function,
        JOINTS,
    )
    .expect("a function");
    let elbow = find(
        &mut bank,
        "left",
        "inverse_kinematics_nullspace",
        0,
        PortKind::Function,
        JOINTS,
    )
    .expect("one");
    let mut pose = vec![0; 7];
    assert!(bank.call(forward, &bits(&joints), &mut pose));
    let with = |more: &[f64]| [pose.clone(), bits(more)].concat();
    let mut found = vec![0; 7];
    assert!(bank.call(
        inverse,
        &with(&joints.map(|joint| joint + 0.001)),
        &mut found
    ));
    let off = |found: &[u64]| {
        let each = found
            .iter()
            .zip(&joints)
            .map(|(bits, joint)| (f64::from_bits(*bits) - joint).abs());
        each.fold(0.0, f64::max)
    };
    assert!(off(&found) < 0.01);
    assert!(bank.call(elbow, &with(&[[0.0; 7], joints].concat()), &mut found));
    assert!(
        off(&found) < 1e-9,
        "the elbow of the joints, not of the hint"
    );
    assert!(
        !bank.call(inverse, &with(&[0.0; 3]), &mut found),
        "a hint too short"
    );
    let far = bits(&[9.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
    assert!(!bank.call(inverse, &[far, bits(&joints)].concat(), &mut found));
}

#[test]
fn velocities_of_joints_are_those_of_the_tool_and_the_elbow() {
    let mut bank = bank();
    let ty = Type::Array(Scalar::Real, 7);
    let function = find(
        &mut bank,
        "right",
        "velocity_kinematics",
        0,
        PortKind::Function,
        ty,
    )
    .expect("a function");
    let still = [0.0, 0.5, 0.0, -1.2, 0.0, 0.9, 0.0];
    let mut result = vec![0; 7];
    // Rotating the base rotates the tool about z and moves the elbow along.
    let turning = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    assert!(bank.call(function, &bits(&[still, turning].concat()), &mut result));
    let result: Vec<f64> = result.into_iter().map(f64::from_bits).collect();
    assert!(
        result[1] > 0.5 && (result[5] - 1.0).abs() < 1e-12 && result[6].abs() < 1e-9,
        "{result:?}"
    );
}

#[test]
fn a_tool_and_a_way_of_control_are_checked() {
    let mut bank = bank();
    let tool = actuator(&mut bank, "left", "tool", 3, Type::Array(Scalar::Real, 7));
    assert_eq!(
        bank.check_set_point(tool, &bits(&[2.0, 0.0, 0.0, 0.1, 0.0, 0.0, 0.0])),
        Rejection::NONE
    );
    assert_eq!(
        bank.check_set_point(tool, &bits(&[-2.0, 0.0, 0.0, 0.1, 0.0, 0.0, 0.0])),
        Rejection::ILLEGAL_VALUE
    );
    assert_eq!(
        bank.check_set_point(tool, &bits(&[f64::NAN; 7])),
        Rejection::ILLEGAL_VALUE
    );
    let strategy = actuator(
        &mut bank,
        "left",
        "control_strategy",
        0,
        Type::Scalar(Scalar::Int),
    );
    assert_eq!(bank.check_set_point(strategy, &[20]), Rejection::NONE);
    assert_eq!(
        bank.check_set_point(strategy, &[21]),
        Rejection::ILLEGAL_VALUE
    );
}

#[test]
fn arms_of_six_axes_and_without_a_closed_form_work_too() {
    let text = "[devices.ur]\nkind = \"arm\"\nmodel = \"ur5e\"\njoints = [0, -1.2, 1.4, -1.5, -1.5, 0]\n
        [devices.panda]\nkind = \"arm\"\nmodel = \"franka-panda\"\njoints = [0, 0, 0, -1.5, 0, 1.5, 0]\n";
    let mut bank = SimBank::new(
        &Cell::parse("cell.toml", text).unwrap_or_else(|errors| panic!("{errors}")),
        1e-3,
    );
    for (device, axes) in [("ur", 6), ("panda", 7)] {
        let pose = sensor(&mut bank, device, "pose", 0, POSE);
        let tcp = actuator(&mut bank, device, "tcp", 0, POSE);
        let joints = Type::Array(Scalar::Real, axes);
        let torque = sensor(&mut bank, device, "torque", 0, joints);
        assert_eq!(
            reals(&mut bank, torque, axes as usize),
            vec![0.0; axes as usize]
        );
        let here = reals(&mut bank, pose, 7);
        let refusal = bank.check_set_point(tcp, &bits(&here));
        assert_eq!(refusal, Rejection::NONE, "{}", bank.error_code(tcp));
        let joint = actuator(&mut bank, device, "joint.position", axes - 1, REAL);
        let last = actuator(&mut bank, device, "joint.position", 0, REAL);
        assert_eq!(bank.check_set_point(joint, &bits(&[0.0])), Rejection::NONE);
        assert_eq!(bank.check_set_point(last, &bits(&[1e-10])), Rejection::NONE);
        assert!(
            find(
                &mut bank,
                device,
                "joint.position",
                axes,
                PortKind::Actuator,
                REAL
            )
            .is_err()
        );
    }
}
