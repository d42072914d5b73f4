//! Forms of expressions, and the clocks of expressions and flows.

use super::exprs::{Decider, Requirement};
use super::model::{Clock, Expr, Kind, Node};

/// Form: the result type (`None` for any), the text, and the parts, which have the required type, clock and presence
/// unless stated otherwise.
pub(crate) type Form = (Option<Kind>, &'static str, &'static [Part]);

#[derive(Clone, Copy)]
pub(crate) enum Part {
    /// Like the whole.
    Own,
    /// Like the whole, and never absent.
    Total,
    /// Of another type, and never absent.
    OfType(Kind),
    /// Delayed flow.
    Delayed,
    /// Of this type and any clock; the value is not used.
    Unused(Kind),
}

use Kind::{Bool, Int, Mode, Pair, Row as Ints};
use Part::{Delayed, OfType, Own, Total, Unused};

/// Forms for all clocks.
#[rustfmt::skip]
pub(crate) const FORMS: &[Form] = &[
    (None, "(@ -> @)", &[Own, Own]),
    (None, "(@ -> pre @)", &[Total, Delayed]),
    (None, "(@ -> pre @)", &[Total, Delayed]),
    (None, "(@ fby @)", &[Total, Delayed]),
    (None, "(if @ then @ else @)", &[OfType(Bool), Own, Own]),
    (Some(Int), "((@ + @) mod 1000)", &[Own, Own]),
    (Some(Int), "((@ - @) mod 1000)", &[Own, Own]),
    (Some(Int), "((@ + 1) mod 1000)", &[Own]),
    (Some(Int), "((@ * 3) mod 50)", &[Own]),
    (Some(Int), "Count(@)", &[Total]),
    (Some(Int), "(restart Count every @)(@)", &[OfType(Bool), Total]),
    (Some(Int), "condact(@, Count(@), @)", &[OfType(Bool), Total, Total]),
    (Some(Int), "(Pair{u = @; v = @}).u", &[Own, Unused(Int)]),
    (Some(Int), "(Pair{u = @; v = @}).v", &[Unused(Int), Own]),
    (Some(Int), "([@, @])[1]", &[Unused(Int), Own]),
    (Some(Int), "(@).v", &[OfType(Pair)]),
    (Some(Int), "(@)[0]", &[OfType(Ints)]),
    (Some(Bool), "(@ and @)", &[Own, Own]),
    (Some(Bool), "(@ or @)", &[Own, Own]),
    (Some(Bool), "(not @)", &[Own]),
    (Some(Bool), "(@ < @)", &[OfType(Int), OfType(Int)]),
    (Some(Bool), "(@ > 1)", &[OfType(Int)]),
    (Some(Bool), "(@ <> @)", &[OfType(Pair), OfType(Pair)]),
    (Some(Bool), "(@ = Slow)", &[OfType(Mode)]),
    (Some(Bool), "(false -> @)", &[Own]),
    (Some(Pair), "Pair{u = @; v = @}", &[OfType(Int), OfType(Int)]),
    (Some(Pair), "(@ with .u = @)", &[Total, OfType(Int)]),
    (Some(Ints), "[@, @]", &[OfType(Int), OfType(Int)]),
    (Some(Ints), "(@ ^ 2)", &[OfType(Int)]),
    (Some(Mode), "(if @ then Slow else @)", &[OfType(Bool), Own]),
];

/// Returns `x when c`.
pub(crate) fn when(value: Expr, on: &str, clock: Clock) -> Expr {
    Expr {
        kind: value.kind,
        optional: value.optional,
        node: Node::Template(format!("(@ when {on})").into(), vec![value]),
        clock: Some(clock),
    }
}

pub(crate) fn form(text: &str, parts: Vec<Expr>, want: &Requirement, clock: Option<Clock>) -> Expr {
    Expr {
        node: Node::Template(text.into(), parts),
        kind: want.kind,
        optional: want.optional,
        clock,
    }
}

/// Returns a clock with one more sampling step.
pub(crate) fn then(clock: &Clock, on: &str) -> Clock {
    clock.iter().cloned().chain([on.to_owned()]).collect()
}

/// Returns the sampling conditions that a flow provides.
pub(crate) fn samplings(decider: &Decider) -> Vec<String> {
    let name = &decider.name;
    match decider.kind {
        Kind::Mode => ["Off", "Slow", "Fast"]
            .map(|value| format!("{value}({name})"))
            .into(),
        _ => vec![name.clone(), format!("not {name}")],
    }
}

/// Returns the common prefix of clocks; literals have none.
pub(crate) fn common(clocks: impl Iterator<Item = Option<Clock>>) -> Option<Clock> {
    clocks.flatten().reduce(|a, b| {
        let both = a.iter().zip(b.iter()).take_while(|(a, b)| a == b);
        both.map(|(on, _)| on.clone()).collect()
    })
}
