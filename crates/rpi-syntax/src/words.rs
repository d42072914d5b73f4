//! Decides where a contextual word is a keyword and where it is a name.
//!
//! One pass over the tokens, left to right, by the row of the word table and the tokens on both
//! sides. So few words need to be reserved, and the grammar never sees the question.

use crate::lexer::Lexeme;
use crate::token::{Keyword, Place, Token};

/// Turns every contextual word that stands where it is a name into a name, and every text that
/// names a claim into a label.
pub(crate) fn settle(lexemes: &mut [Lexeme]) {
    for at in 0..lexemes.len() {
        let token = lexemes[at].token;
        if token == Token::Str {
            settle_text(lexemes, at);
        } else if let Some(word) = token.keyword()
            && word.place != Place::Reserved
            && !Around::new(lexemes, at).makes_keyword(word)
        {
            lexemes[at].token = Token::Ident;
        }
    }
}

fn settle_text(lexemes: &mut [Lexeme], at: usize) {
    use Token::{Assert, Assume, Check, Ensure, Guarantee, Require};
    let before = at.checked_sub(1).map(|i| lexemes[i].token);
    if let Some(Assert | Assume | Check | Ensure | Guarantee | Require) = before {
        lexemes[at].token = Token::Label;
    }
}

/// Puts in the `type` of `f<<type real[m]>>` where it was left out: nothing else than a type can be meant.
pub(crate) fn mark_types(lexemes: &mut Vec<Lexeme>) {
    use Token::{Comma, LBracket, LStatic, RealType};
    let begins = |at: &usize| {
        let is_type = lexemes[at + 1].token == RealType && lexemes[at + 2].token == LBracket;
        match lexemes[*at].token {
            LStatic => is_type,
            Comma => is_type && opened_by(&lexemes[..*at]) == Some(LStatic),
            _ => false,
        }
    };
    let marks: Vec<usize> = (0..lexemes.len().saturating_sub(2))
        .filter(begins)
        .collect();
    if marks.is_empty() {
        return;
    }
    let mut marked = Vec::with_capacity(lexemes.len() + marks.len());
    let mut from = 0;
    for at in marks {
        marked.extend_from_slice(&lexemes[from..=at]);
        let start = lexemes[at + 1].start;
        marked.push(Lexeme {
            token: Token::Type,
            start,
            end: start,
        });
        from = at + 1;
    }
    marked.extend_from_slice(&lexemes[from..]);
    *lexemes = marked;
}

/// How far back the bracket around a type is looked for.
const NEAR: usize = 200;

/// The bracket that is open behind these tokens.
fn opened_by(before: &[Lexeme]) -> Option<Token> {
    use Token::{LBrace, LBracket, LParen, LStatic, RBrace, RBracket, RParen, RStatic};
    let mut depth = 0u32;
    let opens = before
        .iter()
        .rev()
        .take(NEAR)
        .find(|lexeme| match lexeme.token {
            RParen | RBracket | RBrace | RStatic => {
                depth += 1;
                false
            }
            LParen | LBracket | LBrace | LStatic if depth == 0 => true,
            LParen | LBracket | LBrace | LStatic => {
                depth -= 1;
                false
            }
            _ => false,
        });
    opens.map(|lexeme| lexeme.token)
}

/// The tokens around a word: those before it are settled, the next one is not.
struct Around {
    second_before: Option<Token>,
    before: Option<Token>,
    after: Option<Token>,
}

impl Around {
    fn new(lexemes: &[Lexeme], at: usize) -> Around {
        let token = |i: usize| lexemes.get(i).map(|lexeme| lexeme.token);
        Around {
            second_before: at.checked_sub(2).and_then(token),
            before: at.checked_sub(1).and_then(token),
            after: token(at + 1),
        }
    }

    fn makes_keyword(&self, word: &Keyword) -> bool {
        if self.is_field() || self.is_defined_or_named() {
            return false;
        }
        match word.place {
            Place::Reserved => true,
            Place::Declaration => self.begins(self.begins_declaration()),
            Place::Statement => self.begins(self.begins_statement()),
            Place::BeforeName => self.is_before_name(),
            Place::AfterOperand => self.is_after_operand(),
            Place::Either => self.is_before_name() || self.is_after_operand(),
            Place::Clause => self.is_after_operand() || self.begins_statement(),
            Place::Alternative => self.is_alternative(),
            Place::Branch => self.is_before_name() && self.is_after_operand_or_bar(),
        }
    }

    /// `arm.end`; but a `.` after `tel` ends a declaration.
    fn is_field(&self) -> bool {
        self.before == Some(Token::Dot) && self.second_before != Some(Token::Tel)
    }

    /// `end = 3`, `start: real`, `(end, x)`, `f(start)`
    fn is_defined_or_named(&self) -> bool {
        use Token::{Colon, Comma, Dot, Eq, RParen};
        matches!(self.after, Some(Eq | Colon | Comma | Dot | RParen))
    }

    /// `test(x)`, `frame[2]`
    fn is_called(&self) -> bool {
        use Token::{LBracket, LParen};
        matches!(self.after, Some(LParen | LBracket))
    }

    /// Where something can begin, if it is no call there; or right before a name, where nothing else
    /// than a word of the language can stand.
    fn begins(&self, can_begin: bool) -> bool {
        use Token::{Ident, Int, Path, Real, Str};
        let before_name = matches!(self.after, Some(Ident | Path | Int | Real | Str));
        before_name || can_begin && !self.is_called()
    }

    fn begins_declaration(&self) -> bool {
        self.begins_statement() || matches!(self.before, Some(Token::Dot | Token::Str))
    }

    fn begins_statement(&self) -> bool {
        use Token::{Automaton, Con, End, Initial, Let, Noc, Semi, Tel};
        match self.before {
            None | Some(Let | Tel | Semi | End | Con | Noc | Automaton | Initial) => true,
            // `mode m (require x; ...)`
            Some(Token::LParen) => self.second_before == Some(Token::Ident),
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
            Some(word) => word.place != Place::Reserved && !self.is_element(),
        }
    }

    /// First or next in a list, where a connective word may follow: `Pose(state in base)`.
    fn is_element(&self) -> bool {
        matches!(self.before, Some(Token::LParen | Token::Comma))
    }

    fn is_after_operand(&self) -> bool {
        self.before.is_some_and(ends_operand)
    }

    fn is_after_operand_or_bar(&self) -> bool {
        self.is_after_operand() || self.before == Some(Token::Bar)
    }

    fn is_alternative(&self) -> bool {
        use Token::{Bar, Unless, Until};
        matches!(self.before, Some(Bar | Unless | Until))
    }
}

/// Whether an operator could stand after the token.
fn ends_operand(token: Token) -> bool {
    use Token::{
        BoolType, End, False, Ident, Initial, Int, IntType, Otherwise, Path, Percent, Question,
        RBrace, RBracket, RParen, RStatic, Real, RealType, Restart, Str, Tel, True,
    };
    match token {
        Ident | Path | Int | Real | Str | True | False => true,
        RParen | RBracket | RBrace | RStatic | Percent => true,
        // Ends of types, bodies and clauses, after which a clause may follow.
        BoolType | IntType | RealType | Question | Tel | End | Initial | Otherwise | Restart => {
            true
        }
        _ => false,
    }
}
