//! Semantic tokens: the colour of each word by its meaning, for a whole document, a range, or as changes.

use lsp_types::{
    SemanticToken, SemanticTokenModifier, SemanticTokenType, SemanticTokens, SemanticTokensDelta,
    SemanticTokensDeltaParams, SemanticTokensEdit, SemanticTokensFullDeltaResult,
    SemanticTokensFullOptions, SemanticTokensLegend, SemanticTokensOptions, SemanticTokensParams,
    SemanticTokensRangeParams,
};
use rpi_diag::{FileId, Span};
use rpi_driver::Inspection;
use rpi_prims::PrimId;
use rpi_sema::query::{DefKind, Reference, builtin};
use rpi_sema::units::is_unit;
use rpi_syntax::{CommentKind, SourceToken, SourceTokenKind, source_tokens};

use crate::builtin_documents::is_builtin;
use crate::highlights::written_names;
use crate::line_index::LineIndex;
use crate::uri;
use crate::workspace::Workspace;

/// Types of tokens in the order of their numbers in the protocol.
const TYPES: &[SemanticTokenType] = &[
    SemanticTokenType::NAMESPACE,
    SemanticTokenType::TYPE,
    SemanticTokenType::ENUM_MEMBER,
    SemanticTokenType::PROPERTY,
    SemanticTokenType::FUNCTION,
    SemanticTokenType::CLASS,
    SemanticTokenType::INTERFACE,
    SemanticTokenType::EVENT,
    SemanticTokenType::PARAMETER,
    SemanticTokenType::VARIABLE,
    SemanticTokenType::KEYWORD,
    SemanticTokenType::OPERATOR,
    SemanticTokenType::NUMBER,
    SemanticTokenType::STRING,
    SemanticTokenType::COMMENT,
    UNIT,
];

/// Type of the token of a unit of measure, which the protocol does not predefine.
const UNIT: SemanticTokenType = SemanticTokenType::new("unit");

/// Modifiers of tokens in the order of their bits in the protocol.
const MODIFIERS: &[SemanticTokenModifier] = &[
    SemanticTokenModifier::DECLARATION,
    SemanticTokenModifier::READONLY,
    SemanticTokenModifier::MODIFICATION,
    SemanticTokenModifier::DOCUMENTATION,
    SemanticTokenModifier::DEFAULT_LIBRARY,
];

/// Kinds of definitions, each with the type of its tokens. Definitions of other kinds are variables.
const DEF_TYPES: &[(DefKind, SemanticTokenType)] = &[
    (DefKind::Module, SemanticTokenType::NAMESPACE),
    (DefKind::Block, SemanticTokenType::NAMESPACE),
    (DefKind::State, SemanticTokenType::NAMESPACE),
    (DefKind::Type, SemanticTokenType::TYPE),
    (DefKind::EnumValue, SemanticTokenType::ENUM_MEMBER),
    (DefKind::Field, SemanticTokenType::PROPERTY),
    (DefKind::Port, SemanticTokenType::PROPERTY),
    (DefKind::Output, SemanticTokenType::PROPERTY),
    (DefKind::Node, SemanticTokenType::FUNCTION),
    (DefKind::Function, SemanticTokenType::FUNCTION),
    (DefKind::Fragment, SemanticTokenType::FUNCTION),
    (DefKind::Primitive, SemanticTokenType::FUNCTION),
    (DefKind::Command, SemanticTokenType::CLASS),
    (DefKind::Task, SemanticTokenType::CLASS),
    (DefKind::Test, SemanticTokenType::STRING),
    (DefKind::Device, SemanticTokenType::INTERFACE),
    (DefKind::Result, SemanticTokenType::EVENT),
    (DefKind::Step, SemanticTokenType::EVENT),
    (DefKind::StaticParam, SemanticTokenType::PARAMETER),
    (DefKind::Param, SemanticTokenType::PARAMETER),
    (DefKind::Input, SemanticTokenType::PARAMETER),
    (DefKind::TakenOver, SemanticTokenType::PARAMETER),
];

/// Kinds of definitions whose value is fixed when the program is loaded.
const FIXED: &[DefKind] = &[DefKind::Const, DefKind::StaticParam, DefKind::EnumValue];

/// Tokens that a client has received, with their number.
#[derive(Clone, Debug)]
pub(crate) struct SentTokens {
    id: u64,
    tokens: Vec<SemanticToken>,
}

/// Returns the options of the server: types and modifiers, and the supported requests.
pub(crate) fn options() -> SemanticTokensOptions {
    SemanticTokensOptions {
        legend: SemanticTokensLegend {
            token_types: TYPES.to_vec(),
            token_modifiers: MODIFIERS.to_vec(),
        },
        range: Some(true),
        full: Some(SemanticTokensFullOptions::Delta { delta: Some(true) }),
        ..SemanticTokensOptions::default()
    }
}

/// Handles `textDocument/semanticTokens/full`: returns the tokens of a document; `None` if it is not open.
pub(crate) fn full(world: &mut Workspace, params: SemanticTokensParams) -> Option<SemanticTokens> {
    let seen = world.analysis(&params.text_document.uri)?;
    let tokens = encode(world, &seen, tokens(&seen));
    let id = remember(world, &params.text_document.uri, tokens.clone());
    Some(SemanticTokens {
        result_id: Some(id),
        data: tokens,
    })
}

/// Handles `textDocument/semanticTokens/range`: returns the tokens of a range of a document; `None` if it is not open.
pub(crate) fn range(
    world: &mut Workspace,
    params: SemanticTokensRangeParams,
) -> Option<SemanticTokens> {
    let seen = world.analysis(&params.text_document.uri)?;
    let places = world.locations(&seen);
    let (start, end) = (
        places.offset(params.range.start),
        places.offset(params.range.end),
    );
    let mut all = tokens(&seen);
    all.retain(|token| token.span.end > start && token.span.start < end);
    Some(SemanticTokens {
        result_id: None,
        data: encode(world, &seen, all),
    })
}

/// Handles `textDocument/semanticTokens/full/delta`: returns the changes since the tokens that the client names, or all
/// tokens if they are not known. Returns `None` if the document is not open.
pub(crate) fn delta(
    world: &mut Workspace,
    params: SemanticTokensDeltaParams,
) -> Option<SemanticTokensFullDeltaResult> {
    let uri = &params.text_document.uri;
    let seen = world.analysis(uri)?;
    let new = encode(world, &seen, tokens(&seen));
    let old = world.sent_tokens.get(&uri::to_path(uri)).cloned();
    let result_id = Some(remember(world, uri, new.clone()));
    let old = old.filter(|old| old.id.to_string() == params.previous_result_id);
    Some(match old {
        Some(old) => SemanticTokensFullDeltaResult::TokensDelta(SemanticTokensDelta {
            result_id,
            edits: changes(&old.tokens, &new),
        }),
        None => SemanticTokensFullDeltaResult::Tokens(SemanticTokens {
            result_id,
            data: new,
        }),
    })
}

/// Records the tokens that a client receives for a document. Returns their number.
fn remember(world: &mut Workspace, uri: &lsp_types::Uri, tokens: Vec<SemanticToken>) -> String {
    let path = uri::to_path(uri);
    let id = world.sent_tokens.get(&path).map_or(1, |sent| sent.id + 1);
    world.sent_tokens.insert(path, SentTokens { id, tokens });
    id.to_string()
}

/// Numbers of a token in the protocol: position relative to the previous token, length, type and modifiers.
const NUMBERS_PER_TOKEN: usize = 5;

/// Returns the edit that turns the tokens `old` into `new`; no edit if they are equal.
fn changes(old: &[SemanticToken], new: &[SemanticToken]) -> Vec<SemanticTokensEdit> {
    let head = old.iter().zip(new).take_while(|(a, b)| a == b).count();
    let (old, new) = (&old[head..], &new[head..]);
    let pairs = old.iter().rev().zip(new.iter().rev());
    let tail = pairs.take_while(|(a, b)| a == b).count();
    let (removed, added) = (old.len() - tail, &new[..new.len() - tail]);
    if removed == 0 && added.is_empty() {
        return Vec::new();
    }
    let number = |tokens: usize| u32::try_from(NUMBERS_PER_TOKEN * tokens).unwrap_or(u32::MAX);
    vec![SemanticTokensEdit {
        start: number(head),
        delete_count: number(removed),
        data: Some(added.to_vec()),
    }]
}

/// Token with its type and modifiers as numbers of the protocol.
struct TypedToken {
    span: Span,
    ty: u32,
    modifiers: u32,
}

/// Returns the tokens of a document in text order.
fn tokens(seen: &Inspection) -> Vec<TypedToken> {
    let text = seen.sources.text(FileId(0));
    let written = written_names(seen);
    let pieces = source_tokens(text, seen.mode());
    let mut all = Vec::with_capacity(pieces.len());
    for (k, piece) in pieces.iter().enumerate() {
        let offset = |at: usize| u32::try_from(at).unwrap_or(u32::MAX);
        let span = Span::new(
            FileId(0),
            offset(piece.range.start),
            offset(piece.range.end),
        );
        let name = seen.index().reference_at(FileId(0), span.start);
        let name = name.filter(|name| name.span == span);
        let typed = match name {
            Some(name) => Some(name_type(seen, name, written.contains(&span))),
            None => word_type(text, &pieces[..k], piece).map(|ty| (ty, 0)),
        };
        if let Some((ty, modifiers)) = typed {
            let ty = index_of(TYPES, &ty);
            all.push(TypedToken {
                span,
                ty,
                modifiers: modifiers | comment_modifier(piece),
            });
        }
    }
    all
}

fn index_of<T: PartialEq>(table: &[T], row: &T) -> u32 {
    let at = table.iter().position(|known| known == row);
    at.and_then(|at| u32::try_from(at).ok()).unwrap_or(0)
}

fn modifier(one: &SemanticTokenModifier) -> u32 {
    1 << index_of(MODIFIERS, one)
}

fn comment_modifier(piece: &SourceToken) -> u32 {
    match piece.kind {
        SourceTokenKind::Comment(CommentKind::Doc) => {
            modifier(&SemanticTokenModifier::DOCUMENTATION)
        }
        _ => 0,
    }
}

/// Returns the type and the modifiers of a name with a declaration.
fn name_type(seen: &Inspection, name: Reference, is_written: bool) -> (SemanticTokenType, u32) {
    let def = seen.index().def(name.def);
    let row = DEF_TYPES.iter().find(|(kind, _)| *kind == def.kind);
    let ty = row.map_or(SemanticTokenType::VARIABLE, |(_, ty)| ty.clone());
    let file = seen.sources.name(def.span.file);
    let flags = [
        (def.span == name.span, SemanticTokenModifier::DECLARATION),
        (FIXED.contains(&def.kind), SemanticTokenModifier::READONLY),
        (is_written, SemanticTokenModifier::MODIFICATION),
        (
            is_builtin(std::path::Path::new(file)),
            SemanticTokenModifier::DEFAULT_LIBRARY,
        ),
    ];
    let set = flags.iter().filter(|(holds, _)| *holds);
    (ty, set.map(|(_, one)| modifier(one)).sum())
}

/// Returns the type of a token without a declaration; `None` for punctuation and undefined names.
fn word_type(text: &str, before: &[SourceToken], piece: &SourceToken) -> Option<SemanticTokenType> {
    let word = &text[piece.range.clone()];
    match piece.kind {
        SourceTokenKind::Comment(_) => Some(SemanticTokenType::COMMENT),
        SourceTokenKind::String => Some(SemanticTokenType::STRING),
        SourceTokenKind::Number => Some(SemanticTokenType::NUMBER),
        SourceTokenKind::KeywordOrSymbol => symbol_type(word),
        SourceTokenKind::Name if is_unit(word) && in_unit(text, before) => Some(UNIT),
        SourceTokenKind::Name if PrimId::from_name(word).is_some() => {
            Some(SemanticTokenType::FUNCTION)
        }
        SourceTokenKind::Name => {
            let known = builtin(word)?;
            Some(match known.is_call {
                true => SemanticTokenType::FUNCTION,
                false => SemanticTokenType::VARIABLE,
            })
        }
    }
}

/// Types that are keywords of the language.
const TYPE_WORDS: &[&str] = &["bool", "int", "real"];

fn symbol_type(word: &str) -> Option<SemanticTokenType> {
    let is_word = word.starts_with(|c: char| c.is_ascii_alphabetic());
    let is_punctuation = matches!(
        word,
        "(" | ")" | "[" | "]" | "{" | "}" | "," | ";" | ":" | "."
    );
    match (is_word, is_punctuation) {
        (true, _) if TYPE_WORDS.contains(&word) => Some(SemanticTokenType::TYPE),
        (true, _) => Some(SemanticTokenType::KEYWORD),
        (false, true) => None,
        (false, false) => Some(SemanticTokenType::OPERATOR),
    }
}

/// Returns whether a token after these is inside of the brackets of a unit: after a number or `real`, without a space in
/// between.
fn in_unit(text: &str, before: &[SourceToken]) -> bool {
    let word = |piece: &SourceToken| &text[piece.range.clone()];
    let inside = |piece: &&SourceToken| {
        matches!(piece.kind, SourceTokenKind::Name | SourceTokenKind::Number)
            || matches!(word(piece), "/" | "*" | "^" | "-")
    };
    let mut left = before.iter().rev().skip_while(inside);
    let is_open = left.next().is_some_and(|piece| word(piece) == "[");
    let is_measured =
        |piece: &SourceToken| piece.kind == SourceTokenKind::Number || word(piece) == "real";
    is_open && left.next().is_some_and(is_measured)
}

/// Converts tokens to the form of the protocol. A token of several lines is split into one for each line.
fn encode(world: &Workspace, seen: &Inspection, tokens: Vec<TypedToken>) -> Vec<SemanticToken> {
    let text = seen.sources.text(FileId(0));
    let lines = LineIndex::new(text);
    let encoding = world.client.encoding;
    let mut out = Vec::with_capacity(tokens.len());
    let (mut line, mut column) = (0, 0);
    for token in tokens {
        let mut start = token.span.start as usize;
        for part in seen.sources.slice(token.span).split_inclusive('\n') {
            let from = lines.position(text, start, encoding);
            let to = lines.position(text, start + part.trim_end().len(), encoding);
            start += part.len();
            if to.line != from.line || to.character <= from.character {
                continue;
            }
            out.push(SemanticToken {
                delta_line: from.line - line,
                delta_start: match from.line == line {
                    true => from.character - column,
                    false => from.character,
                },
                length: to.character - from.character,
                token_type: token.ty,
                token_modifiers_bitset: token.modifiers,
            });
            (line, column) = (from.line, from.character);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn token(delta_start: u32) -> SemanticToken {
        SemanticToken {
            delta_line: 0,
            delta_start,
            length: 1,
            token_type: 0,
            token_modifiers_bitset: 0,
        }
    }

    #[test]
    fn changes_turn_the_old_tokens_into_the_new_ones() {
        let cases: &[(&[u32], &[u32])] = &[
            (&[1, 2, 3], &[1, 2, 3]),
            (&[1, 2, 3], &[1, 3]),
            (&[1, 3], &[1, 2, 2, 3]),
            (&[], &[1]),
            (&[1, 1, 1], &[1, 1]),
        ];
        for (old, new) in cases {
            let [old, new] =
                [old, new].map(|all| all.iter().map(|n| token(*n)).collect::<Vec<_>>());
            let mut text = old.clone();
            for edit in changes(&old, &new) {
                let start = edit.start as usize / NUMBERS_PER_TOKEN;
                let end = start + edit.delete_count as usize / NUMBERS_PER_TOKEN;
                text.splice(start..end, edit.data.unwrap_or_default());
            }
            assert_eq!(text, new);
        }
    }

    #[test]
    fn the_numbers_of_types_and_modifiers_are_in_the_tables() {
        for (_, ty) in DEF_TYPES {
            assert!(TYPES.contains(ty), "{ty:?}");
        }
        assert_eq!(modifier(&MODIFIERS[2]), 4);
    }
}
