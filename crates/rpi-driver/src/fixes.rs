//! Fixes as the program can take them: their first values with units and values of enums, of which passes over nets know
//! nothing, and none for what is not the program's own.

use crate::modules::is_library_path;
use rpi_diag::{Edit, Finding, Fix, SourceMap, Span};
use rpi_sema::Checked;
use rpi_sema::ty::Ty;
use rpi_sema::typed::{Expr, Kind};
use std::cell::OnceCell;

/// How passes begin the text of a first value, by machine type.
const PLAIN: &[&str] = &["0.0 -> ", "0 -> ", "false -> "];

/// Gives the first values in the fixes of findings the type of what they stand before; a first value of a type without
/// literals is left to the writer.
pub(crate) fn typed(findings: &mut [Finding], checked: &Checked) {
    let places = Places::of(checked);
    for finding in findings {
        finding.fixes.retain_mut(|fix| type_fix(fix, &places));
    }
}

/// The expressions of a program by their places, put in order when one is looked for.
struct Places<'c> {
    checked: &'c Checked,
    /// With the places beside them: sorting looks at nothing else.
    sorted: OnceCell<Vec<(Span, &'c Expr)>>,
}

impl<'c> Places<'c> {
    fn of(checked: &'c Checked) -> Places<'c> {
        let sorted = OnceCell::new();
        Places { checked, sorted }
    }

    fn sorted(&self) -> &[(Span, &'c Expr)] {
        self.sorted.get_or_init(|| {
            let units = self.checked.units.iter();
            let exprs = units.flat_map(|unit| &unit.exprs);
            let mut places: Vec<(Span, &Expr)> = exprs.map(|expr| (expr.span, expr)).collect();
            places.sort_by_key(|(place, _)| *place);
            places
        })
    }

    /// Those that begin at a place, the shortest first.
    fn starting(&self, place: Span) -> impl Iterator<Item = &'c Expr> {
        let start = |span: Span| (span.file, span.start);
        let sorted = self.sorted();
        let first = sorted.partition_point(|(at, _)| start(*at) < start(place));
        let here = sorted[first..].iter();
        let here = here.take_while(move |(at, _)| start(*at) == start(place));
        here.map(|(_, expr)| *expr)
    }
}

/// Takes out the fixes that would change the standard library, which is part of the compiler.
pub(crate) fn of_the_program(findings: &mut [Finding], sources: &SourceMap) {
    let is_library = |span: Span| is_library_path(sources.name(span.file));
    for finding in findings {
        finding
            .fixes
            .retain(|fix| fix.edits.iter().all(|edit| !is_library(edit.span)));
    }
}

/// Lets fixes that leave nothing of a line delete it.
pub(crate) fn whole_lines(findings: &mut [Finding], sources: &SourceMap) {
    let fixes = findings.iter_mut().flat_map(|finding| &mut finding.fixes);
    for edit in fixes.flat_map(|fix| &mut fix.edits) {
        edit.take_lines(sources.text(edit.span.file));
    }
}

/// False where a first value cannot be written.
fn type_fix(fix: &mut Fix, places: &Places<'_>) -> bool {
    for pair in fix.edits.chunks_mut(2) {
        if let [before, after] = pair {
            bare_name(before, after, places);
        }
    }
    let mut insertions = fix.edits.iter_mut().filter(|edit| edit.span.is_empty());
    insertions.all(|edit| type_edit(edit, places).is_some())
}

/// `pre x` for `pre (x)`, where what is delayed is nothing but a name.
fn bare_name(before: &mut Edit, after: &mut Edit, places: &Places<'_>) {
    let (Some(head), Some(tail)) = (before.text.strip_suffix('('), after.text.strip_prefix(')'))
    else {
        return;
    };
    // The brackets of a call stay, `time(x)`.
    if head.ends_with(char::is_alphanumeric) {
        return;
    }
    let whole = before.span.merge(after.span);
    let mut here = places.starting(whole).filter(|expr| expr.span == whole);
    if here.any(|expr| matches!(expr.kind, Kind::Flow(_))) {
        (before.text, after.text) = (head.to_owned(), tail.to_owned());
    }
}

/// None where there is no way to write the first value that it begins with.
fn type_edit(edit: &mut Edit, places: &Places<'_>) -> Option<()> {
    let (open, rest) = match edit.text.strip_prefix('(') {
        Some(rest) => ("(", rest),
        None => ("", edit.text.as_str()),
    };
    let begins = |plain: &&str| rest.strip_prefix(*plain);
    if let Some(behind) = PLAIN.iter().find_map(begins)
        && let Some(ty) = type_at(edit.span, places)
    {
        edit.text = format!("{open}{} -> {behind}", neutral(ty)?);
    }
    Some(())
}

/// The type of the shortest expression that begins at a place, as far as its type is known.
fn type_at<'c>(place: Span, places: &Places<'c>) -> Option<&'c Ty> {
    let mut here = places.starting(place);
    let known = here.find(|expr| !expr.ty.has_unknown());
    known.map(|expr| &expr.ty)
}

/// A value of a type as it is written, nothing in the sense of addition where there is one.
fn neutral(ty: &Ty) -> Option<String> {
    match ty {
        Ty::Bool => Some("false".to_owned()),
        Ty::Int => Some("0".to_owned()),
        Ty::Subrange(range) => Some(range.nearest(0).to_string()),
        Ty::Real(dim) if *ty == Ty::REAL || dim.is_plain() => Some("0.0".to_owned()),
        Ty::Real(dim) => Some(format!("0[{dim}]")),
        Ty::Duration => Some("0[s]".to_owned()),
        Ty::Enum(values) => values.values.first().map(ToString::to_string),
        Ty::Array(element, n) => Some(format!("{}^{n}", neutral(element)?)),
        // What an instance was made for is not part of its name.
        Ty::Struct(of) if !of.name.contains('<') => {
            let fields = of.fields.iter();
            let fields = fields.map(|field| {
                Some(format!(
                    "{} = {}",
                    field.name.as_ref()?,
                    neutral(&field.ty)?
                ))
            });
            let fields: Option<Vec<String>> = fields.collect();
            Some(format!("{}{{{}}}", of.name, fields?.join("; ")))
        }
        _ => None,
    }
}
