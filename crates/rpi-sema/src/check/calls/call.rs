//! Calls: resolution of the callee, static arguments, activation, and instantiation of the called unit.

use crate::check::bodies::body::Body;
use crate::check::bodies::locals;
use crate::check::bodies::statement;
use crate::check::calls::applied;
use crate::check::calls::arg_tuples;
use crate::check::calls::args;
use crate::check::calls::args::CallArgument;
use crate::check::calls::callable::Callable;
use crate::check::calls::callable::FixedPortValue;
use crate::check::calls::callee;
use crate::check::calls::callee::Callee;
use crate::check::calls::condact;
use crate::check::calls::intrinsics;
use crate::check::calls::intrinsics::Intrinsic;
use crate::check::calls::iterate;
use crate::check::calls::prim;
use crate::check::diagnostics::elsewhere;
use crate::check::diagnostics::suggest_callee;
use crate::check::exprs::names;
use crate::check::exprs::proof_only;
use crate::check::signatures::constraint;
use crate::check::signatures::external;
use crate::check::signatures::header;
use crate::check::signatures::header::Header;
use crate::check::signatures::instance;
use crate::check::signatures::size_inference;
use crate::check::signatures::static_args;
use crate::check::signatures::static_args::StaticBindings;
use crate::check::signatures::static_params;
use crate::check::signatures::static_params::StaticParamDecl;
use crate::check::signatures::unit;
use crate::check::types::data;
use crate::program::{DeclId, DeclKind};
use crate::ty::{Substitution, Ty};
use crate::typed::{self, Equation, ExprId, FlowPresence, FlowRole, Target, TargetPlace, UnitKind};
use crate::typed::{Activation, TypedKind};
use rpi_diag::Span;
use rpi_syntax::Name;
use rpi_syntax::ast::{self, NodeDef};
use std::rc::Rc;

/// Call whose arguments have been matched with the ports of the callee.
pub(crate) struct MatchedCall {
    /// Ports of the called declaration for its static arguments.
    pub(crate) header: Rc<Header>,
    /// Argument of each in-port, in the order of the ports; `None` for a port that uses its default.
    pub(crate) args: Vec<Option<ExprId>>,
    /// Types and frames inferred from the arguments for the names that the signature leaves open.
    subst: Substitution,
}

/// Checks a call `f(x, y)` of a node, an operator or a primitive, and returns its typed expression.
pub(crate) fn check_call<'a>(cx: &mut Body<'_, 'a>, call: &'a ast::Call, span: Span) -> ExprId {
    let activation = resolve_activation(cx, &call.activation);
    call_with_activation(cx, call, activation, span)
}

/// Checks a call with the activation (condition under which the callee runs) that is written around it, and returns its
/// typed expression.
pub(crate) fn call_with_activation<'a>(
    cx: &mut Body<'_, 'a>,
    call: &'a ast::Call,
    activation: Activation,
    span: Span,
) -> ExprId {
    let name = &call.callee.name;
    match callee::resolve_callee(cx, &name.name, name.span) {
        Callee::Nothing(_) => {
            let given = elsewhere::check_foreign_args(cx, call, span);
            elsewhere::suggest_for_foreign_call(cx, call, &given, span);
            suggest_callee::suggest_struct_literal(cx, call, span)
        }
        Callee::Special(special) => intrinsics::check_intrinsic(cx, special, call, span),
        Callee::Iterator("condact") if call.callee.statics.is_empty() => {
            intrinsics::check_intrinsic(cx, Intrinsic::Condact, call, span)
        }
        Callee::Iterator("condact") => condact::condact_call(cx, call, span),
        Callee::Iterator(name) if call.callee.statics.is_empty() => {
            suggest_callee::iterator_without_statics(cx, name, call, span)
        }
        Callee::Iterator(name) => {
            match iterate::resolve_iterator(cx, name, &call.callee.statics, call.callee.span) {
                Some(iteration) => {
                    let given = args::check_args(cx, &call.args);
                    call_callable(
                        cx,
                        &Callable::Iteration(Rc::new(iteration)),
                        given,
                        activation,
                        span,
                    )
                }
                None => {
                    args::check_args(cx, &call.args);
                    cx.error_expr(span)
                }
            }
        }
        Callee::Known(callable) => {
            let given = args::check_args(cx, &call.args);
            call_callable(cx, &callable, given, activation, span)
        }
        Callee::Prim(prim) => prim::check_prim_call(cx, prim, call, span),
        Callee::Constructor(ty, index) => {
            let given = args::check_args(cx, &call.args);
            let values: Vec<ExprId> = given.iter().map(|arg| arg.value).collect();
            data::constructor_value(cx, (ty, index), &call.callee.statics, &values, span)
        }
        Callee::Decl(id) => call_decl(cx, id, call, activation, span),
    }
}

/// Checks a call of a declaration under an activation condition, and returns its typed expression. A call of an alias
/// (`node f = g<<3>>;`) is a call of its target.
fn call_decl<'a>(
    cx: &mut Body<'_, 'a>,
    id: DeclId,
    call: &'a ast::Call,
    activation: Activation,
    span: Span,
) -> ExprId {
    proof_only::check_call_in_quantifier(cx, call, id, span);
    if let DeclKind::Node(node) = cx.checker.program.decl(id).kind
        && let NodeDef::Alias(callee) = &node.definition
    {
        let given = args::check_args(cx, &call.args);
        return match callee::resolve_alias(cx, id, callee, &call.callee.statics) {
            Some(callable) => call_callable(cx, &callable, given, activation, span),
            None => cx.error_expr(span),
        };
    }
    let mut bound = static_args::bind_statics(cx, id, &call.callee.statics);
    let args = static_args::bind_sizes(cx, id, &call.args, &mut bound);
    let (mut given, all_named) = args::check_args_for(cx, id, &args);
    given.extend(bound.ports);
    if bound.has_error || !all_named {
        return cx.error_expr(span);
    }
    call_declared(cx, id, bound.statics, given, activation, span)
}

/// Checks the conditions and the default value of an activation, as in `activate ... every c`, and returns their typed
/// form.
fn resolve_activation<'a>(cx: &mut Body<'_, 'a>, activation: &'a ast::Activation) -> Activation {
    match activation {
        ast::Activation::Always => Activation::Always,
        ast::Activation::Restart { every } => Activation::Restart {
            every: statement::check_condition(cx, every, "a restart"),
        },
        ast::Activation::Activate {
            every,
            restart,
            default,
        } => Activation::Condact {
            every: statement::check_condition(cx, every, "an activation"),
            default: default
                .as_ref()
                .map(|default| condact::check_condact_default(cx, default)),
            restart: restart
                .as_ref()
                .map(|restart| statement::check_condition(cx, restart, "a restart")),
        },
    }
}

/// Checks the application of a callable to arguments that have been checked, and returns its typed expression.
pub(crate) fn call_callable<'a>(
    cx: &mut Body<'_, 'a>,
    callable: &Callable,
    given: Vec<CallArgument<'a>>,
    activation: Activation,
    span: Span,
) -> ExprId {
    match callable {
        Callable::Unit(id, statics, fixed) => {
            call_with_fixed_ports(cx, *id, statics, fixed, given, activation, span)
        }
        Callable::Prim(prim) => prim::prim_call_with(cx, *prim, &given, span),
        Callable::Op(op) => applied::call_operator(cx, *op, &given, span),
        Callable::Predefined(predef) => applied::call_predefined_op(cx, predef, given, span),
        Callable::Intrinsic(special) => intrinsics::apply_intrinsic(cx, *special, &given, span),
        Callable::Iteration(iteration) => iterate::apply_iterator(cx, iteration, &given, span),
        Callable::NodeParam(header) => applied::call_node_param(cx, header, given, span),
    }
}

/// Checks a call of a declaration. The values that static arguments have fixed for some of its ports are added to the
/// arguments `given`.
fn call_with_fixed_ports<'a>(
    cx: &mut Body<'_, 'a>,
    id: DeclId,
    statics: &Rc<StaticBindings>,
    fixed: &Rc<[(Name, FixedPortValue)]>,
    mut given: Vec<CallArgument<'a>>,
    activation: Activation,
    span: Span,
) -> ExprId {
    let params = static_params::static_params_of_decl(cx.checker, id);
    for (name, fixed) in &**fixed {
        let value = match fixed {
            FixedPortValue::Constant(constant) => names::constant_expr(cx, constant, span),
            FixedPortValue::LoadTime(value) => *value,
        };
        let param = params
            .iter()
            .map(StaticParamDecl::name)
            .find(|p| p.name == *name);
        let port = || static_params::in_port_idents(cx.checker, id).find(|port| port.name == *name);
        given.push(CallArgument {
            name: param.or_else(port),
            value,
            is_static: true,
        });
    }
    call_declared(cx, id, (**statics).clone(), given, activation, span)
}

/// Checks a call of a declaration with values `statics` of its static parameters and checked arguments `given`. Returns
/// the typed expression of the call.
fn call_declared<'a>(
    cx: &mut Body<'_, 'a>,
    id: DeclId,
    statics: StaticBindings,
    given: Vec<CallArgument<'a>>,
    activation: Activation,
    span: Span,
) -> ExprId {
    match match_call(cx, id, statics, given, span) {
        Ok(fitted) => add_call(cx, fitted, activation, span),
        // The type is kept, so that the uses of the outputs are still checked.
        Err(ty) => cx.add(TypedKind::Error, ty, span),
    }
}

/// Matches the arguments of a call with the ports of a declaration, and infers the static parameters without a value.
///
/// After an error, it returns the type of the result as far as this type is known.
pub(crate) fn match_call<'a>(
    cx: &mut Body<'_, 'a>,
    id: DeclId,
    mut statics: StaticBindings,
    mut given: Vec<CallArgument<'a>>,
    span: Span,
) -> Result<MatchedCall, Ty> {
    if unit::reads_rpi_syntax(cx) {
        given = arg_tuples::flatten_tuple_args(cx, given);
    }
    if !size_inference::infer_size_params(cx, id, &given, &mut statics) {
        return Err(Ty::Unknown);
    }
    let open = static_params::add_default_statics(cx.checker, id, &mut statics);
    if unit::lacks_sizes(cx.checker, id, &open, &statics, span) {
        // Not reported beside a misspelt argument: that may be the one the size depends on.
        if !args::report_unknown_args(cx, id, &given) {
            instance::report_missing(cx, id, &open, span);
        }
        return Err(Ty::Unknown);
    }
    if !constraint::check_constraints(cx, id, &statics, span) {
        return Err(Ty::Unknown);
    }
    let header = header::check_header(cx.checker, id, Rc::new(statics.clone()));
    let header = header.ok_or(Ty::Unknown)?;
    let free = header.free_frames.iter();
    let mut subst = Substitution {
        frames: free.map(|frame| (frame.clone(), None)).collect(),
        ..Substitution::default()
    };
    let Some(mut args) = args::match_args_to_ports(cx, &header, &given, span) else {
        return Err(match open.is_empty() {
            true => header.result_type().substituted(&subst),
            false => Ty::Unknown,
        });
    };
    let mut sound = args::check_arg_types(cx, &header, &mut args, &mut subst);
    let of_units = header.inputs.iter().any(|port| port.ty.has_unknown());
    let given = args.iter().flatten();
    let all_known = given.copied().all(|arg| !cx.ty_of(arg).has_unknown());
    let known_at = all_known.then_some(span);
    let header = instance::resolve_instance(cx, &header, statics, &open, &subst, (span, known_at));
    let header = header.ok_or(Ty::Unknown)?;
    // Units that depend on static parameters are known only in the instance, so that the types are checked again.
    sound = sound && (!of_units || args::check_arg_types(cx, &header, &mut args, &mut subst));
    match sound {
        true => Ok(MatchedCall {
            header,
            args,
            subst,
        }),
        false => Err(header.result_type().substituted(&subst)),
    }
}

/// Adds the typed expression of a call to the body and returns it. The called declaration is checked for these static
/// arguments if that has not been done.
fn add_call(
    cx: &mut Body<'_, '_>,
    fitted: MatchedCall,
    activation: Activation,
    span: Span,
) -> ExprId {
    let MatchedCall {
        ref header,
        args,
        ref subst,
    } = fitted;
    if header.kind != UnitKind::Function {
        cx.record_state(span);
    }
    external::check_external_call(cx, header, span);
    let Some(unit) = unit::instantiate(cx.checker, header, span) else {
        return cx.error_expr(span);
    };
    let args = name_clock_args(cx, header, args);
    let ty = header.result_type().substituted(subst);
    if let Activation::Condact {
        default: Some(default),
        ..
    } = activation
    {
        statement::expect_type(
            cx,
            default,
            &ty,
            &crate::check::diagnostics::report::ExpectationReason::Unexplained,
        );
    }
    let args = args.into();
    let call = typed::Call {
        unit,
        args,
        activation,
    };
    cx.add(TypedKind::Call(Box::new(call)), ty, span)
}

/// Gives each argument that is the clock of another port a flow of its own, because a clock refers to a flow by name.
/// Returns the changed arguments.
fn name_clock_args(
    cx: &mut Body<'_, '_>,
    header: &Header,
    mut args: Vec<Option<ExprId>>,
) -> Vec<Option<ExprId>> {
    if cx.inference.is_running {
        return args;
    }
    let deciding = header.inputs.iter().zip(&mut args);
    for (port, arg) in deciding.filter(|(port, _)| port.is_clock) {
        let unnamed = |id: &ExprId| !matches!(cx.unit.expr(*id).kind, TypedKind::Flow(_));
        if let Some(value) = arg.filter(unnamed) {
            *arg = Some(bind_to_flow(cx, port, value));
        }
    }
    args
}

/// Adds a flow whose value is an expression, named after the port with a unique suffix. Returns an expression that
/// reads the flow.
fn bind_to_flow(
    cx: &mut Body<'_, '_>,
    port: &crate::check::signatures::header::Port,
    value: ExprId,
) -> ExprId {
    let (span, ty) = (cx.span_of(value), cx.ty_of(value).clone());
    let name = ast::Ident {
        name: format!("{}#{}", port.name, cx.unit.flows.len()).into(),
        span,
    };
    let flow = locals::add_flow(
        cx,
        &name,
        ty.clone(),
        FlowPresence::Inferred,
        FlowRole::Local,
    );
    let place = TargetPlace::Flow { flow, at: 0 };
    let equation = Equation {
        targets: vec![Target { place, ty, span }],
        value,
        span,
    };
    cx.current_block().equations.push(equation);
    names::flow_expr(cx, flow, span)
}
