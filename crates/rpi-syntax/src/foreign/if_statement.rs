//! `if` statements of C, Python and Structured Text.

use super::imperative::{block_end, defined_names};
use super::{ForeignSyntax, Repair, foreign_syntax};
use crate::syntax_errors::ErrorContext;
use crate::token::Token;
use rpi_diag::Fix;
use std::collections::BTreeMap;
use std::ops::Range;

/// Recognises an `if` statement: `if c then y = a; else y = b; end`.
pub(super) fn if_statement(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = statement_start(found)?;
    let read = IfReader { found, at }.choice();
    let end = read
        .as_ref()
        .map_or_else(|| block_end(found, at), |(_, end)| *end);
    let diagnostic = foreign_syntax("`if` is an expression, not a statement")
        .primary(found.token_span(at), "expected an equation");
    let diagnostic = match read.and_then(|(branches, _)| equivalent_equations(found, at, &branches))
    {
        Some(meant) => {
            let place = found.range_span(at..end);
            let title = match meant.contains('\n') {
                true => "write an equation for each flow".to_owned(),
                false => format!("write `{meant}`"),
            };
            diagnostic.fix(Fix::maybe(title).replace(place, meant))
        }
        None => diagnostic.help(equation_help(found, at..end)),
    };
    found
        .cx
        .suppress_foreign_operators(found.range_span(at..end));
    Some(ForeignSyntax {
        diagnostic,
        repair: Repair::RemovePhrase(at..end, defined_names(found, at..end)),
    })
}

/// Returns the form of the equation of the first flow that an `if` statement defines.
fn equation_help(found: &ErrorContext<'_, '_>, range: Range<usize>) -> String {
    let names = defined_names(found, range.clone());
    let name = names.first().map_or("...", |first| first.name.as_str());
    let then = range
        .clone()
        .find(|at| found.token_at(*at) == Some(Token::Then));
    let condition = match then {
        Some(then) if then > range.start + 1 => found.range_text(range.start + 1..then),
        _ => "...",
    };
    format!(
        "each flow has one equation, with one value for each branch: `{name} = if {condition} then ... else ...;`"
    )
}

/// Returns the index of the first token of the `if` statement with the syntax error; `None` if the error is in another
/// construct.
fn statement_start(found: &ErrorContext<'_, '_>) -> Option<usize> {
    let at = found.error.index;
    if matches!(found.token_at(at), Some(Token::If | Token::When)) && found.expects_equation() {
        return Some(at);
    }
    let start = found.structure.phrase(at).start;
    let begins = start.checked_sub(1).and_then(|at| found.token_at(at));
    let is_first = matches!(begins, Some(Token::Let | Token::Semi | Token::Tel));
    let is_word = found.token_at(start) == Some(Token::Ident) && is_any_of(found, start, &["if"]);
    (is_first && is_word && start < at).then_some(start)
}

fn is_any_of(found: &ErrorContext<'_, '_>, at: usize, words: &[&str]) -> bool {
    let written = found.source_text(at);
    words.iter().any(|word| written.eq_ignore_ascii_case(word))
}

/// Branch of an `if` statement in another language.
struct Branch {
    /// Range of the tokens of the condition; `None` for the `else` branch.
    condition: Option<Range<usize>>,
    /// Assigned names (as token indices), each with the range of the tokens of its value.
    values: Vec<(usize, Range<usize>)>,
}

/// Reader of an `if` statement in another language; `at` is the index of the current token.
struct IfReader<'r, 'f, 't> {
    found: &'r ErrorContext<'f, 't>,
    at: usize,
}

/// Delimiters around the assignments of a branch.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Delimiters {
    /// Braces around the assignments, as in C.
    Braces,
    /// Keywords or a colon, as in Structured Text and Python.
    Keywords,
    /// No delimiters: the branch is one assignment.
    Bare,
}

impl IfReader<'_, '_, '_> {
    /// Reads the branches of the statement. Returns the branches and the index one past the last token; [`None`] if any
    /// part is not recognised.
    fn choice(mut self) -> Option<(Vec<Branch>, usize)> {
        let mut branches = Vec::new();
        loop {
            self.at += 1;
            let (condition, style) = self.condition()?;
            let values = self.values(style)?;
            let condition = Some(condition);
            branches.push(Branch { condition, values });
            if self.is_any_of(&["elsif", "elseif", "elif"]) {
                continue;
            }
            if !self.is_any_of(&["else"]) {
                break;
            }
            self.at += 1;
            if self.is_any_of(&["if"]) {
                continue;
            }
            self.else_branch(style, &mut branches)?;
            break;
        }
        self.skip_end();
        Some((branches, self.at))
    }

    fn else_branch(&mut self, style: Delimiters, branches: &mut Vec<Branch>) -> Option<()> {
        let style = match self.token() {
            Some(Token::LBrace) => Delimiters::Braces,
            _ if style == Delimiters::Braces => Delimiters::Bare,
            _ => style,
        };
        self.at += usize::from(matches!(self.token(), Some(Token::LBrace | Token::Colon)));
        let start = self.at;
        let mut values = self.values(style)?;
        if style == Delimiters::Keywords && !self.is_end() {
            // Without a closing keyword, the branch is only its first statement.
            self.at = start;
            values = self.values(Delimiters::Bare)?;
        }
        let condition = None;
        branches.push(Branch { condition, values });
        Some(())
    }

    fn condition(&mut self) -> Option<(Range<usize>, Delimiters)> {
        let start = self.at;
        if self.token() == Some(Token::LParen) {
            let close = self.found.structure.partner(start)?;
            if self.found.token_at(close + 2) == Some(Token::Eq) {
                self.at = close + 1;
                let condition = start + 1..close;
                return (!condition.is_empty()).then_some((condition, Delimiters::Bare));
            }
        }
        loop {
            let style = match self.token()? {
                _ if self.is_any_of(&["then"]) => Delimiters::Keywords,
                Token::LBrace => Delimiters::Braces,
                Token::Colon => Delimiters::Keywords,
                Token::Semi | Token::Tel | Token::Let => return None,
                _ => {
                    self.at = self
                        .found
                        .structure
                        .partner(self.at)
                        .filter(|p| *p > self.at)
                        .unwrap_or(self.at)
                        + 1;
                    continue;
                }
            };
            let mut condition = start..self.at;
            let group = self.found.structure.partner(start);
            if style == Delimiters::Braces && group == Some(self.at - 1) {
                condition = start + 1..self.at - 1;
            }
            self.at += 1;
            return (!condition.is_empty()).then_some((condition, style));
        }
    }

    fn values(&mut self, style: Delimiters) -> Option<Vec<(usize, Range<usize>)>> {
        let mut values = Vec::new();
        while self.token() == Some(Token::Ident)
            && self.found.token_at(self.at + 1) == Some(Token::Eq)
        {
            let name = self.at;
            self.at += 2;
            let start = self.at;
            while !matches!(
                self.token(),
                None | Some(Token::Semi | Token::Else | Token::RBrace | Token::Tel)
            ) {
                self.at += 1;
            }
            if start == self.at {
                return None;
            }
            values.push((name, start..self.at));
            self.at += usize::from(self.token() == Some(Token::Semi));
            if style == Delimiters::Bare {
                break;
            }
        }
        if style == Delimiters::Braces {
            if self.token() != Some(Token::RBrace) {
                return None;
            }
            self.at += 1;
        }
        (!values.is_empty()).then_some(values)
    }

    fn is_end(&self) -> bool {
        self.is_any_of(&["end", "endif", "end_if", "fi"])
    }

    fn skip_end(&mut self) {
        if self.is_end() {
            self.at += 1;
            self.at += usize::from(self.is_end_of_if());
            self.at += usize::from(self.token() == Some(Token::Semi));
        }
    }

    /// Returns whether the current token is the `if` of an `end if`, and not the start of another statement.
    // An `if` that begins a new statement is followed by its condition on the same line.
    fn is_end_of_if(&self) -> bool {
        let lexemes = self.found.lexemes;
        let is_apart = |at: usize| match (lexemes.get(at), lexemes.get(at + 1)) {
            (Some(this), Some(next)) => self.found.cx.slice(this.end, next.start).contains('\n'),
            _ => true,
        };
        let ends = self.found.token_at(self.at + 1) == Some(Token::Semi) || is_apart(self.at);
        self.is_any_of(&["if"]) && !is_apart(self.at - 1) && ends
    }

    fn token(&self) -> Option<Token> {
        self.found.token_at(self.at)
    }

    fn is_any_of(&self, words: &[&str]) -> bool {
        is_any_of(self.found, self.at, words)
    }
}

/// Maximum length of the text of a fix, in bytes. Without a better fix, the diagnostic has a help text instead.
// Each equation repeats all conditions, so the text can grow with the product of branches and flows.
const MAX_FIX_LEN: usize = 4_000;

/// Returns the text of the equivalent equations, one per flow, for the statement at token `at`. `None` unless each
/// branch defines the same flows exactly once and the text is short enough.
fn equivalent_equations(
    found: &ErrorContext<'_, '_>,
    at: usize,
    branches: &[Branch],
) -> Option<String> {
    let (last, first) = (branches.last()?, branches.first()?);
    let by_name = |branch: &Branch| -> BTreeMap<&str, Range<usize>> {
        let values = branch.values.iter();
        let named = values.map(|(name, value)| (found.source_text(*name), value.clone()));
        named.collect()
    };
    let values: Vec<BTreeMap<&str, Range<usize>>> = branches.iter().map(by_name).collect();
    let count = first.values.len();
    let same = |(branch, values): (&Branch, &BTreeMap<&str, Range<usize>>)| {
        branch.values.len() == count && values.len() == count
    };
    if last.condition.is_some() || !branches.iter().zip(&values).all(same) {
        return None;
    }
    let mut conditions = Vec::new();
    for condition in branches
        .iter()
        .filter_map(|branch| branch.condition.clone())
    {
        let place = found.range_span(condition.clone());
        let text = (place.end - place.start) as usize <= MAX_FIX_LEN;
        conditions.push(text.then(|| found.translated_text(condition))?);
    }
    if conditions.iter().map(String::len).sum::<usize>() * count > MAX_FIX_LEN {
        return None;
    }
    let equation = |(name, _): &(usize, Range<usize>)| {
        let name = found.source_text(*name);
        let mut text = format!("{name} =");
        for (k, values) in values.iter().enumerate() {
            let value = found.translated_text(values.get(name)?.clone());
            match conditions.get(k) {
                Some(condition) => {
                    text.push_str(&format!(" if {condition} then {value} else"));
                }
                None => text.push_str(&format!(" {value};")),
            }
        }
        Some(text)
    };
    let equations: Option<Vec<String>> = first.values.iter().map(equation).collect();
    let start = found.lexemes[at].start as usize;
    let line = found.cx.text[..start].rfind('\n').map_or(0, |at| at + 1);
    let before = &found.cx.text[line..start];
    let indent: String = before.chars().take_while(|c| c.is_whitespace()).collect();
    Some(equations?.join(&format!("\n{indent}")))
}

impl ErrorContext<'_, '_> {
    /// Returns the source text of a range of tokens, with operators of other languages replaced by those of RPI.
    fn translated_text(&self, range: Range<usize>) -> String {
        let mut text = String::new();
        for at in range.clone() {
            let lexeme = self.lexemes[at];
            if at > range.start {
                let gap = self.cx.slice(self.lexemes[at - 1].end, lexeme.start);
                text.push_str(gap);
            }
            let written = self.source_text(at);
            match super::find_operator(written) {
                Some(_) => text.push_str(lexeme.token.spelling().unwrap_or(written)),
                None => text.push_str(written),
            }
        }
        text
    }
}
