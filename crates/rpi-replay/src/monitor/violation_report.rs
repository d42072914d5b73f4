//! Diagnostics of violated claims: responsible side, cycle and values.

use rpi_diag::{Code, Diagnostic};
use rpi_image::Type;
use rpi_net::{Claim, ClaimKind, ClaimRead};

use super::ClaimViolation;

/// Returns the diagnostic of a claim that is violated in the cycle with this number, from 0.
pub(super) fn diagnostic(claim: &Claim, broken: &ClaimViolation, cycle: u64) -> Diagnostic {
    let row = texts_of(claim.kind);
    let message = format!("{} in cycle {cycle}", violation_text(claim));
    let mut diagnostic = Diagnostic::new(row.code, message).primary(claim.span, row.label);
    if !broken.now.is_empty() {
        diagnostic = diagnostic.note(format!("in this cycle {}", broken.now));
    }
    if let Some(before) = broken.before.as_ref().filter(|before| !before.is_empty()) {
        diagnostic = diagnostic.note(format!("in the previous cycle {before}"));
    }
    let diagnostic = match &claim.path[..] {
        "" => diagnostic,
        path => diagnostic.note(format!("in the call `{path}`")),
    };
    match (claim.kind, &claim.path[..]) {
        (ClaimKind::Assume, "") => diagnostic.help(format!(
            "the inputs of the run violate it: give `{}` other inputs, or weaken the assumption",
            claim.subject
        )),
        (ClaimKind::Assume, path) => diagnostic.help(format!(
            "the caller violates it: correct the arguments of the call `{path}`, or weaken the assumption"
        )),
        (ClaimKind::Assert, _) => diagnostic.help(format!(
            "correct the equations of `{}`, give other inputs, or weaken the assertion",
            claim.subject
        )),
        (ClaimKind::Check, _) => diagnostic.help(format!(
            "correct the equations of `{}`, or weaken the property",
            claim.subject
        )),
        (ClaimKind::Guarantee, _) => diagnostic.help(format!(
            "correct the equations of `{}`, exclude these inputs by an `assume`, or weaken the guarantee",
            claim.subject
        )),
        (ClaimKind::ModeCompleteness, _) => diagnostic.help(
            "add a mode for this case, weaken a `require`, or exclude these inputs by an `assume`",
        ),
    }
}

/// Returns a value as text in the syntax of the language, with the unit of the flow or as the name of an enumeration
/// value; `none` if the value is absent.
pub(super) fn value_text(read: &ClaimRead, cells: Option<&[u64]>, ty: Type) -> String {
    let Some(cells) = cells else {
        return "none".to_owned();
    };
    let name = cells.first().and_then(|cell| usize::try_from(*cell).ok());
    let name = name.and_then(|place| read.values.get(place));
    name.cloned()
        .unwrap_or_else(|| format!("{}{}", rpi_literal::write(cells, ty), read.unit))
}

/// Returns the description of a violation, for example "the guarantee of `f` is not kept".
pub(super) fn violation_text(claim: &Claim) -> String {
    format!("{} {}", claim_name(claim), texts_of(claim.kind).verb)
}

/// Texts and diagnostic code for one kind of claim, such as a guarantee.
struct KindTexts {
    kind: ClaimKind,
    code: Code,
    what: &'static str,
    verb: &'static str,
    label: &'static str,
}

const fn kind_texts(
    kind: ClaimKind,
    code: Code,
    what: &'static str,
    verb: &'static str,
    label: &'static str,
) -> KindTexts {
    KindTexts {
        kind,
        code,
        what,
        verb,
        label,
    }
}

#[rustfmt::skip]
const ROWS: &[KindTexts] = &[
    kind_texts(ClaimKind::Assert,    Code::RPI9012, "the assertion",  "does not hold", "this is false"),
    kind_texts(ClaimKind::Check,     Code::RPI9012, "the property",   "does not hold", "this is false"),
    kind_texts(ClaimKind::Assume,    Code::RPI9013, "the assumption", "does not hold", "this is false for the inputs of the caller"),
    kind_texts(ClaimKind::Guarantee, Code::RPI9014, "the guarantee",  "is not kept", "guaranteed here"),
    kind_texts(ClaimKind::ModeCompleteness,     Code::RPI9015, "the contract",   "has no mode that applies", "at least one of these modes must apply"),
];

fn texts_of(kind: ClaimKind) -> &'static KindTexts {
    let row = ROWS.iter().find(|row| row.kind == kind);
    row.unwrap_or(&ROWS[0])
}

/// Returns the name of a claim for messages, such as: the guarantee "smaller" of `Half` in mode `up`.
pub(super) fn claim_name(claim: &Claim) -> String {
    let label = claim.label.as_ref().map(|label| format!(" \"{label}\""));
    let mode = claim.mode.as_ref().map(|mode| format!(" in mode `{mode}`"));
    let (label, mode) = (label.unwrap_or_default(), mode.unwrap_or_default());
    format!(
        "{}{label} of `{}`{mode}",
        texts_of(claim.kind).what,
        claim.subject
    )
}
