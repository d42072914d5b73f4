//! Grammar actions for contracts.
//!
//! In the functions, `l` and `r` are the byte offsets of the beginning and end of the node.

use super::calls;
use super::with_elements;
use crate::ast::*;
use crate::context::ParseContext;
use rpi_diag::Span;

/// Clause of a contract as parsed, before the clauses are sorted by kind.
pub(crate) enum ContractPart {
    Locals(Locals),
    GhostTuple(GhostTuple),
    Claim(Box<Claim>),
    Mode(ContractMode),
    Import(ContractImport),
    Broken,
}

/// Builds ghost variables of a contract, which only contracts refer to. Several names with one value,
/// `var x, y: int = e;`, share one equation.
pub(crate) fn ghost_vars(mut vars: Vec<VarDecl>) -> ContractPart {
    let value = match &mut vars[..] {
        [one] if one.names.len() > 1 => one.default.take(),
        _ => None,
    };
    match value {
        Some(value) => ghost_tuple_from_vars(vars, value),
        None => ContractPart::Locals(Locals::Var(vars)),
    }
}

/// Builds ghost variables of a contract with different types and one value: `var x: int, y: bool = e;`.
pub(crate) fn ghost_tuple(first: Box<VarDecl>, rest: Vec<VarDecl>, value: Expr) -> ContractPart {
    ghost_tuple_from_vars(with_elements(vec![*first], rest), value)
}

fn ghost_tuple_from_vars(vars: Vec<VarDecl>, value: Expr) -> ContractPart {
    let names = vars.iter().flat_map(|var| &var.names);
    let targets = names.map(|name| Target {
        name: name.clone(),
        path: Vec::new(),
        span: name.span,
    });
    let equation = Equation {
        targets: targets.collect(),
        value,
    };
    let first = vars.first().map_or(Span::NONE, |var| var.span);
    let span = first.merge(equation.value.span);
    ContractPart::GhostTuple(GhostTuple {
        vars,
        equation,
        span,
    })
}

pub(crate) fn claim(
    kind: ClaimKind,
    label: Option<Ident>,
    condition: Expr,
    provided: Option<Expr>,
) -> Box<Claim> {
    Box::new(Claim {
        kind,
        label,
        condition,
        provided,
    })
}

/// Returns an empty body, the definition of a declaration with the keyword `contract`.
pub(crate) fn contract_body() -> NodeDef {
    let (locals, statements) = (Vec::new(), Vec::new());
    NodeDef::Body(Body { locals, statements })
}

pub(crate) fn mode(name: Ident, parts: Vec<Claim>) -> ContractMode {
    let (requires, ensures) = parts
        .into_iter()
        .partition(|claim| claim.kind == ClaimKind::Assume);
    ContractMode {
        name,
        requires,
        ensures,
    }
}

pub(crate) fn contract(
    cx: &ParseContext<'_>,
    l: u32,
    parts: Vec<ContractPart>,
    r: u32,
) -> Box<Contract> {
    let mut contract = Contract {
        locals: Vec::new(),
        ghost_tuples: Vec::new(),
        claims: Vec::new(),
        modes: Vec::new(),
        imports: Vec::new(),
        span: cx.span(l, r),
    };
    for part in parts {
        match part {
            ContractPart::Locals(locals) => contract.locals.push(locals),
            ContractPart::GhostTuple(together) => contract.ghost_tuples.push(together),
            ContractPart::Claim(claim) => contract.claims.push(*claim),
            ContractPart::Mode(mode) => contract.modes.push(mode),
            ContractPart::Import(import) => contract.imports.push(import),
            ContractPart::Broken => {}
        }
    }
    Box::new(contract)
}

pub(crate) fn import(
    cx: &ParseContext<'_>,
    l: u32,
    callee: Callee,
    inputs: Vec<Arg>,
    outputs: Vec<Arg>,
    r: u32,
) -> ContractPart {
    let count = inputs.len();
    let args = with_elements(inputs, outputs);
    let call = calls::call(callee, Activation::Always, args);
    ContractPart::Import(ContractImport {
        call: calls::call_expr(cx, l, call, r),
        input_count: count,
    })
}
