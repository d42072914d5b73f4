//! Elaborates calls by inlining the callee at the place of the call.

use crate::elab::arrays;
use crate::elab::block;
use crate::elab::condact;
use crate::elab::coverage_points;
use crate::elab::elementwise;
use crate::elab::expr;
use crate::elab::flows;
use crate::elab::fragment_inputs;
use crate::elab::fragment_outputs;
use crate::elab::guards;
use crate::elab::node_budget;
use crate::elab::outside_flows;
use crate::elab::sampled_flows;
use crate::elab::scope::{FlowState, Scope};
use crate::elab::signal::{Signal, Wire};
use crate::elab::subrange;
use crate::elab::watched_flows;
use crate::elab::{ElabMode, Elaborator, MAX_DEPTH, NotConstantError, Position};
use crate::typed::{Activation, Call};
use crate::typed::{BlockId, ExprId, Unit, UnitId, UnitKind};
use rpi_diag::{Code, Diagnostic, Span};
use rpi_image::{Scalar, Value};
use rpi_net::{self as net, AbsentPolicy, Fragment, FragmentId, Origin, PortRef, Restart};

/// Call that runs only in some cycles, under a condition.
pub(super) struct ConditionalCall {
    /// Boolean signal: the condition under which the call runs.
    pub(super) condition: Signal,
    /// Signals of the results in cycles in which the call runs.
    pub(super) result: Wire,
    /// Signals of the results before the first run of the call; `None` if no default is given.
    pub(super) default: Option<Wire>,
    /// For each leaf (scalar part) of the results, whether it may be absent in cycles in which the call runs.
    pub(super) is_optional: Vec<bool>,
}

/// Argument of a call: the signals of its leaves (scalar parts), and its location.
pub(super) struct CallArgument {
    wire: Wire,
    span: Span,
}

/// Elaborates a call expression according to its activation (always, with restarts, or under a condition) and returns
/// the signals of its results.
pub(super) fn elab_call<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    call: &'u Call,
    id: ExprId,
    at: Position,
) -> Wire {
    let span = scope.unit.expr(id).span;
    let args = arguments(elab, scope, call, id, at);
    let path = elab_path(elab, id);
    match &call.activation {
        Activation::Always => results_of(elab, scope, call, (id, &args), at, path),
        Activation::Restart { every } => {
            let every = expr::elab_operand(elab, scope, [id, *every], at.unguarded());
            let Some(every) = arrays::port_of(elab, &every, Scalar::Bool, at, span) else {
                return crate::elab::signal::empty_wire();
            };
            let activation = net::Activation::Always;
            let inner = elab_fragment(
                elab,
                &path,
                at.fragment,
                activation,
                Restart::Every(every),
                span,
            );
            results_of(
                elab,
                scope,
                call,
                (id, &args),
                Position::in_fragment(inner),
                path,
            )
        }
        Activation::Condact { .. } => elab_condact(elab, scope, call, (id, &args), at, path),
    }
}

/// Elaborates a call that runs under a condition and holds its results between runs. `path` is the name of the call in
/// the net.
fn elab_condact<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    call: &'u Call,
    (id, args): (ExprId, &[Option<CallArgument>]),
    at: Position,
    path: String,
) -> Wire {
    let Activation::Condact {
        every,
        default,
        restart,
    } = &call.activation
    else {
        return crate::elab::signal::empty_wire();
    };
    let span = scope.unit.expr(id).span;
    let every = expr::elab_operand(elab, scope, [id, *every], at.unguarded());
    let restart = restart.map(|restart| [id, restart]);
    let inner = condact::condact_fragment(elab, scope, &every, restart, &path, at, span);
    elab.inlining.keeps_results = !scope.unit.is_lustre;
    let inside = Position::in_fragment(inner);
    let result = results_of(elab, scope, call, (id, args), inside, path);
    let result = fragment_outputs::gate_wire(elab, &result, inner, at.fragment);
    let default =
        default.map(|one| sampled_flows::operand_wire(elab, scope, [id, one], at.unguarded()));
    let callee = &elab.units[call.unit.0 as usize];
    let run = ConditionalCall {
        condition: every,
        result,
        default,
        is_optional: callee.optional_leaves().collect(),
    };
    condact::hold_results(elab, &run, id, scope, at)
}

fn arguments<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    call: &'u Call,
    id: ExprId,
    at: Position,
) -> Vec<Option<CallArgument>> {
    let callee = &elab.units[call.unit.0 as usize];
    let given = match guards::is_guarded(elab, call) {
        true => at,
        // A callee with state runs in all cycles, whichever branch of an `if` is chosen, so its arguments are not
        // guarded.
        false => at.unguarded(),
    };
    let mut args = Vec::with_capacity(call.args.len());
    for (port, arg) in callee.inputs.iter().zip(&call.args) {
        let count = callee.flow(*port).ty.leaf_count();
        let is_sampled = callee.flow(*port).clock.is_some();
        args.push(arg.map(|arg| CallArgument {
            wire: match is_sampled {
                true => elementwise::expr_leaves(elab, scope, arg, count, given),
                false => argument(elab, scope, [id, arg], count, given),
            },
            span: scope.unit.expr(arg).span,
        }));
    }
    args
}

/// Inlines the called unit at the position `at` and returns the signals of its results. Connects the clock conditions
/// inside of the call to which the clocks of the caller refer.
fn results_of<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    call: &'u Call,
    (id, args): (ExprId, &[Option<CallArgument>]),
    at: Position,
    path: String,
) -> Wire {
    let span = scope.unit.expr(id).span;
    let wire = inline_unit(elab, call.unit, args, at, path, span);
    let exposed = std::mem::take(&mut elab.inlining.exposed_conditions);
    sampled_flows::bind_exposed(elab, scope, id, exposed);
    wire
}

/// Returns the signals of the argument `arg` of the call `id`, expanded to `count` leaves (scalar parts). The argument
/// is absent in cycles in which the clock of the call ticks and its own clock does not.
fn argument<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    [id, arg]: [ExprId; 2],
    count: usize,
    at: Position,
) -> Wire {
    let wire = sampled_flows::operand_wire(elab, scope, [id, arg], at);
    match (&wire[..], count) {
        ([Signal::Absent], n) if n != 1 => (0..n).map(|_| Signal::Absent).collect(),
        _ => wire,
    }
}

/// Returns the name for the net nodes of an expression: the name of the flow being defined if the expression is its
/// whole value, else this name with a number.
fn elab_path(elab: &mut Elaborator<'_>, id: ExprId) -> String {
    if elab.naming.top_expr == Some(id) {
        return elab.naming.name.clone();
    }
    elab.naming.serial += 1;
    format!("{}#{}", elab.naming.name, elab.naming.serial - 1)
}

/// Returns the activation of a fragment by a condition; `Always` for the constant `true`. A fragment is inactive if its
/// condition is absent.
pub(super) fn elab_activation(
    elab: &mut Elaborator<'_>,
    condition: &Signal,
    at: Position,
    span: Span,
) -> net::Activation {
    if *condition == Signal::Const(Value::bool(true)) {
        return net::Activation::Always;
    }
    match arrays::port_of(elab, condition, Scalar::Bool, at, span) {
        Some(condition) => net::Activation::When {
            condition,
            if_absent: AbsentPolicy::Inactive,
        },
        None => net::Activation::Always,
    }
}

/// Adds a fragment to the net, with its name `path`, its activation and its restart condition, and returns it.
pub(super) fn elab_fragment(
    elab: &mut Elaborator<'_>,
    path: &str,
    parent: FragmentId,
    activation: net::Activation,
    restart: Restart,
    span: Span,
) -> FragmentId {
    elab.net.add_fragment(Fragment {
        name: path.to_owned(),
        parent: Some(parent),
        activation,
        restart,
        is_clock: false,
        inputs: Vec::new(),
        outputs: Vec::new(),
        budget_ns: None,
        origin: Origin {
            span,
            flow: Some(path.to_owned()),
        },
    })
}

/// Inlines a unit at the position `at` with its inputs connected to `args`, and returns the signals of its outputs.
/// `path` is the name of the call in the net.
pub(super) fn inline_unit(
    elab: &mut Elaborator<'_>,
    id: UnitId,
    args: &[Option<CallArgument>],
    at: Position,
    path: String,
    span: Span,
) -> Wire {
    let unit = &elab.units[id.0 as usize];
    if elab.inlining.call_stack.len() >= MAX_DEPTH {
        return report_too_deep(elab, id, span);
    }
    node_budget::credit_text(elab, id);
    if !node_budget::charge_call(elab, span) {
        return crate::elab::signal::empty_wire();
    }
    elab.inlining.call_stack.push(id);
    elab.inlining.call_spans.push(span);
    let outer = (
        std::mem::take(&mut elab.naming.name),
        elab.naming.serial,
        elab.naming.top_expr,
    );
    let entered = std::mem::replace(&mut elab.inlining.guard, at.guard);
    let result = inline_body(elab, unit, id, args, at, path, span);
    (elab.naming.name, elab.naming.serial, elab.naming.top_expr) = outer;
    elab.inlining.guard = entered;
    elab.inlining.call_stack.pop();
    elab.inlining.call_spans.pop();
    result
}

fn inline_body<'u>(
    elab: &mut Elaborator<'u>,
    unit: &'u Unit,
    id: UnitId,
    args: &[Option<CallArgument>],
    at: Position,
    path: String,
    span: Span,
) -> Wire {
    if elab.mode == ElabMode::Constant && unit.kind == UnitKind::Node {
        // A node runs cycle by cycle; only functions can be evaluated at compile time.
        return elab.fail(NotConstantError::RunTime(span));
    }
    let keeps_results = std::mem::take(&mut elab.inlining.keeps_results);
    coverage_points::record_call(elab, unit);
    let mut scope = Scope::new(unit, id);
    scope.call_span = Some(span);
    let in_fragment = unit.kind == UnitKind::Fragment && elab.mode != ElabMode::Constant;
    scope.prefix = if in_fragment || path.is_empty() {
        String::new()
    } else {
        format!("{path}.")
    };
    elab.naming.name.clone_from(&path);
    let at = match guards::is_stateless_expr(elab, id) {
        true => at,
        false => at.unguarded(),
    };
    scope.base = at.fragment;
    connect(elab, &mut scope, args, at);
    let inner = match in_fragment {
        true => Position::in_fragment(fragment_of_unit(elab, &mut scope, &path, at, span)),
        false => at,
    };
    if in_fragment {
        fragment_inputs::add_input_entries(elab, &mut scope, inner.fragment);
    }
    let around = std::mem::replace(&mut scope.base, inner.fragment);
    let spans: Vec<Option<Span>> = args.iter().map(|arg| Some(arg.as_ref()?.span)).collect();
    subrange::check_inputs(elab, &mut scope, &spans, inner);
    scope.base = around;
    if elab.mode != ElabMode::Constant {
        block::body(elab, &mut scope, inner);
    }
    let is_lifted = keeps_results || crate::clocks::may_be_inactive(unit);
    let around = std::mem::replace(&mut scope.base, inner.fragment);
    let leaves = outputs_of(elab, &mut scope, is_lifted, span);
    watched_flows::export_watched(elab, &mut scope, inner);
    scope.base = around;
    elab.inlining.exposed_conditions = match elab.mode {
        ElabMode::Constant => Vec::new(),
        _ => sampled_flows::exposed_conditions(elab, &mut scope, id, span),
    };
    fragment_outputs::gate_wire(elab, &leaves, inner.fragment, at.fragment)
}

/// Returns the signals of a unit's outputs. If `is_lifted`, the outputs can be read in all cycles of the unit: they are
/// absent in cycles in which their clocks do not tick.
fn outputs_of<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    is_lifted: bool,
    span: Span,
) -> Wire {
    let mut leaves = Vec::new();
    for output in &scope.unit.outputs {
        let mut wire = flows::elab_flow(elab, scope, *output, span);
        if is_lifted {
            wire = outside_flows::off_clock_absent(elab, scope, *output, &wire, span);
        }
        leaves.extend(wire.iter().cloned());
    }
    leaves.into()
}

fn fragment_of_unit<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    path: &str,
    at: Position,
    span: Span,
) -> FragmentId {
    let root = scope.unit.block(BlockId::ROOT);
    let activation = match root.when {
        Some(when) => {
            let condition = expr::elab_condition(elab, scope, when, at);
            elab_activation(elab, &condition, at, span)
        }
        None => net::Activation::Always,
    };
    let restart = if root.restart {
        Restart::OnActivation
    } else {
        Restart::Never
    };
    let fragment = elab_fragment(elab, path, at.fragment, activation, restart, span);
    let made = &mut elab.net.fragments[fragment.0 as usize];
    made.budget_ns = root.budget_ns;
    // The output flow has that path itself, so the fragment gets the unit's name.
    made.origin.flow = Some(scope.unit.name.to_string());
    fragment
}

/// Connects the inputs of a unit to the arguments of the caller, or to their defaults.
pub(super) fn connect<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    args: &[Option<CallArgument>],
    at: Position,
) {
    let unit = scope.unit;
    for (flow, arg) in unit.inputs.iter().zip(args) {
        let wire = match (arg, unit.flow(*flow).default) {
            (Some(arg), _) => arg.wire.clone(),
            (None, Some(default)) => expr::elab_expr(elab, scope, default, at),
            (None, None) => continue,
        };
        *scope.state(*flow) = FlowState::Done(wire);
    }
}

/// Reports calls that are nested too deeply, because of an infinite recursion or a long chain of calls. Returns a value
/// without signals.
fn report_too_deep(elab: &mut Elaborator<'_>, id: UnitId, span: Span) -> Wire {
    let unit = &elab.units[id.0 as usize];
    let message = match elab.inlining.call_stack.contains(&id) {
        true => format!("`{}` is infinitely recursive", unit.name),
        false => format!("calls are nested more than {MAX_DEPTH} deep"),
    };
    let diagnostic = Diagnostic::new(Code::RPI1011, message)
        .primary(span, format!("`{}` is called here", unit.name))
        .secondary(unit.span, "declared here")
        .help(format!(
            "`with` chooses at compile time where a recursion ends: `with n = ... then ... else {}<<...>>(...)`",
            unit.name
        ));
    report_failure(elab, diagnostic, span)
}

/// Reports an error because of which the net or constant has no value. Later errors are not reported. Returns a value
/// without signals.
pub(super) fn report_failure(
    elab: &mut Elaborator<'_>,
    diagnostic: Diagnostic,
    span: Span,
) -> Wire {
    if elab.mode == ElabMode::Constant {
        return elab.fail(NotConstantError::Fault(span, diagnostic.message));
    }
    if elab.failure.is_none() {
        elab.diagnostics.push(diagnostic);
    }
    elab.fail(NotConstantError::Reported)
}

/// Connects a placeholder port to its signal, unless it is connected already. Other ports are ignored.
pub(super) fn bind_alias(elab: &mut Elaborator<'_>, port: PortRef, signal: &Signal) {
    if let Some(alias) = crate::elab::signal::alias_of(port) {
        elab.aliases.signals[alias].get_or_insert_with(|| signal.clone());
    }
}
