//! Construction of arrays from values that are computed one by one.
//!
//! An array of up to [`PIECE`] elements is created and its elements are set one by one, as programs of the reference
//! system do. Each of these steps copies the array, so that the work would grow with the square of its length: a longer
//! array is therefore concatenated from halves, with work in O(n log n).

use crate::elab::arrays::{constant_array, element_params, one_input, sized_params};
use crate::elab::nodes;
use crate::elab::primitive_family::{PrimitiveFamily, member};
use crate::elab::signal::Signal;
use crate::elab::{Elaborator, Position};
use rpi_diag::Span;
use rpi_image::{Scalar, Type};
use rpi_net::prim;
use rpi_net::{Input, Inputs, PortRef, Types};
use rpi_prims::PrimId;
use smallvec::smallvec;

/// Length up to which the elements of an array are set one by one. The declared work of the primitives for arrays holds
/// up to this length (see [`Type::work_factor`]).
const PIECE: usize = 8;

/// Adds net nodes that build an array or matrix from its leaves (scalar parts). Returns the port with the array; `None`
/// if there are no primitives for the type.
pub(super) fn build_array(
    elab: &mut Elaborator<'_>,
    wire: &[Signal],
    ty: Type,
    at: Position,
    span: Span,
) -> Option<PortRef> {
    match ty {
        Type::Array(scalar, _) if wire.len() > PIECE => {
            concatenate_halves(elab, wire, scalar, at, span)
        }
        _ => set_elements(elab, wire, ty, at, span),
    }
}

/// Adds net nodes that build both halves of an array, and one that joins them. The first half is a multiple of
/// [`PIECE`] elements long, so that at most one piece is shorter.
fn concatenate_halves(
    elab: &mut Elaborator<'_>,
    wire: &[Signal],
    scalar: Scalar,
    at: Position,
    span: Span,
) -> Option<PortRef> {
    let pieces = wire.len().div_ceil(PIECE);
    let (first, second) = wire.split_at(pieces.div_ceil(2) * PIECE);
    let ty = |half: &[Signal]| {
        u32::try_from(half.len())
            .ok()
            .map(|n| Type::Array(scalar, n))
    };
    let mut inputs = Inputs::new();
    for half in [first, second] {
        inputs.push(half_input(elab, half, ty(half)?, at, span)?);
    }
    let join = member(PrimitiveFamily::ArrayConcatenate, scalar)?;
    let outputs = Types::from([ty(wire)?]);
    let node = nodes::add_node(elab, join, inputs, Vec::new(), outputs, at.fragment, span);
    Some(PortRef { node, port: 0 })
}

/// Returns a half of an array as an input: a constant, or the port of added nodes that build it.
fn half_input(
    elab: &mut Elaborator<'_>,
    half: &[Signal],
    ty: Type,
    at: Position,
    span: Span,
) -> Option<Input> {
    match constant_array(half, ty) {
        Some(values) => Some(Input::constant(values)),
        None => build_array(elab, half, ty, at, span).map(Input::Port),
    }
}

/// Adds net nodes that create an array or matrix and set its elements one by one. Returns the port with the array; `None` if
/// there are no primitives for the type.
fn set_elements(
    elab: &mut Elaborator<'_>,
    wire: &[Signal],
    ty: Type,
    at: Position,
    span: Span,
) -> Option<PortRef> {
    let ArrayPrims {
        create: make,
        sizes,
        set,
        scalar,
    } = ArrayPrims::for_type(ty)?;
    let params = sized_params(make, &sizes);
    let node = nodes::add_node(
        elab,
        make,
        Inputs::new(),
        params,
        Types::from([ty]),
        at.fragment,
        span,
    );
    let mut array = PortRef { node, port: 0 };
    for (k, signal) in (0..).zip(wire.iter()) {
        let value = one_input(elab, signal, scalar, at, span);
        let mut given = sizes.clone();
        given.extend(element_params(ty, k));
        let params = sized_params(set, &given);
        let inputs = smallvec![Input::Port(array), value];
        let node = nodes::add_node(
            elab,
            set,
            inputs,
            params,
            Types::from([ty]),
            at.fragment,
            span,
        );
        array = PortRef { node, port: 0 };
    }
    Some(array)
}

/// Primitives that create an array or matrix of one type and set its elements.
struct ArrayPrims {
    create: PrimId,
    /// Size parameters of these primitives: name and value.
    sizes: Vec<(&'static str, u32)>,
    set: PrimId,
    /// Machine type of the elements.
    scalar: Scalar,
}

impl ArrayPrims {
    fn for_type(ty: Type) -> Option<ArrayPrims> {
        match ty {
            Type::Scalar(_) => None,
            Type::Array(scalar, n) => Some(ArrayPrims {
                create: member(PrimitiveFamily::Array, scalar)?,
                sizes: vec![("Size", n)],
                set: member(PrimitiveFamily::ArraySet, scalar)?,
                scalar,
            }),
            Type::Matrix(rows, cols) => Some(ArrayPrims {
                create: prim!("Core::MatrixCreate"),
                sizes: vec![("Rows", rows), ("Cols", cols)],
                set: prim!("Core::MatrixSet"),
                scalar: Scalar::Real,
            }),
        }
    }
}
