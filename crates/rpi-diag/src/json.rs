//! Output as one JSON object with all details. Locations are given both as byte offsets and as line and column.

use serde::Serialize;

use crate::{Applicability, Edit, Finding, Fix, Label, LineCol, SourceMap, Span};

/// Version of the schema. It is incremented when a field changes its meaning or is removed, not for new fields.
const SCHEMA_VERSION: u32 = 1;

/// Renders the indented object and a final newline.
pub(crate) fn render(findings: &[Finding], sources: &SourceMap) -> String {
    let findings = findings
        .iter()
        .map(|finding| finding_row(finding, sources))
        .collect();
    pretty(&Report {
        schema: "rpi-findings",
        version: SCHEMA_VERSION,
        findings,
    })
}

/// Serialises a value as indented JSON. The types of this crate only contain strings and numbers, so this cannot fail.
pub(crate) fn pretty(value: &impl Serialize) -> String {
    serde_json::to_string_pretty(value).unwrap_or_default() + "\n"
}

#[derive(Serialize)]
struct Report<'a> {
    schema: &'static str,
    version: u32,
    findings: Vec<FindingRow<'a>>,
}

#[derive(Serialize)]
struct FindingRow<'a> {
    code: &'static str,
    severity: &'static str,
    title: &'static str,
    message: &'a str,
    labels: Vec<LabelRow<'a>>,
    help: &'a [String],
    notes: &'a [String],
    fixes: Vec<FixRow<'a>>,
    explain: String,
}

#[derive(Serialize)]
struct LabelRow<'a> {
    #[serde(flatten)]
    place: PlaceRow<'a>,
    text: &'a str,
    primary: bool,
}

#[derive(Serialize)]
struct FixRow<'a> {
    title: &'a str,
    applicability: &'static str,
    edits: Vec<EditRow<'a>>,
}

#[derive(Serialize)]
struct EditRow<'a> {
    #[serde(flatten)]
    place: PlaceRow<'a>,
    text: &'a str,
}

/// Range in a file; `file` is null for a location without text.
#[derive(Serialize)]
struct PlaceRow<'a> {
    file: Option<&'a str>,
    start: PointRow,
    end: PointRow,
}

/// Position: `offset` counts bytes from 0, `line` and `col` count from 1, `col` in Unicode scalar values.
#[derive(Serialize)]
struct PointRow {
    offset: usize,
    line: u32,
    col: u32,
}

fn finding_row<'a>(finding: &'a Finding, sources: &'a SourceMap) -> FindingRow<'a> {
    FindingRow {
        code: finding.code.as_str(),
        severity: finding.severity().as_str(),
        title: finding.code.title(),
        message: &finding.message,
        labels: finding
            .labels
            .iter()
            .map(|label| label_row(label, sources))
            .collect(),
        help: &finding.help,
        notes: &finding.notes,
        fixes: finding
            .fixes
            .iter()
            .map(|fix| fix_row(fix, sources))
            .collect(),
        explain: format!("rpic explain {}", finding.code),
    }
}

fn label_row<'a>(label: &'a Label, sources: &'a SourceMap) -> LabelRow<'a> {
    LabelRow {
        place: place_row(label.span, sources),
        text: &label.text,
        primary: label.primary,
    }
}

/// Returns `sure` or `maybe`.
pub(crate) fn applicability(applicability: Applicability) -> &'static str {
    match applicability {
        Applicability::Sure => "sure",
        Applicability::Maybe => "maybe",
    }
}

fn fix_row<'a>(fix: &'a Fix, sources: &'a SourceMap) -> FixRow<'a> {
    FixRow {
        title: &fix.title,
        applicability: applicability(fix.applicability),
        edits: fix
            .edits
            .iter()
            .map(|edit| edit_row(edit, sources))
            .collect(),
    }
}

fn edit_row<'a>(edit: &'a Edit, sources: &'a SourceMap) -> EditRow<'a> {
    EditRow {
        place: place_row(edit.span, sources),
        text: &edit.text,
    }
}

fn place_row(span: Span, sources: &SourceMap) -> PlaceRow<'_> {
    let (start, end) = sources.clamp(span);
    PlaceRow {
        file: (!span.is_none()).then(|| sources.name(span.file)),
        start: point_row(start, sources.line_col(span)),
        end: point_row(end, sources.line_col_end(span)),
    }
}

fn point_row(offset: usize, at: LineCol) -> PointRow {
    PointRow {
        offset,
        line: at.line,
        col: at.col,
    }
}
