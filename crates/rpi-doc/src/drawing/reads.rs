//! Reads of an expression: flows of the enclosing declaration, ports of devices, and events of the command.

use rpi_driver::Inspection;
use rpi_sema::query::{DefId, DefKind, Reference};
use rpi_syntax::ast::{Callee, Expr, ExprKind, StaticValue};
use rpi_syntax::ops::{BinaryOp, UnaryOp};

/// Names of the predeclared flows for which a line is drawn: those whose value depends on other commands and on
/// clients.
const DRAWN_PREDECLARED: &[&str] = &["cancel", "takeover", "predecessor"];

/// Source of a value that an expression reads: a flow, a device port or a predeclared flow.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(super) enum Source {
    /// Flow that the body defines or that enters the declaration, by its definition.
    Flow(DefId),
    /// Port of a device: the definition of the device, and the definition of the port.
    Port(DefId, DefId),
    /// Predeclared flow, such as `cancel`, by its name.
    Predeclared(String),
}

/// Use of a value by an expression: the source of the value, and whether the value may be old or absent.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) struct Read {
    pub(super) key: Source,
    /// True if the value of an earlier cycle is read, as by `pre`.
    pub(super) delayed: bool,
    /// True if the value may be absent in a cycle.
    pub(super) optional: bool,
}

/// Returns the uses of flows and ports in expressions, in source order.
pub(super) fn reads<'e>(seen: &Inspection, exprs: impl IntoIterator<Item = &'e Expr>) -> Vec<Read> {
    let mut found = Vec::new();
    for expr in exprs {
        collect_reads(seen, expr, false, &mut found);
    }
    found
}

fn collect_reads(seen: &Inspection, expr: &Expr, delayed: bool, found: &mut Vec<Read>) {
    if is_path(expr) {
        found.extend(read(seen, expr, delayed));
        return;
    }
    match &expr.kind {
        ExprKind::Unary(UnaryOp::Pre | UnaryOp::Last, inner) => {
            collect_reads(seen, inner, true, found)
        }
        ExprKind::Binary(binary) if binary.op == BinaryOp::Fby => {
            collect_reads(seen, &binary.lhs, delayed, found);
            collect_reads(seen, &binary.rhs, true, found);
        }
        ExprKind::When(when) => {
            collect_reads(seen, &when.value, delayed, found);
            let clock = seen.index().references_in(when.clock.flow.span);
            found.extend(key(seen, clock).map(|key| Read {
                key,
                delayed,
                optional: false,
            }));
        }
        _ => {
            if let ExprKind::Call(call) = &expr.kind {
                statics(seen, &call.callee, found);
            }
            for child in expr.children() {
                collect_reads(seen, child, delayed, found);
            }
        }
    }
}

/// Adds the reads in the static arguments of a call, such as parameters of the command, to `found`.
fn statics(seen: &Inspection, callee: &Callee, found: &mut Vec<Read>) {
    for argument in &callee.statics {
        match &argument.value {
            StaticValue::Expr(value) => collect_reads(seen, value, false, found),
            StaticValue::Callee(inner) => statics(seen, inner, found),
            StaticValue::Type(_) | StaticValue::Op(_) => {}
        }
    }
}

/// Returns whether an expression is only a path of names, such as `x` or `F.way.done`.
fn is_path(expr: &Expr) -> bool {
    match &expr.kind {
        ExprKind::Name(_) => true,
        ExprKind::Field(field) => is_path(&field.base),
        _ => false,
    }
}

fn read(seen: &Inspection, path: &Expr, delayed: bool) -> Option<Read> {
    let names = seen.index().references_in(path.span);
    let key = key(seen, names).or_else(|| predeclared(path))?;
    let types = names.last().map(|name| seen.types_of_read(name.span));
    Some(Read {
        key,
        delayed,
        optional: types.is_some_and(|types| types.iter().any(|one| one.optional)),
    })
}

fn predeclared(path: &Expr) -> Option<Source> {
    let name = path.as_name()?;
    DRAWN_PREDECLARED
        .contains(&name.as_str())
        .then(|| Source::Predeclared(name.to_string()))
}

/// Returns the flow or device port that a path such as `F.way.done` denotes: the last flow of the same declaration in
/// the path, or the port. `names` are the resolved names of the path. Returns `None` if the path denotes neither.
pub(super) fn key(seen: &Inspection, names: &[Reference]) -> Option<Source> {
    use DefKind::{Input, Local, Output, Param, Port, TakenOver};
    let kind = |name: &Reference| seen.index().def(name.def).kind;
    if let [device, port, ..] = names
        && kind(device) == Param
        && kind(port) == Port
    {
        return Some(Source::Port(device.def, port.def));
    }
    // The name of a call is followed by its out-ports, which belong to the called unit.
    let first = names.first()?;
    let top = seen
        .index()
        .def(first.def)
        .parent
        .map(|_| enclosing_declaration(seen, first.def));
    let flows = names.iter().filter(|name| {
        matches!(kind(name), TakenOver | Input | Local | Output | Param)
            && Some(self::enclosing_declaration(seen, name.def)) == top
    });
    flows.last().map(|name| Source::Flow(name.def))
}

/// Returns the top-level declaration that contains a definition; the definition itself if it is at the top level.
pub(super) fn enclosing_declaration(seen: &Inspection, id: DefId) -> DefId {
    let parent = |id: &DefId| {
        let parent = seen.index().def(*id).parent?;
        (seen.index().def(parent).kind != DefKind::Module).then_some(parent)
    };
    std::iter::successors(Some(id), parent).last().unwrap_or(id)
}
