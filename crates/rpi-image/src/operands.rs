//! Order of the operand words of one primitive. The compiler, the verifier and the printer share this definition.

use crate::desc::{ParamType, PortType, PrimDesc, StateSize};
use crate::image::Form;
use alloc::vec::Vec;

/// Port, parameter or state that an operand stands for, in one call of a primitive.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum OperandRole {
    /// Operand for the in-port with this index.
    Input(usize),
    /// Operand for the parameter with this index.
    Param(usize),
    /// Operand for the out-port with this index.
    Output(usize),
    /// Operand for the state of the primitive.
    State,
}

/// Operand of a primitive call in the code of an image. Its words are the first slot, then sizes, then the presence.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Operand {
    /// Port, parameter or state that the operand stands for.
    pub role: OperandRole,
    /// Number of words for the length or shape, after the first slot.
    pub size_words: usize,
    /// Whether the last word is a presence slot.
    pub has_presence: bool,
}

impl Operand {
    /// Returns the number of consecutive 32-bit words that encode the operand.
    #[must_use]
    pub const fn words(self) -> usize {
        1 + self.size_words + self.has_presence as usize
    }
}

/// Returns the operands of one call of a primitive in order: inputs, parameters, outputs, state.
#[must_use]
pub fn operand_layout(desc: &PrimDesc, form: Form) -> Vec<Operand> {
    let presence = form == Form::Optional;
    let inputs = desc.inputs.iter().enumerate().map(|(k, p)| Operand {
        role: OperandRole::Input(k),
        size_words: port_sizes(p.ty),
        has_presence: presence,
    });
    let params = desc.params.iter().enumerate().filter_map(|(k, p)| {
        Some(Operand {
            role: OperandRole::Param(k),
            size_words: param_sizes(p.ty)?,
            has_presence: false,
        })
    });
    let outputs = desc.outputs.iter().enumerate().map(|(k, p)| Operand {
        role: OperandRole::Output(k),
        size_words: port_sizes(p.ty),
        has_presence: presence,
    });
    let state = state_sizes(desc.state).map(|sizes| Operand {
        role: OperandRole::State,
        size_words: sizes,
        has_presence: false,
    });
    inputs.chain(params).chain(outputs).chain(state).collect()
}

/// Returns the number of operand words of one call of a primitive.
#[must_use]
pub fn group_words(fields: &[Operand]) -> usize {
    fields.iter().map(|f| f.words()).sum()
}

const fn port_sizes(ty: PortType) -> usize {
    match ty {
        PortType::Scalar(_) => 0,
        PortType::Array(_) => 1,
        PortType::Matrix => 2,
    }
}

/// Returns the number of size words of a parameter; `None` for a text, which has no operand.
const fn param_sizes(ty: ParamType) -> Option<usize> {
    match ty {
        ParamType::Scalar(_) => Some(0),
        ParamType::Array(_) => Some(1),
        ParamType::Str => None,
    }
}

const fn state_sizes(state: StateSize) -> Option<usize> {
    match state {
        StateSize::None | StateSize::Fixed(0) => None,
        StateSize::Fixed(_) => Some(0),
        StateSize::Computed(_) => Some(1),
    }
}
