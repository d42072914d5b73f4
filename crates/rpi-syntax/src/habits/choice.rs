//! `if` statements of C, Python and Structured Text.

use super::bodies::{block_end, defined};
use super::{Habit, Mend, habit};
use crate::explain::Found;
use crate::token::Token;
use rpi_diag::Fix;
use std::collections::BTreeMap;
use std::ops::Range;

/// Recognises an `if` statement: `if c then y = a; else y = b; end`.
pub(super) fn choice(found: &Found<'_, '_>) -> Option<Habit> {
    let at = begin(found)?;
    let read = Reader { found, at }.choice();
    let end = read
        .as_ref()
        .map_or_else(|| block_end(found, at), |(_, end)| *end);
    let finding = habit("`if` is an expression, not a statement")
        .at(found.span_at(at), "expected an equation");
    let finding = match read.and_then(|(branches, _)| meant(found, at, &branches)) {
        Some(meant) => {
            let place = found.span_of(at..end);
            let title = match meant.contains('\n') {
                true => "write an equation for each flow".to_owned(),
                false => format!("write `{meant}`"),
            };
            finding.fix(Fix::maybe(title).replace(place, meant))
        }
        None => finding.help(
            "each flow has one equation, with a value for both branches: `y = if c then a else b;`",
        ),
    };
    found.cx.swallow_signs(found.span_of(at..end));
    Some(Habit {
        finding,
        mend: Mend::Phrase(at..end, defined(found, at..end)),
    })
}

/// Returns the index of the first token of the statement with the error.
fn begin(found: &Found<'_, '_>) -> Option<usize> {
    let at = found.fault.at;
    if matches!(found.token(at), Some(Token::If | Token::When)) && found.expects_equation() {
        return Some(at);
    }
    let start = found.structure.phrase(at).start;
    let begins = start.checked_sub(1).and_then(|at| found.token(at));
    let is_first = matches!(begins, Some(Token::Let | Token::Semi | Token::Tel));
    let is_word = found.token(start) == Some(Token::Ident) && is(found, start, &["if"]);
    (is_first && is_word && start < at).then_some(start)
}

fn is(found: &Found<'_, '_>, at: usize, words: &[&str]) -> bool {
    let written = found.written(at);
    words.iter().any(|word| written.eq_ignore_ascii_case(word))
}

/// Branch of an `if` statement.
struct Branch {
    /// Token indices of the condition; `None` for the `else` branch.
    condition: Option<Range<usize>>,
    /// Assigned names (token index) with the token indices of their values.
    values: Vec<(usize, Range<usize>)>,
}

/// Reader of an `if` statement; `at` is the index of the current token.
struct Reader<'r, 'f, 't> {
    found: &'r Found<'f, 't>,
    at: usize,
}

/// Delimiters around the equations of a branch.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Style {
    /// Braces, as in C.
    Braces,
    /// Keywords or a colon, as in Structured Text and Python.
    Words,
    /// One statement without delimiters.
    Bare,
}

impl Reader<'_, '_, '_> {
    /// Reads the branches and the index one past the statement. Returns [`None`] if any part is not recognised.
    fn choice(mut self) -> Option<(Vec<Branch>, usize)> {
        let mut branches = Vec::new();
        loop {
            self.at += 1;
            let (condition, style) = self.condition()?;
            let values = self.values(style)?;
            let condition = Some(condition);
            branches.push(Branch { condition, values });
            if self.is(&["elsif", "elseif", "elif"]) {
                continue;
            }
            if !self.is(&["else"]) {
                break;
            }
            self.at += 1;
            if self.is(&["if"]) {
                continue;
            }
            self.otherwise(style, &mut branches)?;
            break;
        }
        self.end();
        Some((branches, self.at))
    }

    fn otherwise(&mut self, style: Style, branches: &mut Vec<Branch>) -> Option<()> {
        let style = match self.token() {
            Some(Token::LBrace) => Style::Braces,
            _ if style == Style::Braces => Style::Bare,
            _ => style,
        };
        self.at += usize::from(matches!(self.token(), Some(Token::LBrace | Token::Colon)));
        let start = self.at;
        let mut values = self.values(style)?;
        if style == Style::Words && !self.is_end() {
            // Without a closing keyword, the branch is only its first statement.
            self.at = start;
            values = self.values(Style::Bare)?;
        }
        let condition = None;
        branches.push(Branch { condition, values });
        Some(())
    }

    fn condition(&mut self) -> Option<(Range<usize>, Style)> {
        let start = self.at;
        if self.token() == Some(Token::LParen) {
            let close = self.found.structure.partner(start)?;
            if self.found.token(close + 2) == Some(Token::Eq) {
                self.at = close + 1;
                let condition = start + 1..close;
                return (!condition.is_empty()).then_some((condition, Style::Bare));
            }
        }
        loop {
            let style = match self.token()? {
                _ if self.is(&["then"]) => Style::Words,
                Token::LBrace => Style::Braces,
                Token::Colon => Style::Words,
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
            if style == Style::Braces && group == Some(self.at - 1) {
                condition = start + 1..self.at - 1;
            }
            self.at += 1;
            return (!condition.is_empty()).then_some((condition, style));
        }
    }

    fn values(&mut self, style: Style) -> Option<Vec<(usize, Range<usize>)>> {
        let mut values = Vec::new();
        while self.token() == Some(Token::Ident) && self.found.token(self.at + 1) == Some(Token::Eq)
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
            if style == Style::Bare {
                break;
            }
        }
        if style == Style::Braces {
            if self.token() != Some(Token::RBrace) {
                return None;
            }
            self.at += 1;
        }
        (!values.is_empty()).then_some(values)
    }

    fn is_end(&self) -> bool {
        self.is(&["end", "endif", "end_if", "fi"])
    }

    fn end(&mut self) {
        if self.is_end() {
            self.at += 1;
            self.at += usize::from(self.is_end_of_if());
            self.at += usize::from(self.token() == Some(Token::Semi));
        }
    }

    /// Returns whether the current `if` belongs to `end if`.
    // An `if` that begins a new statement is followed by its condition on the same line.
    fn is_end_of_if(&self) -> bool {
        let lexemes = self.found.lexemes;
        let is_apart = |at: usize| match (lexemes.get(at), lexemes.get(at + 1)) {
            (Some(this), Some(next)) => self.found.cx.slice(this.end, next.start).contains('\n'),
            _ => true,
        };
        let ends = self.found.token(self.at + 1) == Some(Token::Semi) || is_apart(self.at);
        self.is(&["if"]) && !is_apart(self.at - 1) && ends
    }

    fn token(&self) -> Option<Token> {
        self.found.token(self.at)
    }

    fn is(&self, words: &[&str]) -> bool {
        is(self.found, self.at, words)
    }
}

/// Longest text of a fix, in bytes.
// Each equation repeats all conditions, so the text can grow with the product of branches and flows.
const MAX_TEXT: usize = 4_000;

/// Returns the equivalent equations, one per flow, if every branch defines the same flows exactly once.
fn meant(found: &Found<'_, '_>, at: usize, branches: &[Branch]) -> Option<String> {
    let (last, first) = (branches.last()?, branches.first()?);
    let by_name = |branch: &Branch| -> BTreeMap<&str, Range<usize>> {
        let values = branch.values.iter();
        let named = values.map(|(name, value)| (found.written(*name), value.clone()));
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
        let place = found.span_of(condition.clone());
        let text = (place.end - place.start) as usize <= MAX_TEXT;
        conditions.push(text.then(|| found.meant_text(condition))?);
    }
    if conditions.iter().map(String::len).sum::<usize>() * count > MAX_TEXT {
        return None;
    }
    let equation = |(name, _): &(usize, Range<usize>)| {
        let name = found.written(*name);
        let mut text = format!("{name} =");
        for (k, values) in values.iter().enumerate() {
            let value = found.meant_text(values.get(name)?.clone());
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

impl Found<'_, '_> {
    /// Returns the source text of a range of tokens, with foreign operators replaced by those of RPI.
    fn meant_text(&self, range: Range<usize>) -> String {
        let mut text = String::new();
        for at in range.clone() {
            let lexeme = self.lexemes[at];
            if at > range.start {
                let gap = self.cx.slice(self.lexemes[at - 1].end, lexeme.start);
                text.push_str(gap);
            }
            let written = self.written(at);
            match super::sign(written) {
                Some(_) => text.push_str(lexeme.token.spelling().unwrap_or(written)),
                None => text.push_str(written),
            }
        }
        text
    }
}
