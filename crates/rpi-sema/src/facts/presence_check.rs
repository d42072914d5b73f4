//! Checks for values that must be present: flows that are not optional, conditions, and inputs that are not optional.

use crate::clocks::ClockId;
use crate::facts::Absence;
use crate::facts::absence_error::ABSENT;
use crate::facts::dependents::Definition;
use crate::facts::dependents::Dependents;
use crate::facts::presence::PresenceInference;
use crate::typed::{Activation, Call, ElementwiseOp, TypedKind};
use crate::typed::{ExprId, Flow, FlowId, FlowPresence, SharedFlow, TargetPlace, Unit, UnitKind};
use rpi_diag::{Code, Diagnostic, Quote, Span};
use rpi_syntax::Name;
use std::collections::BTreeSet;

/// Reports flows, conditions and arguments that must be present but may be absent, and warns about superfluous `??`.
pub(super) fn check_presence(
    inference: &PresenceInference<'_>,
    reads: &Dependents<'_>,
    diagnostics: &mut Vec<Diagnostic>,
) {
    let faulty = flows(inference, reads, diagnostics);
    conditions(inference, diagnostics);
    for id in (0..).map(ExprId).take(inference.unit.exprs.len()) {
        match &inference.unit.expr(id).kind {
            TypedKind::Call(call) => arguments(inference, id, call, diagnostics),
            TypedKind::Each(ElementwiseOp::Coalesce, operands)
                if !reads_one_of(inference, operands[0], &faulty) =>
            {
                warn_needless_coalesce(inference, id, [operands[0], operands[1]], diagnostics);
            }
            _ => {}
        }
    }
}

/// Returns whether an expression or one of its operands reads one of these flows.
fn reads_one_of(inference: &PresenceInference<'_>, id: ExprId, flows: &BTreeSet<FlowId>) -> bool {
    if flows.is_empty() {
        return false;
    }
    let mut parts = inference.unit.traverse(id);
    while let Some((id, expr)) = parts.next() {
        if matches!(&expr.kind, TypedKind::Flow(flow) if flows.contains(flow)) {
            return true;
        }
        parts.enter(id);
    }
    false
}

/// Reports flows that are declared as always present but may be absent, and returns these flows.
fn flows(
    inference: &PresenceInference<'_>,
    reads: &Dependents<'_>,
    diagnostics: &mut Vec<Diagnostic>,
) -> BTreeSet<FlowId> {
    let mut faulty = BTreeSet::new();
    for definition in &reads.definitions {
        let equation = match definition {
            Definition::Equation(_, equation) => equation,
            Definition::Shared(shared) => {
                if let Some(diagnostic) = open_value(inference, shared) {
                    diagnostics.push(diagnostic);
                    faulty.insert(shared.flow);
                }
                continue;
            }
        };
        let mut at = 0;
        for target in &equation.targets {
            let count = target.ty.leaf_count();
            if let TargetPlace::Flow { flow, .. } = target.place
                && inference.must_be_present(flow)
                && inference
                    .value_for_targets(equation.value, (at, count), &target.place)
                    .any()
            {
                faulty.insert(flow);
                let clock = inference.clocks.flow_clocks(flow).leaf(0);
                let flow = inference.unit.flow(flow);
                let text = format!("`{}` is `{}`, which is always present", flow.name, flow.ty);
                let diagnostic = inference.absence_error(equation.value, clock, ABSENT);
                diagnostics.push(diagnostic.secondary(flow.span, text));
            }
            at += count;
        }
    }
    faulty
}

/// Returns the error for a flow that must be present but that some states of an automaton do not define; `None` if
/// there is no error.
fn open_value(inference: &PresenceInference<'_>, shared: &SharedFlow) -> Option<Diagnostic> {
    let unit = inference.unit;
    let (first, others) = shared.missing.split_first()?;
    if shared.default.is_some() || !inference.must_be_present(shared.flow) {
        return None;
    }
    let flow = unit.flow(shared.flow);
    let first = unit.block(*first);
    let message = format!("`{}` is absent in the state `{}`", flow.name, first.name);
    let diagnostic = Diagnostic::new(Code::RPI3001, message)
        .primary(
            first.span,
            format!("this state does not define `{}`", flow.name),
        )
        .secondary(
            flow.span,
            format!("`{}` is `{}`, which is always present", flow.name, flow.ty),
        );
    let others = others.iter().map(|block| unit.block(*block).span);
    let diagnostic = others.fold(diagnostic, |f, state| {
        f.secondary(state, "neither does this state")
    });
    Some(diagnostic.help(missing_definition_help(unit, shared, flow)))
}

/// Returns the ways to define a flow that some states do not define. `last` has no value in the first cycle, in which
/// the initial state is active.
fn missing_definition_help(unit: &Unit, shared: &SharedFlow, flow: &Flow) -> String {
    let automata = unit.blocks.iter().flat_map(|block| &block.automata);
    let initial = automata.filter_map(|automaton| {
        let state = automaton.states.get(automaton.initial as usize)?;
        Some(state.block)
    });
    let is_in_initial = initial
        .into_iter()
        .any(|state| shared.missing.contains(&state));
    let Flow { name, ty, .. } = flow;
    let in_states = match (is_in_initial, ty.zero_literal()) {
        (true, Some(zero)) => format!("define it in every state, such as `{name} = {zero};`"),
        (true, None) => format!("define it in every state: `{name} = ...;`"),
        (false, _) => format!("define it in every state (`{name} = last {name};` keeps it)"),
    };
    match unit.is_lustre {
        true => format!("{in_states}, or once outside the automaton: `{name} = ...;`"),
        false => format!(
            "{in_states}, or once outside the automaton (`{name} = ...;`); or declare it as `{ty}?`"
        ),
    }
}

fn conditions(inference: &PresenceInference<'_>, diagnostics: &mut Vec<Diagnostic>) {
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
            if inference.on_clock(id, ClockId::BASE).any() {
                let diagnostic = inference.absence_error_or(id, ClockId::BASE, why, otherwise);
                let own = flow_read_of(unit, id, k).filter(|_| block.when == Some(id));
                diagnostics.push(match own {
                    Some(flow) => Diagnostic {
                        help: vec![own_flow_help(&block.name, flow)],
                        ..diagnostic
                    },
                    None => diagnostic.fix(inference.fix_coalesce(id, otherwise)),
                });
            }
        }
    }
}

/// Returns the advice for a fragment whose condition reads one of its own flows.
fn own_flow_help(fragment: &Name, flow: &Flow) -> String {
    let zero = flow.ty.zero_or_dots();
    format!(
        "a fragment cannot depend on its own flows in the same cycle: read the previous value, `({zero} -> pre hold({fragment}.{}, {zero}))`",
        flow.name
    )
}

/// Returns a flow of a block that an expression reads in the same cycle.
fn flow_read_of(unit: &Unit, id: ExprId, block: usize) -> Option<&Flow> {
    let mut parts = unit.traverse(id);
    while let Some((id, expr)) = parts.next() {
        match &expr.kind {
            TypedKind::Flow(flow) if unit.flow(*flow).block.0 as usize == block => {
                return Some(unit.flow(*flow));
            }
            TypedKind::Each(ElementwiseOp::Pre | ElementwiseOp::Last, _) => {}
            _ => parts.enter(id),
        }
    }
    None
}

impl PresenceInference<'_> {
    /// Returns which leaves (scalar parts) of an argument can be absent for the in-port `port`. An in-port with a clock
    /// takes values on that clock.
    pub(super) fn argument_absence(&self, call: ExprId, port: &Flow, arg: ExprId) -> Absence {
        match port.clock {
            Some(_) => self.absence(arg),
            None => self.on_clock(arg, self.clocks.computed_on(call)),
        }
    }
}

fn arguments(
    inference: &PresenceInference<'_>,
    id: ExprId,
    call: &Call,
    diagnostics: &mut Vec<Diagnostic>,
) {
    let place = inference.clocks.computed_on(id);
    let callee = &inference.units[call.unit.0 as usize];
    for (flow, arg) in callee.inputs.iter().zip(&call.args) {
        let (flow, Some(arg)) = (callee.flow(*flow), arg) else {
            continue;
        };
        let total =
            flow.optional != FlowPresence::Declared(true) && callee.kind != UnitKind::Function;
        if total && inference.argument_absence(id, flow, *arg).any() {
            let text = format!(
                "in-port `{}` of `{}` must be present",
                flow.name, callee.name
            );
            let mut diagnostic = inference.absence_error(*arg, place, ABSENT);
            if let Some(help) = output_help(inference, *arg) {
                diagnostic.help = vec![help];
            }
            diagnostics.push(diagnostic.secondary(flow.span, text));
        }
    }
    let conditions = match &call.activation {
        Activation::Always => [None, None],
        Activation::Restart { every } => [Some(*every), None],
        Activation::Condact { every, restart, .. } => [Some(*every), *restart],
    };
    for id in conditions.into_iter().flatten() {
        if inference.on_clock(id, place).any() {
            let why = "the condition of an activation must be present";
            let diagnostic = inference.absence_error(id, place, why);
            diagnostics.push(diagnostic.fix(inference.fix_coalesce(id, "false")));
        }
    }
}

/// Returns the advice for an argument that is one of several outputs of a call, as in `f(g(x))`.
fn output_help(inference: &PresenceInference<'_>, arg: ExprId) -> Option<String> {
    let TypedKind::Part { base, at } = inference.unit.expr(arg).kind else {
        return None;
    };
    let call = inference.unit.expr(base);
    let TypedKind::Call(called) = &call.kind else {
        return None;
    };
    let names: Vec<&str> = call
        .ty
        .members()
        .iter()
        .filter_map(|m| m.name.as_deref())
        .collect();
    if names.len() < 2 || call.span != inference.unit.expr(arg).span {
        return None;
    }
    let absent = names.get(at as usize).unwrap_or(&names[0]);
    let zero = inference.unit.expr(arg).ty.zero_literal();
    Some(format!(
        "name the outputs of `{}` first, `{} = {};`, and pass values that are always present, such as `{absent} ?? {}`",
        inference.units[called.unit.0 as usize].name,
        names.join(", "),
        Quote::text(call.span),
        zero.unwrap_or("...".to_owned())
    ))
}

/// Warns about `x ?? y` if `x` is always present, so that `y` is never used.
fn warn_needless_coalesce(
    inference: &PresenceInference<'_>,
    id: ExprId,
    [first, second]: [ExprId; 2],
    diagnostics: &mut Vec<Diagnostic>,
) {
    let unit = inference.unit;
    let sure = !inference.for_reader(id, first).any() && unit.expr(first).ty.leaf_count() > 0;
    if sure && !matches!(unit.expr(first).kind, TypedKind::Error) {
        let diagnostic = Diagnostic::new(Code::RPI3002, "the right side of `??` is never used")
            .primary(unit.expr(second).span, "never used")
            .secondary(unit.expr(first).span, "this is always present")
            .help("delete `??` and its right side");
        diagnostics.push(diagnostic);
    }
}

/// Returns the location and label of the first flow or operand because of which an expression may be absent, for an
/// expression that reads it on the clock `reader`. `None` if no cause is found.
pub(super) fn absence_cause(
    inference: &PresenceInference<'_>,
    id: ExprId,
    reader: ClockId,
) -> Option<(Span, String)> {
    let (unit, clocks, mut at, mut reader) = (inference.unit, inference.clocks, id, reader);
    loop {
        let expr = unit.expr(at);
        let row = clocks.expr_clocks(at);
        if at != id
            && let Some(own) = row.iter().find(|own| clocks.is_slower(*own, reader))
        {
            let path = clocks.samplings_beyond(own, reader);
            let clock = crate::clocks::format_clock(inference.units, inference.facts, unit, path);
            return Some((expr.span, format!("this is present only `{clock}`")));
        }
        reader = clocks.computed_on(at);
        match &expr.kind {
            TypedKind::Flow(flow) => {
                let flow = unit.flow(*flow);
                return Some(match unit.block(flow.block).when {
                    Some(when) => {
                        let text = format!("`{}` is absent while this is false", flow.name);
                        (unit.expr(when).span, text)
                    }
                    None => (flow.span, format!("`{}` may be absent", flow.name)),
                });
            }
            TypedKind::None => return Some((expr.span, "`none` is absent".to_owned())),
            TypedKind::Call(call) => match call_absence_cause(inference, call) {
                CallAbsenceCause::Here(text) => return Some((expr.span, text)),
                CallAbsenceCause::Callee(span, text) => return Some((span, text)),
                CallAbsenceCause::Operand(operand) => {
                    at = operand;
                    continue;
                }
                CallAbsenceCause::Operands => {}
            },
            _ => {}
        }
        let is_exact = reads_on_own_clocks(&expr.kind);
        let mut next = None;
        expr.kind.operands(&mut |operand| {
            let is_absent = match is_exact {
                true => inference.exprs[operand.0 as usize].any(),
                false => inference.on_clock(operand, reader).any(),
            };
            if is_absent {
                next.get_or_insert(operand);
            }
        });
        at = next?;
    }
}

/// Returns whether an operator reads each operand on the clock of that operand, not on a common clock.
fn reads_on_own_clocks(kind: &TypedKind) -> bool {
    use TypedKind::{Build, Current, Merge, Part};
    matches!(kind, Current(_) | Merge { .. } | Part { .. } | Build(_))
}

/// Reason for which the result of a call may be absent.
enum CallAbsenceCause {
    /// The call itself is the reason. The text is the label for its location.
    Here(String),
    /// A location in the called unit is the reason, with the label for it.
    Callee(Span, String),
    /// The operand of the call that may be absent, as an expression.
    Operand(ExprId),
    /// Some operand of the call may be absent. The first such operand is the reason.
    Operands,
}

fn call_absence_cause(inference: &PresenceInference<'_>, call: &Call) -> CallAbsenceCause {
    let callee = &inference.units[call.unit.0 as usize];
    if callee.kind == UnitKind::Function {
        return CallAbsenceCause::Operands;
    }
    let before = call.activation.default();
    let is_activated = matches!(call.activation, Activation::Condact { .. });
    let mut outputs = callee.outputs.iter().map(|flow| callee.flow(*flow));
    let optional = outputs.find(|flow| flow.optional == FlowPresence::Declared(true));
    match (before, optional) {
        (None, _) if is_activated => {
            let text = "absent before the first run: give a value with `initial default`";
            CallAbsenceCause::Here(text.to_owned())
        }
        (Some(before), _) if inference.exprs[before.0 as usize].any() => {
            CallAbsenceCause::Operand(before)
        }
        (_, Some(flow)) => {
            let text = format!("`{}` of `{}` may be absent", flow.name, callee.name);
            CallAbsenceCause::Callee(flow.span, text)
        }
        _ => CallAbsenceCause::Operands,
    }
}
