//! Diagnostics for text outside of declarations.

use crate::actions::declarations;
use crate::ast::{DeclaredKind, DeclaredName, Item, ItemKind};
use crate::context::ParseContext;
use crate::lexer::Lexeme;
use crate::recover;
use crate::token::Token;
use rpi_diag::{Code, Diagnostic, Fix};

/// Keywords of other languages that begin declarations, in lower case, each with the corresponding RPI keyword.
const FOREIGN_KEYWORDS: &[(&str, Token)] = &[
    ("block", Token::Node),
    ("class", Token::Node),
    ("component", Token::Node),
    ("def", Token::Function),
    ("defun", Token::Function),
    ("fn", Token::Function),
    ("fun", Token::Function),
    ("func", Token::Function),
    ("function", Token::Function),
    ("function_block", Token::Node),
    ("model", Token::Node),
    ("module", Token::Node),
    ("operator", Token::Node),
    ("proc", Token::Node),
    ("procedure", Token::Node),
    ("program", Token::Node),
    ("routine", Token::Node),
    ("sub", Token::Node),
    ("subroutine", Token::Node),
    ("subsystem", Token::Node),
];

/// Returns the RPI keyword that corresponds to a declaration keyword of another language; `None` for other words.
pub(crate) fn corresponding_keyword(written: &str) -> Option<Token> {
    let mut words = FOREIGN_KEYWORDS.iter();
    let found = words.find(|(word, _)| written.eq_ignore_ascii_case(word));
    found.map(|(_, meant)| *meant)
}

/// Reports the name at the start of a declaration, which resembles the keyword `word`. Returns [`None`] if the name is
/// spelt like the keyword.
pub(crate) fn misspelt_keyword(
    cx: &ParseContext<'_>,
    name: Lexeme,
    word: Token,
) -> Option<Diagnostic> {
    let meant = word.spelling().unwrap_or_default();
    let written = cx.slice(name.start, name.end);
    let span = cx.span(name.start, name.end);
    let diagnostic = Diagnostic::new(
        Code::RPI0010,
        format!("no declaration begins with `{written}`"),
    )
    .primary(span, format!("did you mean `{meant}`?"))
    .fix(Fix::maybe(format!("write `{meant}`")).replace(span, meant));
    let diagnostic = match corresponding_keyword(written) {
        Some(_) => diagnostic
            .help(declaration_help(cx, name, meant))
            .help("a `node` may have state, a `function` has none, and a `command` moves devices"),
        None => diagnostic,
    };
    (written != meant).then_some(diagnostic)
}

/// Returns the form of a node or function with the declared name, for a declaration keyword of another language.
fn declaration_help(cx: &ParseContext<'_>, keyword: Lexeme, meant: &str) -> String {
    let rest = cx.text[keyword.end as usize..].trim_start();
    let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_');
    let name = match &rest[..end.unwrap_or(rest.len())] {
        "" => "F",
        name => name,
    };
    format!("a {meant} is written `{meant} {name} (x: real) returns (y: real) let y = ...; tel`")
}

/// Reports a package or model of Lustre V6, which RPI does not support. `word` is its first token.
pub(crate) fn unsupported_package(cx: &ParseContext<'_>, word: Lexeme) -> Diagnostic {
    let written = cx.slice(word.start, word.end);
    Diagnostic::new(
        Code::RPI0010,
        format!("a {written} of Lustre V6 is not supported"),
    )
    .primary(
        cx.span(word.start, word.end),
        "the rest of the file is ignored",
    )
    .help("declare its nodes, types and constants at the top level")
}

/// Returns whether the tokens begin a type declaration without `type`: `enum Mode { A, B }`, `struct P { x: int }`.
pub(crate) fn is_type_without_keyword(lexemes: &[Lexeme]) -> bool {
    use Token::{Enum, Ident, LBrace, Struct};
    let shape: Vec<Token> = lexemes.iter().take(3).map(|lexeme| lexeme.token).collect();
    matches!(shape[..], [Enum | Struct, Ident, LBrace])
}

/// Reports a type declaration that begins with `enum` or `struct` instead of `type`, and parses it. Reports tokens
/// after it as outside of declarations.
pub(crate) fn parse_type_without_keyword(
    cx: &ParseContext<'_>,
    lexemes: &[Lexeme],
    diagnostics: &mut Vec<Diagnostic>,
) -> Item {
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
    diagnostics.push(
        Diagnostic::new(Code::RPI0010, message)
            .primary(head, "expected `type` before this")
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
    let item = recover::parse_item(cx, &meant, diagnostics);
    if let Some(first) = rest.first().filter(|first| first.token != Token::Semi) {
        diagnostics.push(stray_tokens(cx, Some(*first), rest));
    }
    item
}

/// Words of other languages that import a module.
const IMPORT_KEYWORDS: &[&str] = &[
    "import", "from", "using", "open", "require", "uses", "load", "with",
];

/// First words (in lower case) of top-level constructs in other languages, with help texts that show the RPI
/// equivalents.
const FOREIGN_TOP_LEVEL: &[(&[&str], &str)] = &[
    (
        &[
            "import",
            "from",
            "using",
            "open",
            "require",
            "uses",
            "load",
            "with",
            "package",
            "namespace",
            "mod",
            "unit",
        ],
        "`use motion;` imports a module: the file `motion.rpi` or a module of the standard library",
    ),
    (
        &["typedef", "alias", "newtype"],
        "a type is declared by `type Count = int;`",
    ),
    (
        &[
            "int", "real", "bool", "float", "double", "void", "auto", "static", "public",
            "private", "unsigned", "long", "short", "char", "inline", "virtual", "async", "export",
            "pub", "final", "extern",
        ],
        "a function is declared by `function f (x: int) returns (y: int) let y = x + 1; tel`, a constant by `const n: int = 3;`",
    ),
    (
        &[
            "let",
            "var",
            "val",
            "global",
            "dim",
            "define",
            "decl",
            "constant",
            "static",
            "persistent",
            "var_global",
        ],
        "a constant is declared by `const n: int = 3;`; flows are defined in a `node` or `command`",
    ),
    (
        &[
            "if", "for", "while", "switch", "print", "repeat", "case", "return", "ptp", "movej",
            "movel", "wait",
        ],
        "equations are written between `let` and `tel` in a `node` or `command`; steps in a `task`",
    ),
    (
        &["enum", "struct", "record", "union"],
        "a type is declared by `type Mode = enum { Off, On };`, `type Part = struct { x: real };`",
    ),
    (
        &["interface", "trait", "impl", "template"],
        "the guarantees of a node are its `contract`; static parameters are written in `<< >>`",
    ),
];

/// Returns a help text on the RPI equivalent of a construct that begins with a word of another language; `None` for
/// other words.
fn top_level_help(word: &str) -> Option<&'static str> {
    let word = word.to_ascii_lowercase();
    let found = FOREIGN_TOP_LEVEL
        .iter()
        .find(|(words, _)| words.contains(&&*word));
    found.map(|(_, help)| *help)
}

/// Returns an error node that declares the name of a `typedef` or function of C, so that uses of the name cause no
/// errors. `None` if the tokens are neither.
pub(crate) fn c_declaration(cx: &ParseContext<'_>, lexemes: &[Lexeme]) -> Option<Item> {
    use Token::{BoolType, Ident, IntType, LParen, RealType, Semi};
    let token = |at: usize| lexemes.get(at).map(|lexeme| lexeme.token);
    let first = cx.slice(lexemes[0].start, lexemes[0].end);
    let is_type = |at: usize| matches!(token(at), Some(BoolType | Ident | IntType | RealType));
    let (kind, at) = match first {
        "typedef" => {
            let semi = lexemes.iter().position(|lexeme| lexeme.token == Semi)?;
            (DeclaredKind::Type, semi.checked_sub(1)?)
        }
        _ if is_type(0) && token(1) == Some(Ident) && token(2) == Some(LParen) => {
            (DeclaredKind::Callable, 1)
        }
        _ => return None,
    };
    let name = lexemes.get(at).filter(|name| name.token == Ident)?;
    let name = cx.ident(name.start, name.end);
    let end = lexemes.last().map_or(0, |lexeme| lexeme.end);
    let kind = ItemKind::Error(vec![DeclaredName { kind, name }]);
    Some(declarations::item(cx, lexemes[0].start, kind, end))
}

/// Reports tokens outside of declarations (RPI0010). `before` is the token before the first of them.
pub(crate) fn stray_tokens(
    cx: &ParseContext<'_>,
    before: Option<Lexeme>,
    lexemes: &[Lexeme],
) -> Diagnostic {
    let first = lexemes[0];
    let written = cx.slice(first.start, first.end);
    let span = cx.span(first.start, first.end);
    let message = format!("`{written}` is outside of any declaration");
    let diagnostic = Diagnostic::new(Code::RPI0010, message);
    if first.token == Token::Tel {
        return diagnostic.primary(span, "no body is open here");
    }
    if IMPORT_KEYWORDS.contains(&&*written.to_ascii_lowercase()) {
        return foreign_import(cx, lexemes);
    }
    let diagnostic = diagnostic.primary(span, "no declaration begins like this");
    let closes_body = |lexeme: &Lexeme| lexeme.token == Token::Tel;
    match before.filter(closes_body) {
        Some(tel) if lexemes.iter().any(closes_body) => diagnostic.secondary(
            cx.span(tel.start, tel.end),
            "the body ends here; is this `tel` superfluous?",
        ),
        _ if top_level_help(written).is_some() => {
            cx.suppress_foreign_operators(cx.span(first.start, lexemes[lexemes.len() - 1].end));
            diagnostic.help(top_level_help(written).unwrap_or_default())
        }
        _ => with_equation_help(cx, diagnostic, lexemes),
    }
}

/// Adds the place of equations, and the form of a constant if the tokens are an equation: `speed = 250[mm/s];`.
fn with_equation_help(
    cx: &ParseContext<'_>,
    diagnostic: Diagnostic,
    lexemes: &[Lexeme],
) -> Diagnostic {
    let diagnostic = diagnostic
        .help("equations are written between `let` and `tel` in a node, fragment, command or test");
    let shape: Vec<Token> = lexemes.iter().take(2).map(|lexeme| lexeme.token).collect();
    if shape[..] != [Token::Ident, Token::Eq] {
        return diagnostic;
    }
    let first = lexemes[0];
    let name = cx.slice(first.start, first.end);
    diagnostic.fix(
        Fix::maybe(format!("make `{name}` a constant"))
            .insert_before(cx.span(first.start, first.end), "const "),
    )
}

/// Reports an import of another language: `import motion;`.
fn foreign_import(cx: &ParseContext<'_>, lexemes: &[Lexeme]) -> Diagnostic {
    let (first, last) = (lexemes[0], lexemes[lexemes.len() - 1]);
    cx.suppress_foreign_operators(cx.span(first.start, last.end));
    let span = cx.span(first.start, first.end);
    let written = cx.slice(first.start, first.end);
    let diagnostic = Diagnostic::new(Code::RPI0010, "a module is imported by `use`")
        .primary(span, format!("`{written}` is from another language"));
    let shape: Vec<Token> = lexemes.iter().take(3).map(|lexeme| lexeme.token).collect();
    if !matches!(shape[..], [_, Token::Ident, Token::Semi]) {
        return diagnostic.help("`use motion;` imports a module: the file `motion.rpi` or a module of the standard library");
    }
    let module = cx.slice(lexemes[1].start, lexemes[1].end);
    diagnostic
        .help(format!(
            "`use {module};` imports the file `{module}.rpi` or the module `{module}` of the standard library"
        ))
        .fix(Fix::maybe("write `use`").replace(span, "use"))
}
