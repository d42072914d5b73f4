//! Benchmark of forward and inverse kinematics of seven-axis arms, one call each.

use criterion::{Criterion, criterion_group, criterion_main};
use rpi_kin::models::kuka_lbr::LWR_4_PLUS;
use rpi_kin::{Pose, jacobian};
use std::hint::black_box;

const HINT: [f64; 7] = [0.3, 0.6, -0.2, 1.3, 0.4, -0.9, 0.1];

/// Returns 256 sets of joint values in rad, spread over ±1.5 rad, so that branch prediction does not help the
/// benchmark.
fn spread() -> Vec<[f64; 7]> {
    let part =
        |step: u32, axis: u32| f64::from((step * (37 + 11 * axis) + 13 * axis) % 257) / 256.0;
    (0..256)
        .map(|step| core::array::from_fn(|axis| (part(step, axis as u32) - 0.5) * 3.0))
        .collect()
}

fn forward(c: &mut Criterion) {
    let joints = spread();
    let mut each = joints.iter().cycle();
    c.bench_function("forward, 7 axes, pose as quaternion", |b| {
        b.iter(|| LWR_4_PLUS.forward(black_box(each.next().unwrap_or(&HINT))));
    });
    c.bench_function("forward, 7 axes, matrix", |b| {
        b.iter(|| {
            LWR_4_PLUS
                .chain
                .flange_pose(black_box(each.next().unwrap_or(&HINT)))
        });
    });
    c.bench_function("jacobian, 7 axes", |b| {
        b.iter(|| {
            let joints = black_box(each.next().unwrap_or(&HINT));
            jacobian::geometric(
                &LWR_4_PLUS.chain,
                joints,
                &nalgebra::Vector3::new(0.1, 0.2, 0.3),
            )
        });
    });
}

fn inverse(c: &mut Criterion) {
    let solve = |pose: &Pose, hint: &[f64; 7]| {
        LWR_4_PLUS.inverse(black_box(pose), black_box(hint), LWR_4_PLUS.limits)
    };
    let near: Vec<(Pose, [f64; 7])> = spread()
        .into_iter()
        .map(|joints| {
            (
                LWR_4_PLUS.forward(&joints),
                joints.map(|joint| joint + 0.01),
            )
        })
        .collect();
    let mut each = near.iter().cycle();
    c.bench_function("inverse, S-R-S, hint near by", |b| {
        b.iter(|| each.next().map(|(pose, hint)| solve(pose, hint)));
    });
    let mut each = near.iter().cycle();
    c.bench_function("inverse, S-R-S, any hint, elbow moved or not", |b| {
        b.iter(|| each.next().map(|(pose, _)| solve(pose, &HINT)));
    });
}

fn six_axes(c: &mut Criterion) {
    for arm in [
        &rpi_kin::models::kuka_kr::KR_6_R900,
        &rpi_kin::models::universal_robots::UR5E,
    ] {
        let poses: Vec<(Pose, [f64; 7])> = spread()
            .into_iter()
            .map(|joints| (arm.forward(&joints[..6]), joints))
            .collect();
        let mut each = poses.iter().cycle();
        c.bench_function(&format!("inverse, {}", arm.id), |b| {
            b.iter(|| {
                each.next()
                    .map(|(pose, hint)| arm.inverse(black_box(pose), &hint[..6], arm.limits))
            });
        });
    }
}

criterion_group!(kinematics, forward, inverse, six_axes);
criterion_main!(kinematics);
