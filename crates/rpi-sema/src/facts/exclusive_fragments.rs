//! Mutually exclusive fragments: `??` over flows of fragments of which one is always active is always present.

use crate::typed::{BlockId, ExprId, FlowId, Unit};
use crate::typed::{ElementwiseOp, TypedKind};

/// Returns whether `a ?? b` is present in all cycles because its operands include flows from fragments with opposite
/// activation conditions, or from all states of an automaton. `total` returns whether a flow is present whenever its
/// block is active.
pub(super) fn is_always_present(
    unit: &Unit,
    a: ExprId,
    b: ExprId,
    total: impl Fn(FlowId) -> bool,
) -> bool {
    let mut flows = Vec::new();
    sources(unit, a, &mut flows);
    sources(unit, b, &mut flows);
    // An optional flow of an active fragment may be absent, so it guarantees nothing.
    flows.retain(|flow| total(*flow));
    let blocks: Vec<BlockId> = flows.iter().map(|flow| unit.flow(*flow).block).collect();
    have_opposite_conditions(unit, &blocks) || cover_all_states(unit, &blocks)
}

/// Appends the flows that a chain of `??` reads to `flows`, including flows of which a part is read.
fn sources(unit: &Unit, id: ExprId, flows: &mut Vec<FlowId>) {
    match &unit.expr(id).kind {
        TypedKind::Flow(flow) => flows.push(*flow),
        TypedKind::Part { base, .. } => sources(unit, *base, flows),
        TypedKind::Each(ElementwiseOp::Coalesce, operands) => {
            operands.iter().for_each(|id| sources(unit, *id, flows));
        }
        _ => {}
    }
}

fn have_opposite_conditions(unit: &Unit, blocks: &[BlockId]) -> bool {
    let condition = |block: &BlockId| {
        let block = unit.block(*block);
        let outermost = block.parent.is_some_and(|parent| parent == BlockId::ROOT);
        block
            .when
            .filter(|_| outermost)
            .and_then(|when| literal(unit, when, true))
    };
    let conditions: Vec<(u32, bool)> = blocks.iter().filter_map(condition).collect();
    conditions
        .iter()
        .any(|(flow, holds)| conditions.contains(&(*flow, !holds)))
}

/// Returns the index of the flow of an expression that is a flow or the negation of one, and the value of this flow
/// when the expression has the value `holds`. `None` for other expressions.
pub(crate) fn literal(unit: &Unit, id: ExprId, holds: bool) -> Option<(u32, bool)> {
    match &unit.expr(id).kind {
        TypedKind::Flow(flow) => Some((flow.0, holds)),
        TypedKind::Prim(call) if call.prim.desc().name == "Core::BooleanNot" => {
            literal(unit, call.inputs.first().copied()??, !holds)
        }
        _ => None,
    }
}

fn cover_all_states(unit: &Unit, blocks: &[BlockId]) -> bool {
    let automata = unit.blocks.first().map(|root| &root.automata);
    let mut automata = automata.into_iter().flatten();
    automata.any(|automaton| {
        automaton
            .states
            .iter()
            .all(|state| blocks.contains(&state.block))
    })
}
