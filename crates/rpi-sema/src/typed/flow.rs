//! Flows, with their roles and clocks.

use crate::ty::Ty;
use crate::typed::{BlockId, ExprId, FlowId};
use rpi_diag::Span;
use rpi_syntax::Name;

/// Role of a flow in its unit, which decides where its value comes from.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum FlowRole {
    /// Parameter: a value or device that is fixed when the command is loaded.
    Param,
    /// In-port of the unit, whose value the caller gives in each cycle.
    Input,
    /// Value that a command takes over from the preceding command.
    TakenOver,
    /// Out-port of the unit, which equations of the unit define.
    Output,
    /// Flow that is defined and used only inside of the unit.
    Local,
}

impl FlowRole {
    /// Returns whether equations of the unit define flows of this role: out-ports and local flows.
    #[must_use]
    pub fn has_equation(self) -> bool {
        matches!(self, FlowRole::Output | FlowRole::Local)
    }
}

/// Whether a flow may be absent in a cycle, and whether that is declared or inferred.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum FlowPresence {
    /// The presence is declared. The value is true if the flow is declared optional (`T?`), so that it may be absent.
    Declared(bool),
    /// The presence is inferred from the flow's equation.
    Inferred,
}

/// Named value of a unit: a port, a parameter or a local flow. Except for parameters, the value changes from cycle to
/// cycle.
#[derive(Clone, PartialEq, Debug)]
pub struct Flow {
    /// Name of the flow.
    pub name: Name,
    /// Type of the flow.
    pub ty: Ty,
    /// Whether the flow may be absent.
    pub optional: FlowPresence,
    /// Role of the flow, which decides where its value comes from: in-port, out-port, local flow, parameter, or value
    /// from the preceding command.
    pub role: FlowRole,
    /// Block of the unit in which the flow is declared or introduced.
    pub block: BlockId,
    /// Declared clock; `None` if the declaration states none.
    pub clock: Option<DeclaredClock>,
    /// Default of an in-port or parameter; `None` if there is none, so that the caller must give an argument.
    pub default: Option<ExprId>,
    /// Location of the flow's name in its declaration.
    pub span: Span,
}

/// Clock in a declaration or after `when`: the cycles in which a flow has a certain value.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct DeclaredClock {
    /// Flow whose value is the condition of the clock.
    pub flow: FlowId,
    /// Value of that flow when the clock ticks: 0 or 1 for a Boolean, an index for an enum.
    pub value: u32,
}
