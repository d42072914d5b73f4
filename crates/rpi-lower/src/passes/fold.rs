//! Constant folding, with the primitives' own code.
//!
//! In addition: primitives whose inputs turn out to be always present lose their presence words; Boolean operations
//! with a constant side are simplified; scopes that are always active are inlined, and those that are never active are
//! removed.

use super::laws::{self, Law};
use super::order::{Stop, walk};
use super::rename::{Renames, drop_ops};
use crate::access::Access;
use crate::flat::{Flat, Item, Op, ScopeId, Work, index};
use crate::slots::{Region, Slot};
use rpi_image::State;
use rpi_image::image::Form;
use rpi_prims::{Clock, Cx, NoDevices, PrimId};

pub(super) fn fold(flat: &mut Flat, clock: Clock) {
    let mut fold = Fold {
        renames: Renames::new(flat),
        dropped: vec![false; flat.ops.len()],
        never: Vec::new(),
        clock,
    };
    for stop in walk(flat) {
        match stop {
            Stop::Enter(scope) => fold.enter(flat, scope),
            Stop::Op(op, _) if fold.never.is_empty() => fold.op(flat, op),
            Stop::Op(op, _) => fold.forget(flat, op),
            Stop::Leave(scope) => _ = fold.never.pop_if(|s| *s == scope),
        }
    }
    // Operations run after those whose results they read, so their own reads are already renamed.
    fold.renames.apply_outside(flat);
    drop_ops(flat, &fold.dropped);
    dissolve(flat);
}

struct Fold {
    renames: Renames,
    dropped: Vec<bool>,
    /// The outermost enclosing scope that is never active, if any (at most one entry).
    never: Vec<ScopeId>,
    clock: Clock,
}

impl Fold {
    fn enter(&mut self, flat: &Flat, scope: ScopeId) {
        let guard = self.renames.get(flat.scopes[scope.index()].guard);
        if guard == Slot::FALSE && self.never.is_empty() {
            self.never.push(scope);
        }
    }

    /// Drops an operation that never runs. Its outputs keep their initial value 0.
    fn forget(&mut self, flat: &mut Flat, number: u32) {
        let written: Vec<Slot> = flat.writes(flat.ops[number as usize]).collect();
        for slot in written {
            let zero = flat
                .slots
                .constant(&vec![0; flat.slots.cells(slot) as usize]);
            self.renames.set(slot, zero);
        }
        self.dropped[number as usize] = true;
    }

    fn op(&mut self, flat: &mut Flat, number: u32) {
        self.renames.reads(flat, number);
        self.be_sure(flat, number);
        let op = flat.ops[number as usize];
        let done = match op.work {
            Work::Run(prim, form) => self.run(flat, op, prim, form),
            Work::Copy => self.copy(flat, op),
            Work::Actuate(..) | Work::Call(..) => false,
        };
        self.dropped[number as usize] = done;
    }

    fn copy(&mut self, flat: &Flat, op: Op) -> bool {
        let (from, to) = (Slot(flat.words(op)[0]), Slot(flat.words(op)[1]));
        let fixed = !matches!(flat.slots.region(from), Region::State(_));
        if fixed {
            self.renames.set(to, from);
        }
        fixed
    }

    /// Switches to the form without presence words if all inputs are certainly present.
    fn be_sure(&mut self, flat: &mut Flat, number: u32) {
        let op = flat.ops[number as usize];
        let Work::Run(prim, Form::Optional) = op.work else {
            return;
        };
        let there = flat
            .accesses(op)
            .all(|(a, slot)| a != Access::Decide || slot == Slot::TRUE);
        if !there || prim.prim().total.is_none() {
            return;
        }
        let presence = presence_words(flat, op);
        let words: Vec<u32> = flat.words(op).to_vec();
        let kept = (0..words.len()).filter(|k| !presence[*k]);
        let kept: Vec<u32> = kept.map(|k| words[k]).collect();
        for k in (0..words.len()).filter(|k| presence[*k]) {
            if flat.access(op, k) == Access::Write {
                self.renames.set(Slot(words[k]), Slot::TRUE);
            }
        }
        flat.shapes.of(prim, Form::Total);
        flat.words[op.at as usize..op.at as usize + kept.len()].copy_from_slice(&kept);
        let op = &mut flat.ops[number as usize];
        op.work = Work::Run(prim, Form::Total);
        op.len = index(kept.len());
    }

    fn run(&mut self, flat: &mut Flat, op: Op, prim: PrimId, form: Form) -> bool {
        if let Some(side) = self.side(flat, op, prim, form) {
            let written: Vec<Slot> = flat.writes(op).collect();
            self.renames.set(written[0], side);
            return true;
        }
        let constant = flat
            .reads(op)
            .all(|s| flat.slots.region(s) == Region::Constant);
        if !constant || !matches!(prim.desc().state, State::None) {
            return false;
        }
        let Some(results) = compute(flat, op, prim, form, self.clock) else {
            return false;
        };
        for (slot, content) in results {
            let constant = flat.slots.constant(&content);
            self.renames.set(slot, constant);
        }
        true
    }

    /// The input to which an operation can be simplified.
    fn side(&self, flat: &Flat, op: Op, prim: PrimId, form: Form) -> Option<Slot> {
        let words = flat.words(op);
        match (laws::of(prim)?, form) {
            (Law::Gate { neutral, absorbing }, Form::Total) => {
                laws::gate(Slot(words[0]), Slot(words[1]), neutral, absorbing)
            }
            (Law::Choice, Form::Total) => {
                laws::choice(Slot(words[0]), Slot(words[1]), Slot(words[2]))
            }
            _ => None,
        }
    }
}

/// For each word of an operation, whether it is a presence.
fn presence_words(flat: &Flat, op: Op) -> Vec<bool> {
    let Work::Run(prim, form) = op.work else {
        return Vec::new();
    };
    let fields = rpi_image::operands::fields(prim.desc(), form);
    let words = fields.iter().flat_map(|f| {
        let (plain, presence) = (f.words() - usize::from(f.presence), f.presence);
        std::iter::repeat_n(false, plain).chain(presence.then_some(true))
    });
    let words: Vec<bool> = words.collect();
    debug_assert_eq!(words.len(), flat.words(op).len());
    words
}

/// Runs an operation on constants. Returns its outputs, or `None` if it faulted.
fn compute(
    flat: &Flat,
    op: Op,
    prim: PrimId,
    form: Form,
    clock: Clock,
) -> Option<Vec<(Slot, Vec<u64>)>> {
    let code = match form {
        Form::Total => prim.prim().total,
        Form::Optional => prim.prim().optional,
    }?;
    let (mut cells, mut words) = (Vec::new(), flat.words(op).to_vec());
    let mut written = Vec::new();
    for (k, word) in words.iter_mut().enumerate() {
        let (access, slot) = (flat.access(op, k), Slot(*word));
        if access == Access::Number {
            continue;
        }
        *word = index(cells.len());
        if access == Access::Write {
            written.push((slot, cells.len()));
            cells.resize(cells.len() + flat.slots.cells(slot) as usize, 0);
        } else {
            flat.slots.content(slot, &mut cells);
        }
    }
    let mut cx = Cx {
        cells: &mut cells,
        clock,
        devices: &mut NoDevices,
        fault: None,
    };
    code(&mut cx, &words);
    let faulted = cx.fault.is_some();
    let content = |(slot, at): (Slot, usize)| {
        let end = at + flat.slots.cells(slot) as usize;
        (slot, cells[at..end].to_vec())
    };
    (!faulted).then(|| written.into_iter().map(content).collect())
}

/// Inlines scopes that are always active and removes those that are never active.
fn dissolve(flat: &mut Flat) {
    for k in (0..flat.scopes.len()).rev() {
        let items = std::mem::take(&mut flat.scopes[k].items);
        let mut kept = Vec::with_capacity(items.len());
        for item in items {
            match item {
                Item::Scope(inner) => inline(flat, ScopeId(index(k)), inner, &mut kept),
                Item::Op(_) => kept.push(item),
            }
        }
        flat.scopes[k].items = kept;
    }
}

fn inline(flat: &mut Flat, outer: ScopeId, inner: ScopeId, kept: &mut Vec<Item>) {
    let scope = &mut flat.scopes[inner.index()];
    match scope.guard {
        Slot::TRUE if scope.reset.is_none() => {
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
        Slot::FALSE => {
            scope.items.clear();
            scope.latches.clear();
        }
        _ => kept.push(Item::Scope(inner)),
    }
}
