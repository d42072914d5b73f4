//! Names of device ports used by primitives. A driver provides its ports under these names.
//!
//! | port | kind | value | description |
//! |---|---|---|---|
//! | `joint.commanded_position`, `joint.measured_position` | sensor | real | rad (m for a linear axis), indexed by axis |
//! | `joint.commanded_velocity`, `joint.measured_velocity` | sensor | real | rad/s |
//! | `joint.commanded_acceleration`, `joint.measured_acceleration` | sensor | real | rad/s² |
//! | `joint.measured_torque`, `joint.external_torque` | sensor | real | N m |
//! | `joint1.measured_torque`, `joint1.external_torque`, ... `joint7` | sensor | real | the same without an index, axes from 1 |
//! | `joint.error` | sensor | int | error code, 0 if there is no error |
//! | `joint.position` | actuator | real | rad |
//! | `joint.impedance` | actuator | real^4 | stiffness, damping, additional torque, maximum torque |
//! | `tcp.commanded_position`, `tcp.measured_position` | sensor | Pose | tool in the base frame |
//! | `tcp.commanded_velocity`, `tcp.measured_velocity` | sensor | Twist | of the tool, in the base frame |
//! | `tcp.error` | sensor | int | error code, 0 if there is no error |
//! | `tcp.position` | actuator | Pose | tool in the base frame |
//! | `tcp.impedance` | actuator | real^18 | stiffness, damping, additional force, each as a wrench |
//! | `tcp.sine` | actuator | real^12 | amplitude and frequency of an overlaid force, each as a wrench |
//! | `tcp.force_x`, `_y`, `_z`, `tcp.torque_x`, `_y`, `_z` | sensor | real | estimated at the tool, N and N m |
//! | `tool` | actuator | real^7 | mass (kg), centre of mass (m), moments of inertia (kg m²); indexed by axis |
//! | `tool_and_tcp` | actuator | real^18 | mass, centre of mass as a pose, moments of inertia, tool centre point as a pose |
//! | `control_strategy` | actuator | int | control mode: position, impedance |
//! | `kinematics` | function | real^n to Pose | joints to tool in the base frame |
//! | `inverse_kinematics` | function | Pose, real^n to real^n | tool in the base frame and hint joints, to joints |
//! | `inverse_kinematics_nullspace` | function | Pose, real^7, real^7 to real^7 | tool in the base frame, hint joints and joints that define the elbow, to joints |
//! | `velocity_kinematics` | function | real^7, real^7 to real^7 | joints and joint velocities, to the twist of the tool and the rate of the elbow angle |
//! | `base.position` | sensor | Pose | platform in the world frame |
//! | `base.measured_velocity`, `base.commanded_velocity` | sensor | Twist | of the platform |
//! | `base.error` | sensor | int | error code, 0 if there is no error |
//! | `base.velocity` | actuator | Twist | of the platform |
//! | `wheel.position`, `wheel.velocity` | sensor | real | rad, rad/s, indexed by wheel |
//! | `in.bool`, `in.real`, `out.bool`, `out.real` | sensor | bool, real | inputs, and current values of outputs; indexed |
//! | `out.bool`, `out.real` | actuator | bool, real | outputs; indexed |
//! | `gnss.longitude`, `gnss.latitude`, `gnss.altitude`, `gnss.hdop`, `gnss.vdop` | sensor | real | deg, m, dilutions of precision |
//! | `gnss.satellites` | sensor | int | number in use |
//!
//! An actuator or a function with several in-ports receives their concatenation as one value, in the order of their
//! declaration. The result of a function with several out-ports is split in the same way.

use rpi_image::{DevicePortNames, DeviceResponse, DeviceUse, Role};

/// Creates the role of a primitive that reads one device port per out-port. `device` and `index` are the names of the
/// parameters that select the device and the index of the ports; `ports` are the names of the ports.
pub(super) const fn sensor(
    device: &'static str,
    index: Option<&'static str>,
    ports: &'static [&'static str],
) -> Role {
    Role::Sensor(device_use(device, index, ports, &[]))
}

/// Creates the role of a primitive that writes a device port. `device` and `index` are the names of the parameters that
/// select the device and the index of the port. The out-ports are the responses of the device.
pub(super) const fn actuator(
    device: &'static str,
    index: Option<&'static str>,
    port: &'static [&'static str; 1],
    answers: &'static [DeviceResponse],
) -> Role {
    Role::Actuator(device_use(device, index, port, answers))
}

/// Creates the role of a primitive that calls a function of a device. `device` is the name of the parameter that
/// selects the device.
pub(super) const fn function(device: &'static str, port: &'static [&'static str; 1]) -> Role {
    Role::DeviceFunction(device_use(device, None, port, &[]))
}

const fn device_use(
    device: &'static str,
    index: Option<&'static str>,
    ports: &'static [&'static str],
    answers: &'static [DeviceResponse],
) -> DeviceUse {
    DeviceUse {
        device,
        index,
        ports: DevicePortNames::Fixed(ports),
        responses: answers,
    }
}
