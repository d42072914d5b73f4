//! Boolean operations that the lowering adds for presence and activation.

use crate::flat::{Flat, NO_NODE, ScopeId, Work};
use crate::slots::{Region, Slot};
use rpi_image::Form;
use rpi_net::prim;
use rpi_prims::PrimId;
use rustc_hash::FxHashMap;

/// Value numbering of Boolean operations: maps (primitive, first, second) to results and the scopes in which they are
/// computed.
#[derive(Default)]
pub(crate) struct Logic {
    known: FxHashMap<(PrimId, Slot, Slot), Vec<(ScopeId, Slot)>>,
}

impl Logic {
    /// Conjunction of two registers, computed in `scope` unless it is known in an enclosing scope.
    pub(crate) fn and(&mut self, flat: &mut Flat, scope: ScopeId, a: Slot, b: Slot) -> Slot {
        let (a, b) = (a.min(b), a.max(b));
        match (a, b) {
            (Slot::FALSE, _) => Slot::FALSE,
            (Slot::TRUE, _) => b,
            _ if a == b => a,
            _ => self.gate(flat, scope, prim!("Core::BooleanAnd"), a, b),
        }
    }

    /// Disjunction of two registers; see [`Logic::and`].
    pub(crate) fn or(&mut self, flat: &mut Flat, scope: ScopeId, a: Slot, b: Slot) -> Slot {
        let (a, b) = (a.min(b), a.max(b));
        match (a, b) {
            (Slot::FALSE, _) => b,
            (Slot::TRUE, _) => Slot::TRUE,
            _ if a == b => a,
            _ => self.gate(flat, scope, prim!("Core::BooleanOr"), a, b),
        }
    }

    /// Negation of a register; see [`Logic::and`].
    pub(crate) fn not(&mut self, flat: &mut Flat, scope: ScopeId, a: Slot) -> Slot {
        match a {
            Slot::FALSE => Slot::TRUE,
            Slot::TRUE => Slot::FALSE,
            _ => self.gate(flat, scope, prim!("Core::BooleanNot"), a, a),
        }
    }

    fn gate(&mut self, flat: &mut Flat, scope: ScopeId, prim: PrimId, a: Slot, b: Slot) -> Slot {
        let known = self.known.entry((prim, a, b)).or_default();
        let found = known.iter().find(|(at, _)| encloses(flat, *at, scope));
        if let Some((_, slot)) = found {
            return *slot;
        }
        let result = flat.slots.add(Region::Value, 1);
        let words = [a.0, b.0, result.0];
        let words = if prim == prim!("Core::BooleanNot") {
            &[a.0, result.0][..]
        } else {
            &words[..]
        };
        flat.push(scope, Work::Run(prim, Form::Total), words, NO_NODE);
        known.push((scope, result));
        result
    }
}

fn encloses(flat: &Flat, outer: ScopeId, inner: ScopeId) -> bool {
    let parent = |s: &ScopeId| flat.scopes[s.index()].parent;
    std::iter::successors(Some(inner), parent).any(|s| s == outer)
}
