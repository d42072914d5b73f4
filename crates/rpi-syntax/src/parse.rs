//! Parser driver: lexes a file, splits it into declarations and parses each of them.

use crate::ast::{File, Item};
use crate::context::ParseContext;
use crate::guessed_names::GuessedNames;
use crate::lexer::{LexOutput, Lexeme, LexicalError, LexicalErrorKind, lex_skipping};
use crate::lexical_errors;
use crate::split::{Chunk, ChunkKind, split};
use crate::{Dialect, Parse, nesting, recover, stray_tokens, with_large_stack};
use rpi_diag::{Diagnostic, FileId, Severity, Span};
use std::collections::BTreeSet;

/// Parses a whole file. The function never fails and never panics: every text has a syntax tree.
///
/// Text with a syntax error becomes an error node with the names that it seems to define. There is one diagnostic for
/// each independent error.
pub fn parse(file: FileId, text: &str, mode: Dialect) -> Parse {
    parse_with_tokens(file, text, mode).0
}

/// Parses a whole file like [`parse`] and also returns its tokens.
pub(crate) fn parse_with_tokens(file: FileId, text: &str, mode: Dialect) -> (Parse, Vec<Lexeme>) {
    parse_with_names(file, text, mode, &GuessedNames::new(text))
}

/// Parses a text like [`parse_with_tokens`]. `guessed_names` are those of the whole file, of which `text` may be a part.
pub(crate) fn parse_with_names(
    file: FileId,
    text: &str,
    mode: Dialect,
    guessed_names: &GuessedNames<'_>,
) -> (Parse, Vec<Lexeme>) {
    let (lexed, items, found) =
        with_large_stack(|| parse_with_claims(file, text, mode, guessed_names));
    let gaps = LexicalGaps::new(text, &lexed.errors);
    let mut diagnostics = merge_per_call(text, lexed.errors);
    let found = found.into_iter();
    diagnostics.extend(found.filter(|diagnostic| !gaps.explains(diagnostic)));
    diagnostics.sort_by_key(|diagnostic| diagnostic.span());
    diagnostics.dedup();
    let parse = Parse {
        file: File {
            items,
            dialect: mode,
        },
        comments: lexed.comments,
        diagnostics,
    };
    (parse, lexed.lexemes)
}

/// Returns the diagnostics of the lexer's errors. Diagnostics about named arguments of one call are merged into one
/// with all places.
fn merge_per_call(text: &str, errors: Vec<LexicalError>) -> Vec<Diagnostic> {
    let mut merged: Vec<LexicalError> = Vec::with_capacity(errors.len());
    for error in errors {
        let LexicalError { kind, diagnostic } = &error;
        let span = diagnostic.span();
        let same_call = merged.last_mut().filter(|last| {
            let end = last.diagnostic.labels.last();
            let end = end.map_or(0, |label| label.span.end);
            let between = text.get(end as usize..span.start as usize);
            [last.kind, *kind] == [LexicalErrorKind::NamedArgument; 2]
                && between.is_some_and(|text| !text.contains([';', ')']))
        });
        let Some(LexicalError {
            diagnostic: last, ..
        }) = same_call
        else {
            merged.push(error);
            continue;
        };
        *last = last.clone().secondary(span, "and here");
        let edits = error.diagnostic.fixes.into_iter().flat_map(|fix| fix.edits);
        if let Some(fix) = last.fixes.first_mut() {
            fix.edits.extend(edits);
        }
    }
    merged.into_iter().map(|error| error.diagnostic).collect()
}

/// Maximum number of parses of one file. In the last one, no contracts and properties in comments are read.
const MAX_ATTEMPTS: usize = 4;

/// Splits a file into tokens and parses it, with the contracts and properties in comments. Contracts and properties
/// with errors are treated as comments, and the file is parsed again.
fn parse_with_claims(
    file: FileId,
    text: &str,
    mode: Dialect,
    guessed_names: &GuessedNames<'_>,
) -> (LexOutput, Vec<Item>, Vec<Diagnostic>) {
    let (mut skipped, mut attempt) = (BTreeSet::new(), 0);
    loop {
        let mut lexed = lex_skipping(file, text, mode, &skipped, guessed_names);
        let cx = ParseContext::new(file, text, mode, &lexed, guessed_names);
        let (items, found) = parse_items(&cx, &lexed);
        let foreign = cx.into_foreign_statements();
        let errors = std::mem::take(&mut lexed.errors).into_iter();
        lexed.errors = errors
            .filter(|error| !is_explained(&foreign, error))
            .collect();
        let errors = lexed.errors.iter().map(|error| &error.diagnostic);
        let errors = errors.chain(&found);
        let errors = errors.filter(|f| f.severity() == Severity::Error);
        let errors: Vec<Span> = errors.map(Diagnostic::span).collect();
        attempt += 1;
        let has_error = |claim: &&Span| match attempt < MAX_ATTEMPTS {
            true => {
                (errors.iter()).any(|error| claim.start <= error.start && error.end <= claim.end)
            }
            false => !errors.is_empty(),
        };
        let rejected = lexed.lexed_comments.iter().filter(has_error);
        let rejected: Vec<u32> = rejected.map(|claim| claim.start).collect();
        if rejected.is_empty() {
            return (lexed, items, found);
        }
        skipped.extend(rejected);
    }
}

/// Returns whether an error of the lexer needs no diagnostic, because it lies in a reported statement of another
/// language. `places` are these statements in text order.
fn is_explained(places: &[Span], error: &LexicalError) -> bool {
    if !error.kind.is_explained_by_foreign_statement() {
        return false;
    }
    let at = error.diagnostic.span();
    let after = places.partition_point(|place| place.start <= at.start);
    let place = after.checked_sub(1).map(|i| places[i]);
    place.is_some_and(|place| at.end <= place.end)
}

/// Parts of the text that are missing from the tokens: unknown characters, and comments and strings without an end.
struct LexicalGaps<'t> {
    text: &'t str,
    /// Spans of the missing parts, in text order.
    spans: Vec<Span>,
}

impl LexicalGaps<'_> {
    fn new<'t>(text: &'t str, errors: &[LexicalError]) -> LexicalGaps<'t> {
        let gaps = errors.iter().filter(|error| error.kind.leaves_gap());
        let spans = gaps.map(|error| error.diagnostic.span()).collect();
        LexicalGaps { text, spans }
    }

    /// Returns whether a label of the diagnostic lies next to a part that is missing from the tokens. That part's own
    /// diagnostic then explains the error.
    fn explains(&self, diagnostic: &Diagnostic) -> bool {
        let mut places = diagnostic.labels.iter().map(|label| label.span);
        !self.spans.is_empty() && places.any(|place| self.is_beside_gap(place))
    }

    fn is_beside_gap(&self, place: Span) -> bool {
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

/// Maximum number of errors reported for one file. Text after that is not parsed.
const MAX_ERRORS: usize = 10_000;

fn parse_items(cx: &ParseContext<'_>, lexed: &LexOutput) -> (Vec<Item>, Vec<Diagnostic>) {
    let mut diagnostics = Vec::new();
    let mut items = Vec::new();
    for chunk in split(cx.text, &lexed.lexemes, cx.dialect) {
        if diagnostics.len() > MAX_ERRORS {
            let next = lexed.lexemes[chunk.range.start];
            diagnostics.push(lexical_errors::too_many_errors(
                cx.span(next.start, next.end),
            ));
            break;
        }
        items.extend(parse_item(cx, &chunk, lexed, &mut diagnostics));
    }
    (items, diagnostics)
}

fn parse_item(
    cx: &ParseContext<'_>,
    chunk: &Chunk,
    lexed: &LexOutput,
    diagnostics: &mut Vec<Diagnostic>,
) -> Option<Item> {
    let lexemes = &lexed.lexemes[chunk.range.clone()];
    if let Some(deep) = nesting::too_deep(cx, lexemes) {
        diagnostics.push(deep);
        return Some(recover::broken_item(cx, lexemes));
    }
    match chunk.kind {
        ChunkKind::Declaration => Some(recover::parse_item(cx, lexemes, diagnostics)),
        ChunkKind::Misspelt(Some(word)) => {
            diagnostics.extend(stray_tokens::misspelt_keyword(cx, lexemes[0], word));
            let mut lexemes = lexemes.to_vec();
            let is_foreign =
                stray_tokens::corresponding_keyword(cx.slice(lexemes[0].start, lexemes[0].end))
                    .is_some();
            lexemes[0].token = word;
            let mut rest = Vec::new();
            let item = recover::parse_item(cx, &lexemes, &mut rest);
            if is_foreign && !rest.is_empty() {
                // The rest of the declaration is in the other language, too: replacing the keyword does not fix it.
                let last = lexemes[lexemes.len() - 1];
                cx.suppress_foreign_operators(cx.span(lexemes[0].start, last.end));
                diagnostics
                    .last_mut()
                    .into_iter()
                    .for_each(|f| f.fixes.clear());
                return Some(recover::broken_item(cx, &lexemes));
            }
            diagnostics.append(&mut rest);
            Some(item)
        }
        ChunkKind::Stray if stray_tokens::is_type_without_keyword(lexemes) => Some(
            stray_tokens::parse_type_without_keyword(cx, lexemes, diagnostics),
        ),
        ChunkKind::Misspelt(None) | ChunkKind::Stray => {
            let before = chunk.range.start.checked_sub(1).map(|i| lexed.lexemes[i]);
            diagnostics.push(stray_tokens::stray_tokens(cx, before, lexemes));
            stray_tokens::c_declaration(cx, lexemes)
        }
        ChunkKind::Package => {
            diagnostics.push(stray_tokens::unsupported_package(cx, lexemes[0]));
            None
        }
    }
}
