//! Parser driver: lexes a file, splits it into declarations and parses each of them.

use crate::ast::{File, Item};
use crate::context::Context;
use crate::habits::NAMED;
use crate::lexer::{Lexed, Lexeme, lex_skipping};
use crate::lexical;
use crate::split::{Chunk, Head, split};
use crate::{Mode, Parse, mend, nesting, outside, with_stack};
use rpi_diag::{Code, FileId, Finding, Severity, Span};
use std::collections::BTreeSet;

/// Parses a whole file. Never fails and never panics: every text has a tree.
///
/// Text with a syntax error becomes a `Broken` node with the names that it seems to define. There is one diagnostic for
/// each independent error.
pub fn parse(file: FileId, text: &str, mode: Mode) -> Parse {
    parse_with_tokens(file, text, mode).0
}

/// Parses a whole file like [`parse`] and also returns its tokens.
pub(crate) fn parse_with_tokens(file: FileId, text: &str, mode: Mode) -> (Parse, Vec<Lexeme>) {
    let (lexed, items, found) = with_stack(|| understood(file, text, mode));
    let mut findings = once_for_each_call(text, lexed.findings);
    let gaps = Gaps::new(text, &findings);
    let found = found.into_iter();
    findings.extend(found.filter(|finding| !gaps.explain(finding)));
    findings.sort_by_key(|finding| finding.span());
    findings.dedup();
    let parse = Parse {
        file: File { items, mode },
        comments: lexed.comments,
        findings,
    };
    (parse, lexed.lexemes)
}

/// Merges the diagnostics about arguments named with a foreign operator: one per call, with the places of all of them.
fn once_for_each_call(text: &str, findings: Vec<Finding>) -> Vec<Finding> {
    let mut kept: Vec<Finding> = Vec::with_capacity(findings.len());
    for finding in findings {
        let span = finding.span();
        let is_named = |other: &Finding| other.message == NAMED;
        let same = kept.last_mut().filter(|last| {
            let end = last.labels.last().map_or(0, |label| label.span.end);
            let between = text.get(end as usize..span.start as usize);
            let is_one = between.is_some_and(|text| !text.contains([';', ')']));
            is_named(last) && is_named(&finding) && is_one
        });
        let Some(last) = same else {
            kept.push(finding);
            continue;
        };
        *last = last.clone().also(span, "and here");
        let edits = finding.fixes.into_iter().flat_map(|fix| fix.edits);
        if let Some(fix) = last.fixes.first_mut() {
            fix.edits.extend(edits);
        }
    }
    kept
}

/// Maximum number of parses of a file. In the last one, no contracts or properties in comments are parsed.
const MAX_ATTEMPTS: usize = 4;

/// Lexes and parses a file, with the contracts and properties in comments. Those with errors are treated as comments.
fn understood(file: FileId, text: &str, mode: Mode) -> (Lexed, Vec<Item>, Vec<Finding>) {
    let (mut skipped, mut attempt) = (BTreeSet::new(), 0);
    loop {
        let mut lexed = lex_skipping(file, text, mode, &skipped);
        let (items, found, foreign) = items(file, text, mode, &lexed);
        if !foreign.is_empty() {
            let is_sign = |code| matches!(code, Code::RPI0002 | Code::RPI0013 | Code::RPI0016);
            let is_told = |sign: &Finding| is_sign(sign.code) && lies_in(&foreign, sign);
            lexed.findings.retain(|sign| !is_told(sign));
        }
        let faults = lexed.findings.iter().chain(&found);
        let faults = faults.filter(|f| f.severity() == Severity::Error);
        let faults: Vec<Span> = faults.map(Finding::span).collect();
        attempt += 1;
        let is_strange = |claim: &&Span| match attempt < MAX_ATTEMPTS {
            true => {
                (faults.iter()).any(|fault| claim.start <= fault.start && fault.end <= claim.end)
            }
            false => !faults.is_empty(),
        };
        let strange = lexed.claims.iter().filter(is_strange);
        let strange: Vec<u32> = strange.map(|claim| claim.start).collect();
        if strange.is_empty() {
            return (lexed, items, found);
        }
        skipped.extend(strange);
    }
}

/// Returns whether a diagnostic lies in one of the spans, which are in text order.
fn lies_in(places: &[Span], finding: &Finding) -> bool {
    let at = finding.span();
    let after = places.partition_point(|place| place.start <= at.start);
    let place = after.checked_sub(1).map(|i| places[i]);
    place.is_some_and(|place| at.end <= place.end)
}

/// Parts of the text that form no complete token: unknown characters, unterminated comments and strings.
struct Gaps<'t> {
    text: &'t str,
    /// Spans of the gaps, in text order.
    spans: Vec<Span>,
}

impl Gaps<'_> {
    fn new<'t>(text: &'t str, findings: &[Finding]) -> Gaps<'t> {
        let unread = |code| matches!(code, Code::RPI0002 | Code::RPI0003 | Code::RPI0005);
        let found = findings.iter().filter(|finding| unread(finding.code));
        let spans = found.map(Finding::span).collect();
        Gaps { text, spans }
    }

    /// Returns whether a label of the diagnostic lies next to a gap, whose own diagnostic explains the error.
    fn explain(&self, finding: &Finding) -> bool {
        let mut places = finding.labels.iter().map(|label| label.span);
        !self.spans.is_empty() && places.any(|place| self.beside(place))
    }

    fn beside(&self, place: Span) -> bool {
        let after = self.spans.partition_point(|gap| gap.start < place.end);
        let next = self.spans.get(after);
        let previous = after.checked_sub(1).map(|i| self.spans[i]);
        next.is_some_and(|gap| self.is_blank(place.end, gap.start))
            || previous.is_some_and(|gap| self.is_blank(gap.end, place.start))
    }

    fn is_blank(&self, from: u32, to: u32) -> bool {
        let between = self.text.get(from as usize..to as usize);
        between.is_some_and(|between| between.trim().is_empty())
    }
}

/// Maximum number of errors reported for one file.
const MAX_FAULTS: usize = 10_000;

fn items(
    file: FileId,
    text: &str,
    mode: Mode,
    lexed: &Lexed,
) -> (Vec<Item>, Vec<Finding>, Vec<Span>) {
    let cx = Context::new(file, text, mode, lexed);
    let mut findings = Vec::new();
    let mut items = Vec::new();
    for chunk in split(text, &lexed.lexemes, mode) {
        if findings.len() > MAX_FAULTS {
            let next = lexed.lexemes[chunk.range.start];
            findings.push(lexical::too_many_faults(cx.span(next.start, next.end)));
            break;
        }
        items.extend(item(&cx, &chunk, lexed, &mut findings));
    }
    (items, findings, cx.foreign_statements())
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
            findings.extend(outside::misspelt(cx, lexemes[0], word));
            let mut lexemes = lexemes.to_vec();
            let is_foreign = outside::foreign(cx.slice(lexemes[0].start, lexemes[0].end)).is_some();
            lexemes[0].token = word;
            let told = findings.len();
            let item = mend::item(cx, &lexemes, findings);
            if is_foreign && findings.len() > told {
                // The rest of the declaration is in the other language, too: replacing the keyword does not fix it.
                findings.truncate(told);
                let last = lexemes[lexemes.len() - 1];
                cx.swallow_signs(cx.span(lexemes[0].start, last.end));
                findings
                    .last_mut()
                    .into_iter()
                    .for_each(|f| f.fixes.clear());
                return Some(mend::broken_item(cx, &lexemes));
            }
            Some(item)
        }
        Head::Stray if outside::is_bare_type(lexemes) => {
            Some(outside::bare_type(cx, lexemes, findings))
        }
        Head::Misspelt(None) | Head::Stray => {
            let before = chunk.range.start.checked_sub(1).map(|i| lexed.lexemes[i]);
            findings.push(outside::stray(cx, before, lexemes));
            outside::declared(cx, lexemes)
        }
        Head::Package => {
            findings.push(outside::package(cx, lexemes[0]));
            None
        }
    }
}
