//! Entry points for program texts: lexer, parser and checker.

use rpi_diag::{Diagnostic, FileId, Format, SourceMap, Style, apply, render_as, sure_edits};
use rpi_driver::{
    AnalysedNet, ClaimPolicy, Input, InputKind, compile, compile_node, lower_for_execution,
    lower_for_observation,
};
use rpi_image::Image;
use rpi_syntax::{Dialect, format, parse as parse_text, source_tokens};

/// First line that marks an input as a Lustre program. Any other input is an RPI program.
pub const LUSTRE: &str = "--.lus\n";

/// Folder of the programs that the checker gets. It does not exist, so that a `use` finds only the standard library.
const FOLDER: &str = "no-such-folder";

/// Period for which images are compiled, in nanoseconds: 1 ms.
const PERIOD_NS: u64 = 1_000_000;

fn text(input: &[u8]) -> (String, Dialect) {
    let text = String::from_utf8_lossy(input).into_owned();
    let mode = match text.starts_with(LUSTRE) {
        true => Dialect::Lustre,
        false => Dialect::Rpi,
    };
    (text, mode)
}

/// Entry point of the fuzzer for the lexer: splits a text into tokens, which must be in order and lie within the text.
pub(crate) fn lex(input: &[u8]) {
    let (text, mode) = text(input);
    let mut end = 0;
    for piece in source_tokens(&text, mode) {
        assert!(end <= piece.range.start, "{piece:?} begins before {end}");
        assert!(text.get(piece.range.clone()).is_some(), "{piece:?}");
        end = piece.range.end;
    }
}

/// Entry point of the fuzzer for the parser: parses and formats a text. Formatting the result again must not change it.
pub(crate) fn parse(input: &[u8]) {
    let (text, mode) = text(input);
    let mut sources = SourceMap::new();
    let file = sources.add("fuzz", text.as_str());
    let parse = parse_text(file, &text, mode);
    check_rendering(&parse.diagnostics, &sources);
    if let Ok(once) = format(&text, mode) {
        let twice = format(&once, mode);
        assert_eq!(twice.as_ref(), Ok(&once), "formatted again");
    }
}

/// Entry point of the fuzzer for the checker: compiles a text as far as its errors allow, with diagnostics, fixes, nets
/// and images.
pub(crate) fn check(input: &[u8]) {
    let (text, mode) = text(input);
    let (ending, kind) = match mode {
        Dialect::Lustre => ("lus", InputKind::Lustre),
        Dialect::Rpi => ("rpi", InputKind::Rpi),
    };
    let input = Input {
        path: format!("{FOLDER}/fuzz.{ending}").into(),
        kind,
        bytes: text.into_bytes(),
    };
    let Ok(compiled) = compile(&input) else {
        return;
    };
    check_rendering(&compiled.diagnostics, &compiled.sources);
    check_fixes(&compiled.diagnostics, &compiled.sources);
    compiled.nets().iter().for_each(check_lowering);
    if !compiled.has_errors()
        && let Ok(made) = compile_node(&input, None, ClaimPolicy::Report, true)
    {
        check_rendering(&made.diagnostics, &made.sources);
        made.node.iter().for_each(|node| check_lowering(&node.net));
    }
}

/// Checks that diagnostics point into their texts and can be rendered. Panics if they do not.
pub(crate) fn check_rendering(diagnostics: &[Diagnostic], sources: &SourceMap) {
    for diagnostic in diagnostics {
        for span in diagnostic.labels.iter().map(|label| label.span) {
            let range = span.start as usize..span.end as usize;
            let place = sources.text(span.file).get(range);
            assert!(span.is_none() || place.is_some(), "{diagnostic:?}");
        }
    }
    let style = Style::PLAIN;
    for form in [Format::Human, Format::Json] {
        render_as(form, diagnostics, sources, style);
    }
}

fn check_fixes(diagnostics: &[Diagnostic], sources: &SourceMap) {
    let own = FileId(0);
    let edits = sure_edits(diagnostics);
    let here = edits.iter().filter(|edit| edit.span.file == own);
    apply(sources.text(own), here);
}

/// Lowers a checked net to images, each of which must pass the verifier. Lowering may return an error instead.
pub(crate) fn check_lowering(net: &AnalysedNet) {
    for lower in [lower_for_execution, lower_for_observation] {
        if let Ok(image) = lower(net, PERIOD_NS) {
            check_image(&image);
        }
    }
}

fn check_image(image: &Image) {
    let found = rpi_image::verify(image, &rpi_core::prim_desc);
    assert_eq!(found, Ok(()), "the compiler's image");
}
