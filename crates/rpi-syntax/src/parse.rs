//! From text to tree: lex, split into declarations, parse each.

use crate::ast::{File, Item};
use crate::context::Context;
use crate::lexer::{Lexed, lex};
use crate::split::{Chunk, Head, split};
use crate::{Mode, Parse, mend, nesting, outside};
use rpi_diag::{Code, FileId, Finding, Span};

/// Parses a whole file. Never fails and never panics: every text has a tree.
///
/// What has a fault becomes a `Broken` node with the names that it seems to define; the findings say
/// why, one for each independent fault.
pub fn parse(file: FileId, text: &str, mode: Mode) -> Parse {
    let lexed = lex(file, text, mode);
    let (items, found) = items(file, text, mode, &lexed);
    let mut findings = lexed.findings;
    let (unread, found) = (unread(&findings), found.into_iter());
    findings.extend(found.filter(|finding| !follows_from(&unread, finding, text)));
    findings.sort_by_key(|finding| finding.span());
    Parse {
        file: File { items },
        comments: lexed.comments,
        findings,
    }
}

/// What no token was made of: unknown characters, and a comment that runs to the end of the file.
fn unread(findings: &[Finding]) -> Vec<Span> {
    let unread = |code| matches!(code, Code::RPI0002 | Code::RPI0003);
    let found = findings.iter().filter(|finding| unread(finding.code));
    found.map(Finding::span).collect()
}

/// Whether what does not fit stands right beside what was not read: one fault, one message.
fn follows_from(unread: &[Span], finding: &Finding, text: &str) -> bool {
    let blank = |from: u32, to: u32| {
        let between = text.get(from as usize..to as usize);
        between.is_some_and(|between| between.trim().is_empty())
    };
    unread.iter().any(|gap| {
        let mut places = finding.labels.iter().map(|label| label.span);
        places.any(|place| blank(gap.end, place.start) || blank(place.end, gap.start))
    })
}

fn items(file: FileId, text: &str, mode: Mode, lexed: &Lexed) -> (Vec<Item>, Vec<Finding>) {
    let cx = Context::new(file, text, mode, lexed);
    let mut findings = Vec::new();
    let mut items = Vec::new();
    for chunk in split(text, &lexed.lexemes, mode) {
        items.extend(item(&cx, &chunk, lexed, &mut findings));
    }
    (items, findings)
}

fn item(
    cx: &Context<'_>,
    chunk: &Chunk,
    lexed: &Lexed,
    findings: &mut Vec<Finding>,
) -> Option<Item> {
    let lexemes = &lexed.lexemes[chunk.range.clone()];
    if let Some(deep) = nesting::too_deep(cx, lexemes) {
        findings.push(deep);
        return Some(mend::broken_item(cx, lexemes));
    }
    match chunk.head {
        Head::Declaration => Some(mend::item(cx, lexemes, findings)),
        Head::Misspelt(Some(word)) => {
            findings.push(outside::misspelt(cx, lexemes[0], word));
            let mut lexemes = lexemes.to_vec();
            lexemes[0].token = word;
            Some(mend::item(cx, &lexemes, findings))
        }
        Head::Misspelt(None) | Head::Stray => {
            findings.push(outside::stray(cx, lexemes));
            None
        }
    }
}
