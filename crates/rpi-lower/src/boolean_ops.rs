//! Boolean operations that the lowering adds for presence and activation.

use crate::flat_net::{FlatNet, Item, NO_NODE, OpKind, ScopeId, index};
use crate::registers::{Region, Register};
use rpi_image::Form;
use rpi_net::prim;
use rpi_prims::PrimId;
use rustc_hash::FxHashMap;

/// Table of the Boolean operations that the lowering has added, so that equal ones are computed once. Maps (primitive,
/// first operand, second operand) to the operations with these operands, in different scopes.
#[derive(Default)]
pub(crate) struct BooleanOps {
    known: FxHashMap<(PrimId, Register, Register), Vec<AddedOp>>,
}

/// A Boolean operation that has been added to the flat net, with its result.
struct AddedOp {
    /// Index of the operation in [`FlatNet::ops`].
    op: u32,
    /// Scope in whose list of items the operation is.
    scope: ScopeId,
    result: Register,
}

impl BooleanOps {
    /// Returns the register of the conjunction of two Boolean registers. Adds the operation to `scope` unless a
    /// constant operand decides the result or an equal operation runs whenever `scope` does.
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

    /// Returns the register of the disjunction of two Boolean registers. Adds the operation to `scope` unless a
    /// constant operand decides the result or an equal operation runs whenever `scope` does.
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

    /// Returns the register of the negation of a Boolean register. Adds the operation to `scope` unless the operand is
    /// constant or an equal operation runs whenever `scope` does.
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
    /// Moves the operation outwards to the innermost scope that encloses both its own scope and `reader`, where it can
    /// serve readers in both. Returns false and leaves the operation in place if an operand is computed between the two
    /// places.
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

/// Largest number of operations and scopes searched for a writer of an operand, a bound on the compile time. If the
/// search would need more, the operation is not moved.
const SEARCHED: u32 = 10_000;

/// Returns whether one of the registers `slots` is written in `scope`, or a scope inside it, before the operation with
/// index `end`; `None` if that operation is not in the scope.
///
/// A search of more than `budget` items returns true, which is safe: a register counts as written. `budget` is reduced by
/// one for each item.
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
