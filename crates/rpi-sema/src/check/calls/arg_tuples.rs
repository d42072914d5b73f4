//! Arguments that are tuples: each element becomes an argument of its own.

use crate::check::bodies::body::Body;
use crate::check::bodies::tuple_pieces;
use crate::check::bodies::tuple_pieces::TuplePiece;
use crate::check::calls::args;
use crate::check::calls::args::CallArgument;
use crate::check::signatures::header::Header;
use crate::ty::Ty;
use crate::typed::ExprId;
use crate::typed::TypedKind;

/// Replaces positional arguments that are tuples by their elements: `f(g(x))` where `g` has two outputs.
pub(crate) fn flatten_tuple_args<'a>(
    cx: &mut Body<'_, 'a>,
    given: Vec<CallArgument<'a>>,
) -> Vec<CallArgument<'a>> {
    let mut all = Vec::with_capacity(given.len());
    for arg in given {
        match cx.ty_of(arg.value) {
            Ty::Tuple(_) if arg.name.is_none() => {
                let parts = tuple_elements(cx, arg.value);
                all.extend(parts.into_iter().map(CallArgument::positional));
            }
            _ => all.push(arg),
        }
    }
    all
}

/// Replaces positional arguments that are tuples by their elements, except where the port at that position takes a
/// tuple. Named arguments come first in the result.
pub(crate) fn flatten_tuple_args_for<'a>(
    cx: &mut Body<'_, 'a>,
    header: &Header,
    given: &[CallArgument<'a>],
) -> Vec<CallArgument<'a>> {
    let is_tuple = |arg: &CallArgument<'_>| matches!(cx.ty_of(arg.value), Ty::Tuple(_));
    let (named, placed): (Vec<CallArgument<'a>>, Vec<CallArgument<'a>>) =
        given.iter().partition(|arg| arg.name.is_some());
    if !placed.iter().any(is_tuple) {
        return given.to_vec();
    }
    let is_named = |k: &usize| {
        let mut names = named.iter().filter_map(|arg| arg.name);
        names.any(|name| name.name == header.inputs[*k].name)
    };
    let ports = args::positional_ports(header)
        .into_iter()
        .filter(|k| !is_named(k));
    let wanted: Vec<Option<&Ty>> = ports.map(|k| Some(&header.inputs[k].ty)).collect();
    let values: Vec<ExprId> = placed.iter().map(|arg| arg.value).collect();
    let types: Vec<Ty> = values.iter().map(|id| cx.ty_of(*id).clone()).collect();
    let pieces = tuple_pieces::decompose(&types, &wanted).into_iter();
    let spread = pieces.map(|piece| match piece.ty == types[piece.value] {
        true => placed[piece.value],
        false => CallArgument::positional(add_piece(cx, values[piece.value], piece)),
    });
    named
        .into_iter()
        .chain(spread.collect::<Vec<_>>())
        .collect()
}

/// Adds an expression for a part of the tuple `base` and returns it.
fn add_piece(cx: &mut Body<'_, '_>, base: ExprId, piece: TuplePiece) -> ExprId {
    let span = cx.span_of(base);
    let at = piece.leaf;
    cx.add(TypedKind::Part { base, at }, piece.ty, span)
}

/// Adds an expression for each element of the tuple `base`, with nested tuples decomposed, and returns these
/// expressions.
pub(crate) fn tuple_elements(cx: &mut Body<'_, '_>, base: ExprId) -> Vec<ExprId> {
    let pieces = tuple_pieces::flattened_pieces(cx.ty_of(base)).into_iter();
    pieces.map(|piece| add_piece(cx, base, piece)).collect()
}
