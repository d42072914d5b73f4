//! Words that several checks use.

use super::body::Body;
use crate::ty::{Misfit, Ty};
use crate::typed::ExprId;
use crate::units::Dim;
use rpi_diag::{Code, Finding, Fix, Span};
use rpi_syntax::Name;

impl Body<'_, '_> {
    /// Takes up a finding about this body.
    pub(super) fn report(&mut self, finding: Finding) {
        self.findings.push(finding);
    }

    /// Reports that an expression does not have the type that its place wants.
    pub(super) fn misfit(
        &mut self,
        expr: ExprId,
        expected: &Ty,
        misfit: &Misfit,
        wanted_by: &Wanted,
    ) {
        let found = &self.unit.expr(expr).ty;
        let span = self.unit.expr(expr).span;
        let finding = match misfit {
            Misfit::Dimension { expected, found } => dimension(*expected, *found, span),
            Misfit::Frame { expected, found } => frame(expected, found, span),
            Misfit::Size { expected, found } => size(*expected, *found, span),
            Misfit::Kind => kind(expected, found, span),
        };
        self.report(wanted_by.explain(finding));
    }
}

/// Why a type is wanted.
pub(super) enum Wanted {
    /// Nothing more is to be said.
    Here,
    /// By what stands at another place.
    By(Span, String),
}

impl Wanted {
    fn explain(&self, finding: Finding) -> Finding {
        match self {
            Wanted::Here => finding,
            Wanted::By(span, text) if span.is_none() => finding.note(text.clone()),
            Wanted::By(span, text) => finding.also(*span, text.clone()),
        }
    }
}

fn kind(expected: &Ty, found: &Ty, span: Span) -> Finding {
    let finding = Finding::new(
        Code::RPI2001,
        format!("expected `{expected}`, found `{found}`"),
    )
    .at(span, format!("this is `{found}`"));
    match (expected, found) {
        (Ty::Real(_), Ty::Int) => finding
            .help("an integer becomes a real by `real`")
            .fix(Fix::maybe("convert it by `real`").insert_before(span, "real ")),
        (Ty::Int, Ty::Real(_)) => {
            finding.help("a real becomes an integer by `int`, which cuts off its fraction")
        }
        _ => finding,
    }
}

fn dimension(expected: Dim, found: Dim, span: Span) -> Finding {
    let finding = Finding::new(
        Code::RPI2002,
        format!("expected a quantity in `{expected}`, found one in `{found}`"),
    )
    .at(span, format!("this is in `{found}`"));
    match (expected.over(found), found.is_plain()) {
        (_, true) => finding.help(format!("give the number its unit: `[{expected}]`")),
        (Some(factor), false) => finding.help(format!("a factor in `{factor}` would make it fit")),
        (None, false) => finding,
    }
}

fn frame(expected: &Name, found: &Name, span: Span) -> Finding {
    Finding::new(
        Code::RPI2005,
        format!("expected the frame `{expected}`, found `{found}`"),
    )
    .at(span, format!("this is about the frame `{found}`"))
    .help(format!(
        "compose it with the pose that leads from `{found}` to `{expected}`"
    ))
}

fn size(expected: u32, found: u32, span: Span) -> Finding {
    Finding::new(
        Code::RPI2009,
        format!("expected {expected} elements, found {found}"),
    )
    .at(span, format!("this has {found} elements"))
}

/// Two dimensions that an operator can not bring together.
pub(super) fn dimensions_apart(op: &str, left: (Dim, Span), right: (Dim, Span)) -> Finding {
    let (a, b) = (left.0, right.0);
    let finding = Finding::new(
        Code::RPI2002,
        format!("`{op}` can not take quantities in `{a}` and in `{b}`"),
    )
    .at(right.1, format!("this is in `{b}`"))
    .also(left.1, format!("this is in `{a}`"));
    match a.over(b) {
        Some(_) if b.is_plain() => finding.help(format!("give the number its unit: `[{a}]`")),
        Some(factor) if !a.is_plain() => finding.help(format!("they differ by `{factor}`")),
        _ => finding,
    }
}

/// A name that nothing answers to.
pub(super) fn unknown(what: &str, name: &str, span: Span, near: Option<String>) -> Finding {
    let finding = Finding::new(Code::RPI1001, format!("there is no {what} `{name}`"))
        .at(span, "not declared");
    did_you_mean(finding, span, near)
}

/// A part that a value does not have.
pub(super) fn no_member(of: &str, name: &str, span: Span, near: Option<String>) -> Finding {
    let finding =
        Finding::new(Code::RPI1004, format!("{of} has no `{name}`")).at(span, "not there");
    did_you_mean(finding, span, near)
}

/// Adds "did you mean" with its fix.
pub(super) fn did_you_mean(finding: Finding, span: Span, near: Option<String>) -> Finding {
    match near {
        Some(near) => finding
            .help(format!("did you mean `{near}`?"))
            .fix(Fix::maybe(format!("write `{near}`")).replace(span, near)),
        None => finding,
    }
}

/// A name that is something else than its place wants.
pub(super) fn not_a(wanted: &str, name: &str, is: &str, span: Span, declared: Span) -> Finding {
    Finding::new(Code::RPI1003, format!("`{name}` is {is}, not {wanted}"))
        .at(span, format!("{wanted} is expected here"))
        .also(declared, "declared here")
}

/// Names in a row for a sentence: `a`, `b` and `c`.
pub(super) fn listed<'n>(names: impl IntoIterator<Item = &'n str>) -> String {
    let quoted: Vec<String> = names.into_iter().map(|name| format!("`{name}`")).collect();
    match &quoted[..] {
        [] => "nothing".to_owned(),
        [one] => one.clone(),
        [most @ .., last] => format!("{} and {last}", most.join(", ")),
    }
}
