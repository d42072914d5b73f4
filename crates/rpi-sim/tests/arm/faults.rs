//! Simulated faults, and what the sensors deliver.

use rpi_device::{DeviceBank, Rejection};
use rpi_sim::error_code::ErrorCode;
use rpi_sim::{FaultKind, ScheduledFault};

use crate::rig::{Rig, speed_up};

#[test]
fn a_failed_joint_refuses_and_the_arm_brakes() {
    let mut rig = Rig::new(
        "[[devices.arm.faults]]\nat = 0.1\nfor = 2.0\ntrouble = \"joint-failure\"\naxis = 4\n",
    );
    let mut last = 0.0;
    for target in speed_up(30.0, 99) {
        rig.set(0, target);
        rig.bank.step();
        last = target;
    }
    rig.bank.step();
    rig.bank.step();
    assert_eq!(rig.error(4), ErrorCode::JOINT_FAILED);
    assert_eq!(rig.check(4, 0.0), Rejection::DEVICE_FAILED);
    assert!(
        rig.position(0) > last && rig.bank.is_moving(0),
        "it brakes, it does not freeze"
    );
    (0..1500).for_each(|_| rig.bank.step());
    assert!(!rig.bank.is_moving(0));
    (0..1000).for_each(|_| rig.bank.step());
    assert_eq!(rig.error(4), ErrorCode::OK, "the fault is over");
    assert_eq!(rig.check(4, 0.0), Rejection::NONE);
}

#[test]
fn an_emergency_stop_refuses_everything() {
    let mut rig = Rig::new("");
    let fault = ScheduledFault {
        from: 0.0,
        until: 0.5,
        kind: FaultKind::EmergencyStop,
    };
    assert!(rig.bank.inject("arm", fault));
    rig.bank.step();
    for axis in 0..7 {
        assert_eq!(rig.check(axis, 0.0), Rejection::DEVICE_FAILED);
        assert_eq!(rig.error(axis), ErrorCode::EMERGENCY_STOP);
    }
    assert!(!rig.bank.inject("leg", fault), "there is no such device");
}

/// M8.2.
#[test]
fn lost_samples_are_absent_and_lost_set_points_do_not_arrive() {
    let text = "[[devices.arm.faults]]\nat = 0.01\nfor = \"10 ms\"\ntrouble = \"lost-samples\"\n
        [[devices.arm.faults]]\nat = 0.03\ntrouble = \"lost-set-points\"\n";
    let mut rig = Rig::new(text);
    let mut absent = 0;
    let mut targets = speed_up(30.0, 200);
    for _ in 0..29 {
        let target = targets.next().expect("enough");
        rig.set(0, target);
        rig.bank.step();
        let port = rig.positions[0];
        absent += usize::from(rig.real(port).is_none());
    }
    assert_eq!(absent, 10);
    rig.set(0, targets.next().expect("enough"));
    rig.bank.step();
    assert_eq!(rig.error(0), ErrorCode::SET_POINT_MISSING);
}

#[test]
fn latency_lag_and_noise_change_what_is_measured_only() {
    let ramp: Vec<f64> = speed_up(30.0, 100).collect();
    let mut late = Rig::new("latency = \"7 ms\"");
    let mut slow = Rig::new("lag = \"10 ms\"");
    let mut noisy = Rig::new("noise = 1e-4");
    let commanded = noisy.sensor("joint.commanded_position", 0);
    let mut off = Vec::new();
    for (tick, target) in ramp.iter().enumerate() {
        for rig in [&mut late, &mut slow, &mut noisy] {
            rig.set(0, *target);
            rig.bank.step();
        }
        let old = if tick < 7 { 0.0 } else { ramp[tick - 7] };
        assert_eq!(late.position(0), old);
        assert!(slow.position(0) < *target);
        assert_eq!(noisy.real(commanded), Some(*target));
        off.push(noisy.position(0) - target);
    }
    (0..200).for_each(|_| {
        let last = ramp[99];
        slow.bank.write(slow.joints[0], &[last.to_bits()]);
        slow.bank.step();
    });
    let spread = (off.iter().map(|one| one * one).sum::<f64>() / off.len() as f64).sqrt();
    assert!(spread > 0.5e-4 && spread < 2e-4, "{spread}");
}

#[test]
fn a_contact_is_felt_at_the_tool_and_in_the_joints() {
    let text = "joints = [0, 0, 0, \"90 deg\", 0, 0, 0]\n
        [[devices.arm.faults]]\ntrouble = \"contact\"\nforce = [0, 0, \"-10 N\"]\n";
    let mut rig = Rig::new(text);
    rig.bank.step();
    let (force, torque) = (
        rig.sensor("tcp.force_z", 0),
        rig.sensor("joint.external_torque", 3),
    );
    assert_eq!(rig.real(force), Some(-10.0));
    // The forearm and hand extend horizontally by 0.468 m, and axis 4 of an LWR counts upwards.
    let felt = rig.real(torque).expect("a sample");
    assert!((felt.abs() - 4.68).abs() < 1e-9, "{felt}");
    let numbered = rig.sensor("joint4.external_torque", 0);
    assert_eq!(rig.real(numbered), Some(felt));
}
