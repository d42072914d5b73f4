//! Flows: what they are for, and when they are there.

use super::{BlockId, ExprId, FlowId};
use crate::ty::Ty;
use rpi_diag::Span;
use rpi_syntax::Name;

/// What a flow is for.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum FlowRole {
    /// A value or device fixed when the command is loaded.
    Param,
    /// An in-port.
    Input,
    /// Taken over from the predecessor.
    Given,
    /// An out-port.
    Output,
    /// None of these.
    Local,
}

impl FlowRole {
    /// Whether equations of the unit define such a flow.
    #[must_use]
    pub fn has_equation(self) -> bool {
        matches!(self, FlowRole::Output | FlowRole::Local)
    }
}

/// When a flow or port can be absent.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Optional {
    /// As declared.
    Declared(bool),
    /// Found out from its equation.
    Inferred,
}

/// A flow.
#[derive(Clone, Debug)]
pub struct Flow {
    /// Its name.
    pub name: Name,
    /// Its type.
    pub ty: Ty,
    /// Whether it may be absent.
    pub optional: Optional,
    /// What it is for.
    pub role: FlowRole,
    /// The block it belongs to.
    pub block: BlockId,
    /// The clock that its declaration states.
    pub clock: Option<ClockOn>,
    /// What a port is where the caller gives nothing.
    pub default: Option<ExprId>,
    /// Where it is declared.
    pub span: Span,
}

/// A clock: the cycles in which a flow has one of the values.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct ClockOn {
    /// The flow that decides.
    pub flow: FlowId,
    /// The value: 0 or 1 for a Boolean, the place of an enum's value.
    pub value: u32,
}
