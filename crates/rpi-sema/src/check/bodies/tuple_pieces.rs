//! Decomposition of tuples into as many values as there are targets or ports.
//!
//! Lists of values are flat in Lustre: `a, b, c = (f(x), z)` where `f` has two outputs. A nested tuple is one value
//! where one is expected: `c, ab = (e[0], e[1])` with `ab: [int, int]`. Therefore the expected types decide; where they
//! are not known, the number of values decides and the outermost tuples are decomposed first.

use crate::check::exprs::access::leaf_count;
use crate::ty::Member;
use crate::ty::Substitution;
use crate::ty::Ty;
use crate::ty::check_assignable;

/// Part of one of several values, for the decomposition of tuples into their elements.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct TuplePiece {
    /// Index of the value, in the list of values, of which this is a part.
    pub(crate) value: usize,
    /// Index of the first leaf (scalar part) of the part among the leaves of the value.
    pub(crate) leaf: u32,
    pub(crate) ty: Ty,
}

/// Decomposes the tuples in a list of values so that each value matches one of the types `wanted`; a type is `None` if
/// it is not known. If no decomposition has the right number of parts, all tuples are fully decomposed.
pub(crate) fn decompose(list: &[Ty], wanted: &[Option<&Ty>]) -> Vec<TuplePiece> {
    let whole: Vec<TuplePiece> = (list.iter().cloned().enumerate())
        .map(|(of, ty)| TuplePiece {
            value: of,
            leaf: 0,
            ty,
        })
        .collect();
    let by_type = decompose_by_type(&whole, wanted);
    by_type.unwrap_or_else(|| decompose_by_count(whole, wanted.len()))
}

/// Decomposes only the tuples that do not match the next type in `wanted` as a whole. `None` if a type is not known, a
/// part does not match, or the numbers differ.
fn decompose_by_type(whole: &[TuplePiece], wanted: &[Option<&Ty>]) -> Option<Vec<TuplePiece>> {
    let mut pieces = Vec::with_capacity(wanted.len());
    // Remaining values in reverse order: the next one is last.
    let mut open: Vec<TuplePiece> = whole.iter().rev().cloned().collect();
    for wanted in wanted {
        let wanted = (*wanted)?;
        let mut next = open.pop()?;
        while check_assignable(wanted, &next.ty, &mut Substitution::default()).is_err() {
            let inner = next.elements()?;
            open.extend(inner.into_iter().rev());
            next = open.pop()?;
        }
        pieces.push(next);
    }
    open.is_empty().then_some(pieces)
}

/// Decomposes tuples, the outermost ones first, until there are `count` parts. If `count` cannot be reached exactly,
/// all tuples are fully decomposed.
fn decompose_by_count(mut level: Vec<TuplePiece>, count: usize) -> Vec<TuplePiece> {
    while level.len() < count {
        let is_whole = |piece: &TuplePiece| !matches!(piece.ty, Ty::Tuple(_));
        if level.iter().all(is_whole) {
            break;
        }
        level = level
            .into_iter()
            .flat_map(TuplePiece::elements_or_self)
            .collect();
    }
    match level.len() == count {
        true => level,
        false => flatten(level),
    }
}

/// Returns the elements of a tuple type, with nested tuples decomposed; the type itself as the only part if it is not a
/// tuple.
pub(crate) fn flattened_pieces(ty: &Ty) -> Vec<TuplePiece> {
    let (value, leaf, ty) = (0, 0, ty.clone());
    flatten(vec![TuplePiece { value, leaf, ty }])
}

fn flatten(mut level: Vec<TuplePiece>) -> Vec<TuplePiece> {
    while level.iter().any(|piece| matches!(piece.ty, Ty::Tuple(_))) {
        level = level
            .into_iter()
            .flat_map(TuplePiece::elements_or_self)
            .collect();
    }
    level
}

impl TuplePiece {
    /// Returns the elements of a part that is a tuple; `None` for other types.
    fn elements(&self) -> Option<Vec<TuplePiece>> {
        let Ty::Tuple(members) = &self.ty else {
            return None;
        };
        let mut at = self.leaf;
        let inner = members.iter().map(|Member { ty, .. }| {
            let piece = TuplePiece {
                value: self.value,
                leaf: at,
                ty: ty.clone(),
            };
            at += leaf_count(ty);
            piece
        });
        Some(inner.collect())
    }

    fn elements_or_self(self) -> Vec<TuplePiece> {
        self.elements().unwrap_or_else(|| vec![self])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pair() -> Ty {
        Ty::tuple([Ty::Int, Ty::Int])
    }

    fn types(value: Ty, wanted: &[Option<&Ty>]) -> Vec<Ty> {
        let pieces = decompose(&[value], wanted).into_iter();
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
        let found = decompose(&[Ty::Int, value], &[None; 4]);
        let places: Vec<(usize, u32)> = found
            .iter()
            .map(|piece| (piece.value, piece.leaf))
            .collect();
        assert_eq!(places, [(0, 0), (1, 0), (1, 1), (1, 2)]);
    }
}
