//! Examples and links in doc comments.
//!
//! An example is a block fenced by ```` ```rpi ````. It is a separate program that imports the surrounding module
//! implicitly. A link is a name in brackets and backquotes, ``[`lowpass`]``.

use std::borrow::Borrow;
use std::ops::Range;

use rpi_diag::{Code, Diagnostic, SourceMap, Span};
use rpi_sema::query::Index;
use rpi_syntax::{CommentKind, Dialect, SourceTokenKind, source_tokens};

/// Line of a doc comment: the byte range of its text in the file, after `--|` and one space.
type Line = Range<usize>;

/// Returns the doc comments of a program text in the language `mode`, each as the byte ranges of its consecutive lines.
#[must_use]
pub fn doc_blocks(text: &str, mode: Dialect) -> Vec<Vec<Range<usize>>> {
    let mut blocks: Vec<Vec<Line>> = Vec::new();
    let mut end = 0;
    for piece in source_tokens(text, mode) {
        if piece.kind != SourceTokenKind::Comment(CommentKind::Doc) {
            continue;
        }
        let begin = piece.range.start + "--|".len();
        let line = &text[begin..piece.range.end];
        let shift = usize::from(line.starts_with(' '));
        let body = begin + shift..begin + shift + line[shift..].trim_end().len();
        let gap = &text[end..piece.range.start];
        match blocks.last_mut() {
            Some(block) if gap.trim().is_empty() && gap.matches('\n').count() <= 1 => {
                block.push(body);
            }
            _ => blocks.push(vec![body]),
        }
        end = piece.range.end;
    }
    blocks
}

/// Returns the examples in the doc comments of a program text in the language `mode`, each as the byte ranges of its
/// lines.
#[must_use]
pub fn examples(text: &str, mode: Dialect) -> Vec<Vec<Range<usize>>> {
    let mut found = Vec::new();
    for block in doc_blocks(text, mode) {
        let mut open: Option<(bool, Vec<Line>)> = None;
        for line in block {
            let info = text[line.clone()].trim_start().strip_prefix("```");
            match (open.take(), info) {
                (None, Some(info)) => open = Some((info.trim() == "rpi", Vec::new())),
                (None, None) => {}
                (Some((true, lines)), Some(_)) => found.push(lines),
                (Some((false, _)), Some(_)) => {}
                (Some((wanted, mut lines)), None) => {
                    lines.push(line);
                    open = Some((wanted, lines));
                }
            }
        }
    }
    found
}

/// Returns a text of the same length in which everything but the example with these lines is blank, so that locations
/// in the example are locations in the original text.
#[must_use]
pub(crate) fn example_text(text: &str, lines: &[Range<usize>]) -> String {
    let mut out = String::with_capacity(text.len());
    let mut at = 0;
    for line in lines {
        out.extend(text[at..line.start].bytes().map(blank));
        out.push_str(&text[line.clone()]);
        at = line.end;
    }
    out.extend(text[at..].bytes().map(blank));
    out
}

fn blank(byte: u8) -> char {
    if byte == b'\n' { '\n' } else { ' ' }
}

/// Returns the names to which a doc comment links, written in brackets and backquotes, with their byte ranges. Links in
/// fenced blocks are ignored.
pub fn doc_links(doc: &str) -> impl Iterator<Item = (Range<usize>, &str)> {
    let mut start = 0;
    let mut fenced = false;
    let lines = doc.split_inclusive('\n').filter_map(move |line| {
        let at = start;
        start += line.len();
        let fence = line.trim_start().starts_with("```");
        fenced ^= fence;
        (!fence && !fenced).then_some((at, line))
    });
    lines.flat_map(|(at, line)| {
        line.match_indices("[`").filter_map(move |(from, _)| {
            let rest = &line[from + 2..];
            let name = &rest[..rest.find("`]")?];
            let begin = at + from + 2;
            (!name.contains('`')).then(|| (begin..begin + name.len(), name))
        })
    })
}

/// Returns a diagnostic for each link in the doc comments of the first file whose name is undefined. `index` computes
/// the index of all definitions, if the file has links.
pub(crate) fn broken_links<I: Borrow<Index>>(
    sources: &SourceMap,
    mode: Dialect,
    index: impl FnOnce() -> I,
) -> Vec<Diagnostic> {
    let Some(file) = sources.files().next() else {
        return Vec::new();
    };
    let text = sources.text(file);
    if !text.contains("[`") {
        return Vec::new();
    }
    let index = index();
    let index = index.borrow();
    let (mut diagnostics, mut budget) = (Vec::new(), SUGGESTION_BUDGET);
    for line in doc_blocks(text, mode).into_iter().flatten() {
        for (range, name) in doc_links(&text[line.clone()]) {
            let offset = |at: usize| u32::try_from(line.start + at).unwrap_or(u32::MAX);
            let span = Span::new(file, offset(range.start), offset(range.end));
            if index.resolve_path(file, span.start, name).is_none() {
                diagnostics.push(broken_link(index, span, name, &mut budget));
            }
        }
    }
    diagnostics
}

/// Maximum number of names that are compared for "did you mean" suggestions, summed over all undefined links. The limit
/// bounds the time for a text with many of them.
const SUGGESTION_BUDGET: usize = 200_000;

fn broken_link(index: &Index, span: Span, name: &str, budget: &mut usize) -> Diagnostic {
    let diagnostic = Diagnostic::new(Code::RPI1201, format!("undefined name `{name}` in a link"))
        .primary(span, "not in scope here");
    let visible = match *budget {
        0 => Vec::new(),
        _ => index.visible(span.file, span.start),
    };
    *budget = budget.saturating_sub(visible.len());
    let names = visible.iter().map(|id| index.def(*id).name.as_str());
    match rpi_diag::suggest(name, names) {
        Some(near) => diagnostic
            .fix(rpi_diag::Fix::maybe(format!("did you mean `{near}`?")).replace(span, near)),
        None => diagnostic
            .help("correct the name, or omit the brackets for a name without a declaration"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "--| Half. See [`whole`].\n--| ```rpi\n--| const a: int = 1;\n--| ```\n\nconst b: int = 2;\n--| ```text\n--| [`x`]\n--| ```\nconst c: int = 3;\n";

    #[test]
    fn examples_stand_where_they_stand() {
        let all = examples(TEXT, Dialect::Rpi);
        assert_eq!(all.len(), 1);
        let text = example_text(TEXT, &all[0]);
        assert_eq!(text.len(), TEXT.len());
        assert_eq!(text.trim(), "const a: int = 1;");
        assert_eq!(text.find("const a"), TEXT.find("const a"));
    }

    #[test]
    fn links_are_names_in_brackets_and_quotes_outside_of_fences() {
        let doc = "a [`b`] [c] `d`\n```\n[`e`]\n```\n[`f.g`]";
        let names: Vec<&str> = doc_links(doc).map(|(_, name)| name).collect();
        assert_eq!(names, ["b", "f.g"]);
        let (range, name) = doc_links(doc).last().unwrap();
        assert_eq!(&doc[range], name);
    }

    #[test]
    fn blocks_end_at_empty_lines() {
        assert_eq!(doc_blocks(TEXT, Dialect::Rpi).len(), 2);
    }
}
