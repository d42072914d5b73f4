//! Which words of an operation are read and which are written.

use crate::flat::{Flat, Op, Work};
use crate::slots::Slot;
use rpi_image::image::Form;
use rpi_image::operands::{Part, fields};
use rpi_prims::PrimId;
use std::rc::Rc;

/// What an operation does with one of its words.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Access {
    /// It reads the value of this slot.
    Read,
    /// It reads a presence, to decide.
    Decide,
    /// It writes this slot.
    Write,
    /// It keeps this slot from cycle to cycle.
    Keep,
    /// The word is a number, no slot.
    Number,
}

/// The accesses of every form of every primitive that was asked for.
#[derive(Clone, Debug, Default)]
pub(crate) struct Shapes {
    /// Two per primitive.
    known: Vec<Option<Rc<[Access]>>>,
}

impl Shapes {
    /// One entry per operand word.
    pub(crate) fn of(&mut self, prim: PrimId, form: Form) -> Rc<[Access]> {
        let at = usize::from(prim.0) * 2 + form as usize;
        if self.known.len() <= at {
            self.known.resize(at + 1, None);
        }
        Rc::clone(self.known[at].get_or_insert_with(|| accesses(prim, form).into()))
    }

    /// One entry per operand word, if [`Shapes::of`] was asked before.
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

/// What one operation does with its words.
#[derive(Clone, Copy)]
pub(crate) enum Shape<'a> {
    /// One entry per word.
    Each(&'a [Access]),
    /// So many are read, the others written.
    Split(usize),
}

impl Shape<'_> {
    /// What is done with word `k`.
    pub(crate) fn access(self, k: usize) -> Access {
        match self {
            Shape::Each(all) => all[k],
            Shape::Split(inputs) if k < inputs => Access::Read,
            Shape::Split(_) => Access::Write,
        }
    }
}

impl Access {
    /// The word is read, for its value or to decide.
    pub(crate) const fn is_read(self) -> bool {
        matches!(self, Access::Read | Access::Decide)
    }
}

impl Shapes {
    /// What an operation does with its words.
    pub(crate) fn shape(&self, op: Op) -> Shape<'_> {
        match op.work {
            Work::Run(prim, form) => Shape::Each(self.get(prim, form)),
            Work::Copy => Shape::Split(1),
            Work::Actuate(_, inputs) | Work::Call(_, inputs) => Shape::Split(inputs as usize),
        }
    }
}

impl Flat {
    /// What an operation does with its words, in order; numbers are left out.
    pub(crate) fn accesses(&self, op: Op) -> impl Iterator<Item = (Access, Slot)> + '_ {
        let shape = self.shapes.shape(op);
        let words = self.words(op).iter().enumerate();
        words.filter_map(move |(k, word)| match shape.access(k) {
            Access::Number => None,
            access => Some((access, Slot(*word))),
        })
    }

    /// What an operation does with its word `k`.
    pub(crate) fn access(&self, op: Op, k: usize) -> Access {
        self.shapes.shape(op).access(k)
    }

    /// Replaces the slots that an operation accesses in a certain way.
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

    /// The slots that an operation reads, constants and presences included.
    pub(crate) fn reads(&self, op: Op) -> impl Iterator<Item = Slot> + '_ {
        self.accesses(op).filter(|a| a.0.is_read()).map(|a| a.1)
    }

    /// The slots that an operation writes.
    pub(crate) fn writes(&self, op: Op) -> impl Iterator<Item = Slot> + '_ {
        self.accesses(op)
            .filter(|a| a.0 == Access::Write)
            .map(|a| a.1)
    }
}
