//! Operands of an operation, and their substitution in C forms.

use super::literals::{literal, real_literal};
use super::types::expected;
use super::variables::Variables;
use crate::flat_net::{FlatNet, Op};
use crate::registers::Register;
use rpi_image::image::Form;
use rpi_image::operands::{OperandRole, operand_layout};
use rpi_image::{PrimDesc, Scalar};

/// Operands of one primitive call, as needed to fill the placeholders of its C template.
pub(super) struct Operands {
    /// Inputs, then parameters: value register, type and presence register of each. `None` as presence means always
    /// present.
    inputs: Vec<(Register, Scalar, Option<Register>)>,
    /// Value register and presence register of each output; `None` in the form of the primitive without presences.
    pub(super) outputs: Vec<(Register, Option<Register>)>,
    /// C expression for the state of the primitive, such as `state->s5`; empty if it has none.
    pub(super) state: String,
}

impl Operands {
    /// Extracts the operands of the primitive call `op`. `desc` and `form` are the primitive and the form of its code
    /// that the operation calls.
    pub(super) fn new(flat: &FlatNet, op: Op, desc: &'static PrimDesc, form: Form) -> Operands {
        let mut operands = Operands {
            inputs: Vec::new(),
            outputs: Vec::new(),
            state: String::new(),
        };
        let words = flat.words(op);
        let mut at = 0;
        for field in operand_layout(desc, form) {
            let (slot, last) = (Register(words[at]), words[at + field.words() - 1]);
            let present = field.has_presence.then_some(Register(last));
            at += field.words();
            match field.role {
                OperandRole::Output(_) => operands.outputs.push((slot, present)),
                OperandRole::State => operands.state = format!("state->s{}", slot.0),
                part => operands.inputs.push((slot, expected(desc, part), present)),
            }
        }
        operands
    }
}

/// Variables and times that the placeholders of a C template are replaced by.
pub(super) struct Template<'a> {
    pub(super) variables: Variables<'a>,
    /// Period of the command in seconds, the value of the placeholder `{dt}`.
    pub(super) dt: f64,
    /// Duration of a tick of the core in nanoseconds, the value of the placeholder `{tick}`.
    pub(super) tick_ns: u64,
}

impl Template<'_> {
    /// Returns the C template `form` with its placeholders in braces replaced. A placeholder without a slot number
    /// stands for slot `k` of its operand.
    pub(super) fn fill(&self, form: &str, operands: &Operands, k: u32) -> String {
        let mut out = String::new();
        let mut rest = form;
        while let Some((before, after)) = rest.split_once('{') {
            let Some((name, after)) = after.split_once('}') else {
                break;
            };
            out.push_str(before);
            out.push_str(&self.operand(name, operands, k));
            rest = after;
        }
        out.push_str(rest);
        out
    }

    fn operand(&self, name: &str, operands: &Operands, k: u32) -> String {
        match name {
            "s" => return operands.state.clone(),
            "dt" => return literal(self.dt.to_bits(), Scalar::Real),
            "tick" => return real_literal(self.tick_ns as f64),
            _ => {}
        }
        let (letter, rest) = name.split_at(1);
        let index = usize::from(letter.as_bytes()[0] - b'a');
        let Some(&(slot, ty, present)) = operands.inputs.get(index) else {
            return String::new();
        };
        match rest {
            "?" => present.map_or("true".to_owned(), |p| self.variables.bool(p)),
            "" => self.variables.cell(
                slot,
                k.min(self.variables.flat.registers.size(slot) - 1),
                ty,
            ),
            cell => self.variables.cell(slot, cell.parse().unwrap_or(0), ty),
        }
    }
}
