//! Order of type inference. A local flow without a declared type gets the type of its equation, wherever that is in the
//! text, and flows may depend on each other through `pre`.
//!
//! An equation that reads a flow of unknown type is postponed until that flow's equation has been checked. If the
//! equations depend on each other, the rest of the equation gives a guess (`t = 0[s] -> pre t + dt` is a time, whatever
//! `pre t` is); guesses are verified when all types are known. Types that are still unknown are guessed from the
//! numbers in the equation (`n = pre n + 1` is an integer), so that only its actual error is reported. The search keeps
//! its own stack, so that a long chain of equations cannot overflow the call stack.

use crate::check::bodies::automaton;
use crate::check::bodies::body::Body;
use crate::check::bodies::elements;
use crate::check::bodies::tuple_pieces;
use crate::check::exprs::expr;
use crate::ty::Ty;
use crate::typed::{BlockId, ExprId, FlowId};
use rpi_diag::Span;
use rpi_syntax::ast;
use smallvec::SmallVec;

/// Equation that has been declared and waits to be checked.
pub(crate) struct PendingEquation<'a> {
    pub(crate) block: BlockId,
    pub(crate) lhs: EquationLhs<'a>,
    pub(crate) value: &'a ast::Expr,
    pub(crate) span: Span,
    /// For each target the flow whose type this equation decides; `None` for other targets.
    pub(crate) inferred_flows: SmallVec<[Option<FlowId>; 1]>,
    /// Progress of the check.
    pub(crate) state: EquationState,
    /// Index variables of the left side with their values, if the equation defines one array element.
    pub(crate) indices: Vec<(ast::Ident, i64)>,
}

/// A read of a flow whose type was not known yet.
#[derive(Clone, Copy)]
pub(crate) struct UnknownRead {
    /// Index of the equation that defines the flow.
    pub(crate) equation: usize,
    pub(crate) span: Span,
    /// Whether the flow is read in the current cycle, not through `pre`.
    pub(crate) in_same_cycle: bool,
}

/// Policy for guessing the type of an operation on a number and an operand of unknown type.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub(crate) enum GuessPolicy {
    /// No type is guessed: an integer may be meant as a real, and a factor changes the unit.
    #[default]
    Never,
    /// An unknown type beside an integer is guessed as `int`.
    Integers,
    /// Types are guessed from integers, and from factors without a unit.
    Factors,
}

/// Left side of an equation.
#[derive(Clone, Copy)]
pub(crate) enum EquationLhs<'a> {
    /// Targets of an equation.
    Targets(&'a [ast::Target]),
    /// Variable with a value in its declaration.
    Var(FlowId),
}

/// Progress of checking an equation.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) enum EquationState {
    /// The equation has not been checked yet.
    Unchecked,
    /// The types of the flows that the equation reads must be inferred first.
    Waiting,
    /// The equation has been checked, but it reads flows of unknown type, so that its own type is a guess.
    Guessed,
    /// The types of the equation's flows cannot be inferred, which has been reported.
    Reported,
    /// The equation has been checked; this is its value.
    Done(ExprId),
}

impl PendingEquation<'_> {
    /// Whether the equation decides the type of a flow.
    pub(crate) fn infers_type(&self) -> bool {
        self.inferred_flows.iter().any(Option::is_some)
    }
}

/// Sizes of the body's tables before a trial check.
pub(crate) struct Checkpoint {
    exprs: usize,
    diagnostics: usize,
    first_state_span: Option<Span>,
}

/// Infers the types of all flows without a declared type.
pub(crate) fn infer_types(cx: &mut Body<'_, '_>) {
    cx.inference.is_running = true;
    for index in 0..cx.pending.len() {
        if cx.pending[index].infers_type() && cx.pending[index].state == EquationState::Unchecked {
            resolve_equation(cx, index);
        }
    }
    while recheck_guessed(cx) {}
    cx.inference.is_running = false;
    guess_from_numbers(cx, GuessPolicy::Integers);
}

/// Guesses the types that only operations on numbers determine, from the types of these numbers.
pub(crate) fn guess_from_numbers(cx: &mut Body<'_, '_>, number_literals: GuessPolicy) {
    cx.inference.is_running = true;
    cx.inference.guess_policy = number_literals;
    while recheck_guessed(cx) {}
    cx.inference.guess_policy = GuessPolicy::Never;
    cx.inference.is_running = false;
}

/// Returns the value of an equation; checks it now if it is not checked yet.
pub(crate) fn checked_value(cx: &mut Body<'_, '_>, index: usize) -> ExprId {
    match cx.pending[index].state {
        EquationState::Done(value) => value,
        _ => {
            let value = check_value(cx, index);
            cx.pending[index].state = EquationState::Done(value);
            value
        }
    }
}

/// Checks the value of an equation in its block.
pub(crate) fn check_value(cx: &mut Body<'_, '_>, index: usize) -> ExprId {
    let (block, value) = (cx.pending[index].block, cx.pending[index].value);
    cx.in_block(block, |body| {
        elements::with_index_bindings(body, index, |body| expr::check_expr(body, value))
    })
}

/// Records the read of an undeclared flow if its type is not known yet.
pub(crate) fn record_unknown_read(cx: &mut Body<'_, '_>, flow: FlowId, span: Span) {
    let known = !cx.unit.flow(flow).ty.has_unknown();
    let Some(equation) = cx.inference.defined_by[flow.0 as usize].filter(|_| !known) else {
        return;
    };
    if !matches!(cx.pending[equation].state, EquationState::Done(_)) {
        let now = cx.bindings.pre_depth == 0;
        cx.inference.unknown_reads.push(UnknownRead {
            equation,
            span,
            in_same_cycle: now,
        });
    }
}

fn resolve_equation(cx: &mut Body<'_, '_>, index: usize) {
    let mut stack = vec![index];
    while let Some(&top) = stack.last() {
        if !matches!(
            cx.pending[top].state,
            EquationState::Unchecked | EquationState::Waiting
        ) || try_check(cx, top)
        {
            stack.pop();
            continue;
        }
        let open = |k: &usize| cx.pending[*k].state == EquationState::Unchecked;
        let needs = cx
            .inference
            .unknown_reads
            .iter()
            .map(|missing| missing.equation);
        let needs: Vec<usize> = needs.filter(open).collect();
        if needs.is_empty() {
            cx.pending[top].state = EquationState::Guessed;
            stack.pop();
        } else {
            cx.pending[top].state = EquationState::Waiting;
            stack.extend(needs.into_iter().rev());
        }
    }
}

/// Checks the value of an equation. If it reads flows of unknown type, only a first guess of its type is kept.
/// Returns whether the check is complete.
fn try_check(cx: &mut Body<'_, '_>, index: usize) -> bool {
    let mark = checkpoint(cx);
    cx.inference.unknown_reads.clear();
    let value = check_value(cx, index);
    let ty = cx.ty_of(value).clone();
    if cx.inference.unknown_reads.is_empty() && ty.has_unknown() {
        wait_for_other_states(cx, index);
    }
    let complete = cx.inference.unknown_reads.is_empty();
    if complete {
        cx.pending[index].state = EquationState::Done(value);
    } else {
        rollback(cx, mark);
    }
    set_inferred_types(cx, index, &ty);
    complete
}

/// Sets the types of the flows that an equation defines, as far as the type of its value is known.
fn set_inferred_types(cx: &mut Body<'_, '_>, index: usize, ty: &Ty) {
    let flows = cx.pending[index].inferred_flows.clone();
    let types: SmallVec<[Ty; 1]> = match flows.len() {
        1 => SmallVec::from([ty.clone()]),
        count => {
            let pieces = tuple_pieces::decompose(std::slice::from_ref(ty), &vec![None; count]);
            pieces.into_iter().map(|piece| piece.ty).collect()
        }
    };
    let types = types.into_iter().chain(std::iter::repeat(Ty::Unknown));
    for (flow, ty) in flows.iter().zip(types) {
        let Some(flow) = *flow else {
            continue;
        };
        let around: Vec<FlowId> = automaton::enclosing_shared_flows(cx, flow).collect();
        let outer = around.iter().map(|outer| &cx.unit.flow(*outer).ty);
        let mut types = std::iter::once(&ty).chain(outer);
        let known = types.find(|ty| !ty.has_unknown());
        let ty = known.unwrap_or(&ty).clone();
        for flow in std::iter::once(flow).chain(around) {
            let known = &mut cx.unit.flows[flow.0 as usize].ty;
            if known.has_unknown() {
                *known = ty.clone();
            }
        }
    }
}

/// Postpones an equation such as `v = none`, of unknown type, until another state has determined the type of `v`.
fn wait_for_other_states(cx: &mut Body<'_, '_>, index: usize) {
    for flow in cx.pending[index]
        .inferred_flows
        .clone()
        .into_iter()
        .flatten()
    {
        if let Some(equation) = unchecked_in_other_state(cx, flow, index) {
            let span = cx.pending[index].span;
            cx.inference.unknown_reads.push(UnknownRead {
                equation,
                span,
                in_same_cycle: false,
            });
        }
    }
}

/// Returns an unchecked equation that defines the flow of this equation in another state.
fn unchecked_in_other_state(cx: &Body<'_, '_>, flow: FlowId, index: usize) -> Option<usize> {
    let outer = automaton::enclosing_shared_flows(cx, flow);
    let versions = outer.filter_map(|outer| cx.shared.contributions.get(&outer));
    let mut equations = versions
        .flatten()
        .filter_map(|other| cx.inference.defined_by[other.0 as usize]);
    equations.find(|other| *other != index && cx.pending[*other].state == EquationState::Unchecked)
}

/// Checks all guessed equations again; returns whether a type became known.
fn recheck_guessed(cx: &mut Body<'_, '_>) -> bool {
    let before = unknown_flow_count(cx);
    for index in 0..cx.pending.len() {
        if cx.pending[index].state == EquationState::Guessed && cx.pending[index].infers_type() {
            try_check(cx, index);
        }
    }
    unknown_flow_count(cx) < before
}

fn unknown_flow_count(cx: &Body<'_, '_>) -> usize {
    let guessed = cx
        .pending
        .iter()
        .filter(|p| p.state == EquationState::Guessed);
    let flows = guessed.flat_map(|p| p.inferred_flows.iter().flatten());
    flows.filter(|f| cx.unit.flow(**f).ty.has_unknown()).count()
}

/// Returns the current sizes of the body's tables.
pub(crate) fn checkpoint(cx: &Body<'_, '_>) -> Checkpoint {
    Checkpoint {
        exprs: cx.unit.exprs.len(),
        diagnostics: cx.diagnostics.len(),
        first_state_span: cx.first_state_span,
    }
}

/// Undoes all additions to the tables of the body since a checkpoint.
pub(crate) fn rollback(cx: &mut Body<'_, '_>, mark: Checkpoint) {
    cx.unit.exprs.truncate(mark.exprs);
    // `chosen` is sorted by expression, so that the undone ones are at its end.
    let is_kept = |id: &ExprId| (id.0 as usize) < mark.exprs;
    let kept = cx.unit.static_conditions.partition_point(is_kept);
    cx.unit.static_conditions.truncate(kept);
    cx.diagnostics.truncate(mark.diagnostics);
    cx.reported.undefined_names.truncate(mark.diagnostics);
    cx.reported.undefined_flows.truncate(mark.diagnostics);
    cx.reported.invalid_clocks.truncate(mark.diagnostics);
    cx.inference.real_fix_index = cx
        .inference
        .real_fix_index
        .filter(|at| *at < mark.diagnostics);
    cx.first_state_span = mark.first_state_span;
}
