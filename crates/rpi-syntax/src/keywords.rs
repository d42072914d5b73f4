//! Resolution of contextual keywords: decides where such a word is a keyword and where it is a name.
//!
//! One pass over the tokens, left to right, uses the row of the keyword table and the neighbouring tokens. So few words
//! need to be reserved, and the grammar has no ambiguity to resolve.

use crate::Dialect;
use crate::lexer::Lexeme;
use crate::token::{Keyword, KeywordContext, Token};

/// Turns every contextual keyword that is used as a name into a name, and every string that names a claim into a label.
pub(crate) fn resolve_keywords(lexemes: &mut [Lexeme], mode: Dialect) {
    let has_own_check = mode == Dialect::Rpi && declares_node(lexemes, Token::Check);
    let has_own_last = declares_node(lexemes, Token::Last);
    let matched = matches_on_parentheses(lexemes);
    let enclosed = semicolons_in_brackets(lexemes);
    let mut in_contract = false;
    for at in 0..lexemes.len() {
        let token = lexemes[at].token;
        if token == Token::Str {
            resolve_label(lexemes, at);
        } else if let Some(word) = token.keyword()
            && !word.is_reserved_in(mode)
            && !Neighbours::new(lexemes, at, &enclosed).is_keyword(word)
            && !begins_claim(lexemes, at, in_contract, has_own_check, &enclosed)
            && !is_activate_of_restart(lexemes, at)
            && (has_own_last || !is_last_operator(lexemes, at, &enclosed))
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

/// Returns the indices of the `;` inside brackets, in text order: `merge(c; start * 2.0; x)`. No statement begins after
/// them. The `;` in a mode of a contract, `mode m (require x; ensure y)`, and in an unclosed bracket are left out.
fn semicolons_in_brackets(lexemes: &[Lexeme]) -> Vec<usize> {
    use Token::{LBracket, LParen, LStatic, Let, RBracket, RParen, RStatic, Semi, Tel};
    let of_mode = |open: usize| open >= 2 && lexemes[open - 2].token == Token::ModeWord;
    // Each open bracket with the number of `;` found before it.
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

/// Returns whether the token is the operator `last` before a bracket: `last (x)`.
fn is_last_operator(lexemes: &[Lexeme], at: usize, enclosed: &[usize]) -> bool {
    let around = Neighbours::new(lexemes, at, enclosed);
    lexemes[at].token == Token::Last && around.after == Some(Token::LParen) && !around.is_field()
}

/// Returns whether the token is the keyword in `(activate (restart N every r) every c)`, not a call of `activate`.
fn is_activate_of_restart(lexemes: &[Lexeme], at: usize) -> bool {
    let token = |behind: usize| lexemes.get(at + behind).map(|lexeme| lexeme.token);
    lexemes[at].token == Token::Activate
        && [token(1), token(2)] == [Some(Token::LParen), Some(Token::Restart)]
        && token(3).is_some_and(is_name)
}

/// Returns the indices of the `match` before a value in parentheses, `match (o) with A: 1 end`, in text order. A call
/// of a node named `match` is not followed by cases.
fn matches_on_parentheses(lexemes: &[Lexeme]) -> Vec<usize> {
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

/// Returns whether cases follow: `with A: 1`, `with | A: 1`, `with W(A): 1`. An update has the form `with [0] = 1`.
fn cases_follow(lexemes: &[Lexeme], at: usize) -> bool {
    let token = |i: usize| lexemes.get(i).map(|lexeme| lexeme.token);
    let is_case = token(at + 1).is_some_and(is_name)
        && matches!(token(at + 2), Some(Token::Colon | Token::LParen));
    token(at) == Some(Token::With) && (is_case || token(at + 1) == Some(Token::Bar))
}

/// Returns whether the file declares a node, function or fragment named like the keyword.
fn declares_node(lexemes: &[Lexeme], word: Token) -> bool {
    use Token::{Fragment, Function, Imported, Node};
    let pairs = lexemes.windows(2);
    let declares = |token| matches!(token, Node | Function | Fragment | Imported);
    let mut names = pairs.filter(|pair| declares(pair[0].token));
    names.any(|pair| pair[1].token == word)
}

/// Returns whether the token begins a claim with a bracket, not a call: `guarantee (x > 0);` in a contract,
/// `check (x > 0);` in a body. If the file declares a node `check`, the latter is a call.
fn begins_claim(
    lexemes: &[Lexeme],
    at: usize,
    in_contract: bool,
    has_own_check: bool,
    enclosed: &[usize],
) -> bool {
    use Token::{Assume, Check, Ensure, Guarantee, LParen, ModeWord, Require};
    let around = Neighbours::new(lexemes, at, enclosed);
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

fn resolve_label(lexemes: &mut [Lexeme], at: usize) {
    use Token::{Assert, Assume, Check, Ensure, Guarantee, Property, Require};
    let before = at.checked_sub(1).map(|i| lexemes[i].token);
    if let Some(Assert | Assume | Check | Ensure | Guarantee | Property | Require) = before {
        lexemes[at].token = Token::Label;
    }
}

/// Inserts the `type` of `f<<type real[m]>>` where it is left out, as only a type is possible there.
pub(crate) fn insert_type_keywords(lexemes: &mut Vec<Lexeme>) {
    use Token::{Comma, LBracket, LStatic, RealType};
    let begins = |at: &usize| {
        let is_type = lexemes[at + 1].token == RealType && lexemes[at + 2].token == LBracket;
        match lexemes[*at].token {
            LStatic => is_type,
            Comma => is_type && innermost_open_bracket(&lexemes[..*at]) == Some(LStatic),
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

/// Splits the `>>` of `any@<set<int>>` into two `>`, as each closes a list of types opened by `<`.
pub(crate) fn split_closing(lexemes: &mut Vec<Lexeme>) {
    let mut open: Vec<Token> = Vec::new();
    let mut parted = Vec::new();
    for at in 0..lexemes.len() {
        match lexemes[at].token {
            Token::Lt if opens_type_list(lexemes, at, open.last()) => open.push(Token::Lt),
            Token::LStatic => open.push(Token::LStatic),
            Token::Gt | Token::RStatic if open.is_empty() => {}
            Token::Gt => {
                open.pop_if(|token| *token == Token::Lt);
            }
            Token::RStatic if open.pop() == Some(Token::Lt) => {
                if open.last() == Some(&Token::LStatic) && is_triple_closing(lexemes, at) {
                    shift_closing(lexemes, at);
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

/// Returns whether a `>` follows directly: the `>>>` of `any<<type set<int>>>`.
fn is_triple_closing(lexemes: &[Lexeme], at: usize) -> bool {
    let next = lexemes.get(at + 1);
    next.is_some_and(|next| next.token == Token::Gt && next.start == lexemes[at].end)
}

/// Turns `>> >` into `> >>`.
fn shift_closing(lexemes: &mut [Lexeme], at: usize) {
    let middle = lexemes[at].start + 1;
    (lexemes[at].token, lexemes[at].end) = (Token::Gt, middle);
    (lexemes[at + 1].token, lexemes[at + 1].start) = (Token::RStatic, middle);
}

/// Returns whether the `<` opens a list of types: after `@`, after a name in the place of a type, or inside such a
/// list.
fn opens_type_list(lexemes: &[Lexeme], at: usize, open: Option<&Token>) -> bool {
    use Token::{At, Colon, Comma, Gt, Ident, LStatic, Lt, Semi, Type};
    let token = |back: usize| at.checked_sub(back).map(|at| lexemes[at].token);
    match (token(1), token(2)) {
        (Some(At), _) | (Some(Ident), Some(Colon)) => true,
        (Some(Ident), Some(Lt | Comma | Semi | Gt)) => open == Some(&Lt),
        (Some(Ident), Some(Type)) => open == Some(&LStatic),
        _ => false,
    }
}

/// Maximum number of tokens searched backwards for the bracket around a type.
const MAX_LOOKBEHIND: usize = 200;

/// Returns the innermost bracket that is open after these tokens.
fn innermost_open_bracket(before: &[Lexeme]) -> Option<Token> {
    use Token::{LBrace, LBracket, LParen, LStatic, RBrace, RBracket, RParen, RStatic};
    let mut depth = 0u32;
    let opens = before
        .iter()
        .rev()
        .take(MAX_LOOKBEHIND)
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

/// Tokens around a word. Keywords before it are resolved; those after it are not.
struct Neighbours {
    third_before: Option<Token>,
    second_before: Option<Token>,
    before: Option<Token>,
    after: Option<Token>,
    second_after: Option<Token>,
    /// Whether the previous token is a `;` inside brackets.
    follows_enclosed_semi: bool,
    /// Whether a bracket with variable declarations follows.
    precedes_declarations: bool,
}

/// Returns whether variable declarations follow the bracket at `at`.
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

fn is_name(token: Token) -> bool {
    let word = token.keyword();
    token == Token::Ident || word.is_some_and(|word| word.context != KeywordContext::Reserved)
}

impl Neighbours {
    fn new(lexemes: &[Lexeme], at: usize, enclosed: &[usize]) -> Neighbours {
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

    fn is_keyword(&self, word: &Keyword) -> bool {
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

    /// Returns whether the word is a field: `arm.end`. A `.` after `tel` ends a declaration instead.
    fn is_field(&self) -> bool {
        self.before == Some(Token::Dot) && self.second_before != Some(Token::Tel)
    }

    /// Returns whether the next token shows that the word is a name: `end = 3`, `start: real`, `(end, x)`, `f(start)`.
    fn is_certainly_name(&self) -> bool {
        use Token::{Colon, Comma, Dot, Eq, RParen};
        matches!(self.after, Some(Eq | Colon | Comma | Dot | RParen))
    }

    /// Returns whether the word is called or indexed: `test(x)`, `frame[2]`.
    fn is_called(&self) -> bool {
        use Token::{LBracket, LParen};
        matches!(self.after, Some(LParen | LBracket))
    }

    /// Returns whether the word begins a declaration or statement: it is at a possible start and not called, or it is
    /// directly before a name or literal, where only a keyword is possible.
    fn is_at_start(&self, can_begin: bool) -> bool {
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

    /// Returns whether the word is an operand before a connective keyword: `status in base`. In `c initial default x` a
    /// value precedes, so `initial` is a keyword.
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

    /// Returns whether the word begins an element of a list, where a connective keyword may follow:
    /// `Pose(state in base)`.
    fn is_list_element(&self) -> bool {
        matches!(self.before, Some(Token::LParen | Token::Comma))
    }

    fn is_after_operand(&self) -> bool {
        self.before.is_some_and(ends_operand) && !self.follows_conversion()
    }

    /// Returns whether the word is the operand of a conversion: `int step`. After `:` or `of`, `int` is a type.
    fn follows_conversion(&self) -> bool {
        let is_type = matches!(self.second_before, Some(Token::Colon | Token::Of));
        matches!(self.before, Some(Token::IntType | Token::RealType)) && !is_type
    }

    /// Returns whether the word is a prefix operator: `real current x`. `int` and `real` before it may be conversions.
    fn is_prefix(&self) -> bool {
        let converted = matches!(self.before, Some(Token::IntType | Token::RealType));
        (converted || !self.is_after_operand()) && self.after.is_some_and(begins_operand)
    }

    /// Returns whether the word is the node of a restart: `step` in `(restart step every c)(x)`.
    fn is_restarted_node(&self) -> bool {
        [self.second_before, self.before] == [Some(Token::LParen), Some(Token::Restart)]
    }

    fn is_after_operand_or_bar(&self) -> bool {
        self.is_after_operand() || self.before == Some(Token::Bar)
    }

    /// Returns whether the word is a conversion to a machine integer: `(int8 x)`.
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

/// Returns whether the token begins an operand and cannot continue one. `-` is excluded: `x - y` is a difference, even
/// if `x` is a prefix elsewhere.
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

/// Returns whether the token ends a value.
pub(crate) fn ends_value(token: Token) -> bool {
    use Token::{
        False, Ident, Int, Path, Percent, RBrace, RBracket, RParen, RStatic, Real, Str, True,
    };
    let value = matches!(token, Ident | Path | Int | Real | Str | True | False);
    value || matches!(token, RParen | RBracket | RBrace | RStatic | Percent)
}

/// Returns whether an operator or clause may follow the token.
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
