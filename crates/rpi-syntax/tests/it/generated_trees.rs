//! Property tests on generated trees without source: printing and parsing them gives the same tree.

use crate::format::{check, check_beside};
use crate::support::{assert_same, dump_without_parens, parse_clean, programs};
use crate::tree_strategies::file;
use proptest::prelude::*;
use rpi_syntax::ast::*;
use rpi_syntax::{Dialect, print};

/// Removes the parentheses of the source from constants.
pub(crate) fn strip_parens(file: &mut File) {
    for item in &mut file.items {
        if let ItemKind::Const(defs) = &mut item.kind {
            for value in defs.iter_mut().filter_map(|def| def.value.as_mut()) {
                strip(value);
            }
        }
    }
}

fn strip(expr: &mut Expr) {
    while let ExprKind::Paren(inner) = &mut expr.kind {
        let inner = std::mem::replace(&mut **inner, Expr::bool(false));
        *expr = inner;
    }
    match &mut expr.kind {
        ExprKind::Unary(_, operand) => strip(operand),
        ExprKind::Binary(binary) => {
            strip(&mut binary.lhs);
            strip(&mut binary.rhs);
        }
        ExprKind::Field(field) => strip(&mut field.base),
        ExprKind::Index(index) => strip(&mut index.base),
        ExprKind::When(when) => strip(&mut when.value),
        ExprKind::If(conditional) => {
            strip(&mut conditional.condition);
            strip(&mut conditional.then_value);
            strip(&mut conditional.else_value);
        }
        _ => {}
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    #[test]
    fn made_up_trees_read_back(file in file()) {
        let text = print(&file, Dialect::Rpi);
        let again = parse_clean(&text, Dialect::Rpi).file;
        assert_same(&dump_without_parens(&file), &dump_without_parens(&again), "the tree changes");
        check(&text, Dialect::Rpi);
    }

    #[test]
    fn comments_anywhere_are_kept(file in file(), places in prop::collection::vec((any::<prop::sample::Index>(), 0..6usize), 1..8)) {
        let text = with_comments(&print(&file, Dialect::Rpi), &places);
        check(&text, Dialect::Rpi);
    }

    #[test]
    fn comments_anywhere_in_programs_are_kept(program in any::<prop::sample::Index>(), places in prop::collection::vec((any::<prop::sample::Index>(), prop::sample::select(&[0usize, 1, 3, 4][..])), 1..8)) {
        let programs = programs();
        let program = &programs[program.index(programs.len())];
        // In `.lus` files the style rewrites more than the tokens in `passed`.
        if program.mode == Dialect::Rpi {
            let passed = [",", ";", "(", ")", "[", "]", "const"];
            check_beside(&with_comments(&program.text, &places), Dialect::Rpi, &passed);
        }
    }

    #[test]
    fn no_text_panics(text in "[ -~ä\n]{0,200}") {
        let _ = rpi_syntax::format(&text, Dialect::Rpi);
        let _ = rpi_syntax::format(&text, Dialect::Lustre);
    }

    #[test]
    fn no_row_of_words_panics(words in prop::collection::vec(prop::sample::select(WORDS), 0..60)) {
        let text = words.join(" ");
        let _ = rpi_syntax::format(&text, Dialect::Rpi);
    }
}

/// Tokens for random token sequences.
const WORDS: &[&str] = &[
    "node",
    "function",
    "let",
    "tel",
    "(",
    ")",
    "<<",
    ">>",
    "[",
    "]",
    "{",
    "}",
    "x",
    "y",
    "3",
    "0.5",
    "=",
    ";",
    ",",
    ":",
    ".",
    "returns",
    "var",
    "const",
    "type",
    "int",
    "real",
    "->",
    "pre",
    "when",
    "if",
    "then",
    "else",
    "command",
    "task",
    "fragment",
    "automaton",
    "state",
    "initial",
    "unless",
    "until",
    "end",
    "finish",
    "yield",
    "fail",
    "on",
    "|",
    "start",
    "repeat",
    "times",
    "con",
    "noc",
    "assume",
    "guarantee",
    "device",
    "sensor",
    "test",
    "\"t\"",
    "\n",
    "-- c\n",
    "--| d\n",
    "use",
    "given",
    "budget",
    "restart",
    "every",
    "activate",
    "merge",
    "with",
    "step",
    "..",
    "?",
    "??",
    "%",
    "-",
    "^",
];

/// Returns the offsets between two tokens, where a comment can be inserted.
fn gaps(text: &str) -> Vec<usize> {
    let gap = |(at, sign): (usize, char)| match sign {
        ' ' | ')' | ']' | '}' | ',' | ';' => Some(at),
        '(' | '[' | '{' => Some(at + 1),
        _ => None,
    };
    let gaps = text.char_indices().filter_map(gap);
    gaps.filter(|at| outside_strings(text, *at)).collect()
}

/// Returns a text with comments inserted between its tokens.
fn with_comments(text: &str, places: &[(prop::sample::Index, usize)]) -> String {
    const COMMENTS: &[&str] = &[
        " -- c\n",
        "\n-- c\n",
        "\n\n--| d\n",
        " (* b *) ",
        "\n(* b\n b *)\n",
        " --| d\n",
    ];
    let comments = parse_clean(text, Dialect::Rpi).comments;
    let in_comment = |at: usize| {
        comments
            .all
            .iter()
            .any(|c| (c.span.start as usize..c.span.end as usize).contains(&at))
    };
    let gaps: Vec<usize> = gaps(text)
        .into_iter()
        .filter(|at| !in_comment(*at))
        .collect();
    let mut places: Vec<(usize, usize)> = places
        .iter()
        .filter(|_| !gaps.is_empty())
        .map(|(index, comment)| (gaps[index.index(gaps.len())], *comment))
        .collect();
    places.sort_by_key(|(at, _)| std::cmp::Reverse(*at));
    let mut text = text.to_owned();
    for (at, comment) in places {
        text.insert_str(at, COMMENTS[comment]);
    }
    text
}

/// Returns whether an offset is outside of string literals and line comments.
fn outside_strings(text: &str, at: usize) -> bool {
    let line = text[..at].rsplit('\n').next().unwrap_or_default();
    line.matches('"').count() - line.matches("\\\"").count() == 0 && !line.contains("--")
}
