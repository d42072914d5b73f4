//! What an expression reads: flows of the declaration around it, ports of devices, what happens to the command.

use rpi_driver::Inspected;
use rpi_sema::query::{DefId, DefKind, Reference};
use rpi_syntax::ast::{Callee, Expr, ExprKind, StaticValue};
use rpi_syntax::ops::{BinaryOp, UnaryOp};

/// Predeclared flows that are worth a line: what others do to the command.
const SHOWN: &[&str] = &["cancel", "takeover", "predecessor"];

/// What is read.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(super) enum Key {
    /// A flow.
    Flow(DefId),
    /// A port of a device.
    Port(DefId, DefId),
    /// A predeclared flow.
    Predeclared(String),
}

/// One reading.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) struct Read {
    pub(super) key: Key,
    /// One cycle late.
    pub(super) delayed: bool,
    /// What is read may be absent.
    pub(super) optional: bool,
}

/// What expressions read, in the order of the text.
pub(super) fn reads<'e>(seen: &Inspected, exprs: impl IntoIterator<Item = &'e Expr>) -> Vec<Read> {
    let mut found = Vec::new();
    for expr in exprs {
        look(seen, expr, false, &mut found);
    }
    found
}

fn look(seen: &Inspected, expr: &Expr, delayed: bool, found: &mut Vec<Read>) {
    if is_path(expr) {
        found.extend(read(seen, expr, delayed));
        return;
    }
    match &expr.kind {
        ExprKind::Unary(UnaryOp::Pre | UnaryOp::Last, inner) => look(seen, inner, true, found),
        ExprKind::Binary(binary) if binary.op == BinaryOp::Fby => {
            look(seen, &binary.lhs, delayed, found);
            look(seen, &binary.rhs, true, found);
        }
        ExprKind::When(when) => {
            look(seen, &when.value, delayed, found);
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
                look(seen, child, delayed, found);
            }
        }
    }
}

/// Static arguments may be parameters of the command.
fn statics(seen: &Inspected, callee: &Callee, found: &mut Vec<Read>) {
    for argument in &callee.statics {
        match &argument.value {
            StaticValue::Expr(value) => look(seen, value, false, found),
            StaticValue::Callee(inner) => statics(seen, inner, found),
            StaticValue::Type(_) | StaticValue::Op(_) => {}
        }
    }
}

/// `x`, `F.way.done`
fn is_path(expr: &Expr) -> bool {
    match &expr.kind {
        ExprKind::Name(_) => true,
        ExprKind::Field(field) => is_path(&field.base),
        _ => false,
    }
}

fn read(seen: &Inspected, path: &Expr, delayed: bool) -> Option<Read> {
    let names = seen.index().references_in(path.span);
    let key = key(seen, names).or_else(|| predeclared(path))?;
    let types = names.last().map(|name| seen.types_of_read(name.span));
    Some(Read {
        key,
        delayed,
        optional: types.is_some_and(|types| types.iter().any(|one| one.optional)),
    })
}

fn predeclared(path: &Expr) -> Option<Key> {
    let name = path.as_name()?;
    SHOWN
        .contains(&name.as_str())
        .then(|| Key::Predeclared(name.to_string()))
}

/// What a path means: the innermost flow in it, or the device's port.
pub(super) fn key(seen: &Inspected, names: &[Reference]) -> Option<Key> {
    use DefKind::{Given, Input, Local, Output, Param, Port};
    let kind = |name: &Reference| seen.index().def(name.def).kind;
    if let [device, port, ..] = names
        && kind(device) == Param
        && kind(port) == Port
    {
        return Some(Key::Port(device.def, port.def));
    }
    // Behind a call's own name stand its out-ports, which belong to what is called.
    let first = names.first()?;
    let top = seen
        .index()
        .def(first.def)
        .parent
        .map(|_| top(seen, first.def));
    let flows = names.iter().filter(|name| {
        matches!(kind(name), Given | Input | Local | Output | Param)
            && Some(self::top(seen, name.def)) == top
    });
    flows.last().map(|name| Key::Flow(name.def))
}

/// The declaration around a definition.
pub(super) fn top(seen: &Inspected, id: DefId) -> DefId {
    let parent = |id: &DefId| {
        let parent = seen.index().def(*id).parent?;
        (seen.index().def(parent).kind != DefKind::Module).then_some(parent)
    };
    std::iter::successors(Some(id), parent).last().unwrap_or(id)
}
