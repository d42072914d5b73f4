//! Constant folding, with the primitives' own code.
//!
//! In addition: primitives whose inputs turn out to be always present lose their presence words; Boolean operations
//! with a constant side are simplified; scopes that are always active are inlined, and those that are never active are
//! removed.

use super::identities::{self, Identity};
use super::substitution::{Substitution, drop_ops};
use super::traversal::{TraversalEvent, traverse};
use crate::access::Access;
use crate::flat_net::{FlatNet, Item, Op, OpKind, ScopeId, index};
use crate::registers::{Region, Register};
use rpi_image::StateSize;
use rpi_image::image::Form;
use rpi_prims::{Context, CycleTime, NoDevices, PrimId};

pub(super) fn fold(flat: &mut FlatNet, clock: CycleTime) {
    let mut fold = Fold {
        renames: Substitution::new(flat),
        dropped: vec![false; flat.ops.len()],
        never_active: Vec::new(),
        clock,
    };
    for stop in traverse(flat) {
        match stop {
            TraversalEvent::Enter(scope) => fold.enter(flat, scope),
            TraversalEvent::Op(op, _) if fold.never_active.is_empty() => fold.op(flat, op),
            TraversalEvent::Op(op, _) => fold.drop_dead_op(flat, op),
            TraversalEvent::Leave(scope) => _ = fold.never_active.pop_if(|s| *s == scope),
        }
    }
    // Operations run after those whose results they read, so their own reads are already renamed.
    fold.renames.apply_outside_ops(flat);
    drop_ops(flat, &fold.dropped);
    inline_scopes(flat);
}

struct Fold {
    renames: Substitution,
    dropped: Vec<bool>,
    /// The outermost of the scopes around the current operation that are never active; empty if all may be active. At
    /// most one entry.
    never_active: Vec<ScopeId>,
    clock: CycleTime,
}

impl Fold {
    fn enter(&mut self, flat: &FlatNet, scope: ScopeId) {
        let guard = self.renames.get(flat.scopes[scope.index()].guard);
        if guard == Register::FALSE && self.never_active.is_empty() {
            self.never_active.push(scope);
        }
    }

    /// Drops an operation in a scope that is never active. Readers of its outputs get the constant 0, the initial
    /// value.
    fn drop_dead_op(&mut self, flat: &mut FlatNet, number: u32) {
        let written: Vec<Register> = flat.writes(flat.ops[number as usize]).collect();
        for slot in written {
            let zero = flat
                .registers
                .constant(&vec![0; flat.registers.size(slot) as usize]);
            self.renames.set(slot, zero);
        }
        self.dropped[number as usize] = true;
    }

    fn op(&mut self, flat: &mut FlatNet, number: u32) {
        self.renames.apply_to_op(flat, number);
        self.drop_presences(flat, number);
        let op = flat.ops[number as usize];
        let done = match op.kind {
            OpKind::Run(prim, form) => self.run(flat, op, prim, form),
            OpKind::Copy => self.copy(flat, op),
            OpKind::Actuate(..) | OpKind::Call(..) => false,
        };
        self.dropped[number as usize] = done;
    }

    fn copy(&mut self, flat: &FlatNet, op: Op) -> bool {
        let (from, to) = (Register(flat.words(op)[0]), Register(flat.words(op)[1]));
        let fixed = !matches!(flat.registers.region(from), Region::State(_));
        if fixed {
            self.renames.set(to, from);
        }
        fixed
    }

    /// Replaces a call of a primitive in the form with presence words by one in the form without, if all its inputs are
    /// present in every cycle.
    fn drop_presences(&mut self, flat: &mut FlatNet, number: u32) {
        let op = flat.ops[number as usize];
        let OpKind::Run(prim, Form::Optional) = op.kind else {
            return;
        };
        let there = flat
            .accesses(op)
            .all(|(a, slot)| a != Access::ReadPresence || slot == Register::TRUE);
        if !there || prim.prim().total.is_none() {
            return;
        }
        let presence = presence_words(flat, op);
        let words: Vec<u32> = flat.words(op).to_vec();
        let kept = (0..words.len()).filter(|k| !presence[*k]);
        let kept: Vec<u32> = kept.map(|k| words[k]).collect();
        for k in (0..words.len()).filter(|k| presence[*k]) {
            if flat.access(op, k) == Access::Write {
                self.renames.set(Register(words[k]), Register::TRUE);
            }
        }
        flat.accesses.get_or_compute(prim, Form::Total);
        flat.words[op.at as usize..op.at as usize + kept.len()].copy_from_slice(&kept);
        let op = &mut flat.ops[number as usize];
        op.kind = OpKind::Run(prim, Form::Total);
        op.len = index(kept.len());
    }

    fn run(&mut self, flat: &mut FlatNet, op: Op, prim: PrimId, form: Form) -> bool {
        if let Some(side) = self.simplify(flat, op, prim, form) {
            let written: Vec<Register> = flat.writes(op).collect();
            self.renames.set(written[0], side);
            return true;
        }
        let constant = flat
            .reads(op)
            .all(|s| flat.registers.region(s) == Region::Constant);
        if !constant || !matches!(prim.desc().state, StateSize::None) {
            return false;
        }
        let Some(results) = compute(flat, op, prim, form, self.clock) else {
            return false;
        };
        for (slot, content) in results {
            let constant = flat.registers.constant(&content);
            self.renames.set(slot, constant);
        }
        true
    }

    /// Returns the input register that always equals the result of an operation, if an algebraic identity proves one
    /// (`x and true` is `x`); else `None`.
    fn simplify(&self, flat: &FlatNet, op: Op, prim: PrimId, form: Form) -> Option<Register> {
        let words = flat.words(op);
        match (identities::identity_of(prim)?, form) {
            (Identity::Gate { neutral, absorbing }, Form::Total) => identities::simplify_gate(
                Register(words[0]),
                Register(words[1]),
                neutral,
                absorbing,
            ),
            (Identity::Choice, Form::Total) => identities::simplify_choice(
                Register(words[0]),
                Register(words[1]),
                Register(words[2]),
            ),
            _ => None,
        }
    }
}

/// Returns, for each operand word of an operation, whether it is a presence register. Empty for operations that do not
/// call a primitive.
fn presence_words(flat: &FlatNet, op: Op) -> Vec<bool> {
    let OpKind::Run(prim, form) = op.kind else {
        return Vec::new();
    };
    let fields = rpi_image::operands::operand_layout(prim.desc(), form);
    let words = fields.iter().flat_map(|f| {
        let (plain, presence) = (f.words() - usize::from(f.has_presence), f.has_presence);
        std::iter::repeat_n(false, plain).chain(presence.then_some(true))
    });
    let words: Vec<bool> = words.collect();
    debug_assert_eq!(words.len(), flat.words(op).len());
    words
}

/// Runs a primitive on constant operands at compile time. Returns its output registers with their contents; `None` if
/// it raised a fault or has no code in this form.
fn compute(
    flat: &FlatNet,
    op: Op,
    prim: PrimId,
    form: Form,
    clock: CycleTime,
) -> Option<Vec<(Register, Vec<u64>)>> {
    let code = match form {
        Form::Total => prim.prim().total,
        Form::Optional => prim.prim().optional,
    }?;
    let (mut cells, mut words) = (Vec::new(), flat.words(op).to_vec());
    let mut written = Vec::new();
    for (k, word) in words.iter_mut().enumerate() {
        let (access, slot) = (flat.access(op, k), Register(*word));
        if access == Access::Number {
            continue;
        }
        *word = index(cells.len());
        if access == Access::Write {
            written.push((slot, cells.len()));
            cells.resize(cells.len() + flat.registers.size(slot) as usize, 0);
        } else {
            flat.registers.append_initial(slot, &mut cells);
        }
    }
    let mut cx = Context {
        slots: &mut cells,
        time: clock,
        devices: &mut NoDevices,
        fault: None,
    };
    code(&mut cx, &words);
    let faulted = cx.fault.is_some();
    let content = |(slot, at): (Register, usize)| {
        let end = at + flat.registers.size(slot) as usize;
        (slot, cells[at..end].to_vec())
    };
    (!faulted).then(|| written.into_iter().map(content).collect())
}

/// Moves the items of scopes that are always active into the scopes around them, and removes scopes that are never
/// active.
fn inline_scopes(flat: &mut FlatNet) {
    for k in (0..flat.scopes.len()).rev() {
        let items = std::mem::take(&mut flat.scopes[k].items);
        let mut kept = Vec::with_capacity(items.len());
        for item in items {
            match item {
                Item::Scope(inner) => inline_scope(flat, ScopeId(index(k)), inner, &mut kept),
                Item::Op(_) => kept.push(item),
            }
        }
        flat.scopes[k].items = kept;
    }
}

fn inline_scope(flat: &mut FlatNet, outer: ScopeId, inner: ScopeId, kept: &mut Vec<Item>) {
    let scope = &mut flat.scopes[inner.index()];
    match scope.guard {
        Register::TRUE if scope.reset.is_none() => {
            kept.append(&mut scope.items);
            let latches = std::mem::take(&mut scope.latches);
            flat.scopes[outer.index()].latches.extend(latches);
            // Nested scopes of the inlined scope now belong to the outer one.
            for item in kept.iter() {
                if let Item::Scope(moved) = item {
                    flat.scopes[moved.index()].parent = Some(outer);
                }
            }
        }
        Register::FALSE => {
            scope.items.clear();
            scope.latches.clear();
        }
        _ => kept.push(Item::Scope(inner)),
    }
}
