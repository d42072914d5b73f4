//! Order of the operand words of one primitive. The compiler, the verifier and the printer share this definition.

use crate::desc::{ParamType, PortType, PrimDesc, StateSize};
use crate::image::Form;
use alloc::vec::Vec;

/// Port, parameter or state of a primitive to which an operand of a call belongs.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum OperandRole {
    /// The operand holds the slots of the in-port with this index in [`PrimDesc::inputs`].
    Input(usize),
    /// The operand holds the slots of the parameter with this index in [`PrimDesc::params`].
    Param(usize),
    /// The operand holds the slots of the out-port with this index in [`PrimDesc::outputs`].
    Output(usize),
    /// The operand holds the slots of the state of the primitive.
    State,
}

/// Layout of one operand of a primitive call in the code of an image. Its words are the index of the first slot, then
/// the length or shape, then the index of the presence slot; the last two only if needed.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Operand {
    /// Port, parameter or state to which the operand belongs.
    pub role: OperandRole,
    /// Number of words for the length or shape: 0 for a scalar, 1 for an array or a state of computed size, 2 for a
    /// matrix.
    pub size_words: usize,
    /// True if the last word is the index of a presence slot.
    pub has_presence: bool,
}

impl Operand {
    /// Returns the number of consecutive 32-bit words that encode the operand.
    #[must_use]
    pub const fn words(self) -> usize {
        1 + self.size_words + self.has_presence as usize
    }
}

/// Returns the operands of one call of a primitive in the order of their words: inputs, parameters, outputs, state.
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

/// Returns the number of operand words of one call of a primitive; `fields` are the operands of the call.
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

/// Returns the number of words for the length of a parameter: 0 for a scalar, 1 for an array. Returns `None` for a
/// text, which has no operand.
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
