//! Subranges of `int`: the range of values that a declaration allows.

use crate::ty::{Member, Ty};
use rpi_diag::{Code, Diagnostic};
use std::fmt;
use std::rc::Rc;

/// Range of integers with inclusive bounds, written `[from, to]`. A missing bound is written `*`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Subrange {
    /// Least value in the range; `None` if there is no lower bound.
    pub from: Option<i64>,
    /// Greatest value in the range; `None` if there is no upper bound.
    pub to: Option<i64>,
}

impl Subrange {
    /// Returns the least and the greatest value in the range. A missing bound is that of 64-bit integers.
    #[must_use]
    pub fn bounds(self) -> [i64; 2] {
        [self.from.unwrap_or(i64::MIN), self.to.unwrap_or(i64::MAX)]
    }

    /// Returns whether the range contains no value.
    #[must_use]
    pub fn is_empty(self) -> bool {
        let [from, to] = self.bounds();
        from > to
    }

    /// Returns the value in the range that is nearest to `value`.
    #[must_use]
    pub fn clamp(self, value: i64) -> i64 {
        let [from, to] = self.bounds();
        value.min(to).max(from)
    }

    /// Returns whether `other` contains all values of this range.
    #[must_use]
    pub fn is_subset_of(self, other: Subrange) -> bool {
        self.bounds().into_iter().all(|end| other.contains(end))
    }

    /// Returns whether the range contains a value.
    #[must_use]
    pub fn contains(self, value: i64) -> bool {
        let [from, to] = self.bounds();
        (from..=to).contains(&value)
    }
}

impl fmt::Display for Subrange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let end = |end: Option<i64>| end.map_or("*".to_owned(), |value| value.to_string());
        write!(f, "[{}, {}]", end(self.from), end(self.to))
    }
}

impl Ty {
    /// Returns the type of an expression that reads a flow of this type, which is `int` for a subrange. Fields of
    /// structs remain subranges, which are checked where a struct is built.
    #[must_use]
    pub fn widened(self) -> Ty {
        match self {
            Ty::Subrange(_) => Ty::Int,
            Ty::Array(element, n) if element.has_bare_subrange() => {
                Ty::Array(Rc::new((*element).clone().widened()), n)
            }
            Ty::Tuple(members) if members.iter().any(|member| member.ty.has_bare_subrange()) => {
                let member = |member: &Member| Member {
                    name: member.name.clone(),
                    ty: member.ty.clone().widened(),
                };
                Ty::Tuple(members.iter().map(member).collect())
            }
            other => other,
        }
    }

    /// Returns whether the type is or contains a subrange that is not in a struct.
    fn has_bare_subrange(&self) -> bool {
        match self {
            Ty::Subrange(_) => true,
            Ty::Array(element, _) => element.has_bare_subrange(),
            Ty::Tuple(members) => members.iter().any(|member| member.ty.has_bare_subrange()),
            _ => false,
        }
    }

    /// Returns the leaves (scalar parts) with a subrange type, each with its index. Fields of structs are included only
    /// for a value from `outside` of the program, because otherwise they are checked where the struct is built.
    #[must_use]
    pub fn subranges(&self, outside: bool) -> Vec<(usize, Subrange)> {
        let mut found = Vec::new();
        if self.has_subrange(outside) {
            self.subranges_from(0, outside, &mut found);
        }
        found
    }

    pub(crate) fn has_subrange(&self, outside: bool) -> bool {
        match self {
            Ty::Subrange(_) => true,
            Ty::Array(element, _) => element.has_subrange(outside),
            Ty::Struct(_) if !outside => false,
            _ => {
                let mut members = self.members().iter();
                members.any(|member| member.ty.has_subrange(outside))
            }
        }
    }

    fn subranges_from(&self, first: usize, outside: bool, found: &mut Vec<(usize, Subrange)>) {
        match self {
            Ty::Subrange(range) => found.push((first, *range)),
            Ty::Array(element, n) if element.has_subrange(outside) => {
                let size = element.leaf_count();
                for k in 0..*n as usize {
                    element.subranges_from(first + k * size, outside, found);
                }
            }
            Ty::Struct(_) if !outside => {}
            _ => {
                let mut at = first;
                for member in self.members() {
                    member.ty.subranges_from(at, outside, found);
                    at += member.ty.leaf_count();
                }
            }
        }
    }
}

/// Returns the diagnostic for a constant `value` outside of the subrange of its type. The caller adds the location.
pub(crate) fn outside_subrange(value: i64, range: Subrange) -> Diagnostic {
    let message = format!("{value} is outside of the subrange {range}");
    Diagnostic::new(Code::RPI2017, message)
        .help(format!("use a value in {range}, or widen the range"))
}
