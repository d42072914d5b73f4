//! Units are created at their first call and checked from a queue, so that nested calls cost no stack.

use crate::check::Checker;
use crate::check::bodies::assumptions;
use crate::check::bodies::body::Body;
use crate::check::bodies::contract;
use crate::check::bodies::none_type;
use crate::check::bodies::statement;
use crate::check::calls::prim;
use crate::check::diagnostics::report;
use crate::check::limits::nesting;
use crate::check::reuse;
use crate::check::signatures::alias;
use crate::check::signatures::external;
use crate::check::signatures::header;
use crate::check::signatures::header::Header;
use crate::check::signatures::header::unit_kind;
use crate::check::signatures::imported;
use crate::check::signatures::instance::instance_key;
use crate::check::signatures::static_args::StaticBindings;
use crate::check::signatures::static_params;
use crate::check::signatures::units_on_demand;
use crate::check::task;
use crate::check::types::consts;
use crate::elab::MAX_DEPTH;
use crate::program::{DeclId, DeclKind};
use crate::typed::TypedKind;
use crate::typed::{ExprId, Unit, UnitId, UnitKind};
use rpi_diag::{Code, Diagnostic, Severity, Span};
use rpi_syntax::ast::{
    self, CommandDecl, Contract, FragmentDecl, Modifier, NodeDecl, NodeDef, NodeKind,
};
use std::rc::Rc;

/// Maximum number of units of a program. An infinite recursion over static parameters exceeds it.
const MAX_UNITS: usize = 20_000;

/// Entry of a unit in the table of instances: its ports and the progress of its check.
pub(crate) struct UnitEntry {
    pub(crate) header: Rc<Header>,
    /// Location of the first call of the unit.
    called: Span,
    /// Nesting: number of instances with static arguments of which each was created by the check of the previous one.
    depth: u32,
    pub(super) state: Progress,
}

/// Progress of the check of a unit.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) enum Progress {
    Queued,
    Started,
    Done,
    /// The unit and all units that it calls, directly or indirectly, have been checked.
    Complete,
}

/// Returns the unit of a callable, and creates it at the first call; `None` if a limit is exceeded.
pub(crate) fn instantiate(
    checker: &mut Checker<'_>,
    header: &Rc<Header>,
    span: Span,
) -> Option<UnitId> {
    let key = instance_key(header.decl, &header.statics);
    if let Some(id) = checker.instances.ids.get(&key).copied() {
        reuse::record_call(checker, header, span, id);
        return Some(id);
    }
    let depth = match header.statics.is_empty() {
        true => 0,
        false => checker.instances.depth + 1,
    };
    if checker.units.len() >= MAX_UNITS || depth as usize > MAX_DEPTH {
        instance_limit_exceeded(checker, header, depth, span);
        return None;
    }
    if checker.limits.expanded_size >= checker.limits.max_expanded_size {
        nesting::program_too_large(checker, span);
        return None;
    }
    let id = UnitId(u32::try_from(checker.units.len()).unwrap_or(u32::MAX));
    checker.units.push(Rc::new(Unit::new(
        header.name.clone(),
        header.kind,
        header.span,
    )));
    checker.instances.entries.push(UnitEntry {
        header: header.clone(),
        called: span,
        depth,
        state: Progress::Queued,
    });
    checker.instances.ids.insert(key, id);
    checker.instances.called.insert(header.decl);
    checker.instances.queue.push_back(id);
    reuse::record_call(checker, header, span, id);
    Some(id)
}

fn instance_limit_exceeded(checker: &mut Checker<'_>, header: &Header, depth: u32, span: Span) {
    if std::mem::replace(&mut checker.limits.size_reported, true) {
        return;
    }
    let name = &checker.program.decl(header.decl).name;
    let message = match depth as usize > MAX_DEPTH {
        true => format!("recursion of `{name}` is more than {MAX_DEPTH} instances deep"),
        false => format!("`{name}` has more than {MAX_UNITS} instances"),
    };
    let diagnostic = Diagnostic::new(Code::RPI1011, message).primary(span, "limit exceeded here");
    checker.diagnostics.push(diagnostic.help(format!(
        "`with` chooses at compile time where a recursion ends: `with n = ... then ... else {name}<<...>>(...)`"
    )));
}

/// Returns the unit of a declaration that is run on its own; `None` if it needs static arguments.
pub(crate) fn root_unit(checker: &mut Checker<'_>, id: DeclId) -> Option<UnitId> {
    let mut statics = StaticBindings::new();
    let open = static_params::add_default_statics(checker, id, &mut statics);
    let needs_more = static_params::static_params_of_decl(checker, id)
        .iter()
        .any(|param| {
            let is_open = open.contains(&param.name().name);
            is_open
                && !matches!(
                    statics.get(&param.name().name),
                    Some(crate::check::signatures::static_args::StaticBinding::LoadTime)
                )
        });
    let sizes = has_open_sizes(checker, id, &open, &statics);
    if needs_more || sizes {
        return None;
    }
    let header = header::check_header(checker, id, Rc::new(statics))?;
    let is_alias = matches!(
        checker.program.decl(id).kind,
        DeclKind::Node(node) if matches!(node.definition, NodeDef::Alias(_))
    );
    // The target of an alias is not known before it is called.
    if is_alias && header.outputs.is_empty() {
        return None;
    }
    instantiate(checker, &header, header.span)
}

/// Whether one of the parameters `open`, those without an argument, is a value that may determine array sizes.
fn has_open_sizes(
    checker: &mut Checker<'_>,
    id: DeclId,
    open: &[rpi_syntax::Name],
    statics: &StaticBindings,
) -> bool {
    let params = static_params::static_params_of_decl(checker, id);
    params.iter().any(|param| match param {
        crate::check::signatures::static_params::StaticParamDecl::Value(name, def)
            if open.contains(&name.name) =>
        {
            crate::check::signatures::static_params::distinguishes_instances(
                &static_params::static_param_type(checker, id, def, statics),
            )
        }
        _ => false,
    })
}

/// Whether one of the parameters `open` may determine array sizes, and the ports or the body need its value.
pub(crate) fn lacks_sizes(
    checker: &mut Checker<'_>,
    id: DeclId,
    open: &[rpi_syntax::Name],
    statics: &StaticBindings,
    span: Span,
) -> bool {
    let lacks = has_open_sizes(checker, id, open, statics);
    let header = lacks.then(|| {
        alias::header_with_open_statics(checker, id, Rc::new(statics.clone()), open, span)
    });
    header.is_some_and(|header| header.is_none())
}

/// Checks all units whose check has not begun, and the units that they call.
pub(crate) fn check_queued(checker: &mut Checker<'_>) {
    while let Some(id) = checker.instances.queue.pop_front() {
        check_unit(checker, id);
    }
}

/// Whether a callable reads none of the given ports. A static parameter that is never read needs no argument.
pub(crate) fn reads_no_ports(
    checker: &mut Checker<'_>,
    header: &Rc<Header>,
    ports: &[(usize, &crate::check::signatures::header::Port)],
    span: Span,
) -> bool {
    let Some(id) = instantiate(checker, header, span) else {
        return false;
    };
    units_on_demand::check_unit_now(checker, id);
    let state = checker.instances.entries[id.0 as usize].state;
    if !matches!(state, Progress::Done | Progress::Complete) {
        return false;
    }
    let unit = &checker.units[id.0 as usize];
    let flows: Vec<_> = ports.iter().map(|(place, _)| unit.inputs[*place]).collect();
    let mut exprs = unit.exprs.iter();
    !exprs.any(|expr| matches!(expr.kind, TypedKind::Flow(flow) if flows.contains(&flow)))
}

/// Returns whether a declaration belongs to the standard library.
fn is_in_library(checker: &Checker<'_>, id: DeclId) -> bool {
    let module = checker.program.module(checker.program.decl(id).module);
    let modules = (checker.program.library.modules)();
    modules.contains(&module.name.as_str())
}

pub(super) fn check_unit(checker: &mut Checker<'_>, id: UnitId) {
    let entry = &mut checker.instances.entries[id.0 as usize];
    if entry.state != Progress::Queued {
        return;
    }
    entry.state = Progress::Started;
    let header = entry.header.clone();
    let called = entry.called;
    let outer = std::mem::replace(&mut checker.instances.depth, entry.depth);
    if !reuse::reuse_unit(checker, id) {
        check_anew(checker, id, &header, called);
    }
    checker.instances.depth = outer;
    checker.instances.entries[id.0 as usize].state = Progress::Done;
}

/// Checks the body of the unit `id`. `called` is the location of its first call.
fn check_anew(checker: &mut Checker<'_>, id: UnitId, header: &Header, called: Span) {
    reuse::begin_record(checker);
    let mut unit = Unit::new(header.name.clone(), header.kind, header.span);
    unit.is_lustre = checker.is_lustre(header.decl);
    let mut body = Body::new(checker, header.decl, header.statics.clone(), unit);
    check_decl(&mut body, header.decl);
    none_type::infer_none_types(&mut body);
    if called != header.span && header.is_instance() {
        if !body.diagnostics.is_empty() {
            // Each error is reported for one instance only.
            reuse::forbid_reuse(body.checker);
        }
        attribute_to_call(&mut body, header, called);
    }
    let own = body.diagnostics.len();
    let unit = body.finish();
    checker.limits.expanded_size += unit.exprs.len() + unit.flows.len();
    checker.units[id.0 as usize] = Rc::new(unit);
    reuse::store_unit(checker, id, own);
}

/// Adds to each error in an instance of a generic callable the call for which the instance is checked.
fn attribute_to_call(cx: &mut Body<'_, '_>, header: &Header, called: Span) {
    let diagnostics = std::mem::take(&mut cx.diagnostics);
    let is_error = |diagnostic: &Diagnostic| diagnostic.severity() == Severity::Error;
    let instances = &mut cx.checker.instances;
    // The declaration has been reported, so that no instance has an error of its own.
    let is_erroneous = instances.erroneous_generics.contains(&header.decl);
    let is_own_error = |diagnostic: &Diagnostic| is_error(diagnostic) && !is_erroneous;
    let text = format!("in `{}`, called here", header.name);
    if is_in_library(cx.checker, header.decl) {
        // The library has no errors of its own, so the arguments of this call are the cause.
        let first = diagnostics.into_iter().find(is_own_error);
        cx.diagnostics
            .extend(first.map(|first| first.with_cause(called, text)));
        return;
    }
    let named = |diagnostic: Diagnostic| match is_error(&diagnostic) {
        true => diagnostic.secondary(called, text.clone()),
        false => diagnostic,
    };
    // An error is reported for one call only, even if its message differs for another one.
    let reported = &mut cx.checker.instances.reported;
    let is_new = |diagnostic: &Diagnostic| {
        let key = (header.decl, diagnostic.code, diagnostic.span());
        !is_error(diagnostic) || is_own_error(diagnostic) && reported.insert(key)
    };
    let diagnostics = diagnostics.into_iter().filter(is_new).map(named);
    cx.diagnostics = diagnostics.collect();
}

fn check_decl(cx: &mut Body<'_, '_>, id: DeclId) {
    header::declare_ports(cx, id);
    // The header has reported the errors in the ports.
    cx.diagnostics.clear();
    match cx.checker.program.decl(id).kind {
        DeclKind::Node(node) => check_node(cx, node),
        DeclKind::Fragment(fragment) => check_fragment(cx, fragment),
        DeclKind::Primitive(primitive) => prim::check_primitive(cx, primitive),
        DeclKind::Command(command) => check_command(cx, command),
        DeclKind::Test(test) => statement::check_body(cx, &test.body),
        DeclKind::Task(task) => task::check_task(cx, task),
        _ => {}
    }
}

fn check_node<'a>(cx: &mut Body<'_, 'a>, node: &'a NodeDecl) {
    check_modifier(cx, node);
    cx.unit.is_contract = node.kind == NodeKind::Contract;
    match &node.definition {
        NodeDef::Body(body) => {
            let allowed = match node.kind {
                NodeKind::Contract => node.signature.outputs.as_deref(),
                _ => None,
            };
            let assumed = check_body_with(cx, node.contract.as_ref(), Some(body));
            assumptions::check_assumptions(cx, &assumed, allowed.unwrap_or_default());
            if let (NodeKind::Contract, Some(contract)) = (node.kind, &node.contract) {
                imported::declare_mode_outputs(cx, contract);
            }
        }
        NodeDef::Alias(callee) => alias::check_alias(cx, callee),
        NodeDef::Extern => {
            let assumed = check_body_with(cx, node.contract.as_ref(), None);
            assumptions::check_assumptions(cx, &assumed, &[]);
            if node.kind == NodeKind::Function && node.modifier != Modifier::Unsafe {
                external::add_external_body(cx, node);
            }
        }
    }
    cx.unit.has_state = cx.first_state_span.is_some();
    if let (NodeKind::Function, Some(span)) = (node.kind, cx.first_state_span) {
        state_in_function(cx, span);
    }
}

/// Reports a modifier that contradicts its declaration: `opaque` without a contract, `transparent` without a body, or
/// an external declaration with a body.
fn check_modifier(cx: &mut Body<'_, '_>, node: &NodeDecl) {
    let has_body = matches!(node.definition, NodeDef::Body(_));
    let (name, outside) = (&node.signature.name, node.external_form.keyword());
    if has_body && let Some(outside) = outside {
        let message = format!("`{}` is external but has a body", name.name);
        let diagnostic = Diagnostic::new(Code::RPI1014, message);
        let diagnostic = diagnostic.primary(name.span, format!("declared as `{outside}`"));
        let diagnostic = diagnostic.help(format!("remove `{outside}` or the body"));
        report::report_diagnostic(cx, diagnostic);
    }
    let (lacks, word, instead_of) = match node.modifier {
        Modifier::Opaque if node.contract.is_none() => ("a contract", "opaque", None),
        Modifier::Transparent if !has_body => ("a body", "transparent", outside),
        _ => return,
    };
    let message = format!("`{}` is `{word}` but lacks {lacks}", name.name);
    let diagnostic = Diagnostic::new(Code::RPI1014, message)
        .primary(name.span, format!("callers rely on {lacks}"))
        .help(match instead_of {
            Some(old) => format!("replace `{old}` by {lacks}, or remove `{word}`"),
            None => format!("add {lacks}, or remove `{word}`"),
        });
    report::report_diagnostic(cx, diagnostic);
}

fn state_in_function(cx: &mut Body<'_, '_>, span: Span) {
    let name = &cx.unit.name;
    let diagnostic = match called_at(cx, span) {
        Some((kind, node)) => {
            let message = format!("the function `{name}` calls the {kind} `{node}`");
            Diagnostic::new(Code::RPI3005, message)
                .primary(span, format!("a {kind} may have state"))
                .help(format!("a function depends on its arguments alone: declare `{node}` as a `function`, too, or `{name}` as a `node`"))
        }
        None => Diagnostic::new(Code::RPI3005, format!("the function `{name}` has state"))
            .primary(span, "this remembers earlier cycles")
            .help("a function depends on its arguments alone; declare a `node`"),
    };
    report::report_diagnostic(
        cx,
        diagnostic.secondary(cx.unit.span, "declared as a function here"),
    );
}

/// Returns the kind and name of the node or fragment called at this location of the body; `None` if there is none.
fn called_at(cx: &Body<'_, '_>, span: Span) -> Option<(&'static str, rpi_syntax::Name)> {
    let mut here = cx.unit.exprs.iter().filter(|expr| expr.span == span);
    here.find_map(|expr| match &expr.kind {
        TypedKind::Call(call) => {
            let header = &cx.checker.instances.entries[call.unit.0 as usize].header;
            let kind = match header.kind {
                UnitKind::Node => "node",
                UnitKind::Fragment => "fragment",
                _ => return None,
            };
            Some((kind, header.name.clone()))
        }
        _ => None,
    })
}

fn check_fragment<'a>(cx: &mut Body<'_, 'a>, fragment: &'a FragmentDecl) {
    if let Some(when) = &fragment.when {
        let condition =
            statement::check_condition(cx, &when.condition, "the activation of a fragment");
        cx.current_block().when = Some(condition);
        cx.current_block().restart = when.resets;
    }
    if let Some(budget) = &fragment.budget {
        cx.current_block().budget_ns = consts::const_nanoseconds(cx, budget);
    }
    let assumed = check_body_with(cx, fragment.contract.as_ref(), Some(&fragment.body));
    assumptions::check_assumptions(cx, &assumed, &[]);
}

fn check_command<'a>(cx: &mut Body<'_, 'a>, command: &'a CommandDecl) {
    if let Some(budget) = &command.budget {
        cx.current_block().budget_ns = consts::const_nanoseconds(cx, budget);
    }
    let assumed = check_body_with(cx, command.contract.as_ref(), Some(&command.body));
    assumptions::check_assumptions(cx, &assumed, &[]);
}

/// Checks a body and its contract; returns the assumptions of the contract. In Lustre the contract is checked
/// first, because it does not see the names of the body.
fn check_body_with<'a>(
    cx: &mut Body<'_, 'a>,
    contract: Option<&'a Contract>,
    body: Option<&'a ast::Body>,
) -> Vec<ExprId> {
    let contract = contract.map(|contract| (contract::declare_contract(cx, contract), contract));
    let (before, after) = match reads_rpi_syntax(cx) {
        true => (None, contract),
        false => (contract, None),
    };
    let mut assumed = Vec::new();
    if let Some((block, contract)) = before {
        cx.contract.hidden_locals = body.map_or(&[], |body| &body.locals);
        assumed.extend(assumptions::check_contract_assumptions(cx, block, contract));
    }
    match body {
        Some(body) => statement::check_body(cx, body),
        None => statement::check_equations(cx),
    }
    if let Some((block, contract)) = after {
        assumed.extend(assumptions::check_contract_assumptions(cx, block, contract));
    }
    assumed
}

/// Whether the body is in a file in RPI syntax, not in Lustre.
pub(crate) fn reads_rpi_syntax(cx: &Body<'_, '_>) -> bool {
    cx.mode == rpi_syntax::Dialect::Rpi
}

/// Returns whether a declaration can be called.
pub(crate) fn is_callable(kind: DeclKind<'_>) -> bool {
    unit_kind(kind).is_some_and(|kind| !kind.is_root())
}
