//! Decides where a contextual word is a keyword and where it is a name.
//!
//! One pass over the tokens, left to right, by the row of the word table and the tokens on both
//! sides. So few words need to be reserved, and the grammar never sees the question.

use crate::Mode;
use crate::lexer::Lexeme;
use crate::token::{Keyword, Place, Token};

/// Turns every contextual word that stands where it is a name into a name, and every text that
/// names a claim into a label.
pub(crate) fn settle(lexemes: &mut [Lexeme], mode: Mode) {
    let has_own_check = mode == Mode::Rpi && declares_node(lexemes, Token::Check);
    let has_own_last = declares_node(lexemes, Token::Last);
    let matched = in_parentheses_matched(lexemes);
    let enclosed = enclosed(lexemes);
    let mut in_contract = false;
    for at in 0..lexemes.len() {
        let token = lexemes[at].token;
        if token == Token::Str {
            settle_text(lexemes, at);
        } else if let Some(word) = token.keyword()
            && !word.is_reserved_in(mode)
            && !Around::new(lexemes, at, &enclosed).makes_keyword(word)
            && !begins_claim(lexemes, at, in_contract, has_own_check, &enclosed)
            && !is_before_restart(lexemes, at)
            && (has_own_last || !is_last_of(lexemes, at, &enclosed))
            && matched.binary_search(&at).is_err()
        {
            lexemes[at].token = Token::Ident;
        }
        match lexemes[at].token {
            Token::Con | Token::Contract => in_contract = true,
            Token::Noc | Token::Tel => in_contract = false,
            _ => {}
        }
    }
}

/// The `;` inside of brackets, in text order: `merge(c; start * 2.0; x)`. No statement begins behind them. Those of the modes of a
/// contract, `mode m (require x; ensure y)`, are none of them, and a bracket that is not closed holds none.
fn enclosed(lexemes: &[Lexeme]) -> Vec<usize> {
    use Token::{LBracket, LParen, LStatic, Let, RBracket, RParen, RStatic, Semi, Tel};
    let of_mode = |open: usize| open >= 2 && lexemes[open - 2].token == Token::ModeWord;
    // Each open bracket, with the number of signs that had been found before it.
    let mut open: Vec<(usize, usize)> = Vec::new();
    let mut found = Vec::new();
    for (at, lexeme) in lexemes.iter().enumerate() {
        match lexeme.token {
            LParen | LBracket | LStatic => open.push((at, found.len())),
            Let | Tel => {
                let first = open.first().map_or(found.len(), |(_, count)| *count);
                found.truncate(first);
                open.clear();
            }
            Semi if !open.is_empty() => found.push(at),
            RParen | RBracket | RStatic => {
                if let Some((begin, count)) = open.pop()
                    && of_mode(begin)
                {
                    found.truncate(count);
                }
            }
            _ => {}
        }
    }
    let first = open.first().map_or(found.len(), |(_, count)| *count);
    found.truncate(first);
    found
}

/// `last (x)`: no call stands there, unless the file declares what is called so.
fn is_last_of(lexemes: &[Lexeme], at: usize, enclosed: &[usize]) -> bool {
    let around = Around::new(lexemes, at, enclosed);
    lexemes[at].token == Token::Last && around.after == Some(Token::LParen) && !around.is_field()
}

/// `(activate (restart N every r) every c)`: no call of something that is called `activate`.
fn is_before_restart(lexemes: &[Lexeme], at: usize) -> bool {
    let token = |behind: usize| lexemes.get(at + behind).map(|lexeme| lexeme.token);
    lexemes[at].token == Token::Activate
        && [token(1), token(2)] == [Some(Token::LParen), Some(Token::Restart)]
        && token(3).is_some_and(is_name)
}

/// The words `match` before a value in parentheses, `match (o) with A: 1 end`, in text order: what is called so is not followed
/// by cases.
fn in_parentheses_matched(lexemes: &[Lexeme]) -> Vec<usize> {
    let mut open = Vec::new();
    let mut found = Vec::new();
    for (at, lexeme) in lexemes.iter().enumerate() {
        match lexeme.token {
            Token::LParen => open.push(at),
            Token::RParen => {
                let word = open.pop().and_then(|open: usize| open.checked_sub(1));
                let word = word.filter(|word| lexemes[*word].token == Token::Match);
                found.extend(word.filter(|_| cases_follow(lexemes, at + 1)));
            }
            _ => {}
        }
    }
    found.sort_unstable();
    found
}

/// `with A: 1`, `with | A: 1`, `with W(A): 1`; but a part that is replaced is `with [0] = 1`.
fn cases_follow(lexemes: &[Lexeme], at: usize) -> bool {
    let token = |i: usize| lexemes.get(i).map(|lexeme| lexeme.token);
    let is_case = token(at + 1).is_some_and(is_name)
        && matches!(token(at + 2), Some(Token::Colon | Token::LParen));
    token(at) == Some(Token::With) && (is_case || token(at + 1) == Some(Token::Bar))
}

/// Whether something of the file that can be called has the word as its name.
fn declares_node(lexemes: &[Lexeme], word: Token) -> bool {
    use Token::{Fragment, Function, Imported, Node};
    let pairs = lexemes.windows(2);
    let declares = |token| matches!(token, Node | Function | Fragment | Imported);
    let mut names = pairs.filter(|pair| declares(pair[0].token));
    names.any(|pair| pair[1].token == word)
}

/// `guarantee (x > 0);` of a contract, `check (x > 0);` of a body: no call stands there, only one of a node `check` that the
/// file declares.
fn begins_claim(
    lexemes: &[Lexeme],
    at: usize,
    in_contract: bool,
    has_own_check: bool,
    enclosed: &[usize],
) -> bool {
    use Token::{Assume, Check, Ensure, Guarantee, LParen, ModeWord, Require};
    let around = Around::new(lexemes, at, enclosed);
    let of_mode = |at: usize| lexemes[at].token == ModeWord;
    let begins = match around.before {
        Some(LParen) => at.checked_sub(3).is_some_and(of_mode),
        _ => around.begins_statement(),
    };
    let is_claim = match lexemes[at].token {
        Check => !in_contract && !has_own_check,
        Assume | Ensure | Guarantee | Require => in_contract,
        _ => false,
    };
    is_claim && begins && around.after == Some(LParen)
}

fn settle_text(lexemes: &mut [Lexeme], at: usize) {
    use Token::{Assert, Assume, Check, Ensure, Guarantee, Property, Require};
    let before = at.checked_sub(1).map(|i| lexemes[i].token);
    if let Some(Assert | Assume | Check | Ensure | Guarantee | Property | Require) = before {
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

/// Parts the `>>` of `any@<set<int>>` in two: both close a list of types that a `<` opens.
pub(crate) fn part_closing(lexemes: &mut Vec<Lexeme>) {
    let mut open: Vec<Token> = Vec::new();
    let mut parted = Vec::new();
    for at in 0..lexemes.len() {
        match lexemes[at].token {
            Token::Lt if opens_types(lexemes, at, open.last()) => open.push(Token::Lt),
            Token::LStatic => open.push(Token::LStatic),
            Token::Gt | Token::RStatic if open.is_empty() => {}
            Token::Gt => {
                open.pop_if(|token| *token == Token::Lt);
            }
            Token::RStatic if open.pop() == Some(Token::Lt) => {
                if open.last() == Some(&Token::LStatic) && closes_both(lexemes, at) {
                    shift(lexemes, at);
                } else {
                    open.pop_if(|token| *token == Token::Lt);
                    parted.push(at);
                }
            }
            Token::Let | Token::Tel | Token::Eq => open.clear(),
            _ => {}
        }
    }
    for at in parted.into_iter().rev() {
        let whole = lexemes[at];
        let middle = whole.start + 1;
        lexemes[at] = Lexeme {
            token: Token::Gt,
            end: middle,
            ..whole
        };
        lexemes.insert(
            at + 1,
            Lexeme {
                token: Token::Gt,
                start: middle,
                ..whole
            },
        );
    }
}

/// Whether a `>` stands right behind: `>>>` of `any<<type set<int>>>`.
fn closes_both(lexemes: &[Lexeme], at: usize) -> bool {
    let next = lexemes.get(at + 1);
    next.is_some_and(|next| next.token == Token::Gt && next.start == lexemes[at].end)
}

/// `>> >` becomes `> >>`.
fn shift(lexemes: &mut [Lexeme], at: usize) {
    let middle = lexemes[at].start + 1;
    (lexemes[at].token, lexemes[at].end) = (Token::Gt, middle);
    (lexemes[at + 1].token, lexemes[at + 1].start) = (Token::RStatic, middle);
}

/// Whether the `<` opens a list of types: after `@`, after a name where a type stands, or inside such a list.
fn opens_types(lexemes: &[Lexeme], at: usize, open: Option<&Token>) -> bool {
    use Token::{At, Colon, Comma, Gt, Ident, LStatic, Lt, Semi, Type};
    let token = |back: usize| at.checked_sub(back).map(|at| lexemes[at].token);
    match (token(1), token(2)) {
        (Some(At), _) | (Some(Ident), Some(Colon)) => true,
        (Some(Ident), Some(Lt | Comma | Semi | Gt)) => open == Some(&Lt),
        (Some(Ident), Some(Type)) => open == Some(&LStatic),
        _ => false,
    }
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
    third_before: Option<Token>,
    second_before: Option<Token>,
    before: Option<Token>,
    after: Option<Token>,
    second_after: Option<Token>,
    /// Whether a `;` stands before it that is inside of brackets.
    is_enclosed: bool,
    /// Whether a bracket follows in which variables are declared.
    binds: bool,
}

/// Whether names with their type follow the bracket at `at`.
fn declares(lexemes: &[Lexeme], at: usize) -> bool {
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

fn is_name(token: Token) -> bool {
    let word = token.keyword();
    token == Token::Ident || word.is_some_and(|word| word.place != Place::Reserved)
}

impl Around {
    fn new(lexemes: &[Lexeme], at: usize, enclosed: &[usize]) -> Around {
        let token = |i: usize| lexemes.get(i).map(|lexeme| lexeme.token);
        let semi = at.checked_sub(1).filter(|_| !enclosed.is_empty());
        Around {
            is_enclosed: semi.is_some_and(|semi| enclosed.binary_search(&semi).is_ok()),
            third_before: at.checked_sub(3).and_then(token),
            second_after: token(at + 2),
            second_before: at.checked_sub(2).and_then(token),
            before: at.checked_sub(1).and_then(token),
            after: token(at + 1),
            binds: declares(lexemes, at + 1),
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
            Place::AfterOperand => self.is_after_operand() && !self.is_restarted(),
            Place::Either => self.is_before_name() || self.is_after_operand(),
            Place::Clause => self.is_after_operand() || self.begins_statement(),
            Place::Alternative => self.is_alternative(),
            Place::Branch => self.is_before_name() && self.is_after_operand_or_bar(),
            Place::Binder => self.binds,
            Place::Conversion => self.converts(word),
            Place::Prefix => self.is_prefix(),
            Place::Matched => {
                self.is_before_name() || self.is_prefix() && self.after != Some(Token::LParen)
            }
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
            Some(Semi) => !self.is_enclosed,
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
            Some(_) if self.is_joined() => false,
            Some(word) => word.place != Place::Reserved && !self.is_element(),
        }
    }

    /// `status in base`: a connective word follows, and behind it no other. `c initial default x` has a value before it.
    fn is_joined(&self) -> bool {
        if self.before.is_some_and(ends_value) {
            return false;
        }
        let connects = |token: Token| {
            let place = token.keyword().map(|word| word.place);
            matches!(
                place,
                Some(Place::AfterOperand | Place::Clause | Place::Branch | Place::Either)
            )
        };
        let goes_on = |token| begins_operand(token) || is_name(token) && !connects(token);
        self.after.is_some_and(connects) && self.second_after.is_some_and(goes_on)
    }

    /// First or next in a list, where a connective word may follow: `Pose(state in base)`.
    fn is_element(&self) -> bool {
        matches!(self.before, Some(Token::LParen | Token::Comma))
    }

    fn is_after_operand(&self) -> bool {
        self.before.is_some_and(ends_operand) && !self.is_converted()
    }

    /// `int step`: a conversion, where no type stands.
    fn is_converted(&self) -> bool {
        let is_type = matches!(self.second_before, Some(Token::Colon | Token::Of));
        matches!(self.before, Some(Token::IntType | Token::RealType)) && !is_type
    }

    /// `real current x`: `int` and `real` end a type, or convert what follows.
    fn is_prefix(&self) -> bool {
        let converted = matches!(self.before, Some(Token::IntType | Token::RealType));
        (converted || !self.is_after_operand()) && self.after.is_some_and(begins_operand)
    }

    /// `(restart step every c)(x)`, where `step` is a node.
    fn is_restarted(&self) -> bool {
        [self.second_before, self.before] == [Some(Token::LParen), Some(Token::Restart)]
    }

    fn is_after_operand_or_bar(&self) -> bool {
        self.is_after_operand() || self.before == Some(Token::Bar)
    }

    /// `(int8 x)`
    fn converts(&self, word: &Keyword) -> bool {
        use Token::{At, Colon, Ident, Int, LParen, Minus};
        let is_type = matches!(self.before, Some(Colon | Token::Of));
        // `sint` has a width behind it: `sint - 1` is a difference.
        if matches!(word.text, "sint" | "uint") && self.after == Some(Minus) {
            return false;
        }
        !is_type && matches!(self.after, Some(At | Ident | Int | LParen | Minus))
    }

    fn is_alternative(&self) -> bool {
        use Token::{Bar, Continue, Then, Unless, Until};
        let begins = matches!(self.before, Some(Bar | Unless | Until));
        begins && matches!(self.after, Some(Continue | Then))
    }
}

/// Whether the token begins an operand and goes on with none: `x - y` is a difference, also if `x` is a prefix elsewhere.
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

/// Whether the token ends a value.
pub(crate) fn ends_value(token: Token) -> bool {
    use Token::{
        False, Ident, Int, Path, Percent, RBrace, RBracket, RParen, RStatic, Real, Str, True,
    };
    let value = matches!(token, Ident | Path | Int | Real | Str | True | False);
    value || matches!(token, RParen | RBracket | RBrace | RStatic | Percent)
}

/// Whether an operator could stand after the token.
fn ends_operand(token: Token) -> bool {
    use Token::{BoolType, End, Initial, IntType, Otherwise, Question, RealType, Restart, Tel};
    match token {
        token if ends_value(token) => true,
        // Ends of types, bodies and clauses, after which a clause may follow.
        BoolType | IntType | RealType | Question | Tel | End | Initial | Otherwise | Restart => {
            true
        }
        _ => false,
    }
}
