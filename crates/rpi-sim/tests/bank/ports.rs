//! Names and numbers of ports, resources and devices.

use rpi_device::{DeviceBank, PortId, PortKind, Rejection, ResolveError};
use rpi_image::{Scalar, Type};
use rpi_sim::SimBank;

use crate::cell::{BOOL, JOINTS, POSE, REAL, actuator, bank, find, sensor};
use PortKind::{Actuator, Function, Sensor};
use ResolveError::{IndexOutOfRange, UnknownDevice, UnknownPort, WrongType};

/// Checks that each name of a port does not resolve, with this error.
fn check_rejections(device: &str, cases: &[(&str, u32, PortKind, Type, ResolveError)]) {
    let mut bank = bank();
    for &(port, index, kind, ty, error) in cases {
        assert_eq!(
            find(&mut bank, device, port, index, kind, ty),
            Err(error),
            "{device}.{port}[{index}]"
        );
    }
}

#[test]
fn names_that_do_not_resolve_say_why() {
    check_rejections(
        "middle",
        &[("joint.position", 0, Actuator, REAL, UnknownDevice)],
    );
    check_rejections(
        "left",
        &[
            ("joint.colour", 0, Sensor, REAL, UnknownPort),
            ("joint.position", 0, Sensor, REAL, UnknownPort),
            ("joint.position", 7, Actuator, REAL, IndexOutOfRange),
            ("joint.position", 0, Actuator, BOOL, WrongType),
            ("kinematics", 0, Function, JOINTS, WrongType),
            ("joint8.measured_torque", 0, Sensor, REAL, IndexOutOfRange),
            ("joint0.measured_torque", 0, Sensor, REAL, UnknownPort),
        ],
    );
    check_rejections(
        "io",
        &[
            ("in.bool", 2, Sensor, BOOL, IndexOutOfRange),
            ("in.bool", 0, Actuator, BOOL, UnknownPort),
        ],
    );
    let mut bank = bank();
    let one = sensor(&mut bank, "left", "pose", 0, POSE);
    assert_eq!(
        sensor(&mut bank, "left", "pose", 0, POSE),
        one,
        "the same port has the same number"
    );
}

#[test]
fn ports_of_one_motion_share_actuators_and_others_do_not() {
    let mut bank = bank();
    let joint = |bank: &mut SimBank, axis| actuator(bank, "left", "joint.position", axis, REAL);
    let (first, third) = (joint(&mut bank, 0), joint(&mut bank, 2));
    let tcp = actuator(&mut bank, "left", "tcp.position", 0, POSE);
    let joints = actuator(&mut bank, "left", "joints", 0, JOINTS);
    let tool = actuator(&mut bank, "left", "tool", 0, Type::Array(Scalar::Real, 7));
    let other = actuator(&mut bank, "right", "tcp", 0, POSE);
    let outputs: Vec<PortId> = (0..3)
        .map(|index| actuator(&mut bank, "io", "out.bool", index, BOOL))
        .collect();
    let overlap = |one: PortId, two: PortId| {
        let (one, two) = (bank.resources(one), bank.resources(two));
        one.start.max(two.start) < one.end.min(two.end)
    };
    assert!(overlap(tcp, first) && overlap(tcp, third) && overlap(tcp, joints));
    assert!(
        !overlap(first, third)
            && !overlap(tool, tcp)
            && !overlap(tool, first)
            && !overlap(other, tcp)
    );
    assert!(!overlap(outputs[0], outputs[1]) && !overlap(outputs[2], other));
}

#[test]
fn every_port_number_is_answered_without_a_panic() {
    let mut bank = bank();
    // Every table row of every device with a few indices each. Some numbers are valid ports; none may panic.
    for number in (0..=u32::MAX).step_by(0x3ff3) {
        let port = PortId(number & !0x3f_0000);
        let mut value = [0; 16];
        bank.read(port, &mut value);
        bank.check_set_point(port, &value);
        bank.write(port, &value);
        bank.call(port, &value, &mut [0; 16]);
        bank.error_code(port);
    }
    for port in [PortId(0x7fff), PortId(u32::MAX)] {
        assert!(!bank.read(port, &mut [0]));
        assert_eq!(bank.check_set_point(port, &[0]), Rejection::DEVICE_FAILED);
        bank.write(port, &[0]);
        assert!(!bank.call(port, &[], &mut []));
        assert!(bank.resources(port).is_empty());
        assert_eq!(bank.error_code(port), 0);
    }
    let tcp = actuator(&mut bank, "left", "tcp", 0, POSE);
    bank.write(tcp, &[]);
    assert_eq!(bank.check_set_point(tcp, &[]), Rejection::ILLEGAL_VALUE);
    bank.stop(u32::MAX);
    assert!(!bank.is_moving(u32::MAX));
}

#[test]
fn banks_with_the_same_devices_in_the_same_places_give_the_same_numbers() {
    let (mut one, mut other) = (bank(), bank());
    sensor(&mut one, "left", "pose", 0, POSE);
    for (device, port) in [("right", "tcp"), ("left", "tcp")] {
        let number = actuator(&mut one, device, port, 0, POSE);
        assert_eq!(number, actuator(&mut other, device, port, 0, POSE));
        assert_eq!(one.resources(number), other.resources(number));
    }
}

#[test]
fn devices_come_and_go_between_two_ticks() {
    let mut bank = bank();
    let tcp = actuator(&mut bank, "left", "tcp", 0, POSE);
    let left = bank.swap(0, None);
    assert_eq!(left.as_ref().map(rpi_sim::NamedDevice::name), Some("left"));
    assert_eq!(bank.check_set_point(tcp, &[0; 7]), Rejection::DEVICE_FAILED);
    bank.step();
    assert!(bank.swap(0, left).is_none());
    assert_eq!(actuator(&mut bank, "left", "tcp", 0, POSE), tcp);
}
