//! Entry points for program texts: lexer, parser and checker.

use rpi_diag::{FileId, Finding, Format, SourceMap, Style, apply, render_as, sure_edits};
use rpi_driver::{Claims, Input, Kind, compile, compile_node, lower_to_look, lower_to_run};
use rpi_image::Image;
use rpi_net::Net;
use rpi_syntax::{Mode, format, parse as parse_text, pieces};

/// First line that marks a text as Lustre; any other text is `.rpi`.
pub const LUSTRE: &str = "--.lus\n";

/// Folder that does not exist, so that imports can only resolve to the standard library.
const FOLDER: &str = "no-such-folder";

/// Period for which images are compiled, in ns: 1 ms.
const PERIOD_NS: u64 = 1_000_000;

fn text(input: &[u8]) -> (String, Mode) {
    let text = String::from_utf8_lossy(input).into_owned();
    let mode = match text.starts_with(LUSTRE) {
        true => Mode::Lustre,
        false => Mode::Rpi,
    };
    (text, mode)
}

/// Splits a text into tokens. They must be in order and lie within the text.
pub(crate) fn lex(input: &[u8]) {
    let (text, mode) = text(input);
    let mut end = 0;
    for piece in pieces(&text, mode) {
        assert!(end <= piece.range.start, "{piece:?} begins before {end}");
        assert!(text.get(piece.range.clone()).is_some(), "{piece:?}");
        end = piece.range.end;
    }
}

/// Parses and formats a text. Formatting the result again must not change it.
pub(crate) fn parse(input: &[u8]) {
    let (text, mode) = text(input);
    let mut sources = SourceMap::new();
    let file = sources.add("fuzz", text.as_str());
    let parse = parse_text(file, &text, mode);
    shown(&parse.findings, &sources);
    if let Ok(once) = format(&text, mode) {
        let twice = format(&once, mode);
        assert_eq!(twice.as_ref(), Ok(&once), "formatted again");
    }
}

/// Compiles a text as far as its errors allow: diagnostics, fixes, nets, images.
pub(crate) fn check(input: &[u8]) {
    let (text, mode) = text(input);
    let (ending, kind) = match mode {
        Mode::Lustre => ("lus", Kind::Lustre),
        Mode::Rpi => ("rpi", Kind::Rpi),
    };
    let input = Input {
        path: format!("{FOLDER}/fuzz.{ending}").into(),
        kind,
        bytes: text.into_bytes(),
    };
    let Ok(compiled) = compile(&input) else {
        return;
    };
    shown(&compiled.findings, &compiled.sources);
    fixed(&compiled.findings, &compiled.sources);
    compiled.nets().iter().for_each(lowered);
    if !compiled.has_errors()
        && let Ok(made) = compile_node(&input, None, Claims::Report, true)
    {
        shown(&made.findings, &made.sources);
        made.node.iter().for_each(|node| lowered(&node.net));
    }
}

/// Checks that diagnostics point into their texts and can be rendered.
pub(crate) fn shown(findings: &[Finding], sources: &SourceMap) {
    for finding in findings {
        for span in finding.labels.iter().map(|label| label.span) {
            let range = span.start as usize..span.end as usize;
            let place = sources.text(span.file).get(range);
            assert!(span.is_none() || place.is_some(), "{finding:?}");
        }
    }
    let style = Style::PLAIN;
    for form in [Format::Human, Format::Json] {
        render_as(form, findings, sources, style);
    }
}

fn fixed(findings: &[Finding], sources: &SourceMap) {
    let own = FileId(0);
    let edits = sure_edits(findings);
    let here = edits.iter().filter(|edit| edit.span.file == own);
    apply(sources.text(own), here);
}

/// Lowers a checked net. The resulting image must pass the verifier; lowering may return an error.
pub(crate) fn lowered(net: &Net) {
    for lower in [lower_to_run, lower_to_look] {
        if let Ok(image) = lower(net, PERIOD_NS) {
            verified(&image);
        }
    }
}

fn verified(image: &Image) {
    let found = rpi_image::verify(image, &rpi_core::catalogue);
    assert_eq!(found, Ok(()), "the compiler's image");
}
