//! Predeclared flows, such as `time` and `first`: their names, and the primitives that compute them.

use crate::ty::Ty;
use rpi_net::prim;
use rpi_prims::PrimId;

/// Predeclared flow: its name, the primitive that provides its value, its type, and whether only commands have it.
pub(crate) struct PredeclaredFlow {
    pub(crate) name: &'static str,
    pub(crate) prim: PrimId,
    pub(crate) ty: Ty,
    pub(crate) only_in_commands: bool,
}

/// Flows that exist without a declaration, such as `time` and `cancel`.
pub(crate) const PREDECLARED_FLOWS: &[PredeclaredFlow] = &[
    predeclared_flow("cancel", prim!("Cancel"), Ty::Bool, true),
    predeclared_flow("takeover", prim!("Takeover"), Ty::Bool, true),
    predeclared_flow("predecessor", prim!("Rpi::Predecessor"), Ty::Result, true),
    predeclared_flow("first", prim!("Rpi::First"), Ty::Bool, false),
    predeclared_flow("time", prim!("Rpi::Elapsed"), Ty::Duration, false),
    predeclared_flow("dt", prim!("Rpi::PeriodTicks"), Ty::Duration, false),
];

const fn predeclared_flow(
    name: &'static str,
    prim: PrimId,
    ty: Ty,
    of_command: bool,
) -> PredeclaredFlow {
    PredeclaredFlow {
        name,
        prim,
        ty,
        only_in_commands: of_command,
    }
}

/// Returns the name of the predeclared flow whose value the primitive `prim` provides; `None` if there is none.
pub(crate) fn predeclared_flow_of_prim(prim: &str) -> Option<&'static str> {
    let flow = PREDECLARED_FLOWS
        .iter()
        .find(|flow| flow.prim.desc().name == prim);
    flow.map(|flow| flow.name)
}
