//! What a replay takes from the trace instead of computing it.

use rpi_image::{CommandFlow, PrimDesc, Role};

/// True if the out-ports of such a primitive depend on the outside: on devices, other nets, people or clocks.
///
/// The out-ports of an actuator are the device's answers; the net's own clock follows from the trace's start time.
pub(super) fn is_input(desc: &PrimDesc) -> bool {
    match desc.role {
        Role::Sensor(_) | Role::Actuator(_) | Role::DeviceFunction(_) | Role::Input => true,
        Role::Flow(flow) => !follows_from_the_cycle(flow),
        Role::Compute
        | Role::Constant
        | Role::Delay
        | Role::IsAbsent
        | Role::First
        | Role::Export => false,
    }
}

/// True if the value is there before the first step of a cycle.
pub(super) fn is_latched(desc: &PrimDesc) -> bool {
    matches!(desc.role, Role::Sensor(_) | Role::Input | Role::Flow(_))
}

fn follows_from_the_cycle(flow: CommandFlow) -> bool {
    matches!(
        flow,
        CommandFlow::Time | CommandFlow::Period | CommandFlow::NetTime
    )
}
