//! Distance to singularities: 0 where the tool cannot move in some direction, and the least motion of the tool elsewhere.

mod common;

use common::Random;
use nalgebra::{SVector, Vector3};
use rpi_kin::{ArmModel, MAX_AXES, jacobian, models};

const SIX_AXES: [&ArmModel; 3] = [
    &models::kuka_kr::KR_6_R900,
    &models::kuka_kr::KR_16_2,
    &models::universal_robots::UR5E,
];

fn tool(arm: &ArmModel, joints: &[f64; MAX_AXES]) -> Vector3<f64> {
    arm.forward(&joints[..arm.axes()]).translation.vector
}

fn distance(arm: &ArmModel, joints: &[f64; MAX_AXES]) -> f64 {
    jacobian::distance_to_singularity(&arm.chain, joints, &tool(arm, joints))
}

#[test]
fn it_is_zero_at_known_singularities() {
    // Straight wrist of a six-axis arm; outstretched seven-axis arm; elbow of a UR outstretched.
    let kr = &models::kuka_kr::KR_6_R900;
    assert!(distance(kr, &[0.3, -0.8, 0.9, 0.7, 0.0, -0.4, 0.0]) < 1e-12);
    let lwr = &models::kuka_lbr::LWR_4_PLUS;
    assert!(distance(lwr, &[0.3, 0.6, -0.2, 0.0, 0.4, -0.9, 0.1]) < 1e-12);
    let ur = &models::universal_robots::UR5E;
    assert!(distance(ur, &[0.3, -0.8, 0.0, 0.7, 0.5, -0.4, 0.0]) < 1e-12);
    assert!(distance(ur, &[0.3, -0.8, 1.3, 0.7, 0.5, -0.4, 0.0]) > 1e-2);
    assert!(distance(lwr, &[f64::NAN; MAX_AXES]).is_nan());
}

/// The least speed of the tool for joint velocities of magnitude 1: never below the distance, and nearly equal to it in some
/// direction.
#[test]
fn the_tool_moves_at_least_by_the_distance() {
    let mut random = Random(21);
    for arm in SIX_AXES {
        for _ in 0..200 {
            let six: [f64; 6] = random.joints(arm.limits);
            let mut joints = [0.0; MAX_AXES];
            joints[..6].copy_from_slice(&six);
            let known = distance(arm, &joints);
            let mut jacobian = jacobian::geometric(&arm.chain, &six, &tool(arm, &joints));
            let mut linear = jacobian.fixed_rows_mut::<3>(0);
            linear /= arm.chain.length();
            // Power iteration on the inverse of the square of the Jacobian.
            let inverse = (jacobian.transpose() * jacobian).try_inverse();
            let Some(inverse) = inverse else { continue };
            let mut way = SVector::<f64, 6>::from_fn(|_, _| random.between(-1.0, 1.0));
            for _ in 0..500 {
                way = (inverse * way).normalize();
                assert!(
                    (jacobian * way).norm() > known * (1.0 - 1e-6),
                    "{}: {six:?}",
                    arm.id
                );
            }
            let least = (jacobian * way).norm();
            assert!(least < known * 1.01 + 1e-6, "{}: {least} {known}", arm.id);
        }
    }
}

#[test]
fn a_chain_with_fewer_joints_counts_only_as_many_directions() {
    let unit = &models::linear::LINEAR_UNIT;
    assert!(distance(unit, &[0.5; MAX_AXES]) > 0.0);
}
