//! Variables and constants of the C program: the names and types of registers.

use super::literals::literal;
use super::names::VariableNames;
use super::types::types;
use crate::flat_net::FlatNet;
use crate::registers::{Region, Register};
use rpi_image::Scalar;
use rpi_net::Net;

/// C names and types of the registers of a flat net.
pub(super) struct Variables<'a> {
    pub(super) flat: &'a FlatNet,
    names: VariableNames,
    types: Vec<Scalar>,
}

impl<'a> Variables<'a> {
    pub(super) fn new(net: &Net, flat: &'a FlatNet) -> Self {
        Variables {
            flat,
            names: VariableNames::new(net, flat),
            types: types(flat),
        }
    }

    /// Returns the scalar type of each slot of a register.
    pub(super) fn ty(&self, slot: Register) -> Scalar {
        self.types[slot.index()]
    }

    /// Returns the C expression for the memory slot with index `k` of a register that is not a constant.
    pub(super) fn name(&self, slot: Register, k: u32) -> String {
        self.names.cell(self.flat, slot, k)
    }

    /// Returns the registers that receive a value at the end of a cycle for the next one, such as the state of delays,
    /// in ascending order. The state of primitives is not among them.
    pub(super) fn kept(&self) -> Vec<Register> {
        let latched = self
            .flat
            .scopes
            .iter()
            .flat_map(|s| s.latches.iter().map(|l| l.1));
        let mut kept: Vec<Register> = latched.collect();
        kept.sort_unstable();
        kept.dedup();
        kept
    }

    /// Returns the C expression for a Boolean register: a variable, `true` or `false`.
    pub(super) fn bool(&self, slot: Register) -> String {
        self.cell(slot, 0, Scalar::Bool)
    }

    /// Returns the C expression for the memory slot with index `k` of a register: a variable, or a literal of type `ty`
    /// if the register is a constant.
    pub(super) fn cell(&self, slot: Register, k: u32, ty: Scalar) -> String {
        if self.flat.registers.region(slot) != Region::Constant {
            return self.name(slot, k);
        }
        let mut content = Vec::new();
        self.flat.registers.append_initial(slot, &mut content);
        literal(content.get(k as usize).copied().unwrap_or(0), ty)
    }
}
