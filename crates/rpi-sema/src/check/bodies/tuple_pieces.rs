//! Decomposition of tuples into as many values as there are targets or ports.
//!
//! Lists of values are flat in Lustre: `a, b, c = (f(x), z)` where `f` has two outputs. A nested tuple is one value
//! where one is expected: `c, ab = (e[0], e[1])` with `ab: [int, int]`. Therefore the expected types decide; where they
//! are not known, the number of values decides and the outermost tuples are decomposed first.

use crate::check::exprs::access::leaves;
use crate::ty::Member;
use crate::ty::Subst;
use crate::ty::Ty;
use crate::ty::fit;

/// A part of one of several values.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Piece {
    /// Index of the value.
    pub(crate) of: usize,
    /// Index of the first leaf of the part among the leaves of the value.
    pub(crate) at: u32,
    pub(crate) ty: Ty,
}

/// Decomposes a list of values for targets of the types `wanted`, as far as these are known. Returns all pieces if
/// their number cannot match.
pub(crate) fn pieces(list: &[Ty], wanted: &[Option<&Ty>]) -> Vec<Piece> {
    let whole: Vec<Piece> = (list.iter().cloned().enumerate())
        .map(|(of, ty)| Piece { of, at: 0, ty })
        .collect();
    let by_type = by_type(&whole, wanted);
    by_type.unwrap_or_else(|| by_number(whole, wanted.len()))
}

/// Decomposes only values that do not match as a whole; `None` if a type does not match or is not known.
fn by_type(whole: &[Piece], wanted: &[Option<&Ty>]) -> Option<Vec<Piece>> {
    let mut pieces = Vec::with_capacity(wanted.len());
    // Remaining values in reverse order: the next one is last.
    let mut open: Vec<Piece> = whole.iter().rev().cloned().collect();
    for wanted in wanted {
        let wanted = (*wanted)?;
        let mut next = open.pop()?;
        while fit(wanted, &next.ty, &mut Subst::default()).is_err() {
            let inner = next.opened()?;
            open.extend(inner.into_iter().rev());
            next = open.pop()?;
        }
        pieces.push(next);
    }
    open.is_empty().then_some(pieces)
}

/// Decomposes tuples level by level until there are `count` pieces.
fn by_number(mut level: Vec<Piece>, count: usize) -> Vec<Piece> {
    while level.len() < count {
        let is_whole = |piece: &Piece| !matches!(piece.ty, Ty::Tuple(_));
        if level.iter().all(is_whole) {
            break;
        }
        level = level.into_iter().flat_map(Piece::opened_or_whole).collect();
    }
    match level.len() == count {
        true => level,
        false => flattened(level),
    }
}

/// Returns the elements of a tuple, with nested tuples decomposed; the value itself if it is not a tuple.
pub(crate) fn all(ty: &Ty) -> Vec<Piece> {
    let (of, at, ty) = (0, 0, ty.clone());
    flattened(vec![Piece { of, at, ty }])
}

fn flattened(mut level: Vec<Piece>) -> Vec<Piece> {
    while level.iter().any(|piece| matches!(piece.ty, Ty::Tuple(_))) {
        level = level.into_iter().flat_map(Piece::opened_or_whole).collect();
    }
    level
}

impl Piece {
    /// Returns the elements of a tuple; `None` for other types.
    fn opened(&self) -> Option<Vec<Piece>> {
        let Ty::Tuple(members) = &self.ty else {
            return None;
        };
        let mut at = self.at;
        let inner = members.iter().map(|Member { ty, .. }| {
            let piece = Piece {
                of: self.of,
                at,
                ty: ty.clone(),
            };
            at += leaves(ty);
            piece
        });
        Some(inner.collect())
    }

    fn opened_or_whole(self) -> Vec<Piece> {
        self.opened().unwrap_or_else(|| vec![self])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pair() -> Ty {
        Ty::tuple([Ty::Int, Ty::Int])
    }

    fn types(value: Ty, wanted: &[Option<&Ty>]) -> Vec<Ty> {
        let pieces = pieces(&[value], wanted).into_iter();
        pieces.map(|piece| piece.ty).collect()
    }

    #[test]
    fn the_types_that_are_wanted_decide() {
        let (int, bool, pair) = (Ty::Int, Ty::Bool, pair());
        let value = Ty::tuple([Ty::Bool, pair.clone()]);
        let found = types(value.clone(), &[Some(&bool), Some(&pair)]);
        assert_eq!(found, [Ty::Bool, pair.clone()]);
        let found = types(value, &[Some(&bool), Some(&int), Some(&int)]);
        assert_eq!(found, [Ty::Bool, Ty::Int, Ty::Int]);
        let two = Ty::tuple([pair.clone(), pair.clone()]);
        let found = types(two, &[Some(&int), Some(&int), Some(&pair)]);
        assert_eq!(found, [Ty::Int, Ty::Int, pair]);
    }

    #[test]
    fn without_types_the_number_decides() {
        let value = Ty::tuple([Ty::Bool, pair()]);
        assert_eq!(types(value.clone(), &[None, None]), [Ty::Bool, pair()]);
        assert_eq!(types(value.clone(), &[None; 3]).len(), 3);
        assert_eq!(types(value, &[None; 4]).len(), 3);
    }

    #[test]
    fn pieces_say_where_they_begin() {
        let value = Ty::tuple([pair(), Ty::Bool]);
        let found = pieces(&[Ty::Int, value], &[None; 4]);
        let places: Vec<(usize, u32)> = found.iter().map(|piece| (piece.of, piece.at)).collect();
        assert_eq!(places, [(0, 0), (1, 0), (1, 1), (1, 2)]);
    }
}
