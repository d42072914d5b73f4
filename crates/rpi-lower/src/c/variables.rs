//! Variables and constants of the C program: the names and types of registers.

use super::literals::literal;
use super::names::VariableNames;
use super::types::types;
use crate::flat_net::FlatNet;
use crate::registers::{Region, Register};
use rpi_image::Scalar;
use rpi_net::Net;

/// Names and types of the registers of a flat net.
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

    /// The type of a register's slots.
    pub(super) fn ty(&self, slot: Register) -> Scalar {
        self.types[slot.index()]
    }

    /// The C variable of slot `k` of a register.
    pub(super) fn name(&self, slot: Register, k: u32) -> String {
        self.names.cell(self.flat, slot, k)
    }

    /// Registers in which delays keep their state, in order.
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

    /// The C expression for a Boolean register.
    pub(super) fn bool(&self, slot: Register) -> String {
        self.cell(slot, 0, Scalar::Bool)
    }

    /// The C expression for slot `k` of a register: a variable or a constant.
    pub(super) fn cell(&self, slot: Register, k: u32, ty: Scalar) -> String {
        if self.flat.registers.region(slot) != Region::Constant {
            return self.name(slot, k);
        }
        let mut content = Vec::new();
        self.flat.registers.append_initial(slot, &mut content);
        literal(content.get(k as usize).copied().unwrap_or(0), ty)
    }
}
