//! Texts: lexer, parser, checker.

use rpi_diag::{FileId, Finding, Format, SourceMap, Style, apply, render_as, sure_edits};
use rpi_driver::{Claims, Input, Kind, compile, compile_node, lower_to_look, lower_to_run};
use rpi_image::Image;
use rpi_net::Net;
use rpi_syntax::{Mode, format, parse as parse_text, pieces};

/// A text that begins with this line is Lustre, any other is `.rpi`.
pub const LUSTRE: &str = "--.lus\n";

/// A folder that does not exist: what a text uses comes from the standard library alone.
const FOLDER: &str = "no-such-folder";

/// The period that images are made for, 1 ms.
const PERIOD_NS: u64 = 1_000_000;

fn text(input: &[u8]) -> (String, Mode) {
    let text = String::from_utf8_lossy(input).into_owned();
    let mode = match text.starts_with(LUSTRE) {
        true => Mode::Lustre,
        false => Mode::Rpi,
    };
    (text, mode)
}

/// Cuts a text into pieces: they lie in it one after the other.
pub(crate) fn lex(input: &[u8]) {
    let (text, mode) = text(input);
    let mut end = 0;
    for piece in pieces(&text, mode) {
        assert!(end <= piece.range.start, "{piece:?} begins before {end}");
        assert!(text.get(piece.range.clone()).is_some(), "{piece:?}");
        end = piece.range.end;
    }
}

/// Parses and formats a text: what the formatter gives is a program too, and its own form.
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

/// Takes a text as far as its faults allow: findings, fixes, nets, images.
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

/// Findings point into their texts and can be shown.
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

/// A checked net makes an image that verifies, or says why there is none.
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
