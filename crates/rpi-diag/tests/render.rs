//! Snapshots of all output formats, each reviewed by a person.
//!
//! The diagnostics here are constructed by hand; those of the compiler are tested in `tests/ui`.

use rpi_diag::{Code, Diagnostic, FileId, Fix, Format, SourceMap, Span, Style, render, render_as};

const FIG6: &str = "\
use motion;

command MoveToC (arm: Arm; b, c: Pose)
let
  way = Line<<speed: 250[mm/s]>>(arm, c);
  arm.tcp = way.pose

  fragment PastB when takeover
  let yes = crosses(way.travelled, distance(way.start, b)); tel

  finish at_c when way.done;
  yield  at_b when PastB.yes ?? false;
  fail   arm_error when arm.error;
tel
";

const LOOP: &str = "\
node Loop (x: real) returns (y: real)
let
  a = x + d;
  b = 2.0 * a;
  -- one
  -- two
  -- three
  -- four
  -- five
  -- six
  c = b - 1.0;
  d = 0.5 * c;
  y = d;
tel
";

/// Returns the `nth` occurrence (from 0) of `what` in the file.
fn find(sources: &SourceMap, file: FileId, what: &str, nth: usize) -> Span {
    let (at, _) = sources
        .text(file)
        .match_indices(what)
        .nth(nth)
        .expect("the text holds it");
    Span::new(file, at as u32, (at + what.len()) as u32)
}

fn source(name: &str, text: &str) -> (SourceMap, FileId) {
    let mut sources = SourceMap::new();
    let file = sources.add(name, text);
    (sources, file)
}

fn missing_semicolon() -> (SourceMap, Vec<Diagnostic>) {
    let (sources, file) = source("fig6.rpi", FIG6);
    let end = find(&sources, file, "way.pose", 0);
    let next = find(&sources, file, "fragment", 0);
    let diagnostic = Diagnostic::new(
        Code::RPI0001,
        "expected `;` after this equation, found `fragment`",
    )
    .primary(next, "a new declaration begins here")
    .secondary(end, "the equation ends here")
    .fix(Fix::sure("end the equation").insert_after(end, ";"));
    (sources, vec![diagnostic])
}

fn ring() -> (SourceMap, Vec<Diagnostic>) {
    let (sources, file) = source("loop.rpi", LOOP);
    let place = |what| find(&sources, file, what, 0);
    let ring = "`a` depends on itself in the same cycle: a -> b -> c -> d -> a";
    let diagnostic = Diagnostic::new(Code::RPI0001, ring)
        .primary(place("a = x + d"), "`a` needs `d` now")
        .secondary(place("b = 2.0 * a"), "`b` needs `a` now")
        .secondary(place("c = b - 1.0"), "`c` needs `b` now")
        .secondary(place("d = 0.5 * c"), "`d` needs `c` now")
        .help("delay one step of the ring: `pre` gives the value of the cycle before, and is free of the ring")
        .note("a `pre` needs a first value: `0.0 -> pre d`")
        .fix(Fix::maybe("take `d` of the cycle before").replace(place("x + d"), "x + (0.0 -> pre d)"))
        .fix(Fix::maybe("take `a` of the cycle before").replace(place("2.0 * a"), "2.0 * (0.0 -> pre a)"));
    (sources, vec![diagnostic])
}

fn two_files() -> (SourceMap, Vec<Diagnostic>) {
    let mut sources = SourceMap::new();
    let library = sources.add(
        "stdlib/motion.rpi",
        "--| A line.\nfragment Line <<speed: real[m/s]>>\n",
    );
    let user = sources.add("cell.rpi", "way = Line<<speed: 3[m]>>;\n");
    let diagnostic = Diagnostic::new(Code::RPI0002, "`speed` wants a speed, this is a length")
        .primary(find(&sources, user, "3[m]", 0), "a length, m")
        .secondary(find(&sources, library, "real[m/s]", 0), "declared in m/s");
    (sources, vec![diagnostic])
}

fn human((sources, diagnostics): (SourceMap, Vec<Diagnostic>)) -> String {
    render(&diagnostics, &sources, Style::PLAIN)
}

#[test]
fn one_fault_and_its_fix() {
    insta::assert_snapshot!(human(missing_semicolon()));
}

#[test]
fn places_far_apart() {
    insta::assert_snapshot!(human(ring()));
}

#[test]
fn places_in_two_files_begin_with_the_fault() {
    insta::assert_snapshot!(human(two_files()));
}

#[test]
fn a_long_stretch_between_two_places_is_left_out() {
    let (sources, file) = source(
        "long.rpi",
        &format!("{0}first\n{0}second\n{0}", "x = 1;\n".repeat(100)),
    );
    let diagnostic = Diagnostic::new(Code::RPI0001, "odd")
        .primary(find(&sources, file, "second", 0), "here")
        .secondary(find(&sources, file, "first", 0), "and here");
    let shown = human((sources, vec![diagnostic]));
    assert!(
        shown.contains("long.rpi:101:1") && shown.contains("long.rpi:202:1"),
        "{shown}"
    );
    assert!(shown.lines().count() < 20, "{shown}");
}

#[test]
fn a_long_line_beside_a_place_is_left_out() {
    let text = format!("y = {0};\nodd\nz = {0};\n", "x + ".repeat(500));
    let (sources, file) = source("beside.rpi", &text);
    let diagnostic =
        Diagnostic::new(Code::RPI0001, "odd").primary(find(&sources, file, "odd", 0), "here");
    let shown = human((sources, vec![diagnostic]));
    assert!(shown.lines().all(|line| line.len() < 120), "{shown}");
}

#[test]
fn every_form_counts_columns_in_characters() {
    let (sources, file) = source("greek.rpi", "  αβγ = δ;\n");
    let diagnostic =
        Diagnostic::new(Code::RPI0002, "odd").primary(find(&sources, file, "δ", 0), "here");
    for format in [Format::Human, Format::Short] {
        let shown = render_as(
            format,
            std::slice::from_ref(&diagnostic),
            &sources,
            Style::PLAIN,
        );
        assert!(shown.contains("greek.rpi:1:9"), "{shown}");
    }
}

#[test]
fn colours_on_a_terminal() {
    let (sources, diagnostics) = ring();
    let shown = render(
        &diagnostics,
        &sources,
        Style {
            color: true,
            ..Style::PLAIN
        },
    );
    assert!(
        !shown.contains("\u{1b}]8"),
        "no links: not every terminal shows them"
    );
    insta::assert_snapshot!(shown.replace('\u{1b}', "\\e"));
}

#[test]
fn plain_output_has_no_escapes() {
    for case in [missing_semicolon(), ring(), two_files()] {
        assert!(!human(case).contains('\u{1b}'));
    }
}

#[test]
fn ascii_terminals_get_ascii() {
    let (sources, diagnostics) = ring();
    let shown = render(
        &diagnostics,
        &sources,
        Style {
            unicode: false,
            ..Style::PLAIN
        },
    );
    assert!(shown.is_ascii(), "{shown}");
}

#[test]
fn without_a_place_the_message_stands_alone() {
    let diagnostic = Diagnostic::new(Code::RPI0003, "cannot read `cell.toml`: no such file")
        .help("name a file that exists");
    insta::assert_snapshot!(render(&[diagnostic], &SourceMap::new(), Style::PLAIN));
}

#[test]
fn a_fault_over_several_lines() {
    let (sources, file) = source("fig6.rpi", FIG6);
    let block = find(&sources, file, "let", 0).merge(find(&sources, file, "way.pose", 0));
    let diagnostic =
        Diagnostic::new(Code::RPI0004, "this block has no `tel`").primary(block, "opened here");
    insta::assert_snapshot!(render(&[diagnostic], &sources, Style::PLAIN));
}

/// Draws every range, inside and outside the text, of texts that are easy to handle wrongly.
#[test]
fn odd_texts_and_places_are_drawn_without_panic() {
    let texts = [
        "",
        "\n",
        "x",
        "x\n",
        "\u{feff}x",
        "a\r\nb\r\n",
        "\tä = 机器人;\n",
        "x\u{0}y\n\n\n",
    ];
    for text in texts {
        let limit = text.len() as u32 + 2;
        for start in 0..=limit {
            (0..=limit).for_each(|end| draw_everywhere(text, start, end));
        }
    }
}

fn draw_everywhere(text: &str, start: u32, end: u32) {
    let (sources, file) = source("odd.rpi", text);
    let span = Span::new(file, start, end);
    let diagnostic = Diagnostic::new(Code::RPI0001, "odd")
        .primary(span, "here")
        .secondary(Span::NONE, "nowhere")
        .secondary(Span::new(FileId(7), start, end), "no such file")
        .fix(Fix::sure("mend").replace(span, "\n"));
    for name in Format::names() {
        let format = name.parse().expect("a listed form");
        let shown = render_as(
            format,
            std::slice::from_ref(&diagnostic),
            &sources,
            Style::PLAIN,
        );
        assert!(shown.contains("RPI0001"), "{text:?} {span:?} {shown}");
        assert!(
            !shown.contains("Failed to read"),
            "{text:?} {span:?} {shown}"
        );
    }
}

#[test]
fn forms_for_machines() {
    let (sources, diagnostics) = missing_semicolon();
    let form = |format| render_as(format, &diagnostics, &sources, Style::PLAIN);
    insta::assert_snapshot!("short", form(Format::Short));
    insta::assert_snapshot!("github", form(Format::Github));
    insta::assert_snapshot!("json", form(Format::Json));
    insta::assert_snapshot!("sarif", form(Format::Sarif));
}

#[test]
fn no_findings_say_nothing_to_people_and_an_empty_list_to_machines() {
    let none = |format| render_as(format, &[], &SourceMap::new(), Style::PLAIN);
    assert_eq!(none(Format::Human), "");
    assert_eq!(none(Format::Short), "");
    assert_eq!(none(Format::Github), "");
    let json: serde_json::Value = serde_json::from_str(&none(Format::Json)).expect("valid JSON");
    assert_eq!(json["findings"].as_array().map(Vec::len), Some(0));
    let sarif: serde_json::Value = serde_json::from_str(&none(Format::Sarif)).expect("valid JSON");
    assert_eq!(
        sarif["runs"][0]["results"].as_array().map(Vec::len),
        Some(0)
    );
}

#[test]
fn unknown_forms_are_refused_with_the_known_ones() {
    let refusal = "xml"
        .parse::<Format>()
        .expect_err("no such form")
        .to_string();
    assert!(
        refusal.contains("human, short, json, sarif, github"),
        "{refusal}"
    );
}

#[test]
fn of_a_line_without_end_only_what_matters_is_shown() {
    let text = format!(
        "{}broken{}",
        "a = b; ".repeat(100_000),
        " c = d;".repeat(100_000)
    );
    let (sources, file) = source("net.rpinet", &text);
    let at = find(&sources, file, "broken", 0);
    let diagnostic = Diagnostic::new(Code::RPI0001, "expected an equation")
        .primary(at, "found this")
        .fix(Fix::maybe("leave it out").replace(at, ""));
    let shown = human((sources, vec![diagnostic]));
    assert!(shown.len() < 600, "{} bytes", shown.len());
    for part in [
        "a = b; broken c = d;",
        "^^^^^^ found this",
        "net.rpinet:1:700001",
        "leave it out",
    ] {
        assert!(shown.contains(part), "{part} in {shown}");
    }
}

#[test]
fn of_very_many_findings_the_first_are_shown() {
    let (sources, file) = source("a.rpi", "x");
    let diagnostic = Diagnostic::new(Code::RPI0001, "again").primary(Span::new(file, 0, 1), "here");
    let shown = human((sources, vec![diagnostic; 250]));
    assert_eq!(shown.matches("error RPI0001: again").count(), 100);
    assert!(shown.contains("and 150 more"), "{shown}");
    assert!(shown.contains("250 errors"), "{shown}");
}
