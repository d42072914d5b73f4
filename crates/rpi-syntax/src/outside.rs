//! Findings about what stands outside of any declaration.

use crate::ast::Item;
use crate::context::Context;
use crate::lexer::Lexeme;
use crate::mend;
use crate::token::Token;
use rpi_diag::{Code, Finding, Fix};

/// How other languages begin what is declared here; compared without case.
const FOREIGN: &[(&str, Token)] = &[
    ("class", Token::Node),
    ("def", Token::Function),
    ("defun", Token::Function),
    ("fn", Token::Function),
    ("fun", Token::Function),
    ("func", Token::Function),
    ("function", Token::Function),
    ("function_block", Token::Node),
    ("module", Token::Node),
    ("proc", Token::Node),
    ("procedure", Token::Node),
    ("program", Token::Node),
    ("sub", Token::Node),
];

/// The word of a declaration by which this one of another language is meant.
pub(crate) fn foreign(written: &str) -> Option<Token> {
    let mut words = FOREIGN.iter();
    let found = words.find(|(word, _)| written.eq_ignore_ascii_case(word));
    found.map(|(_, meant)| *meant)
}

/// A name that resembles the word of a declaration, where such a word is expected. [`None`] if it
/// is that word.
pub(crate) fn misspelt(cx: &Context<'_>, name: Lexeme, word: Token) -> Option<Finding> {
    let meant = word.spelling().unwrap_or_default();
    let written = cx.slice(name.start, name.end);
    let span = cx.span(name.start, name.end);
    let finding = Finding::new(
        Code::RPI0010,
        format!("no declaration begins with `{written}`"),
    )
    .at(span, format!("did you mean `{meant}`?"))
    .fix(Fix::maybe(format!("write `{meant}`")).replace(span, meant));
    let finding = match foreign(written) {
        Some(_) => finding.help(
            "a `node` may remember what was, a `function` does not, and a `command` moves devices",
        ),
        None => finding,
    };
    (written != meant).then_some(finding)
}

/// A package or model.
pub(crate) fn package(cx: &Context<'_>, word: Lexeme) -> Finding {
    let written = cx.slice(word.start, word.end);
    Finding::new(
        Code::RPI0010,
        format!("a {written} of Lustre V6 is not read"),
    )
    .at(
        cx.span(word.start, word.end),
        "the rest of the file is skipped",
    )
    .help("write its nodes, types and constants without it")
}

/// `enum Mode { A, B }`, `struct P { x: int }`
pub(crate) fn is_bare_type(lexemes: &[Lexeme]) -> bool {
    use Token::{Enum, Ident, LBrace, Struct};
    let shape: Vec<Token> = lexemes.iter().take(3).map(|lexeme| lexeme.token).collect();
    matches!(shape[..], [Enum | Struct, Ident, LBrace])
}

/// The type that was meant; what follows it is told as well.
pub(crate) fn bare_type(cx: &Context<'_>, lexemes: &[Lexeme], findings: &mut Vec<Finding>) -> Item {
    let closes = |lexeme: &Lexeme| lexeme.token == Token::RBrace;
    let end = lexemes
        .iter()
        .position(closes)
        .map_or(lexemes.len(), |at| at + 1);
    let (ty, mut rest) = lexemes.split_at(end);
    let (word, name) = (ty[0], ty[1]);
    let [written, named] = [word, name].map(|lexeme| cx.slice(lexeme.start, lexeme.end));
    let head = cx.span(word.start, name.end);
    let last = ty[ty.len() - 1];
    let mut fix = Fix::sure(format!("write `type {named} = {written}`"))
        .replace(head, format!("type {named} = {written}"));
    match rest.split_first() {
        Some((semi, others)) if semi.token == Token::Semi => rest = others,
        _ => fix = fix.insert_after(cx.span(last.start, last.end), ";"),
    }
    let message = format!("a type is declared by `type {named} = {written} {{ ... }};`");
    findings.push(
        Finding::new(Code::RPI0010, message)
            .at(head, "expected `type` before this")
            .fix(fix),
    );
    let behind = |token, lexeme: Lexeme| Lexeme {
        token,
        start: lexeme.end,
        end: lexeme.end,
    };
    let begin = Lexeme {
        token: Token::Type,
        end: word.start,
        ..word
    };
    let mut meant = vec![
        begin,
        name,
        behind(Token::Eq, name),
        behind(word.token, name),
    ];
    meant.extend_from_slice(&ty[2..]);
    meant.push(behind(Token::Semi, last));
    let item = mend::item(cx, &meant, findings);
    if let Some(first) = rest.first().filter(|first| first.token != Token::Semi) {
        findings.push(stray(cx, Some(*first), rest));
    }
    item
}

/// Anything else outside of declarations; `before` is what stands before it.
pub(crate) fn stray(cx: &Context<'_>, before: Option<Lexeme>, lexemes: &[Lexeme]) -> Finding {
    let first = lexemes[0];
    let written = cx.slice(first.start, first.end);
    let span = cx.span(first.start, first.end);
    let message = format!("`{written}` stands outside of any declaration");
    let finding = Finding::new(Code::RPI0010, message);
    if first.token == Token::Tel {
        return finding.at(span, "closes a body that is not open");
    }
    let finding = finding.at(span, "no declaration begins like this");
    let closes_body = |lexeme: &Lexeme| lexeme.token == Token::Tel;
    match before.filter(closes_body) {
        Some(tel) if lexemes.iter().any(closes_body) => finding.also(
            cx.span(tel.start, tel.end),
            "the body ends here: is this `tel` one too many?",
        ),
        _ => finding
            .help("equations stand between `let` and `tel`, in a node, fragment, command or test"),
    }
}
