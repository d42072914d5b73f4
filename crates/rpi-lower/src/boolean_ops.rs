//! Boolean operations that the lowering adds for presence and activation.

use crate::flat_net::{FlatNet, Item, NO_NODE, OpKind, ScopeId, index};
use crate::registers::{Region, Register};
use rpi_image::Form;
use rpi_net::prim;
use rpi_prims::PrimId;
use rustc_hash::FxHashMap;

/// Table of Boolean operations for value numbering: maps (primitive, first, second) to the operations with these
/// operands.
#[derive(Default)]
pub(crate) struct BooleanOps {
    known: FxHashMap<(PrimId, Register, Register), Vec<AddedOp>>,
}

/// A Boolean operation that has been added to the flat net, with its result.
struct AddedOp {
    /// Index of the operation.
    op: u32,
    /// Scope in which the operation is computed.
    scope: ScopeId,
    result: Register,
}

impl BooleanOps {
    /// Conjunction of two registers, computed in `scope` unless it is known in an enclosing scope.
    pub(crate) fn and(
        &mut self,
        flat: &mut FlatNet,
        scope: ScopeId,
        a: Register,
        b: Register,
    ) -> Register {
        let (a, b) = (a.min(b), a.max(b));
        match (a, b) {
            (Register::FALSE, _) => Register::FALSE,
            (Register::TRUE, _) => b,
            _ if a == b => a,
            _ => self.gate(flat, scope, prim!("Core::BooleanAnd"), a, b),
        }
    }

    /// Disjunction of two registers; see [`BooleanOps::and`].
    pub(crate) fn or(
        &mut self,
        flat: &mut FlatNet,
        scope: ScopeId,
        a: Register,
        b: Register,
    ) -> Register {
        let (a, b) = (a.min(b), a.max(b));
        match (a, b) {
            (Register::FALSE, _) => b,
            (Register::TRUE, _) => Register::TRUE,
            _ if a == b => a,
            _ => self.gate(flat, scope, prim!("Core::BooleanOr"), a, b),
        }
    }

    /// Negation of a register; see [`BooleanOps::and`].
    pub(crate) fn not(&mut self, flat: &mut FlatNet, scope: ScopeId, a: Register) -> Register {
        match a {
            Register::FALSE => Register::TRUE,
            Register::TRUE => Register::FALSE,
            _ => self.gate(flat, scope, prim!("Core::BooleanNot"), a, a),
        }
    }

    fn gate(
        &mut self,
        flat: &mut FlatNet,
        scope: ScopeId,
        prim: PrimId,
        a: Register,
        b: Register,
    ) -> Register {
        let known = self.known.entry((prim, a, b)).or_default();
        for one in known.iter_mut() {
            // Not only to save work: the verifier knows two scopes to be active together by the identity of their
            // guards, not by their values.
            if encloses(flat, one.scope, scope) || one.hoist(flat, scope, [a, b]) {
                return one.result;
            }
        }
        let result = flat.registers.add(Region::Value, 1);
        let words = [a.0, b.0, result.0];
        let words = if prim == prim!("Core::BooleanNot") {
            &[a.0, result.0][..]
        } else {
            &words[..]
        };
        flat.push(scope, OpKind::Run(prim, Form::Total), words, NO_NODE);
        let op = index(flat.ops.len() - 1);
        known.push(AddedOp { op, scope, result });
        result
    }
}

impl AddedOp {
    /// Moves the operation to the innermost scope that encloses its own and `reader`. Returns false if an operand is
    /// computed between the two places; the operation then stays.
    fn hoist(&mut self, flat: &mut FlatNet, reader: ScopeId, operands: [Register; 2]) -> bool {
        let parent = |s: &ScopeId| flat.scopes[s.index()].parent;
        let outwards = std::iter::successors(Some(self.scope), parent);
        let Some(child) = outwards.take_while(|s| !encloses(flat, *s, reader)).last() else {
            return false;
        };
        let Some(common) = flat.scopes[child.index()].parent else {
            return false;
        };
        let place = Item::Scope(child);
        let Some(at) = flat.scopes[common.index()]
            .items
            .iter()
            .position(|item| *item == place)
        else {
            return false;
        };
        if writes_before(flat, child, self.op, operands, &mut { SEARCHED }) != Some(false) {
            return false;
        }
        let own = Item::Op(self.op);
        flat.scopes[self.scope.index()]
            .items
            .retain(|item| *item != own);
        flat.scopes[common.index()].items.insert(at, own);
        self.scope = common;
        true
    }
}

/// Largest number of operations searched for a writer of an operand. If more would be needed, the operation is not
/// moved.
const SEARCHED: u32 = 10_000;

/// Returns whether one of the registers is written in `scope` before the operation `end`; `None` if `end` is not in the
/// scope. A search that takes more than `budget` steps counts as a write.
fn writes_before(
    flat: &FlatNet,
    scope: ScopeId,
    end: u32,
    slots: [Register; 2],
    budget: &mut u32,
) -> Option<bool> {
    for item in &flat.scopes[scope.index()].items {
        let Some(rest) = budget.checked_sub(1) else {
            return Some(true);
        };
        *budget = rest;
        match *item {
            Item::Op(op) if op == end => return Some(false),
            Item::Op(op)
                if flat
                    .writes(flat.ops[op as usize])
                    .any(|s| slots.contains(&s)) =>
            {
                return Some(true);
            }
            Item::Op(_) => {}
            Item::Scope(inner) => {
                if let Some(known) = writes_before(flat, inner, end, slots, budget) {
                    return Some(known);
                }
            }
        }
    }
    None
}

fn encloses(flat: &FlatNet, outer: ScopeId, inner: ScopeId) -> bool {
    let parent = |s: &ScopeId| flat.scopes[s.index()].parent;
    std::iter::successors(Some(inner), parent).any(|s| s == outer)
}
