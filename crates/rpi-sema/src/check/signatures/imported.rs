//! Imports of contracts, and `::c::m`, whether a mode of an imported contract applies.
//!
//! Each import is a separate instance that only makes claims: the out-ports of the contract are in-ports of the
//! instance. Its outputs are the conditions of its modes.

use crate::check::bodies::body::Body;
use crate::check::bodies::locals;
use crate::check::diagnostics::report::undefined_name;
use crate::check::exprs::expr;
use crate::check::signatures::units_on_demand;
use crate::ty::Ty;
use crate::typed::TypedKind;
use crate::typed::{BlockId, Equation, ExprId, FlowPresence, FlowRole, Target, TargetPlace};
use rpi_diag::Span;
use rpi_syntax::ast::{self, Contract, ContractImport, Ident};

/// Maximum number of modes that a contract makes visible from the contracts that it imports.
const MAX_MODES: usize = 1000;

/// Maximum number of contracts in the path to a mode, such as `::c::d::m`. Each contract makes the modes of its imports
/// visible under such paths, whose number can grow exponentially.
const MAX_MODE_PATH: usize = 16;

/// Import of a contract by a contract that is being checked.
#[derive(Clone, Copy)]
pub(crate) struct ContractInstance<'a> {
    syntax: &'a ContractImport,
    /// Block of the contract that imports the other one.
    importer: BlockId,
    /// Typed call of the imported contract with its arguments; `None` until the call is first needed.
    call: Option<ExprId>,
}

impl ContractInstance<'_> {
    /// Returns the name of the imported contract; `None` if the import is not a call.
    fn name(&self) -> Option<&Ident> {
        match &self.syntax.call.kind {
            ast::ExprKind::Call(call) => Some(&call.callee.name),
            _ => None,
        }
    }
}

/// Records the imports of a contract. The current block must be the block of the contract.
pub(crate) fn declare_imports<'a>(cx: &mut Body<'_, 'a>, contract: &'a Contract) {
    let by = cx.block;
    let imports = contract.imports.iter();
    cx.contract
        .imports
        .extend(imports.map(|text| ContractInstance {
            syntax: text,
            importer: by,
            call: None,
        }));
}

/// Checks the imports of the contract in `block` and returns their input arguments.
pub(crate) fn check_imports(cx: &mut Body<'_, '_>, block: BlockId) -> Vec<ExprId> {
    let mut given = Vec::new();
    for at in 0..cx.contract.imports.len() {
        if cx.contract.imports[at].importer == block {
            let call = import_instance(cx, at);
            given.extend(import_args(cx, call).unwrap_or_default());
        }
    }
    given
}

/// Returns the input arguments of an imported contract if `kind` is the condition of one of its modes; `None` for other
/// expressions.
pub(crate) fn imported_mode_args(cx: &Body<'_, '_>, kind: &TypedKind) -> Option<Vec<ExprId>> {
    match kind {
        TypedKind::Part { base, .. } => import_args(cx, *base),
        _ => None,
    }
}

/// Returns the input arguments of an imported contract if `instance` is the call for its import; `None` for other
/// expressions.
fn import_args(cx: &Body<'_, '_>, instance: ExprId) -> Option<Vec<ExprId>> {
    let mut imports = cx.contract.imports.iter();
    let import = imports.find(|import| import.call == Some(instance))?;
    let TypedKind::Call(call) = &cx.unit.expr(instance).kind else {
        return None;
    };
    let given = call.args.iter().take(import.syntax.input_count);
    Some(given.flatten().copied().collect())
}

/// Returns the typed call for the import with index `at`. The call is checked on first use.
fn import_instance(cx: &mut Body<'_, '_>, at: usize) -> ExprId {
    let import = cx.contract.imports[at];
    if let Some(call) = import.call {
        return call;
    }
    // The instance belongs to the importing contract, not to the claim or quantifier that first reads one of its
    // modes.
    let around = (
        cx.contract.claim_check.take(),
        std::mem::take(&mut cx.bindings.bound_names),
    );
    let call = cx.in_block(import.importer, |body| check_import(body, import.syntax));
    (cx.contract.claim_check, cx.bindings.bound_names) = around;
    cx.contract.imports[at].call = Some(call);
    call
}

/// Checks the call for an import, adds it to the current block, and returns its typed expression.
fn check_import<'a>(cx: &mut Body<'_, 'a>, import: &'a ContractImport) -> ExprId {
    let span = import.call.span;
    cx.contract.resolving_contract = true;
    let value = expr::check_expr(cx, &import.call);
    let targets = Vec::new();
    cx.current_block().equations.push(Equation {
        targets,
        value,
        span,
    });
    if let TypedKind::Call(call) = &cx.unit.expr(value).kind {
        let unit = call.unit;
        units_on_demand::check_unit_now(cx.checker, unit);
        let callee = &cx.checker.units[unit.0 as usize];
        cx.unit.exprs[value.0 as usize].ty = callee.result_type().widened();
        if callee.has_state {
            cx.record_state(span);
        }
    }
    value
}

/// Checks a reference `::c::m` to mode `m` of the imported contract `c`. Returns a Boolean expression that is true
/// while the mode applies.
pub(crate) fn imported_mode_condition(
    cx: &mut Body<'_, '_>,
    contract: &str,
    mode: &str,
    span: Span,
) -> ExprId {
    let named =
        |import: &ContractInstance<'_>| import.name().is_some_and(|name| name.name == *contract);
    let Some(at) = cx.contract.imports.iter().position(named) else {
        let imports = cx.contract.imports.iter();
        let names = imports.filter_map(ContractInstance::name);
        let near = rpi_diag::suggest(contract, names.map(|name| name.name.as_str()));
        let near = near.map(|near| format!("::{near}::{mode}"));
        let diagnostic = undefined_name("imported contract", contract, span, near);
        return cx.report_error_expr(diagnostic, span);
    };
    let base = import_instance(cx, at);
    let TypedKind::Call(call) = &cx.unit.expr(base).kind else {
        return cx.error_expr(span);
    };
    let callee = &cx.checker.units[call.unit.0 as usize];
    let modes: Vec<_> = callee.outputs.iter().map(|id| callee.flow(*id)).collect();
    let Some(place) = modes.iter().position(|flow| flow.name == *mode) else {
        let near = rpi_diag::suggest(mode, modes.iter().map(|flow| flow.name.as_str()));
        let near = near.map(|near| format!("::{contract}::{near}"));
        let diagnostic = undefined_name("mode", &format!("{contract}::{mode}"), span, near);
        return cx.report_error_expr(diagnostic, span);
    };
    let at = u32::try_from(place).unwrap_or(u32::MAX);
    cx.add(TypedKind::Part { base, at }, Ty::Bool, span)
}

/// Declares the outputs of a contract that is declared on its own: for each of its modes and of the modes that it
/// imports, whether the mode applies.
pub(crate) fn declare_mode_outputs<'a>(cx: &mut Body<'_, 'a>, contract: &'a Contract) {
    let applies = std::mem::take(&mut cx.contract.mode_conditions);
    let own = contract.modes.iter().map(|mode| &mode.name);
    let own = own.zip(applies).map(|(name, value)| (name.clone(), value));
    let own: Vec<(Ident, ExprId)> = own.collect();
    for (name, value) in own.into_iter().chain(imported_modes(cx)) {
        let span = name.span;
        let never_absent = FlowPresence::Declared(false);
        let flow = locals::add_flow(cx, &name, Ty::Bool, never_absent, FlowRole::Output);
        let target = Target {
            place: TargetPlace::Flow { flow, at: 0 },
            ty: Ty::Bool,
            span,
        };
        cx.current_block().equations.push(Equation {
            targets: vec![target],
            value,
            span,
        });
        cx.unit.outputs.push(flow);
    }
}

/// Returns the path `D::m` of each mode of each imported contract `D`, with an expression that is true while the mode
/// applies.
fn imported_modes(cx: &mut Body<'_, '_>) -> Vec<(Ident, ExprId)> {
    let mut modes = Vec::new();
    for at in 0..cx.contract.imports.len() {
        let Some((name, base)) = cx.contract.imports[at]
            .name()
            .zip(cx.contract.imports[at].call)
        else {
            continue;
        };
        let TypedKind::Call(call) = &cx.unit.expr(base).kind else {
            continue;
        };
        let callee = &cx.checker.units[call.unit.0 as usize];
        let outputs = callee.outputs.iter().map(|id| callee.flow(*id));
        let names = (0..).zip(outputs.map(|flow| flow.name.as_str()));
        let names = names.filter(|(_, mode)| mode.matches("::").count() < MAX_MODE_PATH);
        let names: Vec<(u32, String)> = names
            .map(|(at, mode)| (at, format!("{}::{mode}", name.name)))
            .collect();
        let span = name.span;
        for (at, name) in names {
            if modes.len() >= MAX_MODES {
                return modes;
            }
            let value = cx.add(TypedKind::Part { base, at }, Ty::Bool, span);
            let name = name.as_str().into();
            modes.push((Ident { name, span }, value));
        }
    }
    modes
}
