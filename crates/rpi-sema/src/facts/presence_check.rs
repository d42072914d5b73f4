//! Checks for values that must be present: flows that are not optional, conditions, and inputs that are not optional.

use crate::clocks::ClockId;
use crate::facts::Absence;
use crate::facts::dependents::Definition;
use crate::facts::dependents::Reads;
use crate::facts::presence::Inference;
use crate::typed::{Activation, Call, Each, Kind};
use crate::typed::{ExprId, Flow, FlowId, Optional, Place, Shared, Unit, UnitKind};
use rpi_diag::{Code, Finding, Span};
use std::collections::BTreeSet;

/// Reports values that must be present but may be absent.
pub(super) fn demand(inference: &Inference<'_>, reads: &Reads<'_>, findings: &mut Vec<Finding>) {
    let faulty = flows(inference, reads, findings);
    conditions(inference, findings);
    for id in (0..).map(ExprId).take(inference.unit.exprs.len()) {
        match &inference.unit.expr(id).kind {
            Kind::Call(call) => arguments(inference, id, call, findings),
            Kind::Each(Each::Coalesce, operands)
                if !reads_one_of(inference, operands[0], &faulty) =>
            {
                needless(inference, id, [operands[0], operands[1]], findings);
            }
            _ => {}
        }
    }
}

/// Returns whether an expression reads one of these flows.
fn reads_one_of(inference: &Inference<'_>, id: ExprId, flows: &BTreeSet<FlowId>) -> bool {
    if flows.is_empty() {
        return false;
    }
    let mut parts = inference.unit.parts(id);
    while let Some((id, expr)) = parts.next() {
        if matches!(&expr.kind, Kind::Flow(flow) if flows.contains(flow)) {
            return true;
        }
        parts.enter(id);
    }
    false
}

/// Reports flows that are declared as present but may be absent, and returns them.
fn flows(
    inference: &Inference<'_>,
    reads: &Reads<'_>,
    findings: &mut Vec<Finding>,
) -> BTreeSet<FlowId> {
    let mut faulty = BTreeSet::new();
    for definition in &reads.definitions {
        let equation = match definition {
            Definition::Equation(_, equation) => equation,
            Definition::Shared(shared) => {
                if let Some(finding) = left_open(inference, shared) {
                    findings.push(finding);
                    faulty.insert(shared.flow);
                }
                continue;
            }
        };
        let mut at = 0;
        for target in &equation.targets {
            let count = target.ty.leaf_count();
            if let Place::Flow { flow, .. } = target.place
                && inference.must_be_present(flow)
                && inference
                    .taken(equation.value, (at, count), &target.place)
                    .any()
            {
                faulty.insert(flow);
                let clock = inference.clocks.flow(flow).leaf(0);
                let flow = inference.unit.flow(flow);
                let text = format!("`{}` is `{}`, which is always present", flow.name, flow.ty);
                let finding = inference.absent_here(equation.value, clock, "absent in some cycles");
                findings.push(finding.also(flow.span, text));
            }
            at += count;
        }
    }
    faulty
}

/// Returns an error for a flow that must be present but is not defined in some states.
fn left_open(inference: &Inference<'_>, shared: &Shared) -> Option<Finding> {
    let unit = inference.unit;
    let (first, others) = shared.missing.split_first()?;
    if shared.default.is_some() || !inference.must_be_present(shared.flow) {
        return None;
    }
    let flow = unit.flow(shared.flow);
    let first = unit.block(*first);
    let message = format!("`{}` is absent in the state `{}`", flow.name, first.name);
    let finding = Finding::new(Code::RPI3001, message)
        .at(
            first.span,
            format!("this state does not define `{}`", flow.name),
        )
        .also(
            flow.span,
            format!("`{}` is `{}`, which is always present", flow.name, flow.ty),
        );
    let others = others.iter().map(|block| unit.block(*block).span);
    let finding = others.fold(finding, |f, state| f.also(state, "neither does this state"));
    Some(finding.help(format!(
        "define it in every state (`{0} = last {0};` keeps it), or once outside the automaton: `{0} = ...;`",
        flow.name
    )))
}

fn conditions(inference: &Inference<'_>, findings: &mut Vec<Finding>) {
    let unit = inference.unit;
    for (k, block) in unit.blocks.iter().enumerate() {
        let when = block
            .when
            .iter()
            .map(|id| (*id, "the condition of a fragment must be present"));
        let ends = block
            .ends
            .iter()
            .map(|end| (end.condition, "the condition of an end must be present"));
        // In Lustre nothing is optional, and an absent claim holds.
        let claims = block
            .claims
            .iter()
            .filter(|_| !unit.is_lustre)
            .map(|claim| (claim.condition, "a claim must be present"));
        let states = block
            .automata
            .iter()
            .flat_map(|automaton| &automaton.states);
        let transitions = states.flat_map(|state| state.unless.iter().chain(&state.until));
        let transitions = transitions.filter_map(|t| {
            Some((
                t.condition?,
                "the condition of a transition must be present",
            ))
        });
        let decisions = when.chain(ends).chain(transitions);
        let decisions = decisions.map(|(id, why)| (id, why, "false"));
        // An absent claim counts as holding.
        let claims = claims.map(|(id, why)| (id, why, "true"));
        for (id, why, otherwise) in decisions.chain(claims) {
            if inference.seen_at(id, ClockId::BASE).any() {
                let finding = inference.absent_here(id, ClockId::BASE, why);
                findings.push(match block.when == Some(id) && reads_flow_of(unit, id, k) {
                    true => finding.help(
                        "a fragment cannot depend on its own flows in the same cycle; use the previous value: `pre F.x ?? 0`",
                    ),
                    false => finding.fix(inference.coalesced(id, otherwise)),
                });
            }
        }
    }
}

/// Returns whether an expression reads a flow of a block in the same cycle.
fn reads_flow_of(unit: &Unit, id: ExprId, block: usize) -> bool {
    let mut parts = unit.parts(id);
    while let Some((id, expr)) = parts.next() {
        match &expr.kind {
            Kind::Flow(flow) if unit.flow(*flow).block.0 as usize == block => return true,
            Kind::Each(Each::Pre | Each::Last, _) => {}
            _ => parts.enter(id),
        }
    }
    false
}

impl Inference<'_> {
    /// Returns the absence of an argument for an input. An input with a clock takes values of that clock.
    pub(super) fn given(&self, call: ExprId, port: &Flow, arg: ExprId) -> Absence {
        match port.clock {
            Some(_) => self.of(arg),
            None => self.seen_at(arg, self.clocks.place(call)),
        }
    }
}

fn arguments(inference: &Inference<'_>, id: ExprId, call: &Call, findings: &mut Vec<Finding>) {
    let place = inference.clocks.place(id);
    let callee = &inference.units[call.unit.0 as usize];
    for (flow, arg) in callee.inputs.iter().zip(&call.args) {
        let (flow, Some(arg)) = (callee.flow(*flow), arg) else {
            continue;
        };
        let total = flow.optional != Optional::Declared(true) && callee.kind != UnitKind::Function;
        if total && inference.given(id, flow, *arg).any() {
            let text = format!(
                "in-port `{}` of `{}` must be present",
                flow.name, callee.name
            );
            let finding = inference.absent_here(*arg, place, "absent in some cycles");
            findings.push(finding.also(flow.span, text));
        }
    }
    let conditions = match &call.activation {
        Activation::Always => [None, None],
        Activation::Restart { every } => [Some(*every), None],
        Activation::Condact { every, restart, .. } => [Some(*every), *restart],
    };
    for id in conditions.into_iter().flatten() {
        if inference.seen_at(id, place).any() {
            let why = "the condition of an activation must be present";
            let finding = inference.absent_here(id, place, why);
            findings.push(finding.fix(inference.coalesced(id, "false")));
        }
    }
}

/// Warns about `x ?? y` if x is always present.
fn needless(
    inference: &Inference<'_>,
    id: ExprId,
    [first, second]: [ExprId; 2],
    findings: &mut Vec<Finding>,
) {
    let unit = inference.unit;
    let sure = !inference.seen_by(id, first).any() && unit.expr(first).ty.leaf_count() > 0;
    if sure && !matches!(unit.expr(first).kind, Kind::Fault) {
        let finding = Finding::new(Code::RPI3002, "the right side of `??` is never used")
            .at(unit.expr(second).span, "never used")
            .also(unit.expr(first).span, "this is always present");
        findings.push(finding);
    }
}

/// Finds the cause of an expression's absence: the first flow or operand that may be absent. Returns its span and a
/// label.
pub(super) fn origin(
    inference: &Inference<'_>,
    id: ExprId,
    reader: ClockId,
) -> Option<(Span, String)> {
    let (unit, clocks) = (inference.unit, inference.clocks);
    let (mut at, mut reader) = (id, reader);
    loop {
        let expr = unit.expr(at);
        let row = clocks.row(at);
        let slower = row.iter().find(|own| clocks.is_slower(*own, reader));
        if let Some(own) = slower.filter(|_| at != id) {
            let path = clocks.beyond(own, reader);
            let clock = crate::clocks::print(inference.units, inference.facts, unit, path);
            return Some((expr.span, format!("this is present only `{clock}`")));
        }
        reader = clocks.place(at);
        match &expr.kind {
            Kind::Flow(flow) => {
                let flow = unit.flow(*flow);
                let block = unit.block(flow.block);
                return Some(match block.when {
                    Some(when) => (
                        unit.expr(when).span,
                        format!("`{}` is absent while this is false", flow.name),
                    ),
                    None => (flow.span, format!("`{}` may be absent", flow.name)),
                });
            }
            Kind::None => return Some((expr.span, "`none` is absent".to_owned())),
            Kind::Call(call) => match of_call(inference, call) {
                CallOrigin::Here(text) => return Some((expr.span, text)),
                CallOrigin::At(span, text) => return Some((span, text)),
                CallOrigin::Operand(operand) => {
                    at = operand;
                    continue;
                }
                CallOrigin::Operands => {}
            },
            _ => {}
        }
        // These operators read each operand on the operand's own clock.
        let is_exact = matches!(
            expr.kind,
            Kind::Current(_) | Kind::Merge { .. } | Kind::Part { .. } | Kind::Build(_)
        );
        let mut next = None;
        expr.kind.operands(&mut |operand| {
            let is_absent = match is_exact {
                true => inference.exprs[operand.0 as usize].any(),
                false => inference.seen_at(operand, reader).any(),
            };
            if is_absent {
                next.get_or_insert(operand);
            }
        });
        at = next?;
    }
}

/// Cause of the absence of a call's result.
enum CallOrigin {
    /// The call itself, with a label.
    Here(String),
    /// A place in the callee, with a label.
    At(Span, String),
    /// This operand.
    Operand(ExprId),
    /// Any operand that may be absent.
    Operands,
}

fn of_call(inference: &Inference<'_>, call: &Call) -> CallOrigin {
    let callee = &inference.units[call.unit.0 as usize];
    if callee.kind == UnitKind::Function {
        return CallOrigin::Operands;
    }
    let before = call.activation.default();
    let is_activated = matches!(call.activation, Activation::Condact { .. });
    let mut outputs = callee.outputs.iter().map(|flow| callee.flow(*flow));
    let optional = outputs.find(|flow| flow.optional == Optional::Declared(true));
    match (before, optional) {
        (None, _) if is_activated => {
            let text = "absent before the first run: give a value with `initial default`";
            CallOrigin::Here(text.to_owned())
        }
        (Some(before), _) if inference.exprs[before.0 as usize].any() => {
            CallOrigin::Operand(before)
        }
        (_, Some(flow)) => {
            let text = format!("`{}` of `{}` may be absent", flow.name, callee.name);
            CallOrigin::At(flow.span, text)
        }
        _ => CallOrigin::Operands,
    }
}
