//! Steps and operand words.

use super::cells::Layouts;
use crate::flat::{Flat, Item, Op, ScopeId, Work, index};
use crate::options::{LowerOptions, Observe};
use crate::slots::Slot;
use rpi_image::Image;
use rpi_image::hash::signature;
use rpi_image::image::{Form, PrimUse, Step};
use rpi_image::operands::{Field, fields};
use rpi_prims::PrimId;
use std::collections::BTreeMap;

/// Writes both step lists.
pub(super) fn write(flat: &Flat, layouts: &Layouts, options: &LowerOptions<'_>, image: &mut Image) {
    let mut writer = Writer {
        flat,
        layouts,
        rows: options.observe == Observe::Exports,
        image,
        prims: BTreeMap::new(),
        fields: BTreeMap::new(),
    };
    writer.scope(ScopeId::ROOT);
    writer.commit(ScopeId::ROOT);
}

struct Writer<'a> {
    flat: &'a Flat,
    layouts: &'a Layouts,
    /// Equal neighbours become one row.
    rows: bool,
    image: &'a mut Image,
    prims: BTreeMap<PrimId, u16>,
    fields: BTreeMap<(PrimId, Form), Vec<Field>>,
}

impl Writer<'_> {
    fn scope(&mut self, id: ScopeId) {
        let flat = self.flat;
        let scope = &flat.scopes[id.index()];
        let skip = self.skip(scope.guard, |image| &mut image.steps);
        if let Some((unless, fragment)) = scope.reset {
            let unless = self.layouts.cell(unless);
            self.step(Step::Reset { unless, fragment }, crate::flat::NO_NODE);
        }
        for item in &scope.items {
            match item {
                Item::Op(op) => self.op(flat.ops[*op as usize]),
                Item::Scope(inner) => self.scope(*inner),
            }
        }
        land(&mut self.image.steps, skip);
    }

    /// Opens a skip; gives its place, unless it is none.
    fn skip(&mut self, guard: Slot, steps: impl Fn(&mut Image) -> &mut Vec<Step>) -> Option<usize> {
        if guard == Slot::TRUE {
            return None;
        }
        let unless = self.layouts.cell(guard);
        let at = steps(self.image).len();
        steps(self.image).push(Step::Skip { unless, to: 0 });
        self.image
            .trace
            .resize(self.image.steps.len(), crate::flat::NO_NODE);
        Some(at)
    }

    fn step(&mut self, step: Step, node: u32) {
        self.image.steps.push(step);
        self.image.trace.push(node);
    }

    fn op(&mut self, op: Op) {
        let at = index(self.image.code.len());
        let step = match op.work {
            Work::Run(prim, form) => {
                self.words(prim, form, self.flat.words(op));
                let prim = self.prim(prim);
                Step::Run {
                    prim,
                    form,
                    at,
                    len: op.len,
                }
            }
            Work::Copy => {
                let words = self.flat.words(op);
                self.pairs(Slot(words[0]), Slot(words[1]));
                let len = index(self.image.code.len()) - at;
                Step::Copy { at, len }
            }
            Work::Actuate(actuator) => Step::Actuate { actuator },
            Work::Call(function) => Step::Call { function },
        };
        if !(self.rows && joined(self.image.steps.last_mut(), step)) {
            self.step(step, op.node);
        }
    }

    /// Operand words with cells in place of slots.
    fn words(&mut self, prim: PrimId, form: Form, words: &[u32]) {
        let made = self.fields.entry((prim, form));
        let fields = made.or_insert_with(|| fields(prim.desc(), form));
        let mut words = words;
        for field in fields.iter() {
            let (mine, rest) = words.split_at(field.words());
            words = rest;
            let code = &mut self.image.code;
            code.push(self.layouts.cell(Slot(mine[0])));
            code.extend(&mine[1..=field.sizes]);
            if field.presence {
                code.push(self.layouts.cell(Slot(mine[field.sizes + 1])));
            }
        }
    }

    fn pairs(&mut self, from: Slot, to: Slot) {
        let (a, b) = (self.layouts.cell(from), self.layouts.cell(to));
        for k in 0..self.flat.slots.cells(to) {
            self.image.code.extend([a + k, b + k]);
        }
    }

    fn prim(&mut self, prim: PrimId) -> u16 {
        let table = &mut self.image.prims;
        *self.prims.entry(prim).or_insert_with(|| {
            let desc = prim.desc();
            table.push(PrimUse {
                name: desc.name.to_owned(),
                signature: signature(desc),
            });
            // The registry has fewer than 2^16 primitives.
            (table.len() - 1) as u16
        })
    }

    /// The latches of a scope and of the scopes in it; true if there were any.
    fn commit(&mut self, id: ScopeId) -> bool {
        let flat = self.flat;
        let scope = &flat.scopes[id.index()];
        let before = self.image.commit.len();
        let skip = self.skip(scope.guard, |image| &mut image.commit);
        let mut any = false;
        for item in &scope.items {
            if let Item::Scope(inner) = item {
                any |= self.commit(*inner);
            }
        }
        let at = index(self.image.code.len());
        for (from, to) in &scope.latches {
            self.pairs(*from, *to);
        }
        let len = index(self.image.code.len()) - at;
        if len > 0 {
            self.image.commit.push(Step::Copy { at, len });
        }
        any |= len > 0;
        if any {
            land(&mut self.image.commit, skip);
        } else {
            self.image.commit.truncate(before);
        }
        any
    }
}

/// Lets an open skip jump behind what was written since.
fn land(steps: &mut [Step], skip: Option<usize>) {
    let end = index(steps.len());
    if let Some(Step::Skip { to, .. }) = skip.and_then(|at| steps.get_mut(at)) {
        *to = end;
    }
}

/// Appends a step to an equal one right before it: its words follow those of the other.
fn joined(last: Option<&mut Step>, step: Step) -> bool {
    match (last, step) {
        (
            Some(Step::Run {
                prim,
                form,
                at,
                len,
            }),
            Step::Run {
                prim: p,
                form: f,
                at: next,
                len: more,
            },
        ) if *prim == p && *form == f && *at + *len == next => {
            *len += more;
            true
        }
        (
            Some(Step::Copy { at, len }),
            Step::Copy {
                at: next,
                len: more,
            },
        ) if *at + *len == next => {
            *len += more;
            true
        }
        _ => false,
    }
}
