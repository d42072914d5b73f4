//! Output in SARIF 2.1.0 (OASIS Static Analysis Results Interchange Format), limited to what code scanners read: rules
//! with their pages, results with locations and fixes.

use serde::Serialize;

use crate::{Code, Diagnostic, Edit, Fix, Label, Severity, SourceMap, Span, json};

/// Renders diagnostics as a SARIF 2.1.0 log of one run of the compiler.
pub(crate) fn render(diagnostics: &[Diagnostic], sources: &SourceMap) -> String {
    let mut codes: Vec<Code> = diagnostics
        .iter()
        .map(|diagnostic| diagnostic.code)
        .collect();
    codes.sort();
    codes.dedup();
    let results = diagnostics
        .iter()
        .map(|diagnostic| result(diagnostic, &codes, sources))
        .collect();
    let rules = codes.iter().map(|&code| rule(code)).collect();
    let driver = Driver {
        name: "rpic",
        version: env!("CARGO_PKG_VERSION"),
        rules,
    };
    let run = Run {
        tool: Tool { driver },
        column_kind: "unicodeCodePoints",
        results,
    };
    json::pretty(&Log {
        schema: SCHEMA,
        version: "2.1.0",
        runs: [run],
    })
}

const SCHEMA: &str =
    "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json";

#[derive(Serialize)]
struct Log<'a> {
    #[serde(rename = "$schema")]
    schema: &'static str,
    version: &'static str,
    runs: [Run<'a>; 1],
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Run<'a> {
    tool: Tool,
    column_kind: &'static str,
    results: Vec<SarifResult<'a>>,
}

#[derive(Serialize)]
struct Tool {
    driver: Driver,
}

#[derive(Serialize)]
struct Driver {
    name: &'static str,
    version: &'static str,
    rules: Vec<Rule>,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Rule {
    id: &'static str,
    short_description: Text<'static>,
    help: Help,
    default_configuration: Configuration,
}

#[derive(Serialize)]
struct Help {
    text: &'static str,
    markdown: &'static str,
}

#[derive(Serialize)]
struct Configuration {
    level: &'static str,
}

#[derive(Serialize)]
struct Text<'a> {
    text: &'a str,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct SarifResult<'a> {
    rule_id: &'static str,
    rule_index: usize,
    level: &'static str,
    message: OwnedText,
    locations: Vec<Location<'a>>,
    related_locations: Vec<Location<'a>>,
    fixes: Vec<SarifFix<'a>>,
}

#[derive(Serialize)]
struct OwnedText {
    text: String,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Location<'a> {
    physical_location: PhysicalLocation,
    #[serde(skip_serializing_if = "Option::is_none")]
    message: Option<Text<'a>>,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct PhysicalLocation {
    artifact_location: Artifact,
    region: Region,
}

#[derive(Serialize)]
struct Artifact {
    uri: String,
}

impl Artifact {
    /// Returns the location of a file as a URI reference (RFC 3986): percent-escaped, with slashes. An absolute path
    /// gets the scheme `file`.
    fn from_name(name: &str) -> Artifact {
        let path = name.replace('\\', "/");
        let is_drive = path.as_bytes().get(1) == Some(&b':');
        let start = match (path.starts_with('/'), is_drive) {
            (true, _) => "file://",
            (false, true) => "file:///",
            (false, false) => "",
        };
        let escaped = path.bytes().enumerate().map(|(at, byte)| match byte {
            b'A'..=b'Z' | b'a'..=b'z' | b'0'..=b'9' | b'-' | b'.' | b'_' | b'~' | b'/' => {
                char::from(byte).to_string()
            }
            b':' if is_drive && at == 1 => ":".to_owned(),
            _ => format!("%{byte:02X}"),
        });
        Artifact {
            uri: format!("{start}{}", escaped.collect::<String>()),
        }
    }
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Region {
    start_line: u32,
    start_column: u32,
    end_line: u32,
    end_column: u32,
    byte_offset: usize,
    byte_length: usize,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct SarifFix<'a> {
    description: Text<'a>,
    artifact_changes: Vec<Change<'a>>,
    properties: FixProperties,
}

/// Additional properties of a fix (a SARIF property bag): its applicability, for which SARIF has no field.
#[derive(Serialize)]
struct FixProperties {
    applicability: &'static str,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Change<'a> {
    artifact_location: Artifact,
    replacements: Vec<Replacement<'a>>,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Replacement<'a> {
    deleted_region: Region,
    inserted_content: Text<'a>,
}

/// Returns the SARIF level of a severity. SARIF uses the same names as [`Severity::as_str`].
fn level(severity: Severity) -> &'static str {
    severity.as_str()
}

fn rule(code: Code) -> Rule {
    Rule {
        id: code.as_str(),
        short_description: Text { text: code.title() },
        help: Help {
            text: code.page(),
            markdown: code.page(),
        },
        default_configuration: Configuration {
            level: level(code.severity()),
        },
    }
}

fn result<'a>(
    diagnostic: &'a Diagnostic,
    codes: &[Code],
    sources: &'a SourceMap,
) -> SarifResult<'a> {
    let text = std::iter::once(&diagnostic.message)
        .chain(&diagnostic.help)
        .chain(&diagnostic.notes);
    SarifResult {
        rule_id: diagnostic.code.as_str(),
        rule_index: codes.partition_point(|&code| code < diagnostic.code),
        level: level(diagnostic.severity()),
        message: OwnedText {
            text: text.cloned().collect::<Vec<_>>().join("\n"),
        },
        locations: locations(diagnostic, true, sources),
        related_locations: locations(diagnostic, false, sources),
        fixes: diagnostic
            .fixes
            .iter()
            .filter_map(|fix| sarif_fix(fix, sources))
            .collect(),
    }
}

fn locations<'a>(
    diagnostic: &'a Diagnostic,
    primary: bool,
    sources: &'a SourceMap,
) -> Vec<Location<'a>> {
    let labels = diagnostic
        .labels
        .iter()
        .filter(|label| label.primary == primary && !label.span.is_none());
    // The SARIF schema requires unique items in both lists of locations.
    let mut once: Vec<&Label> = Vec::new();
    for label in labels {
        if !once.contains(&label) {
            once.push(label);
        }
    }
    once.into_iter()
        .map(|label| Location {
            physical_location: PhysicalLocation {
                artifact_location: Artifact::from_name(sources.name(label.span.file)),
                region: region(label.span, sources),
            },
            message: (!label.text.is_empty()).then_some(Text { text: &label.text }),
        })
        .collect()
}

/// Converts a fix to SARIF, with its edits grouped by file. Returns `None` for a fix without a source location.
fn sarif_fix<'a>(fix: &'a Fix, sources: &'a SourceMap) -> Option<SarifFix<'a>> {
    let edits = fix.in_order();
    let files = edits.chunk_by(|a, b| a.span.file == b.span.file);
    let change = |edits: &[&'a Edit]| Change {
        artifact_location: Artifact::from_name(sources.name(edits[0].span.file)),
        replacements: edits
            .iter()
            .map(|edit| Replacement {
                deleted_region: region(edit.span, sources),
                inserted_content: Text { text: &edit.text },
            })
            .collect(),
    };
    (!edits.is_empty()).then(|| SarifFix {
        description: Text { text: &fix.title },
        artifact_changes: files.map(change).collect(),
        properties: FixProperties {
            applicability: json::applicability(fix.applicability),
        },
    })
}

fn region(span: Span, sources: &SourceMap) -> Region {
    let (start, end) = (sources.line_col(span), sources.line_col_end(span));
    let (from, to) = sources.clamp(span);
    Region {
        start_line: start.line,
        start_column: start.col,
        end_line: end.line,
        end_column: end.col,
        byte_offset: from,
        byte_length: to - from,
    }
}
