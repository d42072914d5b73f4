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

/// Equation that has been declared, with the progress of its check.
pub(crate) struct PendingEquation<'a> {
    pub(crate) block: BlockId,
    pub(crate) lhs: EquationLhs<'a>,
    pub(crate) value: &'a ast::Expr,
    pub(crate) span: Span,
    /// For each target, the flow whose type is inferred from this equation; `None` for a target with a declared type.
    pub(crate) inferred_flows: SmallVec<[Option<FlowId>; 1]>,
    /// Progress of the check of this equation.
    pub(crate) state: EquationState,
    /// Names and values of the array indices on the left side, if the equation defines one array element; otherwise
    /// empty.
    pub(crate) indices: Vec<(ast::Ident, i64)>,
}

/// Read of a flow in an equation while the type of the flow was not known yet.
#[derive(Clone, Copy)]
pub(crate) struct UnknownRead {
    /// Index in `pending` of the equation that defines the flow.
    pub(crate) equation: usize,
    pub(crate) span: Span,
    /// Whether the flow is read in the current cycle, rather than through a delay such as `pre`.
    pub(crate) in_same_cycle: bool,
}

/// Which types may be guessed for an operand of unknown type beside a number literal.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub(crate) enum GuessPolicy {
    /// No type is guessed, because an integer literal may be meant as a real, and a factor may change the unit.
    #[default]
    Never,
    /// An operand of unknown type is guessed to be an `int` if the other operand is an `int`.
    Integers,
    /// Types are guessed from integers, and from factors without a unit.
    Factors,
}

/// Left side of an equation: its targets, or the variable whose declaration has a value.
#[derive(Clone, Copy)]
pub(crate) enum EquationLhs<'a> {
    /// Targets of a plain equation.
    Targets(&'a [ast::Target]),
    /// Flow of a variable declaration with a value, `var x: int = e;`.
    Var(FlowId),
}

/// Progress of checking an equation during type inference.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) enum EquationState {
    /// The equation has not been checked yet.
    Unchecked,
    /// The check is postponed until the types of the flows that the equation reads are inferred.
    Waiting,
    /// The equation has been checked once, but it reads flows of unknown type, so that the type of its value is a
    /// guess. It is checked again later.
    Guessed,
    /// The types of the equation's flows cannot be inferred, and the error has been reported.
    Reported,
    /// The equation has been checked completely; the expression is its typed value.
    Done(ExprId),
}

impl PendingEquation<'_> {
    /// Whether the type of at least one flow is inferred from this equation.
    pub(crate) fn infers_type(&self) -> bool {
        self.inferred_flows.iter().any(Option::is_some)
    }
}

/// Sizes of the tables of a body before a trial check, to which `rollback` truncates the tables.
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

/// Infers types that only operations on numbers determine, from the types of these numbers. `number_literals` is the
/// policy for these guesses.
pub(crate) fn guess_from_numbers(cx: &mut Body<'_, '_>, number_literals: GuessPolicy) {
    cx.inference.is_running = true;
    cx.inference.guess_policy = number_literals;
    while recheck_guessed(cx) {}
    cx.inference.guess_policy = GuessPolicy::Never;
    cx.inference.is_running = false;
}

/// Returns the typed value of the equation with this index in `pending`; checks the value first if that has not been
/// done.
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

/// Checks the right side of the equation with this index in `pending`, in the block of the equation, and returns its
/// typed expression.
pub(crate) fn check_value(cx: &mut Body<'_, '_>, index: usize) -> ExprId {
    let (block, value) = (cx.pending[index].block, cx.pending[index].value);
    cx.in_block(block, |body| {
        elements::with_index_bindings(body, index, |body| expr::check_expr(body, value))
    })
}

/// Records the read of a flow whose type is inferred from its equation, if the type is not known yet.
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

/// Checks the right side of the equation with this index in `pending`. If it reads flows of unknown type, the check is
/// undone and only the type of the value is used, as a first guess. Returns whether the check is complete.
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

/// Sets the types of the flows that are inferred from the equation with this index in `pending`. `ty` is the type of
/// its value, of which parts may be unknown.
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

/// Postpones the equation with this index in `pending`, such as `v = none`, whose type is unknown, until the equation
/// of `v` in another state has determined the type of `v`.
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

/// Returns the index in `pending` of an unchecked equation that defines the same flow as equation `index`, in another
/// state of the automaton; `None` if there is none.
fn unchecked_in_other_state(cx: &Body<'_, '_>, flow: FlowId, index: usize) -> Option<usize> {
    let outer = automaton::enclosing_shared_flows(cx, flow);
    let versions = outer.filter_map(|outer| cx.shared.contributions.get(&outer));
    let mut equations = versions
        .flatten()
        .filter_map(|other| cx.inference.defined_by[other.0 as usize]);
    equations.find(|other| *other != index && cx.pending[*other].state == EquationState::Unchecked)
}

/// Checks all equations with a guessed type again. Returns whether the type of a further flow became known.
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

/// Returns the current sizes of the body's tables, for a later `rollback`.
pub(crate) fn checkpoint(cx: &Body<'_, '_>) -> Checkpoint {
    Checkpoint {
        exprs: cx.unit.exprs.len(),
        diagnostics: cx.diagnostics.len(),
        first_state_span: cx.first_state_span,
    }
}

/// Removes all expressions and diagnostics that have been added to the body since the checkpoint `mark`.
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
    let integer_fix = cx.inference.integer_fix.take();
    cx.inference.integer_fix = integer_fix.filter(|(at, _)| *at < mark.diagnostics);
    cx.first_state_span = mark.first_state_span;
}
