//! Conformance of the machine-readable formats to their specifications: SARIF 2.1.0 (OASIS) and GitHub's workflow
//! commands.

use rpi_diag::{Code, Diagnostic, FileId, Fix, Format, SourceMap, Span, Style, render_as};
use serde_json::Value;

fn at(file: u32, start: u32, end: u32) -> Span {
    Span::new(FileId(file), start, end)
}

fn sources() -> SourceMap {
    let mut sources = SourceMap::new();
    sources.add("/tmp/my cell/größe.rpi", "α = β;\nx\n");
    sources.add("parts/a b.rpi", "one\ntwo\n");
    sources
}

fn diagnostic() -> Diagnostic {
    let fix = Fix::sure("rename")
        .replace(at(0, 5, 7), "γ")
        .replace(at(1, 0, 3), "1")
        .replace(at(0, 0, 2), "δ");
    Diagnostic::new(Code::RPI1001, "100% wrong\nand more")
        .primary(at(0, 5, 7), "this: here, there")
        .secondary(at(1, 0, 7), "two lines")
        .secondary(at(1, 0, 7), "two lines")
        .secondary(Span::NONE, "nowhere")
        .help("help it")
        .fix(fix)
        .fix(Fix::maybe("nothing that has a text"))
}

fn shown(format: Format) -> String {
    render_as(format, &[diagnostic()], &sources(), Style::PLAIN)
}

fn sarif() -> Value {
    serde_json::from_str(&shown(Format::Sarif)).expect("JSON")
}

#[test]
fn sarif_names_files_by_references_that_are_escaped() {
    let result = &sarif()["runs"][0]["results"][0];
    let uri = |location: &Value| location["physicalLocation"]["artifactLocation"]["uri"].clone();
    assert_eq!(
        uri(&result["locations"][0]),
        "file:///tmp/my%20cell/gr%C3%B6%C3%9Fe.rpi"
    );
    assert_eq!(uri(&result["relatedLocations"][0]), "parts/a%20b.rpi");
}

#[test]
fn sarif_counts_columns_in_code_points_and_offsets_in_bytes() {
    let log = sarif();
    assert_eq!(log["runs"][0]["columnKind"], "unicodeCodePoints");
    let region = &log["runs"][0]["results"][0]["locations"][0]["physicalLocation"]["region"];
    let expected = [
        ("startLine", 1),
        ("startColumn", 5),
        ("endLine", 1),
        ("endColumn", 6),
        ("byteOffset", 5),
        ("byteLength", 2),
    ];
    for (name, value) in expected {
        assert_eq!(region[name], value, "{name}");
    }
}

#[test]
fn sarif_results_point_to_rules_with_help() {
    let log = sarif();
    let (rules, result) = (
        &log["runs"][0]["tool"]["driver"]["rules"],
        &log["runs"][0]["results"][0],
    );
    let rule = &rules[result["ruleIndex"].as_u64().expect("an index") as usize];
    assert_eq!(
        (&rule["id"], &result["ruleId"]),
        (&"RPI1001".into(), &"RPI1001".into())
    );
    assert_eq!(
        (&result["level"], &rule["defaultConfiguration"]["level"]),
        (&"error".into(), &"error".into())
    );
    assert!(
        rule["help"]["markdown"]
            .as_str()
            .is_some_and(|page| page.contains("# RPI1001"))
    );
}

/// The schema requires unique items and non-empty lists.
#[test]
fn sarif_sets_hold_everything_once_and_fixes_change_each_file_once() {
    let log = sarif();
    let result = &log["runs"][0]["results"][0];
    assert_eq!(result["relatedLocations"].as_array().map(Vec::len), Some(1));
    let fixes = result["fixes"].as_array().expect("fixes");
    assert_eq!(fixes.len(), 1, "a fix without a place is no fix");
    assert_eq!(fixes[0]["properties"]["applicability"], "sure");
    let changes = fixes[0]["artifactChanges"].as_array().expect("changes");
    let counts: Vec<usize> = changes
        .iter()
        .filter_map(|c| Some(c["replacements"].as_array()?.len()))
        .collect();
    assert_eq!(counts, [2, 1]);
}

#[test]
fn annotations_for_github_are_escaped_and_lie_on_their_lines() {
    let shown = shown(Format::Github);
    assert_eq!(shown.lines().count(), 1, "{shown}");
    assert!(
        shown.contains(
            "file=/tmp/my cell/größe.rpi,line=1,endLine=1,col=5,endColumn=6,title=RPI1001::"
        ),
        "{shown}"
    );
    assert!(
        shown.contains("::100%25 wrong%0Aand more%0Ahelp it"),
        "{shown}"
    );
    let over_lines = Diagnostic::new(Code::RPI1001, "odd").primary(at(1, 0, 7), "");
    let shown = render_as(Format::Github, &[over_lines], &sources(), Style::PLAIN);
    assert!(
        shown.contains("line=1,endLine=2,title"),
        "no columns over several lines: {shown}"
    );
}
