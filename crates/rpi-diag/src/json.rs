//! Output as one JSON object with all details. Locations are given both as byte offsets and as line and column.

use serde::Serialize;

use crate::{Applicability, Diagnostic, Edit, Fix, Label, LineCol, SourceMap, Span};

/// Version of the JSON schema of diagnostics. It is incremented when a field changes its meaning or is removed, not for
/// new fields.
const SCHEMA_VERSION: u32 = 1;

/// Renders diagnostics as an indented JSON object with a final newline.
pub(crate) fn render(diagnostics: &[Diagnostic], sources: &SourceMap) -> String {
    let diagnostics = diagnostics
        .iter()
        .map(|diagnostic| json_diagnostic(diagnostic, sources))
        .collect();
    pretty(&JsonReport {
        schema: "rpi-findings",
        version: SCHEMA_VERSION,
        diagnostics,
    })
}

/// Serialises a value as indented JSON with a final newline. Serialisation cannot fail, because the types of this crate
/// contain only strings and numbers.
pub(crate) fn pretty(value: &impl Serialize) -> String {
    serde_json::to_string_pretty(value).unwrap_or_default() + "\n"
}

#[derive(Serialize)]
struct JsonReport<'a> {
    schema: &'static str,
    version: u32,
    // The key of the public format.
    #[serde(rename = "findings")]
    diagnostics: Vec<JsonDiagnostic<'a>>,
}

#[derive(Serialize)]
struct JsonDiagnostic<'a> {
    code: &'static str,
    severity: &'static str,
    title: &'static str,
    message: &'a str,
    labels: Vec<JsonLabel<'a>>,
    help: &'a [String],
    notes: &'a [String],
    fixes: Vec<JsonFix<'a>>,
    explain: String,
}

#[derive(Serialize)]
struct JsonLabel<'a> {
    #[serde(flatten)]
    place: JsonRange<'a>,
    text: &'a str,
    primary: bool,
}

#[derive(Serialize)]
struct JsonFix<'a> {
    title: &'a str,
    applicability: &'static str,
    edits: Vec<JsonEdit<'a>>,
}

#[derive(Serialize)]
struct JsonEdit<'a> {
    #[serde(flatten)]
    place: JsonRange<'a>,
    text: &'a str,
}

/// Range of source text; `file` is null if the diagnostic has no source text.
#[derive(Serialize)]
struct JsonRange<'a> {
    file: Option<&'a str>,
    start: JsonPosition,
    end: JsonPosition,
}

/// Position in a source file: `offset` counts bytes from 0; `line` and `col` count from 1, `col` in Unicode scalar
/// values.
#[derive(Serialize)]
struct JsonPosition {
    offset: usize,
    line: u32,
    col: u32,
}

fn json_diagnostic<'a>(diagnostic: &'a Diagnostic, sources: &'a SourceMap) -> JsonDiagnostic<'a> {
    JsonDiagnostic {
        code: diagnostic.code.as_str(),
        severity: diagnostic.severity().as_str(),
        title: diagnostic.code.title(),
        message: &diagnostic.message,
        labels: diagnostic
            .labels
            .iter()
            .map(|label| json_label(label, sources))
            .collect(),
        help: &diagnostic.help,
        notes: &diagnostic.notes,
        fixes: diagnostic
            .fixes
            .iter()
            .map(|fix| json_fix(fix, sources))
            .collect(),
        explain: format!("rpic explain {}", diagnostic.code),
    }
}

fn json_label<'a>(label: &'a Label, sources: &'a SourceMap) -> JsonLabel<'a> {
    JsonLabel {
        place: json_range(label.span, sources),
        text: &label.text,
        primary: label.primary,
    }
}

/// Returns the JSON name of the applicability of a fix: `sure` or `maybe`.
pub(crate) fn applicability(applicability: Applicability) -> &'static str {
    match applicability {
        Applicability::Sure => "sure",
        Applicability::Maybe => "maybe",
    }
}

fn json_fix<'a>(fix: &'a Fix, sources: &'a SourceMap) -> JsonFix<'a> {
    JsonFix {
        title: &fix.title,
        applicability: applicability(fix.applicability),
        edits: fix
            .edits
            .iter()
            .map(|edit| json_edit(edit, sources))
            .collect(),
    }
}

fn json_edit<'a>(edit: &'a Edit, sources: &'a SourceMap) -> JsonEdit<'a> {
    JsonEdit {
        place: json_range(edit.span, sources),
        text: &edit.text,
    }
}

fn json_range(span: Span, sources: &SourceMap) -> JsonRange<'_> {
    let (start, end) = sources.clamp(span);
    JsonRange {
        file: (!span.is_none()).then(|| sources.name(span.file)),
        start: json_position(start, sources.line_col(span)),
        end: json_position(end, sources.line_col_end(span)),
    }
}

fn json_position(offset: usize, at: LineCol) -> JsonPosition {
    JsonPosition {
        offset,
        line: at.line,
        col: at.col,
    }
}
