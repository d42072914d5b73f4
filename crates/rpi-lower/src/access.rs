//! Read and write sets of operations.

use crate::flat_net::{FlatNet, Op, OpKind};
use crate::registers::Register;
use rpi_image::image::Form;
use rpi_image::operands::{OperandRole, operand_layout};
use rpi_prims::PrimId;
use std::rc::Rc;

/// Way in which an operation uses one of its operand words: the word is a register that is read or written, or a plain
/// number.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Access {
    /// The operation reads the value of the register.
    Read,
    /// The operation reads the register as a presence: true if an input has a value in the current cycle. The operation
    /// decides by it what to compute.
    ReadPresence,
    /// The operation writes the register.
    Write,
    /// The operation stores its state in the register from cycle to cycle: it reads and writes the register.
    State,
    /// The word is a number, such as the length of an array, and not a register.
    Number,
}

/// Cache of the ways in which primitives use their operand words, for each primitive and form that was requested.
#[derive(Clone, Debug, Default)]
pub(crate) struct AccessTable {
    /// Access of each operand word of a primitive in a form. The index is twice the number of the primitive, plus the
    /// number of the form (0 or 1); `None` if not computed yet.
    known: Vec<Option<Rc<[Access]>>>,
}

impl AccessTable {
    /// Returns the accesses of a primitive in a form (with or without presence words), one per operand word. Computes
    /// them on the first request.
    pub(crate) fn get_or_compute(&mut self, prim: PrimId, form: Form) -> Rc<[Access]> {
        let at = usize::from(prim.0) * 2 + form as usize;
        if self.known.len() <= at {
            self.known.resize(at + 1, None);
        }
        Rc::clone(self.known[at].get_or_insert_with(|| accesses(prim, form).into()))
    }

    /// Returns the accesses of a primitive in a form, one per operand word. The result is empty unless
    /// [`AccessTable::get_or_compute`] was called for the same primitive and form before.
    pub(crate) fn get(&self, prim: PrimId, form: Form) -> &[Access] {
        let at = usize::from(prim.0) * 2 + form as usize;
        self.known.get(at).and_then(|s| s.as_deref()).unwrap_or(&[])
    }
}

fn accesses(prim: PrimId, form: Form) -> Vec<Access> {
    let mut all = Vec::new();
    for field in operand_layout(prim.desc(), form) {
        let (value, presence) = match field.role {
            OperandRole::Input(_) => (Access::Read, Access::ReadPresence),
            OperandRole::Param(_) => (Access::Read, Access::Read),
            OperandRole::Output(_) => (Access::Write, Access::Write),
            OperandRole::State => (Access::State, Access::State),
        };
        all.push(value);
        all.extend(std::iter::repeat_n(Access::Number, field.size_words));
        all.extend(field.has_presence.then_some(presence));
    }
    all
}

/// Accesses of all operand words of an operation, in one of two notations.
#[derive(Clone, Copy)]
pub(crate) enum OpAccesses<'a> {
    /// One access for each operand word, as in a call of a primitive.
    Each(&'a [Access]),
    /// Number of operand words that are read; all words after them are written. A copy or a device access has this
    /// form.
    Split(usize),
}

impl OpAccesses<'_> {
    /// Returns the access of the operand word with index `k`, counted from 0. Panics if a primitive has fewer words.
    pub(crate) fn access(self, k: usize) -> Access {
        match self {
            OpAccesses::Each(all) => all[k],
            OpAccesses::Split(inputs) if k < inputs => Access::Read,
            OpAccesses::Split(_) => Access::Write,
        }
    }
}

impl Access {
    /// Returns true if the register is read, as a value or as a presence; false if it is written or holds state.
    pub(crate) const fn is_read(self) -> bool {
        matches!(self, Access::Read | Access::ReadPresence)
    }
}

impl AccessTable {
    /// Returns the accesses of the operand words of an operation. For a primitive, [`AccessTable::get_or_compute`] must
    /// have been called before.
    pub(crate) fn op_accesses(&self, op: Op) -> OpAccesses<'_> {
        match op.kind {
            OpKind::Run(prim, form) => OpAccesses::Each(self.get(prim, form)),
            OpKind::Copy => OpAccesses::Split(1),
            OpKind::Actuate(_, inputs) | OpKind::Call(_, inputs) => {
                OpAccesses::Split(inputs as usize)
            }
        }
    }
}

impl FlatNet {
    /// Returns the registers among the operand words of an operation, each with its access, in the order of the words.
    /// Words that are plain numbers are omitted.
    pub(crate) fn accesses(&self, op: Op) -> impl Iterator<Item = (Access, Register)> + '_ {
        let shape = self.accesses.op_accesses(op);
        let words = self.words(op).iter().enumerate();
        words.filter_map(move |(k, word)| match shape.access(k) {
            Access::Number => None,
            access => Some((access, Register(*word))),
        })
    }

    /// Returns the way in which an operation uses its operand word with index `k`.
    pub(crate) fn access(&self, op: Op, k: usize) -> Access {
        self.accesses.op_accesses(op).access(k)
    }

    /// Replaces each register of an operation whose access satisfies the predicate `which` by the register that `by`
    /// returns for it.
    pub(crate) fn replace(
        &mut self,
        op: Op,
        which: impl Fn(Access) -> bool,
        by: impl Fn(Register) -> Register,
    ) {
        let shape = self.accesses.op_accesses(op);
        let words = &mut self.words[op.at as usize..(op.at + op.len) as usize];
        for (k, word) in words.iter_mut().enumerate() {
            if which(shape.access(k)) {
                *word = by(Register(*word)).0;
            }
        }
    }

    /// Returns the registers that an operation reads, including constants and presences, without its state.
    pub(crate) fn reads(&self, op: Op) -> impl Iterator<Item = Register> + '_ {
        self.accesses(op).filter(|a| a.0.is_read()).map(|a| a.1)
    }

    /// Returns the registers that an operation writes, without its state.
    pub(crate) fn writes(&self, op: Op) -> impl Iterator<Item = Register> + '_ {
        self.accesses(op)
            .filter(|a| a.0 == Access::Write)
            .map(|a| a.1)
    }
}
