//! Clocks, and flows that the core provides to a command.

use crate::context::FaultCode;
use crate::macros::{interface, primitive};
use crate::registry::Prim;
use rpi_image::{CommandFlow, Role};

pub(super) const ALL: &[Prim] = &[CLOCK, CYCLE_TIME, CANCEL, TAKEOVER, ESTOP];

primitive! {
    /// Scaled time since the start, in s. Adds `inIncrement` times the period in each cycle, so the first output is one
    /// step, not 0. `inReset` sets the time to 0 before the addition. The time stops while an input is absent.
    CLOCK = "Core::Clock";
    in { inReset: bool = Reset(Bool(false)); inIncrement: f64 = Increment(Real(1.0)) }
    out { outValue: f64 }
    state { f64 }
    presence strict work 2;
    c Code(r"
*s0 = (inReset ? 0.0 : *s0) + inIncrement * rpi_dt;
*outValue = *s0;
");
    full |cx, _, (time,), (), (reset, increment)| {
        *time = if reset { 0.0 } else { *time } + increment * cx.time.dt;
        (*time,)
    }
}

interface! {
    /// Period of the command, in s.
    CYCLE_TIME = "Core::CycleTime";
    in {}
    out { outValue: f64 }
    presence always work 0;
    role Role::Flow(CommandFlow::Period)
}

interface! {
    /// True from the first cycle after a request to cancel the command.
    CANCEL = "Cancel";
    in {}
    out { outCancel: bool }
    presence always work 0;
    role Role::Flow(CommandFlow::Cancel)
}

interface! {
    /// True in each cycle in which a successor of the command is scheduled that takes over every actuator that may be
    /// moving.
    TAKEOVER = "Takeover";
    in {}
    out { outTakeover: bool }
    presence always work 0;
    role Role::Flow(CommandFlow::Takeover)
}

primitive! {
    /// Emergency stop. If the input is true, the cycle faults: the command ends with a safe stop of its devices.
    ESTOP = "EStop";
    in { inEStop: bool }
    out {}
    presence strict work 1 faults;
    c Code(r"
if (inEStop) {
  rpi_fault(cx, RPI_EMERGENCY_STOP, at);
}
");
    full |cx, place, _, _, (stop,)| {
        if stop {
            cx.fault(FaultCode::EmergencyStop, place);
        }
    }
}
