//! Ports whose values a replay takes from the trace instead of computing them.

use rpi_image::{CommandFlow, PrimDesc, Role};

/// Returns true if the out-ports of the primitive depend on its environment: devices, other nets, users or clocks.
///
/// The out-ports of an actuator are answers of the device. The clock of the net is computed from the start time of the
/// trace.
pub(super) fn is_input(desc: &PrimDesc) -> bool {
    match desc.role {
        Role::Sensor(_)
        | Role::Actuator(_)
        | Role::DeviceFunction(_)
        | Role::ExternalFunction(_)
        | Role::Input => true,
        Role::Flow(flow) => !is_computed_time(flow),
        Role::Compute
        | Role::Constant
        | Role::Delay
        | Role::IsAbsent
        | Role::First
        | Role::Export => false,
    }
}

/// Returns true if the out-ports of the primitive have their values before the first step of a cycle, as sensors do.
pub(super) fn is_latched(desc: &PrimDesc) -> bool {
    matches!(desc.role, Role::Sensor(_) | Role::Input | Role::Flow(_))
}

fn is_computed_time(flow: CommandFlow) -> bool {
    matches!(
        flow,
        CommandFlow::Time | CommandFlow::Period | CommandFlow::NetTime
    )
}
