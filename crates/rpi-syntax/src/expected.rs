//! Descriptions of the tokens that the grammar would have accepted.
//!
//! The grammar lists dozens of tokens where a reader expects "an expression". The tables turn sets of tokens into such
//! terms, and state the purpose of an expected name.

use crate::token::Token;

/// Tokens without a fixed spelling: name in the grammar, token, and description in messages.
const TOKEN_CLASSES: &[(&str, Token, &str)] = &[
    ("NAME", Token::Ident, "a name"),
    ("PATH", Token::Path, "a qualified name"),
    ("INT", Token::Int, "an integer"),
    ("REAL", Token::Real, "a real number"),
    ("STRING", Token::Str, "a string literal"),
    ("LABEL", Token::Label, "a string literal"),
    ("PROPERTY", Token::Property, "a property"),
    ("BROKEN", Token::Broken, ""),
];

/// Returns the token with a name as used in the grammar, such as `"let"` or `NAME`; `None` for an unknown name.
pub(crate) fn token_from_grammar_name(name: &str) -> Option<Token> {
    match name.starts_with('"') {
        true => Token::from_spelling(name.trim_matches('"')),
        false => {
            let class = TOKEN_CLASSES.iter().find(|(class, ..)| *class == name);
            class.map(|(_, token, _)| *token)
        }
    }
}

/// Set of tokens that messages about expected tokens replace by one term, such as "an expression".
struct TokenGroup {
    term: &'static str,
    /// Tokens that must all be expected so that the term applies.
    required: &'static [Token],
    /// Expected tokens that the term of the group replaces in messages.
    covered: &'static [Token],
}

use Token::*;

/// Groups of tokens that messages replace by one term. Larger groups come first, as the first tokens of an expression
/// include those of a name.
const GROUPS: &[TokenGroup] = &[
    TokenGroup {
        term: "an argument",
        required: &[Int, Not, Const, Node, BoolType],
        covered: &[
            LBrace, When, In, Int, Real, Str, True, False, Ident, Path, LParen, LBracket, Hash,
            Nor, Merge, Not, Minus, Pre, Current, Last, If, With, IntType, RealType, BoolType,
            Const, Node, Function, Type, Arrow, Plus, Star, Slash, Div, Mod, Pow, Hat, Bar,
            Coalesce, Implies, Or, Xor, And, Eq, Ne, Lt, Le, Gt, Ge, Fby,
        ],
    },
    TokenGroup {
        term: "an expression",
        required: &[Int, Not, LParen],
        covered: &[
            LBrace, When, Int, Real, Str, True, False, Ident, Path, LParen, LBracket, Hash, Nor,
            Merge, Not, Minus, Pre, Current, Last, If, With, IntType, RealType,
        ],
    },
    TokenGroup {
        term: "an equation",
        required: &[Assert, Automaton],
        covered: &[
            Assert, Automaton, Check, Property, Export, Fail, Finish, Fragment, Ident, Path,
            LParen, Yield,
        ],
    },
    TokenGroup {
        term: "a step",
        required: &[Repeat, Start],
        covered: &[Parallel, Repeat, Start, Ident, Path],
    },
    TokenGroup {
        term: "a type",
        required: &[BoolType, IntType],
        covered: &[
            BoolType, IntType, RealType, Ident, Path, Enum, Struct, LBrace, LBracket,
        ],
    },
    TokenGroup {
        term: "a contract clause",
        required: &[Assume, Guarantee],
        covered: &[Assume, Guarantee, Var, Const, ModeWord],
    },
    TokenGroup {
        term: "an operator",
        required: &[Arrow, Plus],
        covered: &[
            In, Arrow, Plus, Minus, Star, Slash, Div, Mod, Pow, Hat, Bar, Coalesce, Implies, Or,
            Xor, And, Eq, Ne, Lt, Le, Gt, Ge, Fby, When, Dot, LBracket, LBrace, LParen, LStatic,
            Percent,
        ],
    },
    TokenGroup {
        term: "a transition or the next state",
        required: &[Unless, State],
        covered: &[Unless, Until, Initial, State, End],
    },
    TokenGroup {
        term: "the body",
        required: &[Let, Var],
        covered: &[Let, Var, Const, Con, Semi],
    },
    TokenGroup {
        term: "a parameter",
        required: &[Ident, Const, Node, Type],
        covered: &[Ident, Const, Node, Function, Type],
    },
    TokenGroup {
        term: "a port",
        required: &[Ident, Const, LParen],
        covered: &[Ident, Const, LParen],
    },
    TokenGroup {
        term: "a name",
        required: &[Ident, LParen],
        covered: &[Ident, LParen],
    },
];

/// Tokens that are rarely missing. They are listed only if no other token is expected.
const RARELY_MISSING: &[Token] = &[
    Hat, Question, LStatic, Label, Percent, Slash, Star, Plus, Minus, Div, Mod, Dot, Comma,
    LBracket, When, Budget, Con, Initial, At, Import, Lt,
];

/// Role of an expected name in a message, by the token before it: after `node`, "the name of the node".
const NAME_PURPOSES: &[(Token, &str)] = &[
    (Finish, "a result name"),
    (Yield, "a result name"),
    (Fail, "a result name"),
    (Node, "the name of the node"),
    (Function, "the name of the function"),
    (Fragment, "the name of the fragment"),
    (Primitive, "the name of the primitive"),
    (Device, "the name of the device type"),
    (Frame, "the name of a frame"),
    (Command, "the name of the command"),
    (Task, "the name of the task"),
    (Use, "the name of a module"),
    (State, "the name of the state"),
    (Start, "the label of a step"),
    (On, "a result name, `fail` or `any`"),
    (Then, "the name of the next step or state"),
    (Continue, "the name of a state"),
    (Const, "the name of a constant"),
    (Type, "the name of a type"),
    (Var, "the name of a flow"),
    (Export, "the name of a flow"),
    (In, "the name of a frame"),
    (Dot, "the name of a field, port or result"),
    (When, "the name of a flow"),
    (Merge, "the name of a flow"),
    (Actuator, "the name of a port"),
    (Sensor, "the name of a port"),
    (Status, "the name of a port"),
];

/// Maximum number of expected tokens that a message lists, so that the message stays readable.
const MAX_LISTED: usize = 4;

/// Returns a description of the expected tokens for a message, such as "`;` or an operator". `before` is the token
/// before the syntax error.
pub(crate) fn describe(expected: &[Token], before: Option<Token>) -> String {
    let meant = |token: &Token| *token != Broken && !is_kind2_only(*token);
    let mut left: Vec<Token> = expected.iter().copied().filter(meant).collect();
    let mut words = Vec::new();
    for group in GROUPS {
        if group.required.iter().all(|token| left.contains(token)) {
            left.retain(|token| !group.covered.contains(token));
            words.push(group.term.to_owned());
        }
    }
    let meant = |token: &Token| !RARELY_MISSING.contains(token);
    if !words.is_empty() || left.iter().any(meant) {
        left.retain(meant);
    }
    let single = left
        .iter()
        .map(|token| describe_token(*token, before))
        .collect::<Vec<_>>();
    join_alternatives(single.into_iter().chain(words))
}

/// Returns whether the token occurs in Kind 2 programs only. Messages never suggest such a token.
fn is_kind2_only(token: Token) -> bool {
    let word = token.keyword().is_some_and(|word| !word.in_rpi);
    word || matches!(
        token,
        BitAnd
            | Append
            | Property
            | BitOr
            | BitNot
            | IfBlock
            | WhenBlock
            | CondBlock
            | FrameBlock
            | ElsIf
            | ElseBlock
            | EndBlock
            | Case
            | Asks
            | Becomes
    )
}

fn describe_token(token: Token, before: Option<Token>) -> String {
    let class = TOKEN_CLASSES.iter().find(|(_, class, _)| *class == token);
    let purpose = NAME_PURPOSES.iter().find(|(word, _)| Some(*word) == before);
    match (token, class, purpose) {
        (Ident | Path, _, Some((_, purpose))) => (*purpose).to_owned(),
        (_, Some((_, _, words)), _) => (*words).to_owned(),
        _ => format!("`{}`", token.spelling().unwrap_or_default()),
    }
}

fn join_alternatives(words: impl Iterator<Item = String>) -> String {
    let mut words: Vec<String> = words.collect();
    words.dedup();
    if words.len() > MAX_LISTED {
        words.truncate(MAX_LISTED - 1);
        words.push("another token".to_owned());
    }
    match words.pop() {
        None => "the end of the declaration".to_owned(),
        Some(last) if words.is_empty() => last,
        Some(last) => format!("{} or {last}", words.join(", ")),
    }
}

/// Returns advice for a syntax error at the token `here`; `None` if there is none for this token.
pub(crate) fn help_text(here: Option<Token>) -> Option<&'static str> {
    match here {
        Some(LBrace) => Some("a body is written between `let` and `tel`"),
        Some(Colon) => {
            Some("an equation is written `x = e`; its type is declared in the `var` section")
        }
        _ => None,
    }
}
