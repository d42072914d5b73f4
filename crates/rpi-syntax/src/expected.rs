//! Descriptions of the tokens that the grammar would have accepted.
//!
//! The grammar lists dozens of tokens where a reader expects "an expression". The tables turn sets of tokens into such
//! terms, and state the purpose of an expected name.

use crate::token::Token;

/// Grammar names of the tokens without a fixed spelling, with their descriptions.
const CLASSES: &[(&str, Token, &str)] = &[
    ("NAME", Token::Ident, "a name"),
    ("PATH", Token::Path, "a qualified name"),
    ("INT", Token::Int, "an integer"),
    ("REAL", Token::Real, "a real number"),
    ("STRING", Token::Str, "a string literal"),
    ("LABEL", Token::Label, "a string literal"),
    ("PROPERTY", Token::Property, "a property"),
    ("BROKEN", Token::Broken, ""),
];

/// Returns the token with this name in the grammar: `"let"` or `NAME`.
pub(crate) fn token(name: &str) -> Option<Token> {
    match name.starts_with('"') {
        true => Token::of_spelling(name.trim_matches('"')),
        false => {
            let class = CLASSES.iter().find(|(class, ..)| *class == name);
            class.map(|(_, token, _)| *token)
        }
    }
}

/// Set of tokens with a common term.
struct Group {
    words: &'static str,
    /// The group applies if all of these tokens are expected.
    needs: &'static [Token],
    /// Tokens that the term then replaces.
    covers: &'static [Token],
}

use Token::*;

/// Groups, larger sets first: the first tokens of an expression include those of a name.
const GROUPS: &[Group] = &[
    Group {
        words: "an argument",
        needs: &[Int, Not, Const, Node, BoolType],
        covers: &[
            LBrace, When, In, Int, Real, Str, True, False, Ident, Path, LParen, LBracket, Hash,
            Nor, Merge, Not, Minus, Pre, Current, Last, If, With, IntType, RealType, BoolType,
            Const, Node, Function, Type, Arrow, Plus, Star, Slash, Div, Mod, Pow, Hat, Bar,
            Coalesce, Implies, Or, Xor, And, Eq, Ne, Lt, Le, Gt, Ge, Fby,
        ],
    },
    Group {
        words: "an expression",
        needs: &[Int, Not, LParen],
        covers: &[
            LBrace, When, Int, Real, Str, True, False, Ident, Path, LParen, LBracket, Hash, Nor,
            Merge, Not, Minus, Pre, Current, Last, If, With, IntType, RealType,
        ],
    },
    Group {
        words: "an equation",
        needs: &[Assert, Automaton],
        covers: &[
            Assert, Automaton, Check, Property, Export, Fail, Finish, Fragment, Ident, Path,
            LParen, Yield,
        ],
    },
    Group {
        words: "a step",
        needs: &[Repeat, Start],
        covers: &[Parallel, Repeat, Start, Ident, Path],
    },
    Group {
        words: "a type",
        needs: &[BoolType, IntType],
        covers: &[
            BoolType, IntType, RealType, Ident, Path, Enum, Struct, LBrace, LBracket,
        ],
    },
    Group {
        words: "a contract clause",
        needs: &[Assume, Guarantee],
        covers: &[Assume, Guarantee, Var, Const, ModeWord],
    },
    Group {
        words: "an operator",
        needs: &[Arrow, Plus],
        covers: &[
            In, Arrow, Plus, Minus, Star, Slash, Div, Mod, Pow, Hat, Bar, Coalesce, Implies, Or,
            Xor, And, Eq, Ne, Lt, Le, Gt, Ge, Fby, When, Dot, LBracket, LBrace, LParen, LStatic,
            Percent,
        ],
    },
    Group {
        words: "a transition or the next state",
        needs: &[Unless, State],
        covers: &[Unless, Until, Initial, State, End],
    },
    Group {
        words: "the body",
        needs: &[Let, Var],
        covers: &[Let, Var, Const, Con, Semi],
    },
    Group {
        words: "a parameter",
        needs: &[Ident, Const, Node, Type],
        covers: &[Ident, Const, Node, Function, Type],
    },
    Group {
        words: "a port",
        needs: &[Ident, Const, LParen],
        covers: &[Ident, Const, LParen],
    },
    Group {
        words: "a name",
        needs: &[Ident, LParen],
        covers: &[Ident, LParen],
    },
];

/// Tokens that are rarely missing. They are listed only if no other token is expected.
const RARELY_MEANT: &[Token] = &[
    Hat, Question, LStatic, Label, Percent, Slash, Star, Plus, Minus, Div, Mod, Dot, Comma,
    LBracket, When, Budget, Con, Initial, At, Import, Lt,
];

/// Purpose of an expected name, by the token before it.
const NAMES: &[(Token, &str)] = &[
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

/// Maximum number of alternatives in a message.
const LISTED: usize = 4;

/// Returns a description of the expected tokens: "`;` or an operator". `before` is the token before the error.
pub(crate) fn in_words(expected: &[Token], before: Option<Token>) -> String {
    let meant = |token: &Token| *token != Broken && !is_of_kind2(*token);
    let mut left: Vec<Token> = expected.iter().copied().filter(meant).collect();
    let mut words = Vec::new();
    for group in GROUPS {
        if group.needs.iter().all(|token| left.contains(token)) {
            left.retain(|token| !group.covers.contains(token));
            words.push(group.words.to_owned());
        }
    }
    let meant = |token: &Token| !RARELY_MEANT.contains(token);
    if !words.is_empty() || left.iter().any(meant) {
        left.retain(meant);
    }
    let single = left
        .iter()
        .map(|token| one(*token, before))
        .collect::<Vec<_>>();
    listed(single.into_iter().chain(words))
}

/// Returns whether the token occurs in Kind 2 programs only. Such tokens are never suggested.
fn is_of_kind2(token: Token) -> bool {
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

fn one(token: Token, before: Option<Token>) -> String {
    let class = CLASSES.iter().find(|(_, class, _)| *class == token);
    let purpose = NAMES.iter().find(|(word, _)| Some(*word) == before);
    match (token, class, purpose) {
        (Ident | Path, _, Some((_, purpose))) => (*purpose).to_owned(),
        (_, Some((_, _, words)), _) => (*words).to_owned(),
        _ => format!("`{}`", token.spelling().unwrap_or_default()),
    }
}

fn listed(words: impl Iterator<Item = String>) -> String {
    let mut words: Vec<String> = words.collect();
    words.dedup();
    if words.len() > LISTED {
        words.truncate(LISTED - 1);
        words.push("another token".to_owned());
    }
    match words.pop() {
        None => "the end of the declaration".to_owned(),
        Some(last) if words.is_empty() => last,
        Some(last) => format!("{} or {last}", words.join(", ")),
    }
}

/// Returns a help text for the rejected token.
pub(crate) fn hint(here: Option<Token>) -> Option<&'static str> {
    match here {
        Some(LBrace) => Some("a body is written between `let` and `tel`"),
        Some(Colon) => {
            Some("an equation is written `x = e`; its type is declared in the `var` section")
        }
        _ => None,
    }
}
