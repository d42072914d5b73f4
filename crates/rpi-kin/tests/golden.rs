//! Chains and limits against the published tables beside the project.

use rpi_kin::models::{self, lbr};
use rpi_kin::{ArmModel, Pose};
use serde_json::Value;

fn golden() -> Option<Value> {
    let path = rpi_testkit::shared_path("golden/robots-and-profiles.json")?;
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

/// One row of a standard table, multiplied out the plain way: the oracle for the chain's shortcut.
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
    // The table of the iiwa 7 leaves out what it shares with the iiwa 14.
    let arms = [
        (&lbr::LWR_4_PLUS, "lwr4plus", "lwr4plus", "vmax_deg_s_rapi"),
        (&lbr::IIWA_7, "iiwa7", "iiwa14", "vmax_deg_s"),
        (&lbr::IIWA_14, "iiwa14", "iiwa14", "vmax_deg_s"),
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
    let arm = &lbr::IIWA_14;
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
