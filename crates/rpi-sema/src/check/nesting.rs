//! How deep declarations may need one another, and how much a program may ask for: each level costs stack, and what a
//! chain of them makes is taken apart level by level again; iterators and recursions ask for far more than is written.

use super::Checker;
use super::body::Body;
use crate::program::Program;
use crate::ty::{Member, Ty};
use crate::typed::Leaf;
use rpi_diag::{Code, Finding, Span};

/// The deepest nesting of expressions and declarations at which one more declaration is looked at. Within one
/// expression the parser limits it.
const MAX_NESTING: u32 = 420;

/// The most names in a row of which each stands for the next.
const MAX_NAMES: usize = 64;

/// The deepest nesting of structs and arrays in a type.
const MAX_LEVELS: u32 = 420;

/// The most parts of a struct, all levels together.
const MAX_PARTS: usize = super::types::MAX_LEAVES;

/// The most expressions and flows of all units together, beyond what the text is paid for.
const MAX_WRITTEN_OUT: usize = 320_000;

/// Expressions that a byte of text may stand for.
const PER_BYTE: usize = 4;

/// Leaves of constants that cost as much as an expression.
const LEAVES: usize = 4;

/// The most expressions and flows of all units of a program together.
pub(super) fn most(program: &Program<'_>) -> usize {
    MAX_WRITTEN_OUT + PER_BYTE * program.length()
}

impl Body<'_, '_> {
    /// Whether one more element, or instance, may be written out; says so once if not.
    pub(super) fn may_go_on(&mut self, span: Span) -> bool {
        let may = self.c.written_out + self.unit.exprs.len() < self.c.most;
        if !may {
            self.c.too_much(span);
        }
        may
    }
}

impl Checker<'_> {
    /// Whether a constant of these leaves may be kept; says so once if not.
    pub(super) fn may_keep(&mut self, leaves: &[Leaf], span: Span) -> bool {
        self.written_out += leaves.len() / LEAVES;
        let may = self.written_out < self.most;
        if !may {
            self.too_much(span);
        }
        may
    }

    /// Says once that a program asks for too much.
    pub(super) fn too_much(&mut self, span: Span) {
        if std::mem::replace(&mut self.too_many_units, true) {
            return;
        }
        let most = self.most;
        let message = format!("written out this is more than {most} expressions");
        let finding = Finding::new(Code::RPI1011, message).at(span, "one more here");
        self.findings.push(finding.help("iterators are written out element by element, generic nodes for each choice of their static arguments"));
    }

    /// Whether a declaration that is needed by what is being checked can be looked at now; says so once if not.
    pub(super) fn may_nest(&mut self, what: &str, span: Span) -> bool {
        self.may(self.nesting < MAX_NESTING, what, span)
    }

    /// Whether one more name may stand for another one; says so once if not.
    pub(super) fn may_stand_for(&mut self, span: Span) -> bool {
        self.may(self.aliases.len() < MAX_NAMES, "node", span)
    }

    fn may(&mut self, may: bool, what: &str, span: Span) -> bool {
        if !may && !std::mem::replace(&mut self.too_deep, true) {
            self.findings.push(
                Finding::new(
                    Code::RPI1011,
                    format!("too many declarations in a row need one another to know this {what}"),
                )
                .at(span, "needed at the end of the row")
                .help("declare what is needed before what needs it, or shorten the row"),
            );
        }
        may
    }

    /// Works on a declaration that something else needs.
    pub(super) fn nested<T>(&mut self, work: impl FnOnce(&mut Self) -> T) -> T {
        self.nesting += 1;
        let result = work(self);
        self.nesting -= 1;
        result
    }
}

/// Whether a struct of these fields is of a size that can be worked with.
pub(super) fn is_workable(fields: &[Member]) -> bool {
    sum(fields, MAX_LEVELS, MAX_PARTS).is_some()
}

/// How many parts a type has, itself included; none if it has more than `most` or more `levels`. What is too large is
/// not counted to the end.
fn parts(ty: &Ty, levels: u32, most: usize) -> Option<usize> {
    let below = levels.checked_sub(1)?;
    let count = match ty {
        Ty::Array(element, n) => parts(element, below, most)?.checked_mul(*n as usize)?,
        Ty::Struct(_) | Ty::Tuple(_) => sum(ty.members(), below, most)?,
        _ => 0,
    };
    Some(count + 1).filter(|count| *count <= most)
}

fn sum(members: &[Member], levels: u32, most: usize) -> Option<usize> {
    members.iter().try_fold(0usize, |sum, member| {
        Some(sum + parts(&member.ty, levels, most - sum)?)
    })
}
