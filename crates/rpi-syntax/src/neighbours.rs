//! Decides whether a contextual keyword is a keyword or a name, by the tokens around it.

use crate::lexer::Lexeme;
use crate::token::{Keyword, KeywordContext, Token};

/// Tokens around a word that may be a keyword or a name. Tokens before the word have been classified as keyword or
/// name, tokens after it have not.
pub(crate) struct Neighbours {
    third_before: Option<Token>,
    second_before: Option<Token>,
    pub(crate) before: Option<Token>,
    pub(crate) after: Option<Token>,
    second_after: Option<Token>,
    /// Whether the token before the word is a `;` inside brackets, after which no statement begins.
    follows_enclosed_semi: bool,
    /// Whether a bracket with variable declarations follows the word: `(x: int`.
    precedes_declarations: bool,
}

/// Returns whether the token at index `at` is a bracket that begins with a variable declaration: `(x: int`, `{ x: int`.
fn declares_variables(lexemes: &[Lexeme], at: usize) -> bool {
    let token = |i: usize| lexemes.get(i).map(|lexeme| lexeme.token);
    if !matches!(token(at), Some(Token::LParen | Token::LBrace)) {
        return false;
    }
    let mut next = at + 1;
    while token(next).is_some_and(is_name) && token(next + 1) == Some(Token::Comma) {
        next += 2;
    }
    token(next).is_some_and(is_name) && token(next + 1) == Some(Token::Colon)
}

pub(crate) fn is_name(token: Token) -> bool {
    let word = token.keyword();
    token == Token::Ident || word.is_some_and(|word| word.context != KeywordContext::Reserved)
}

impl Neighbours {
    pub(crate) fn new(lexemes: &[Lexeme], at: usize, enclosed: &[usize]) -> Neighbours {
        let token = |i: usize| lexemes.get(i).map(|lexeme| lexeme.token);
        let semi = at.checked_sub(1).filter(|_| !enclosed.is_empty());
        Neighbours {
            follows_enclosed_semi: semi.is_some_and(|semi| enclosed.binary_search(&semi).is_ok()),
            third_before: at.checked_sub(3).and_then(token),
            second_after: token(at + 2),
            second_before: at.checked_sub(2).and_then(token),
            before: at.checked_sub(1).and_then(token),
            after: token(at + 1),
            precedes_declarations: declares_variables(lexemes, at + 1),
        }
    }

    pub(crate) fn is_keyword(&self, word: &Keyword) -> bool {
        if self.is_field() || self.is_certainly_name() {
            return false;
        }
        match word.context {
            KeywordContext::Reserved => true,
            KeywordContext::Declaration => self.is_at_start(self.begins_declaration()),
            KeywordContext::Statement => self.is_at_start(self.begins_statement()),
            KeywordContext::BeforeName => self.is_before_name(),
            KeywordContext::AfterOperand => self.is_after_operand() && !self.is_restarted_node(),
            KeywordContext::BeforeNameOrAfterOperand => {
                self.is_before_name() || self.is_after_operand()
            }
            KeywordContext::AfterOperandOrStatement => {
                self.is_after_operand() || self.begins_statement()
            }
            KeywordContext::TransitionAlternative => self.is_transition_alternative(),
            KeywordContext::Branch => self.is_before_name() && self.is_after_operand_or_bar(),
            KeywordContext::Binder => self.precedes_declarations,
            KeywordContext::Conversion => self.is_conversion(word),
            KeywordContext::Prefix => self.is_prefix(),
            KeywordContext::MatchExpr => {
                self.is_before_name() || self.is_prefix() && self.after != Some(Token::LParen)
            }
        }
    }

    /// Returns whether the word is the name of a field after a `.`: `arm.end`. A `.` after `tel` ends a declaration
    /// instead.
    pub(crate) fn is_field(&self) -> bool {
        self.before == Some(Token::Dot) && self.second_before != Some(Token::Tel)
    }

    /// Returns whether the next token shows that the word is a name and not a keyword: `end = 3`, `start: real`,
    /// `(end, x)`, `f(start)`.
    fn is_certainly_name(&self) -> bool {
        use Token::{Colon, Comma, Dot, Eq, RParen};
        matches!(self.after, Some(Eq | Colon | Comma | Dot | RParen))
    }

    /// Returns whether the word is followed by arguments or an index: `test(x)`, `frame[2]`.
    fn is_called(&self) -> bool {
        use Token::{LBracket, LParen};
        matches!(self.after, Some(LParen | LBracket))
    }

    /// Returns whether the word begins a declaration or statement. It does so directly before a name or literal, where
    /// only a keyword is possible, and at a possible start (`can_begin`) if no arguments or index follow.
    fn is_at_start(&self, can_begin: bool) -> bool {
        use Token::{Ident, Int, Path, Real, Str};
        let before_name = matches!(self.after, Some(Ident | Path | Int | Real | Str));
        before_name || can_begin && !self.is_called()
    }

    fn begins_declaration(&self) -> bool {
        self.begins_statement() || matches!(self.before, Some(Token::Dot | Token::Str))
    }

    pub(crate) fn begins_statement(&self) -> bool {
        use Token::{Automaton, Con, End, Initial, Let, Noc, Semi, Tel};
        match self.before {
            Some(Semi) => !self.follows_enclosed_semi,
            None | Some(Let | Tel | End | Con | Noc | Automaton | Initial) => true,
            // `mode m (require x; ...)`
            Some(Token::LParen) => self.third_before == Some(Token::ModeWord),
            _ => false,
        }
    }

    fn is_before_name(&self) -> bool {
        use Token::{Ident, Int, Path, Real, Str};
        let Some(after) = self.after else {
            return false;
        };
        match after.keyword() {
            None => matches!(after, Ident | Path | Int | Real | Str),
            Some(_) if self.precedes_connective() => false,
            Some(word) => word.context != KeywordContext::Reserved && !self.is_list_element(),
        }
    }

    /// Returns whether the word is an operand before a keyword that connects two operands: `status` in
    /// `status in base`. After a value the word is a keyword itself: `initial` in `c initial default x`.
    fn precedes_connective(&self) -> bool {
        if self.before.is_some_and(ends_value) {
            return false;
        }
        let connects = |token: Token| {
            let place = token.keyword().map(|word| word.context);
            matches!(
                place,
                Some(
                    KeywordContext::AfterOperand
                        | KeywordContext::AfterOperandOrStatement
                        | KeywordContext::Branch
                        | KeywordContext::BeforeNameOrAfterOperand
                )
            )
        };
        let goes_on = |token| begins_operand(token) || is_name(token) && !connects(token);
        self.after.is_some_and(connects) && self.second_after.is_some_and(goes_on)
    }

    /// Returns whether the word begins an element of a list in parentheses: `state` in `Pose(state in base)`. A keyword
    /// may follow such a word.
    fn is_list_element(&self) -> bool {
        matches!(self.before, Some(Token::LParen | Token::Comma))
    }

    fn is_after_operand(&self) -> bool {
        self.before.is_some_and(ends_operand) && !self.follows_conversion()
    }

    /// Returns whether the word is the operand of a conversion: `step` in `int step`. After `:` or `of`, `int` is a
    /// type.
    fn follows_conversion(&self) -> bool {
        let is_type = matches!(self.second_before, Some(Token::Colon | Token::Of));
        matches!(self.before, Some(Token::IntType | Token::RealType)) && !is_type
    }

    /// Returns whether the word is a prefix operator: `current` in `real current x`. An `int` or `real` before the word
    /// may be a conversion.
    fn is_prefix(&self) -> bool {
        let converted = matches!(self.before, Some(Token::IntType | Token::RealType));
        (converted || !self.is_after_operand()) && self.after.is_some_and(begins_operand)
    }

    /// Returns whether the word is the name of the node in a restart: `step` in `(restart step every c)(x)`.
    fn is_restarted_node(&self) -> bool {
        [self.second_before, self.before] == [Some(Token::LParen), Some(Token::Restart)]
    }

    fn is_after_operand_or_bar(&self) -> bool {
        self.is_after_operand() || self.before == Some(Token::Bar)
    }

    /// Returns whether the word is a conversion to a machine integer: `int8` in `(int8 x)`.
    fn is_conversion(&self, word: &Keyword) -> bool {
        use Token::{At, Colon, Ident, Int, LParen, Minus};
        let is_type = matches!(self.before, Some(Colon | Token::Of));
        // `sint` needs a width: `sint - 1` is a difference.
        if matches!(word.text, "sint" | "uint") && self.after == Some(Minus) {
            return false;
        }
        !is_type && matches!(self.after, Some(At | Ident | Int | LParen | Minus))
    }

    fn is_transition_alternative(&self) -> bool {
        use Token::{Bar, Continue, Then, Unless, Until};
        let begins = matches!(self.before, Some(Bar | Unless | Until));
        begins && matches!(self.after, Some(Continue | Then))
    }
}

/// Returns whether the token begins an operand and cannot continue an expression. `-` is excluded, as it also continues
/// one: `x - y`.
pub(crate) fn begins_operand(token: Token) -> bool {
    use Token::{
        Current, False, Hash, Ident, If, Int, IntType, LParen, Last, Merge, Nor, Not, Path, Pre,
        Real, RealType, Str, True, With,
    };
    let value = matches!(
        token,
        Ident | Path | Int | Real | Str | True | False | LParen
    );
    let word = matches!(
        token,
        If | With | Not | Pre | Current | Last | Merge | Nor | Hash | IntType | RealType
    );
    value || word
}

/// Returns whether an operand can end with this token, so that an operator may follow: a name, a literal, a closing
/// bracket or `%`.
pub(crate) fn ends_value(token: Token) -> bool {
    use Token::{
        False, Ident, Int, Path, Percent, RBrace, RBracket, RParen, RStatic, Real, Str, True,
    };
    let value = matches!(token, Ident | Path | Int | Real | Str | True | False);
    value || matches!(token, RParen | RBracket | RBrace | RStatic | Percent)
}

/// Returns whether an operator or a clause such as `budget` may follow the token.
fn ends_operand(token: Token) -> bool {
    use Token::{BoolType, End, Initial, IntType, Otherwise, Question, RealType, Restart, Tel};
    match token {
        token if ends_value(token) => true,
        // Last tokens of types, bodies and clauses: a clause may follow.
        BoolType | IntType | RealType | Question | Tel | End | Initial | Otherwise | Restart => {
            true
        }
        _ => false,
    }
}
