//! Order of the operand words of one primitive. The compiler, the verifier and the printer share this definition.

use crate::desc::{ParamType, PortType, PrimDesc, State};
use crate::image::Form;
use alloc::vec::Vec;

/// Role of an operand in a group of words.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Part {
    /// In-port with this index.
    Input(usize),
    /// Parameter with this index.
    Param(usize),
    /// Out-port with this index.
    Output(usize),
    /// State of the primitive.
    State,
}

/// Words of one operand: the first slot, then sizes, then the presence.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Field {
    /// Role of the operand.
    pub part: Part,
    /// Number of words for the length or shape, after the first slot.
    pub sizes: usize,
    /// Whether the last word is a presence slot.
    pub presence: bool,
}

impl Field {
    /// Returns the number of words.
    #[must_use]
    pub const fn words(self) -> usize {
        1 + self.sizes + self.presence as usize
    }
}

/// Returns the operands of one group in order: inputs, parameters, outputs, state.
#[must_use]
pub fn fields(desc: &PrimDesc, form: Form) -> Vec<Field> {
    let presence = form == Form::Optional;
    let inputs = desc.inputs.iter().enumerate().map(|(k, p)| Field {
        part: Part::Input(k),
        sizes: port_sizes(p.ty),
        presence,
    });
    let params = desc.params.iter().enumerate().filter_map(|(k, p)| {
        Some(Field {
            part: Part::Param(k),
            sizes: param_sizes(p.ty)?,
            presence: false,
        })
    });
    let outputs = desc.outputs.iter().enumerate().map(|(k, p)| Field {
        part: Part::Output(k),
        sizes: port_sizes(p.ty),
        presence,
    });
    let state = state_sizes(desc.state).map(|sizes| Field {
        part: Part::State,
        sizes,
        presence: false,
    });
    inputs.chain(params).chain(outputs).chain(state).collect()
}

/// Returns the number of words of one group.
#[must_use]
pub fn group(fields: &[Field]) -> usize {
    fields.iter().map(|f| f.words()).sum()
}

const fn port_sizes(ty: PortType) -> usize {
    match ty {
        PortType::One(_) => 0,
        PortType::Array(_) => 1,
        PortType::Matrix => 2,
    }
}

/// Returns the number of size words of a parameter; `None` for a text, which has no operand.
const fn param_sizes(ty: ParamType) -> Option<usize> {
    match ty {
        ParamType::One(_) => Some(0),
        ParamType::Array(_) => Some(1),
        ParamType::Str => None,
    }
}

const fn state_sizes(state: State) -> Option<usize> {
    match state {
        State::None | State::Cells(0) => None,
        State::Cells(_) => Some(0),
        State::Sized(_) => Some(1),
    }
}
