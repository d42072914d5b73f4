//! Tests of chains and limits against the published tables stored with the project.

use rpi_kin::models::{self, kuka_lbr};
use rpi_kin::{ArmModel, Pose};
use serde_json::Value;

fn golden() -> Option<Value> {
    let path = rpi_testkit::external_data_path("golden/robots-and-profiles.json")?;
    let text = std::fs::read_to_string(path).expect("a readable file");
    Some(serde_json::from_str(&text).expect("valid JSON"))
}

fn reals(value: &Value) -> Vec<f64> {
    let array = value
        .as_array()
        .unwrap_or_else(|| panic!("an array, not {value}"));
    array
        .iter()
        .map(|number| number.as_f64().expect("a number"))
        .collect()
}

/// Computes one row of a standard table with full matrix products, as the oracle for the optimised recursion of the
/// chain.
fn standard(theta: f64, d: f64, a: f64, alpha: f64) -> Pose {
    let z = nalgebra::Vector3::z();
    let x = nalgebra::Vector3::x();
    Pose::new(z * d, z * theta) * Pose::new(x * a, x * alpha)
}

fn near(one: &Pose, other: &Pose, within: f64) -> bool {
    (one.to_homogeneous() - other.to_homogeneous()).amax() < within
}

#[test]
fn the_lightweight_arms_follow_the_published_tables() {
    let Some(golden) = golden() else { return };
    // The table of the iiwa 7 omits the entries that it shares with the iiwa 14.
    let arms = [
        (
            &kuka_lbr::LWR_4_PLUS,
            "lwr4plus",
            "lwr4plus",
            "vmax_deg_s_rapi",
        ),
        (&kuka_lbr::IIWA_7, "iiwa7", "iiwa14", "vmax_deg_s"),
        (&kuka_lbr::IIWA_14, "iiwa14", "iiwa14", "vmax_deg_s"),
    ];
    for (arm, name, shape, velocity) in arms {
        let (own, shape) = (&golden["robots"][name], &golden["robots"][shape]);
        let [d, a, alpha] = [reals(&own["d"]), reals(&shape["a"]), reals(&shape["alpha"])];
        for round in 0..200 {
            let joints: [f64; 7] = std::array::from_fn(|axis| {
                f64::from((round * (axis as i32 + 3) * 7) % 41 - 20) / 7.0
            });
            let rows = (0..7).map(|axis| standard(joints[axis], d[axis], a[axis], alpha[axis]));
            let expected = rows.fold(Pose::identity(), |so_far, row| so_far * row);
            assert!(
                near(&arm.forward(&joints), &expected, 1e-12),
                "{name} at {joints:?}"
            );
        }
        limits_agree(arm, &reals(&own["qmax_deg"]), &reals(&own[velocity]));
    }
}

#[test]
fn the_panda_stands_where_recorded_poses_say() {
    let Some(golden) = golden() else { return };
    let fk = &golden["fk_panda_link8_pilz"];
    let cases = fk["cases"].as_array().expect("cases");
    assert_eq!(cases.len(), 4);
    let panda = models::by_id("franka-panda").expect("known");
    for case in cases {
        let pose = panda.forward(&reals(&case["q"]));
        let [xyz, quaternion] = [reals(&case["xyz"]), reals(&case["quat"])];
        let off = pose.translation.vector - nalgebra::Vector3::from_row_slice(&xyz);
        assert!(off.amax() < 1e-6, "{off:?}");
        let same = pose
            .rotation
            .coords
            .dot(&nalgebra::Vector4::from_row_slice(&quaternion));
        assert!(
            same.abs() > 1.0 - 1e-6,
            "{} and {quaternion:?}",
            pose.rotation.coords
        );
    }
    let own = &golden["robots"]["panda_fer"];
    ranges_agree(panda, &own["q"], 1.0);
    each_agrees(panda, &reals(&own["v"]), |axis| axis.velocity);
    each_agrees(panda, &reals(&own["a_max"]), |axis| axis.acceleration);
    each_agrees(panda, &reals(&own["jerk"]), |axis| axis.jerk);
}

#[test]
fn the_ur5e_follows_the_published_table() {
    let Some(golden) = golden() else { return };
    let own = &golden["robots"]["ur5e"];
    let [d, a, alpha] = [reals(&own["d"]), reals(&own["a"]), reals(&own["alpha"])];
    let arm = models::by_id("ur5e").expect("known");
    for round in 0..200 {
        let joints: [f64; 6] =
            std::array::from_fn(|axis| f64::from((round * (axis as i32 + 3) * 7) % 41 - 20) / 7.0);
        let rows = (0..6).map(|axis| standard(joints[axis], d[axis], a[axis], alpha[axis]));
        let expected = rows.fold(Pose::identity(), |so_far, row| so_far * row);
        assert!(near(&arm.forward(&joints), &expected, 1e-12), "{joints:?}");
    }
    limits_agree(arm, &reals(&own["qmax_deg"]), &reals(&own["vmax_deg_s"]));
}

/// Computes forward kinematics by the formulas of the OPW paper, without a chain.
fn ortho_parallel(robot: &Value, joints: &[f64; 6]) -> Pose {
    let [sign, offset] = [
        [-1.0, 1.0, 1.0, -1.0, 1.0, -1.0],
        [0.0, -90.0_f64.to_radians(), 0.0, 0.0, 0.0, 0.0],
    ];
    let length = |name: &str| robot["opw"][name].as_f64().expect("a length");
    let q: [f64; 6] = std::array::from_fn(|axis| joints[axis] * sign[axis] - offset[axis]);
    let psi = rpi_math::atan2(length("a2"), length("c3"));
    let k = rpi_math::hypot(length("a2"), length("c3"));
    let lean = q[1] + q[2] + psi;
    let out = length("c2") * rpi_math::sin(q[1]) + k * rpi_math::sin(lean) + length("a1");
    let up = length("c2") * rpi_math::cos(q[1]) + k * rpi_math::cos(lean) + length("c1");
    let about = |axis: nalgebra::Vector3<f64>, angle: f64| Pose::rotation(axis * angle);
    let (y, z) = (nalgebra::Vector3::y(), nalgebra::Vector3::z());
    let wrist = about(z, q[0]) * Pose::translation(out, length("b"), up) * about(y, q[1] + q[2]);
    wrist
        * about(z, q[3])
        * about(y, q[4])
        * about(z, q[5])
        * Pose::translation(0.0, 0.0, length("c4"))
}

#[test]
fn the_industrial_arms_follow_the_published_parameters() {
    let Some(golden) = golden() else { return };
    for (id, name) in [("kuka-kr6-r900", "kr6r900sixx"), ("kuka-kr16-2", "kr16_2")] {
        let (arm, own) = (models::by_id(id).expect("known"), &golden["robots"][name]);
        for round in 0..200 {
            let joints: [f64; 6] = std::array::from_fn(|axis| {
                f64::from((round * (axis as i32 + 3) * 7) % 41 - 20) / 7.0
            });
            let expected = ortho_parallel(own, &joints);
            assert!(
                near(&arm.forward(&joints), &expected, 1e-12),
                "{id} at {joints:?}"
            );
        }
        ranges_agree(arm, &own["q_deg"], 1_f64.to_radians());
        let velocities: Vec<f64> = reals(&own["vmax_deg_s"])
            .into_iter()
            .map(f64::to_radians)
            .collect();
        each_agrees(arm, &velocities, |axis| axis.velocity);
    }
}

#[test]
fn an_industrial_arm_at_zero_is_stretched_out_to_the_front() {
    let arm = models::by_id("kuka-kr6-r900").expect("known");
    let flange = arm.forward(&[0.0; 6]).translation.vector;
    assert!(
        (flange - nalgebra::Vector3::new(0.980, 0.0, 0.435)).amax() < 1e-12,
        "{flange}"
    );
}

fn ranges_agree(arm: &ArmModel, ranges: &Value, unit: f64) {
    for (axis, range) in arm.limits.iter().zip(ranges.as_array().expect("ranges")) {
        let range = reals(range);
        assert!(
            (axis.position.lower - range[0] * unit).abs() < 1e-12,
            "{}",
            arm.id
        );
        assert!(
            (axis.position.upper - range[1] * unit).abs() < 1e-12,
            "{}",
            arm.id
        );
    }
}

fn each_agrees(arm: &ArmModel, expected: &[f64], of: fn(&rpi_kin::AxisLimits) -> f64) {
    assert_eq!(arm.limits.len(), expected.len());
    let mut both = arm.limits.iter().map(of).zip(expected);
    assert!(
        both.all(|(own, expected)| (own - expected).abs() < 1e-9),
        "{}",
        arm.id
    );
}

fn limits_agree(arm: &ArmModel, bound: &[f64], velocity: &[f64]) {
    assert_eq!(arm.limits.len(), bound.len());
    for ((axis, bound), velocity) in arm.limits.iter().zip(bound).zip(velocity) {
        assert!(
            (axis.position.upper - bound.to_radians()).abs() < 1e-12,
            "{}",
            arm.id
        );
        assert!(
            (axis.position.lower + bound.to_radians()).abs() < 1e-12,
            "{}",
            arm.id
        );
        assert!(
            (axis.velocity - velocity.to_radians()).abs() < 1e-12,
            "{}",
            arm.id
        );
    }
}

#[test]
fn every_model_has_limits_for_each_axis_and_a_name_of_its_own() {
    for (index, arm) in models::ALL.iter().enumerate() {
        assert_eq!(arm.limits.len(), arm.axes(), "{}", arm.id);
        assert!(arm.axes() <= rpi_kin::MAX_AXES);
        assert!(
            arm.limits
                .iter()
                .all(|axis| axis.position.lower < axis.position.upper)
        );
        assert!(
            arm.limits
                .iter()
                .all(|axis| axis.velocity > 0.0 && axis.acceleration > 0.0 && axis.jerk > 0.0)
        );
        assert!(std::ptr::eq(
            models::by_id(arm.id).expect("found by its name"),
            *arm
        ));
        assert!(
            index == 0 || models::ALL[index - 1].id < arm.id,
            "sorted: {}",
            arm.id
        );
    }
    assert!(models::by_id("kuka").is_none());
}

#[test]
fn the_jacobian_is_the_derivative_of_the_forward_kinematics() {
    let arm = &kuka_lbr::IIWA_14;
    let joints = [0.3, -0.7, 0.5, 1.1, -0.4, 0.9, 0.2];
    let point = arm.forward(&joints).translation.vector;
    let jacobian = rpi_kin::jacobian::geometric(&arm.chain, &joints, &point);
    let step = 1e-6;
    for axis in 0..7 {
        let moved = |by: f64| {
            let mut joints = joints;
            joints[axis] += by;
            arm.forward(&joints)
        };
        let (ahead, behind) = (moved(step), moved(-step));
        let linear = (ahead.translation.vector - behind.translation.vector) / (2.0 * step);
        let angular = (ahead.rotation * behind.rotation.inverse()).scaled_axis() / (2.0 * step);
        let column = jacobian.column(axis);
        assert!(
            (column.fixed_rows::<3>(0) - linear).amax() < 1e-8,
            "axis {axis}"
        );
        assert!(
            (column.fixed_rows::<3>(3) - angular).amax() < 1e-8,
            "axis {axis}"
        );
    }
}

/// With constant joint velocities, the velocity of the tool changes by the product of the Jacobian's derivative.
#[test]
fn the_velocity_product_is_the_derivative_of_the_tool_velocity() {
    use rpi_kin::jacobian::{geometric, velocity_product};
    for arm in models::ALL {
        let mut joints = [0.3, -0.7, 0.5, 1.1, -0.4, 0.9, 0.2];
        let mut rates = [0.7, 0.3, -0.5, 0.4, 1.1, -0.6, 0.8];
        joints[arm.axes()..].fill(0.0);
        rates[arm.axes()..].fill(0.0);
        let twist = |time: f64| {
            let moved: [f64; 7] = std::array::from_fn(|k| joints[k] + time * rates[k]);
            let point = arm.forward(&moved[..arm.axes()]).translation.vector;
            geometric(&arm.chain, &moved, &point) * nalgebra::SVector::<f64, 7>::from(rates)
        };
        let step = 1e-6;
        let expected = (twist(step) - twist(-step)) / (2.0 * step);
        let point = arm.forward(&joints[..arm.axes()]).translation.vector;
        let product = velocity_product(&arm.chain, &joints, &rates, &point);
        assert!(
            (product - expected).amax() < 1e-7,
            "{}: {product} {expected}",
            arm.id
        );
    }
}

#[test]
fn a_sliding_joint_moves_along_its_axis() {
    let unit = &models::linear::LINEAR_UNIT;
    let carriage = unit.forward(&[0.3]);
    assert_eq!(
        carriage.translation.vector,
        nalgebra::Vector3::new(0.0, 0.0, 0.3)
    );
    let jacobian = rpi_kin::jacobian::geometric(&unit.chain, &[0.3], &carriage.translation.vector);
    assert_eq!(jacobian.as_slice(), [0.0, 0.0, 1.0, 0.0, 0.0, 0.0]);
}

/// Rows that are placed freely give the same poses, axes and Jacobian as the table whose rows they replace.
#[test]
fn rows_placed_freely_follow_the_table() {
    use rpi_kin::{Chain, Convention, Link, Transform, to_transform};
    let leak = |pose: &Pose| -> &'static Transform { Box::leak(Box::new(to_transform(pose))) };
    let arm = models::by_id("ur5e").expect("known");
    let zero = [0.0; 6];
    let frames: Vec<Transform> = arm.chain.link_frames(&zero).collect();
    let before = |axis: usize| match axis {
        0 => Transform::identity(),
        _ => frames[axis - 1],
    };
    let relative = |axis: usize| match axis {
        0 => Transform::identity(),
        _ => before(axis - 1).inverse() * before(axis),
    };
    let placed = |axis: usize| Link::placed(leak(&rpi_kin::to_pose(&relative(axis))));
    let links: Vec<Link> = (0..6).map(placed).collect();
    let flange = before(5).inverse() * frames[5];
    let chain = Chain {
        convention: Convention::Modified,
        links: Box::leak(links.into_boxed_slice()),
        fixed_links: Box::leak(Box::new([Link::placed(leak(&rpi_kin::to_pose(&flange)))])),
    };
    let joints = [0.3, -0.7, 0.5, 1.1, -0.4, 0.9];
    let (one, other) = (arm.chain.flange_pose(&joints), chain.flange_pose(&joints));
    assert!((one.to_homogeneous() - other.to_homogeneous()).amax() < 1e-12);
    let point = one.translation.vector;
    let jacobian = |chain: &Chain| rpi_kin::jacobian::geometric(chain, &joints, &point);
    assert!((jacobian(&arm.chain) - jacobian(&chain)).amax() < 1e-12);
    assert!((chain.length() - 1.3123).abs() < 1e-9, "{}", chain.length());
}

#[test]
fn twists_by_quarter_turns_are_exact() {
    use rpi_kin::chain::LinkTwist;
    let from_degrees = |degrees: f64| LinkTwist::from_angle(degrees.to_radians());
    assert_eq!(from_degrees(90.0), LinkTwist::PLUS_90);
    assert_eq!(from_degrees(-90.0), LinkTwist::MINUS_90);
    assert_eq!(from_degrees(360.0), LinkTwist::NONE);
    assert_ne!(from_degrees(90.001), LinkTwist::PLUS_90);
}
