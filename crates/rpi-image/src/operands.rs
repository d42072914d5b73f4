//! The order of operand words of one primitive in a row: told here once for the compiler, the verifier and the printer.

use crate::desc::{ParamType, PortType, PrimDesc, State};
use crate::image::Form;
use alloc::vec::Vec;

/// What a group of words stands for.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Part {
    /// In-port of this index.
    Input(usize),
    /// Parameter of this index.
    Param(usize),
    /// Out-port of this index.
    Output(usize),
    /// The state.
    State,
}

/// Some words of a group.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Field {
    /// What they stand for.
    pub part: Part,
    /// Words that tell length or shape, right after the first cell.
    pub sizes: usize,
    /// True if a presence cell comes last.
    pub presence: bool,
}

impl Field {
    /// Number of words.
    #[must_use]
    pub const fn words(self) -> usize {
        1 + self.sizes + self.presence as usize
    }
}

/// The fields of one group: inputs, parameters, outputs, state.
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

/// Number of words of one group.
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

/// Text parameters take no word.
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
