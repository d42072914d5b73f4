//! Division of a program text into parts that parse independently of one another, for incremental checking.
//!
//! The parse of a text is the parse of its parts, one after the other. A text is divided only between two declarations that
//! are complete: nothing before the place changes how the parser reads the text after it, and vice versa. Where this is not
//! certain, for example beside a lexical error, the text is not divided. A part with an error can also depend on the names
//! in the whole file, which [`PartParse::depends_on_file`] shows.

use crate::guessed_names::GuessedNames;
use crate::lexer::{LexOutput, Lexeme, lex_skipping};
use crate::parse::parse_with_names;
use crate::split::{Chunk, ChunkKind, follows_name, split};
use crate::token::Token;
use crate::{Dialect, Parse};
use rpi_diag::FileId;
use std::collections::BTreeSet;

/// Parse of a part of a file.
#[derive(Debug)]
pub struct PartParse {
    /// Syntax tree and diagnostics. Their locations are relative to the start of the part.
    pub parse: Parse,
    /// Whether the result depends on the names in the rest of the file, so that it must be computed again when the file
    /// changes.
    pub depends_on_file: bool,
}

/// Parses a part of the text of a file, which [`divide`] has found. `id` is the identifier of the part.
#[must_use]
pub fn parse_part(id: FileId, part: &str, file_text: &str, mode: Dialect) -> PartParse {
    let names = GuessedNames::new(file_text);
    let (parse, _) = parse_with_names(id, part, mode, &names);
    PartParse {
        parse,
        depends_on_file: names.is_used(),
    }
}

/// Places at which a text can be divided into parts.
#[derive(Debug)]
pub struct Division {
    /// Offsets in bytes at which a part ends and the next one begins, in ascending order.
    pub cuts: Vec<usize>,
    /// Whether a part may end directly before the text.
    pub is_open_before: bool,
    /// Whether a part may begin directly after the text.
    pub is_open_after: bool,
}

impl Division {
    /// Result for a text that must not be separated from the text around it.
    const NONE: Division = Division {
        cuts: Vec::new(),
        is_open_before: false,
        is_open_after: false,
    };
}

/// Divides a text into parts that can be parsed separately. `text` is a part of `file_text` that begins at the start of a
/// line. Lustre texts are not divided, because a contract in a comment can change the parse of the whole file.
#[must_use]
pub fn divide(text: &str, file_text: &str, mode: Dialect) -> Division {
    if mode == Dialect::Lustre {
        return Division::NONE;
    }
    let names = GuessedNames::new(file_text);
    let lexed = lex_skipping(FileId(0), text, mode, &BTreeSet::new(), &names);
    if declares_claim_word(text, &lexed.lexemes) {
        return Division::NONE;
    }
    let chunks = split(text, &lexed.lexemes, mode);
    let boundary = Boundary::new(text, &lexed, &chunks);
    let mut cuts = Vec::new();
    for k in 1..chunks.len() {
        if boundary.may_begin(k)
            && let Some(cut) = boundary.end(k - 1)
        {
            cuts.push(cut);
        }
    }
    let last = chunks.len().checked_sub(1);
    Division {
        cuts,
        is_open_before: boundary.may_begin(0),
        is_open_after: last.and_then(|last| boundary.end(last)) == Some(text.len()),
    }
}

/// Returns whether the text seems to declare a node named `check` or `last`. Such a node changes the meaning of the word in
/// the whole file.
fn declares_claim_word(text: &str, lexemes: &[Lexeme]) -> bool {
    use Token::{Fragment, Function, Imported, Node};
    let declares = |token| matches!(token, Node | Function | Fragment | Imported);
    let mut pairs = lexemes.windows(2);
    pairs.any(|pair| {
        let name = &text[pair[1].start as usize..pair[1].end as usize];
        declares(pair[0].token) && matches!(name, "check" | "last")
    })
}

/// Chunks of a text, and the decision where it can be divided between them.
struct Boundary<'t> {
    text: &'t str,
    lexemes: &'t [Lexeme],
    chunks: &'t [Chunk],
    /// For each chunk, whether the lexer has reported an error in it or beside it.
    has_error: Vec<bool>,
}

impl<'t> Boundary<'t> {
    fn new(text: &'t str, lexed: &'t LexOutput, chunks: &'t [Chunk]) -> Boundary<'t> {
        let mut has_error = vec![false; chunks.len()];
        for error in &lexed.errors {
            let at = error.diagnostic.span().start;
            let starts = |chunk: &Chunk| lexed.lexemes[chunk.range.start].start <= at;
            let next = chunks.partition_point(starts);
            // The error may be between two chunks, and then affect both.
            let beside = next.saturating_sub(1)..(next + 1).min(chunks.len());
            has_error[beside].fill(true);
        }
        Boundary {
            text,
            lexemes: &lexed.lexemes,
            chunks,
            has_error,
        }
    }

    /// Returns whether the chunk with index `k` is read in the same way if it is the first one of a part.
    fn may_begin(&self, k: usize) -> bool {
        let Some(chunk) = self.chunks.get(k) else {
            return false;
        };
        let start = self.lexemes[chunk.range.start].start as usize;
        let begins_line = self.text[..start].ends_with('\n') || start == 0;
        let next = self.lexemes.get(chunk.range.start + 1);
        chunk.kind == ChunkKind::Declaration
            && begins_line
            && !self.has_error[k]
            && next.is_some_and(|next| !follows_name(next.token))
    }

    /// Returns the offset at which a part ends whose last chunk has the index `k`: after the line of its last token.
    /// `None` if the part must not end there.
    fn end(&self, k: usize) -> Option<usize> {
        let lexemes = &self.lexemes[self.chunks[k].range.clone()];
        let is_whole = self.chunks[k].is_closed
            && !self.has_error[k]
            && lexemes.iter().any(|lexeme| lexeme.token == Token::Semi)
            && has_pairs_of_brackets(lexemes);
        let last = lexemes.last().filter(|_| is_whole)?;
        let rest = &self.text[last.end as usize..];
        let line = rest.find('\n')?;
        let is_blank = rest[..line].trim().is_empty();
        is_blank.then_some(last.end as usize + line + 1)
    }
}

/// Returns whether each bracket has its partner, so that the search for the bracket of a later token ends within the
/// declaration of that token.
fn has_pairs_of_brackets(lexemes: &[Lexeme]) -> bool {
    use Token::{LBrace, LBracket, LParen, LStatic, RBrace, RBracket, RParen, RStatic};
    let mut open = Vec::new();
    for lexeme in lexemes {
        let partner = match lexeme.token {
            LParen | LBracket | LBrace | LStatic => {
                open.push(lexeme.token);
                continue;
            }
            RParen => LParen,
            RBracket => LBracket,
            RBrace => LBrace,
            RStatic => LStatic,
            _ => continue,
        };
        if open.pop() != Some(partner) {
            return false;
        }
    }
    open.is_empty()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parts(text: &str) -> Vec<&str> {
        let found = divide(text, text, Dialect::Rpi);
        let starts = std::iter::once(0).chain(found.cuts.iter().copied());
        let ends = found.cuts.iter().copied().chain([text.len()]);
        starts.zip(ends).map(|(from, to)| &text[from..to]).collect()
    }

    const USE: &str = "use motion;\n";
    const NODE: &str =
        "\n--| Half.\nnode f (x: real) returns (y: real)\nlet\n  y = x / 2.0;\ntel\n";
    const CONST: &str = "const c: int = 1; -- last\n";

    #[test]
    fn a_part_begins_after_the_line_of_a_complete_declaration() {
        let text = [USE, NODE, CONST, NODE].concat();
        // The comment behind the constant belongs to its line, and may not be separated from it.
        let rest = [CONST, NODE].concat();
        assert_eq!(parts(&text), [USE, NODE, rest.as_str()]);
        let found = divide(&text, &text, Dialect::Rpi);
        assert!(found.is_open_before && found.is_open_after);
        assert!(divide(&text, &text, Dialect::Lustre).cuts.is_empty());
    }

    #[test]
    fn declarations_with_open_ends_are_not_separated_from_the_next() {
        for broken in [
            "node g (x: real) returns (y: real)\nlet\n  y = x;\n",
            "node g (x: real) returns (y: real)\nlet\n  y = (x;\ntel\n",
            "node g (x: real) returns (y: real)\nlet\n  y = \"x;\ntel\n",
            "comand g\n",
        ] {
            let text = [USE, broken, NODE].concat();
            assert!(!parts(&text).contains(&NODE), "{broken}");
        }
    }

    #[test]
    fn a_node_named_as_a_claim_changes_the_whole_file() {
        let text = [
            USE,
            NODE,
            "node check (x: bool) returns (y: bool) let y = x; tel\n",
        ]
        .concat();
        assert_eq!(parts(&text), [text.as_str()]);
    }

    #[test]
    fn parts_parse_as_the_whole_text() {
        let text = [USE, NODE, "const c: int = ;\n", NODE].concat();
        let whole = crate::parse(FileId(0), &text, Dialect::Rpi);
        let (mut items, mut messages) = (0, Vec::new());
        for part in parts(&text) {
            let parsed = parse_part(FileId(0), part, &text, Dialect::Rpi).parse;
            items += parsed.file.items.len();
            messages.extend(parsed.diagnostics.into_iter().map(|one| one.message));
        }
        assert_eq!(items, whole.file.items.len());
        let expected = whole.diagnostics.into_iter().map(|one| one.message);
        assert_eq!(messages, expected.collect::<Vec<_>>());
    }
}
