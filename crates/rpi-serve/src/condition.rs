//! Parser of rule conditions as clients write them.
//!
//! ```text
//! condition = term { "|" term }
//! term      = factor { "&" factor }
//! factor    = "!" factor | "(" condition ")" | "t" | "f" | command "." export | command "@" fact
//! fact      = "ended" | "regular" | "failed" | "result" "(" name ")" | "error" "(" number ")"
//! ```
//! The DirectIO protocol has all of it except `command "@" fact`.

use std::fmt;

/// Syntax tree of a rule condition: a Boolean expression over facts about commands, as clients write it.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) enum Expr {
    /// The condition that is always true.
    True,
    /// The condition that is always false.
    False,
    /// Negation of a condition.
    Not(Box<Expr>),
    /// Conjunction of two conditions.
    And(Box<Expr>, Box<Expr>),
    /// Disjunction of two conditions.
    Or(Box<Expr>, Box<Expr>),
    /// Fact about a command: the name of the command, and the fact.
    Fact(String, FactExpr),
}

/// Fact about a command in a rule condition. Names of exports and results are texts and not yet resolved.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) enum FactExpr {
    /// True if the command's Boolean export with this key is true.
    Export(String),
    /// True once the command has ended, in any way.
    Ended,
    /// True once the command has ended without error and was not cancelled, aborted or stopped.
    Regular,
    /// True once the command has ended with an error, a fault or an abort.
    Failed,
    /// True once the command has ended with the result of this name.
    Result(String),
    /// True once the command has ended with this error number.
    Error(i64),
}

/// Error: a text is not a valid rule condition.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum ConditionError {
    /// The text of the condition differs from the expected syntax at this byte offset.
    Expected {
        /// Description of the expected syntax.
        what: &'static str,
        offset: usize,
    },
    /// The condition is nested more than [`MAX_DEPTH`] levels deep.
    TooDeep,
    /// The condition has more than [`MAX_FACTS`] facts.
    TooLong,
}

impl fmt::Display for ConditionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ConditionError::Expected { what, offset } => {
                write!(f, "expected {what} at byte {offset} of the condition")
            }
            ConditionError::TooDeep => f.write_str("the condition is nested too deeply"),
            ConditionError::TooLong => {
                write!(
                    f,
                    "the condition is too long: it has at most {MAX_FACTS} facts"
                )
            }
        }
    }
}

impl std::error::Error for ConditionError {}

/// Maximum nesting depth of negations and parentheses in a rule condition.
const MAX_DEPTH: usize = 32;
/// Maximum number of facts about commands in a rule condition.
const MAX_FACTS: usize = 256;

impl Expr {
    /// Returns the condition that any of these facts about a command holds; `None` without a fact.
    ///
    /// # Errors
    /// If there are too many facts: functions on conditions are recursive.
    pub(crate) fn any(
        command: &str,
        facts: impl ExactSizeIterator<Item = FactExpr>,
    ) -> Result<Option<Expr>, ConditionError> {
        if facts.len() > MAX_FACTS {
            return Err(ConditionError::TooLong);
        }
        let facts = facts.map(|fact| Expr::Fact(command.to_owned(), fact));
        Ok(facts.reduce(|a, b| Expr::Or(a.into(), b.into())))
    }

    /// Returns the number of facts in the condition; the constants true and false count as one each.
    pub(crate) fn fact_count(&self) -> usize {
        match self {
            Expr::Not(inner) => inner.fact_count(),
            Expr::And(a, b) | Expr::Or(a, b) => a.fact_count() + b.fact_count(),
            Expr::True | Expr::False | Expr::Fact(..) => 1,
        }
    }
}

/// Parses the text of a rule condition, such as `n3.done & !n4@ended`, to a syntax tree.
///
/// # Errors
/// If the text is not a condition, or is too long or nested too deeply.
pub(crate) fn parse(text: &str) -> Result<Expr, ConditionError> {
    let mut parser = Parser {
        text,
        at: 0,
        facts_left: MAX_FACTS,
    };
    let condition = parser.parse_or(MAX_DEPTH)?;
    parser.skip_blanks();
    match parser.rest() {
        "" => Ok(condition),
        _ => Err(parser.expected("the end of the condition")),
    }
}

struct Parser<'a> {
    text: &'a str,
    at: usize,
    /// Number of further facts that the parser accepts before the condition exceeds [`MAX_FACTS`].
    facts_left: usize,
}

impl<'a> Parser<'a> {
    fn rest(&self) -> &'a str {
        &self.text[self.at..]
    }

    fn skip_blanks(&mut self) {
        let rest = self.rest();
        self.at += rest.len() - rest.trim_start().len();
    }

    fn expected(&self, what: &'static str) -> ConditionError {
        let offset = self.at;
        ConditionError::Expected { what, offset }
    }

    fn accept(&mut self, sign: char) -> bool {
        self.skip_blanks();
        let found = self.rest().starts_with(sign);
        self.at += if found { sign.len_utf8() } else { 0 };
        found
    }

    fn name(&mut self) -> Result<&'a str, ConditionError> {
        self.skip_blanks();
        let rest = self.rest();
        let ends = |c: char| !c.is_ascii_alphanumeric() && c != '_' && c != '-';
        let name = &rest[..rest.find(ends).unwrap_or(rest.len())];
        self.at += name.len();
        match name {
            "" => Err(self.expected("a name")),
            _ => Ok(name),
        }
    }

    fn parse_or(&mut self, depth: usize) -> Result<Expr, ConditionError> {
        let mut condition = self.parse_and(depth)?;
        while self.accept('|') {
            condition = Expr::Or(condition.into(), self.parse_and(depth)?.into());
        }
        Ok(condition)
    }

    fn parse_and(&mut self, depth: usize) -> Result<Expr, ConditionError> {
        let mut term = self.parse_factor(depth)?;
        while self.accept('&') {
            term = Expr::And(term.into(), self.parse_factor(depth)?.into());
        }
        Ok(term)
    }

    fn parse_factor(&mut self, depth: usize) -> Result<Expr, ConditionError> {
        let deeper = depth.checked_sub(1).ok_or(ConditionError::TooDeep)?;
        if self.accept('!') {
            return Ok(Expr::Not(self.parse_factor(deeper)?.into()));
        }
        if self.accept('(') {
            let inner = self.parse_or(deeper)?;
            return match self.accept(')') {
                true => Ok(inner),
                false => Err(self.expected("`)`")),
            };
        }
        self.facts_left = self
            .facts_left
            .checked_sub(1)
            .ok_or(ConditionError::TooLong)?;
        let name = self.name()?;
        if self.accept('.') {
            let key = self.name()?.to_owned();
            return Ok(Expr::Fact(name.to_owned(), FactExpr::Export(key)));
        }
        if self.accept('@') {
            return Ok(Expr::Fact(name.to_owned(), self.parse_fact()?));
        }
        match name {
            "t" => Ok(Expr::True),
            "f" => Ok(Expr::False),
            _ => Err(self.expected("`.` or `@`")),
        }
    }

    fn parse_fact(&mut self) -> Result<FactExpr, ConditionError> {
        let fact = self.name()?;
        let mut argument = || match self.accept('(') {
            true => self.name().and_then(|name| match self.accept(')') {
                true => Ok(name),
                false => Err(self.expected("`)`")),
            }),
            false => Err(self.expected("`(`")),
        };
        match fact {
            "ended" => Ok(FactExpr::Ended),
            "regular" => Ok(FactExpr::Regular),
            "failed" => Ok(FactExpr::Failed),
            "result" => argument().map(|name| FactExpr::Result(name.to_owned())),
            "error" => {
                let number = argument()?.parse();
                number
                    .map(FactExpr::Error)
                    .map_err(|_| self.expected("a number"))
            }
            _ => Err(self.expected("ended, regular, failed, result or error")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shape(expr: &Expr) -> String {
        match expr {
            Expr::True => "t".into(),
            Expr::False => "f".into(),
            Expr::Not(a) => format!("!{}", shape(a)),
            Expr::And(a, b) => format!("({}&{})", shape(a), shape(b)),
            Expr::Or(a, b) => format!("({}|{})", shape(a), shape(b)),
            Expr::Fact(command, FactExpr::Export(key)) => format!("{command}.{key}"),
            Expr::Fact(command, fact) => format!("{command}@{fact:?}"),
        }
    }

    #[test]
    fn and_binds_closer_than_or() {
        for (text, expected) in [
            ("t", "t"),
            ("n1.out_1 & n2.out_1", "(n1.out_1&n2.out_1)"),
            ("n1.a | n2.b & !n3.c", "(n1.a|(n2.b&!n3.c))"),
            ("!(n1.a | f) & t", "(!(n1.a|f)&t)"),
            (
                "n1@result(done) & n2 @ error(-3)",
                "(n1@Result(\"done\")&n2@Error(-3))",
            ),
            ("n1@regular", "n1@Regular"),
        ] {
            assert_eq!(parse(text).map(|e| shape(&e)).as_deref(), Ok(expected));
        }
    }

    #[test]
    fn what_is_no_condition_is_refused_with_its_place() {
        for text in [
            "",
            "n1",
            "n1.",
            "n1@",
            "n1@gone",
            "(t",
            "t t",
            "t &",
            "n1@error(x)",
            "§",
        ] {
            assert!(parse(text).is_err(), "{text}");
        }
        let deep = "(".repeat(100_000);
        assert!(parse(&deep).unwrap_err().to_string().contains("deeply"));
        let wide = |n| vec!["n1.a"; n].join(" & ");
        assert!(parse(&wide(MAX_FACTS)).is_ok());
        assert!(
            parse(&wide(1_000_000))
                .unwrap_err()
                .to_string()
                .contains("long")
        );
    }
}
