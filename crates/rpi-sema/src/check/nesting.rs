//! How deep declarations may need one another: each level costs stack, and what a chain of them makes is taken apart
//! level by level again.

use super::Checker;
use crate::ty::{Member, Ty};
use rpi_diag::{Code, Finding, Span};

/// The deepest nesting of expressions and declarations at which one more declaration is looked at. Within one
/// expression the parser limits it.
const MAX_NESTING: u32 = 420;

/// The deepest nesting of structs and arrays in a type.
const MAX_LEVELS: u32 = 420;

/// The most parts of a struct, all levels together.
const MAX_PARTS: usize = 1 << 20;

impl Checker<'_> {
    /// Whether a declaration that is needed by what is being checked can be looked at now; says so once if not.
    pub(super) fn may_nest(&mut self, what: &str, span: Span) -> bool {
        let may = self.nesting < MAX_NESTING;
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
