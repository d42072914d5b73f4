//! Flows, with their roles and clocks.

use crate::ty::Ty;
use crate::typed::{BlockId, ExprId, FlowId};
use rpi_diag::Span;
use rpi_syntax::Name;

/// Role of a flow in its unit: parameter, input, output or local.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum FlowRole {
    /// Value or device that is fixed when the command is loaded.
    Param,
    /// Input of the unit, an in-port.
    Input,
    /// Value taken over from the preceding command.
    TakenOver,
    /// Output of the unit, an out-port.
    Output,
    /// Flow that is only used inside the unit.
    Local,
}

impl FlowRole {
    /// Returns whether the unit defines flows of this role by equations.
    #[must_use]
    pub fn has_equation(self) -> bool {
        matches!(self, FlowRole::Output | FlowRole::Local)
    }
}

/// Whether a flow may be absent, and whether that is declared or inferred.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum FlowPresence {
    /// The presence is declared; `true` if the flow may be absent.
    Declared(bool),
    /// The presence is inferred from the flow's equation.
    Inferred,
}

/// Named value of a unit that changes from cycle to cycle: a port or a local flow.
#[derive(Clone, Debug)]
pub struct Flow {
    /// Name of the flow.
    pub name: Name,
    /// Type of the flow.
    pub ty: Ty,
    /// Whether the flow may be absent.
    pub optional: FlowPresence,
    /// How the flow gets its value: as an input, an output, a local flow, a parameter or a value from the predecessor.
    pub role: FlowRole,
    /// Block that contains the flow.
    pub block: BlockId,
    /// Declared clock; none if there is no clock declaration.
    pub clock: Option<DeclaredClock>,
    /// Default of an input; none if the caller must give an argument.
    pub default: Option<ExprId>,
    /// Span of the name in the declaration.
    pub span: Span,
}

/// Clock in a declaration or `when`: the cycles in which a flow has a given value.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct DeclaredClock {
    /// Flow whose value is the condition of the clock.
    pub flow: FlowId,
    /// Value of the flow: 0 or 1 for a Boolean, the index of an enum's value.
    pub value: u32,
}
