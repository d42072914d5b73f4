//! The same inputs give the same bits, without an allocation in a tick.

use rpi_device::{DeviceBank, Rejection};
use rpi_image::{Scalar, Type};
use rpi_sim::{FaultKind, ScheduledFault, SimBank};

use crate::cell::{JOINTS, REAL, actuator, bank, sensor};

/// Schedules noise and a failure of a joint.
fn inject_faults(bank: &mut SimBank) {
    bank.inject(
        "left",
        ScheduledFault {
            from: 1.0,
            until: 1.5,
            kind: FaultKind::Noise(1e-4),
        },
    );
    bank.inject(
        "left",
        ScheduledFault {
            from: 2.0,
            until: 2.2,
            kind: FaultKind::JointFailure(1),
        },
    );
}

/// A random scenario of one minute: valid and invalid set-points, faults, stops. Returns every bit that was read.
fn wild(bank: &mut SimBank) -> Vec<u64> {
    let joint = actuator(bank, "left", "joint.position", 1, REAL);
    let ports = [
        (sensor(bank, "left", "joints", 0, JOINTS), 7),
        (sensor(bank, "left", "position", 0, JOINTS), 7),
        (
            sensor(
                bank,
                "left",
                "measured_twist",
                0,
                Type::Scalar(Scalar::Twist),
            ),
            6,
        ),
        (sensor(bank, "left", "singularity_distance", 0, REAL), 1),
        (
            sensor(bank, "left", "code", 0, Type::Scalar(Scalar::Int)),
            1,
        ),
    ];
    inject_faults(bank);
    let mut seen = vec![0_u64; 22 * 3_000];
    let mut at = -0.5_f64;
    let mut speed = 0.0;
    rpi_testkit::no_alloc(|| {
        for (tick, row) in seen.chunks_exact_mut(22).enumerate() {
            speed = if tick % 1000 < 100 {
                speed + 2e-6
            } else {
                speed * 0.999
            };
            at += if tick % 700 < 650 { speed } else { 0.1 };
            if bank.check_set_point(joint, &[at.to_bits()]) == Rejection::NONE && tick % 900 != 899
            {
                bank.write(joint, &[at.to_bits()]);
            }
            bank.step();
            let mut rest = row;
            for (port, cells) in ports {
                let (own, after) = rest.split_at_mut(cells);
                bank.read(port, own);
                rest = after;
            }
        }
    });
    seen
}

#[test]
fn the_same_cell_gives_the_same_bits_and_allocates_nothing() {
    let (one, two) = (wild(&mut bank()), wild(&mut bank()));
    assert_eq!(one, two);
    let codes: std::collections::BTreeSet<u64> = one.chunks_exact(22).map(|row| row[21]).collect();
    assert!(codes.len() >= 4, "it was wild: {codes:?}");
}
