//! Results of a call that are kept while the call does not run.

use crate::elab::arrays;
use crate::elab::call;
use crate::elab::call::ConditionalCall;
use crate::elab::elementwise;
use crate::elab::expr;
use crate::elab::expr::leaf_scalars;
use crate::elab::nodes;
use crate::elab::primitive_family::PrimitiveFamily;
use crate::elab::scope::Scope;
use crate::elab::signal::{Signal, Wire};
use crate::elab::{Elaborator, Position};
use crate::typed::ExprId;
use rpi_diag::Span;
use rpi_image::Scalar;
use rpi_net::{FragmentId, Restart};

pub(super) fn condact_fragment<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    every: &Signal,
    restart: Option<[ExprId; 2]>,
    path: &str,
    at: Position,
    span: Span,
) -> FragmentId {
    let at = at.unguarded();
    let restart = restart.map(|pair| expr::elab_operand(elab, scope, pair, at));
    let restart = restart.and_then(|signal| arrays::port_of(elab, &signal, Scalar::Bool, at, span));
    let restart = restart.map_or(Restart::Never, Restart::Every);
    let activation = call::elab_activation(elab, every, at, span);
    call::elab_fragment(elab, path, at.fragment, activation, restart, span)
}

/// Returns the signals of the results of a call that runs only in some cycles: the results of this cycle if it runs,
/// else those of its last run.
pub(super) fn hold_results<'u>(
    elab: &mut Elaborator<'u>,
    run: &ConditionalCall,
    id: ExprId,
    scope: &Scope<'u>,
    at: Position,
) -> Wire {
    let span = scope.unit.expr(id).span;
    let scalars = leaf_scalars(&scope.unit.expr(id).ty);
    let leaves = scalars.into_iter().take(run.result.len()).enumerate();
    let leaves: Vec<Signal> = leaves
        .map(|(k, scalar)| hold_leaf(elab, run, k, scalar, at, span))
        .collect();
    leaves.into()
}

fn hold_leaf(
    elab: &mut Elaborator<'_>,
    run: &ConditionalCall,
    k: usize,
    scalar: Scalar,
    at: Position,
    span: Span,
) -> Signal {
    let signal = run.result[k].clone();
    let default = run.default.as_ref().and_then(|wire| wire.get(k)).cloned();
    let is_optional = run.is_optional.get(k).copied().unwrap_or_default();
    if let (Some(default @ Signal::Const(_)), false) = (&default, is_optional) {
        let inputs = [signal, default.clone()];
        return nodes::add_family_member(elab, PrimitiveFamily::Hold, scalar, &inputs, at, span);
    }
    let result = nodes::new_alias(elab, scalar);
    let alias = Signal::Port(result);
    let pre = match default.is_none() || is_optional {
        true => PrimitiveFamily::OptionalPre,
        false => PrimitiveFamily::Pre,
    };
    let add = |elab: &mut Elaborator<'_>, family, inputs: &[Signal]| {
        nodes::add_family_member(elab, family, scalar, inputs, at, span)
    };
    let before = elementwise::delay(elab, pre, scalar, &alias, at, span);
    let before = match default {
        None => before,
        Some(default) => {
            let first = nodes::first_port(elab, at.fragment, span);
            add(
                elab,
                PrimitiveFamily::Conditional,
                &[first, default, before],
            )
        }
    };
    let held = match is_optional {
        // A run whose result is absent is remembered as absent, too.
        true => {
            let inputs = [run.condition.clone(), signal, before];
            add(elab, PrimitiveFamily::Conditional, &inputs)
        }
        false => add(elab, PrimitiveFamily::Coalesce, &[signal, before]),
    };
    call::bind_alias(elab, result, &held);
    held
}
