//! Convert a unit: a quantity is written in another unit of the same dimension, with exactly the same value.

use lsp_types::CodeActionKind;
use rpi_diag::{FileId, Span};
use rpi_sema::units::resolve;
use rpi_syntax::ast::{ExprKind, Quantity, Unit};
use rpi_syntax::{Dialect, SourceTokenKind, parse, source_tokens};

use super::code_context::CodeContext;
use super::{Refactoring, edit};

/// Units that are offered, if they have the dimension of the quantity.
const OFFERED: &[&str] = &[
    "m", "mm", "cm", "um", "km", "m/s", "mm/s", "m/s^2", "mm/s^2", "s", "ms", "us", "min", "rad",
    "deg", "rad/s", "deg/s", "rpm", "rad/s^2", "deg/s^2", "kg", "g", "N", "kN", "Hz", "kHz", "V",
    "mV", "A", "mA", "Pa", "bar",
];

/// Returns the refactorings that write the quantity at the selection in another unit. A unit in which the value would be
/// rounded to another number is left out.
pub(super) fn convert_unit(context: &CodeContext<'_>) -> Vec<Refactoring> {
    let around = |span: Span| span.contains(context.selection);
    let found = quantities(context)
        .into_iter()
        .find(|(span, _)| around(*span));
    let Some((span, quantity)) = found else {
        return Vec::new();
    };
    let written = context.slice(quantity.unit.span);
    let others = OFFERED.iter().filter(|unit| **unit != written);
    let converted = others.filter_map(|unit| {
        let text = format!("{}[{unit}]", converted(&quantity, unit)?);
        let edits = vec![edit(span, text.clone())];
        let title = format!("write as `{text}`");
        Some(Refactoring::new(
            title,
            CodeActionKind::REFACTOR_REWRITE,
            edits,
        ))
    });
    converted.collect()
}

/// Returns the quantities of the document, also those in static arguments and constants, found by their tokens.
fn quantities(context: &CodeContext<'_>) -> Vec<(Span, Quantity)> {
    let tokens = source_tokens(context.text, context.seen.mode());
    let word = |k: usize| {
        tokens
            .get(k)
            .map_or("", |one| &context.text[one.range.clone()])
    };
    let offset = |at: usize| u32::try_from(at).unwrap_or(u32::MAX);
    let mut found = Vec::new();
    for (k, token) in tokens.iter().enumerate() {
        if token.kind != SourceTokenKind::Number || word(k + 1) != "[" {
            continue;
        }
        let Some(length) = (k + 2..tokens.len()).position(|at| word(at) == "]") else {
            break;
        };
        let end = tokens[k + 2 + length].range.end;
        let text = &context.text[token.range.start..end];
        if let Some(mut quantity) = parse_quantity(text) {
            let open = tokens[k + 1].range.end;
            quantity.unit.span = Span::new(FileId(0), offset(open), offset(end - 1));
            let span = Span::new(FileId(0), offset(token.range.start), offset(end));
            found.push((span, quantity));
        }
    }
    found
}

/// Returns a quantity given by its text; `None` if the text is something else, such as an index.
fn parse_quantity(text: &str) -> Option<Quantity> {
    let source = format!("const q = {text};");
    let parsed = parse(FileId(0), &source, Dialect::Rpi);
    let item = parsed.file.items.into_iter().next()?;
    let rpi_syntax::ast::ItemKind::Const(defs) = item.kind else {
        return None;
    };
    match defs.into_iter().next()?.value?.kind {
        ExprKind::Quantity(quantity) if parsed.diagnostics.is_empty() => Some(*quantity),
        _ => None,
    }
}

/// Returns the number that with the unit `unit` has exactly the value of a quantity; `None` if the dimension differs, or
/// no short number has this value.
fn converted(quantity: &Quantity, unit: &str) -> Option<String> {
    let new = parse_quantity(&format!("1[{unit}]"))?.unit;
    let known = |unit: &Unit| resolve(unit, &|_| None).ok();
    let (from, to) = (known(&quantity.unit)?, known(&new)?);
    (from.dim == to.dim).then_some(())?;
    let value = from.factor.apply(quantity.number.real_value());
    let number = value * to.factor.den / to.factor.num;
    // The shortest text within some digits whose value is the same to the last bit.
    let texts = (0..=MAX_DIGITS).map(|digits| format!("{number:.digits$}"));
    let mut exact = texts.filter(|text| {
        let read: f64 = text.parse().unwrap_or(f64::NAN);
        to.factor.apply(read).to_bits() == value.to_bits()
    });
    let text = exact.next()?;
    // A number with many digits before or after the point is hard to read.
    let is_readable = (1e-3..1e6).contains(&number.abs()) || number == 0.0;
    (text.len() <= MAX_LENGTH && is_readable).then_some(text)
}

/// Maximum number of decimals of a converted number.
const MAX_DIGITS: usize = 9;

/// Maximum length of a converted number in characters.
const MAX_LENGTH: usize = 12;
