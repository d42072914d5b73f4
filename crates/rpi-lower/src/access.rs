//! Read and write sets of operations.

use crate::flat::{Flat, Op, Work};
use crate::slots::Slot;
use rpi_image::image::Form;
use rpi_image::operands::{Part, fields};
use rpi_prims::PrimId;
use std::rc::Rc;

/// Access of an operation through one of its operand words.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Access {
    /// Reads the value of this register.
    Read,
    /// Reads a presence, which decides what the operation does.
    Decide,
    /// Writes this register.
    Write,
    /// Keeps state in this register from cycle to cycle.
    Keep,
    /// The word is a number, not a register.
    Number,
}

/// Cache of the accesses of every primitive and form that was requested.
#[derive(Clone, Debug, Default)]
pub(crate) struct Shapes {
    /// Two entries per primitive, one for each form.
    known: Vec<Option<Rc<[Access]>>>,
}

impl Shapes {
    /// Accesses of a primitive in a form, one per operand word. Computes them on the first request.
    pub(crate) fn of(&mut self, prim: PrimId, form: Form) -> Rc<[Access]> {
        let at = usize::from(prim.0) * 2 + form as usize;
        if self.known.len() <= at {
            self.known.resize(at + 1, None);
        }
        Rc::clone(self.known[at].get_or_insert_with(|| accesses(prim, form).into()))
    }

    /// Accesses of a primitive in a form, one per operand word; empty unless [`Shapes::of`] was called before.
    pub(crate) fn get(&self, prim: PrimId, form: Form) -> &[Access] {
        let at = usize::from(prim.0) * 2 + form as usize;
        self.known.get(at).and_then(|s| s.as_deref()).unwrap_or(&[])
    }
}

fn accesses(prim: PrimId, form: Form) -> Vec<Access> {
    let mut all = Vec::new();
    for field in fields(prim.desc(), form) {
        let (value, presence) = match field.part {
            Part::Input(_) => (Access::Read, Access::Decide),
            Part::Param(_) => (Access::Read, Access::Read),
            Part::Output(_) => (Access::Write, Access::Write),
            Part::State => (Access::Keep, Access::Keep),
        };
        all.push(value);
        all.extend(std::iter::repeat_n(Access::Number, field.sizes));
        all.extend(field.presence.then_some(presence));
    }
    all
}

/// Accesses of one operation.
#[derive(Clone, Copy)]
pub(crate) enum Shape<'a> {
    /// One entry per word.
    Each(&'a [Access]),
    /// The first words, this many, are read; the others are written.
    Split(usize),
}

impl Shape<'_> {
    /// Access through word `k`.
    pub(crate) fn access(self, k: usize) -> Access {
        match self {
            Shape::Each(all) => all[k],
            Shape::Split(inputs) if k < inputs => Access::Read,
            Shape::Split(_) => Access::Write,
        }
    }
}

impl Access {
    /// True if the word is read, as a value or as a presence.
    pub(crate) const fn is_read(self) -> bool {
        matches!(self, Access::Read | Access::Decide)
    }
}

impl Shapes {
    /// Accesses of an operation.
    pub(crate) fn shape(&self, op: Op) -> Shape<'_> {
        match op.work {
            Work::Run(prim, form) => Shape::Each(self.get(prim, form)),
            Work::Copy => Shape::Split(1),
            Work::Actuate(_, inputs) | Work::Call(_, inputs) => Shape::Split(inputs as usize),
        }
    }
}

impl Flat {
    /// The registers of an operation with their accesses, in order; numbers are omitted.
    pub(crate) fn accesses(&self, op: Op) -> impl Iterator<Item = (Access, Slot)> + '_ {
        let shape = self.shapes.shape(op);
        let words = self.words(op).iter().enumerate();
        words.filter_map(move |(k, word)| match shape.access(k) {
            Access::Number => None,
            access => Some((access, Slot(*word))),
        })
    }

    /// Access of an operation through its word `k`.
    pub(crate) fn access(&self, op: Op, k: usize) -> Access {
        self.shapes.shape(op).access(k)
    }

    /// Replaces the registers of an operation whose access satisfies `which`.
    pub(crate) fn replace(
        &mut self,
        op: Op,
        which: impl Fn(Access) -> bool,
        by: impl Fn(Slot) -> Slot,
    ) {
        let shape = self.shapes.shape(op);
        let words = &mut self.words[op.at as usize..(op.at + op.len) as usize];
        for (k, word) in words.iter_mut().enumerate() {
            if which(shape.access(k)) {
                *word = by(Slot(*word)).0;
            }
        }
    }

    /// The registers that an operation reads, including constants and presences.
    pub(crate) fn reads(&self, op: Op) -> impl Iterator<Item = Slot> + '_ {
        self.accesses(op).filter(|a| a.0.is_read()).map(|a| a.1)
    }

    /// The registers that an operation writes.
    pub(crate) fn writes(&self, op: Op) -> impl Iterator<Item = Slot> + '_ {
        self.accesses(op)
            .filter(|a| a.0 == Access::Write)
            .map(|a| a.1)
    }
}
