//! Expressions of other languages: `case` expressions, method calls, lambda expressions.

use super::operators::innermost_if;
use super::word_operators::{begins_operand, is_operand_position};
use super::{ForeignSyntax, Repair, foreign_syntax};
use crate::ast::Ident;
use crate::syntax_errors::ErrorContext;
use crate::token::Token;
use rpi_diag::Fix;

/// Keywords of `case` expressions in other languages, in lower case.
const CASE_KEYWORDS: [&str; 6] = ["case", "match", "switch", "select", "cond", "when"];

/// Recognises a `case` expression: `y = case x of 1: a; ...`, `y = match x { 1 => a, ... }`.
pub(super) fn case_expression(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let fault = found.error.index;
    let is_case = |at: &usize| {
        let word = found.source_text(*at).to_ascii_lowercase();
        found.token_at(*at) == Some(Token::Ident)
            && CASE_KEYWORDS.contains(&&*word)
            && is_operand_position(found, *at)
    };
    let at = (fault.saturating_sub(4)..fault).rev().find(is_case)?;
    // A flow may have such a name, so an error further away has another cause.
    if at + 1 < fault
        && found.token_at(at + 1) != Some(Token::When)
        && found.token_at(at + 1) != Some(Token::LParen)
    {
        return None;
    }
    let word = found.source_text(at).to_ascii_lowercase();
    let equation = found.structure.phrase(at);
    let end = cases_end(found, at, equation.end);
    found
        .cx
        .suppress_foreign_operators(found.range_span(at..end));
    let diagnostic = foreign_syntax("a conditional expression is written `if x = 1 then a else b`")
        .primary(found.token_span(at), format!("`{word}` is from another language"))
        .help("for several cases: `y = if x = 1 then a else if x = 2 then b else c;`; the last `else` covers all other values");
    let names = equation_targets(found, equation.start, at);
    Some(ForeignSyntax {
        diagnostic,
        repair: Repair::RemovePhrase(equation.start..end, names),
    })
}

/// Returns the index one past the tokens of a `case` expression, whose cases may be separated by `;`. The expression
/// begins at token `at`; its first phrase ends at `end`.
fn cases_end(found: &ErrorContext<'_, '_>, at: usize, end: usize) -> usize {
    use Token::{Arrow, Bar, Colon, Else, End, Implies, Semi};
    let mut end = end.max(at + 1);
    while found.token_at(end) == Some(Semi) {
        let next = end + 1;
        let word = found.source_text(next).to_ascii_lowercase();
        let is_case = matches!(found.token_at(next + 1), Some(Colon | Arrow | Implies))
            || matches!(found.token_at(next), Some(Bar | Else | End))
            || matches!(
                &*word,
                "default" | "otherwise" | "end" | "end_case" | "endcase" | "when"
            );
        if !is_case {
            break;
        }
        let is = |i: &usize| matches!(found.token_at(*i), Some(Semi | Token::Tel) | None);
        end = (next..).find(is).unwrap_or(next);
    }
    end
}

/// Returns the names before the `=` in the tokens `start..end`; empty without `=`.
fn equation_targets(found: &ErrorContext<'_, '_>, start: usize, end: usize) -> Vec<Ident> {
    let Some(sign) = (start..end).find(|at| found.token_at(*at) == Some(Token::Eq)) else {
        return Vec::new();
    };
    let names = (start..sign).filter(|at| found.token_at(*at) == Some(Token::Ident));
    names.map(|at| found.ident(at)).collect()
}

/// Recognises a lambda expression: `y = lambda a: a + 1`.
pub(super) fn lambda(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index.checked_sub(1)?;
    let is_word = matches!(
        found.source_text(at),
        "lambda" | "fn" | "func" | "fun" | "def"
    );
    if !is_word || !is_operand_position(found, at) || found.token_at(at) != Some(Token::Ident) {
        return None;
    }
    let diagnostic = foreign_syntax("a function must be declared with a name")
        .primary(found.token_span(at), "keyword of another language")
        .help("`function f (a: int) returns (b: int) let b = a + 1; tel`");
    Some(remove_phrase(diagnostic))
}

/// Combines a diagnostic with the default repair, which removes the statement or declaration that contains the syntax
/// error.
fn remove_phrase(diagnostic: rpi_diag::Diagnostic) -> ForeignSyntax {
    ForeignSyntax {
        diagnostic,
        repair: Repair::RemoveErrorPhrase,
    }
}

/// Recognises `if` as a function: `y = if(c, a, b)`.
pub(super) fn if_function(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let own = innermost_if(found).filter(|_| found.expects(Token::Then))?;
    let open = own + 1;
    let close = found
        .structure
        .partner(open)
        .filter(|_| found.token_at(open) == Some(Token::LParen))?;
    let [first, second] = commas(found, open, close)[..] else {
        return None;
    };
    if close + 1 != found.error.index {
        return None;
    }
    let [c, a, b] = [open + 1..first, first + 1..second, second + 1..close];
    if c.is_empty() || a.is_empty() || b.is_empty() {
        return None;
    }
    let meant = format!(
        "(if {} then {} else {})",
        found.range_text(c),
        found.range_text(a),
        found.range_text(b)
    );
    let place = found.range_span(own..close + 1);
    let diagnostic = foreign_syntax("a conditional expression is written `if c then x else y`")
        .primary(found.token_span(own), "`if` is not a function")
        .fix(Fix::sure(format!("write `{meant}`")).replace(place, meant));
    let repair = Repair::ReplaceTokens(vec![
        found.replacement(own, &[Token::LParen, Token::If]),
        (open..open + 1, Vec::new()),
        found.replacement(first, &[Token::Then]),
        found.replacement(second, &[Token::Else]),
    ]);
    Some(ForeignSyntax { diagnostic, repair })
}

/// Returns the token indices of the commas and semicolons directly within the brackets at the tokens `open` and
/// `close`.
fn commas(found: &ErrorContext<'_, '_>, open: usize, close: usize) -> Vec<usize> {
    let is = |i: &usize| {
        matches!(found.token_at(*i), Some(Token::Comma | Token::Semi))
            && found.structure.parent(*i) == Some(open)
    };
    (open + 1..close).filter(is).collect()
}

/// Recognises a `merge` without cases: `merge c x y`, `merge(c, x, y)`.
pub(super) fn merge_without_cases(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let fault = found.error.index;
    let near = fault.saturating_sub(4)..fault;
    let at = near
        .rev()
        .find(|at| found.token_at(*at) == Some(Token::Merge))?;
    let is_called = found.token_at(at + 1) == Some(Token::LParen);
    let lacks_cases = fault == at + 2 && found.expects(Token::LParen);
    if !is_called && !lacks_cases {
        return None;
    }
    let diagnostic = foreign_syntax("`merge` needs one case in parentheses for each value of its clock")
        .primary(found.token_span(fault), "expected a case such as `(true -> a)`")
        .help("`merge c (true -> a) (false -> b)`, where `a` is present when `c` and `b` when `not c`; for flows that are always present: `if c then a else b`");
    Some(remove_phrase(diagnostic))
}

/// Recognises a clock that is an expression instead of the name of a flow: `y = x when (c and d)`.
pub(super) fn clock_expression(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let fault = found.error.index;
    let when = (0..fault)
        .rev()
        .find(|at| found.token_at(*at) == Some(Token::When))?;
    let open = when + 1;
    let close = found
        .structure
        .partner(open)
        .filter(|close| *close >= fault)?;
    let is_value = when.checked_sub(1).is_some_and(|at| {
        matches!(
            found.token_at(at),
            Some(Token::Ident | Token::Int | Token::Real | Token::RParen | Token::RBracket)
        )
    });
    if found.token_at(open) != Some(Token::LParen)
        || !is_value
        || found.token_at(when - 1).is_none()
    {
        return None;
    }
    let condition = found.range_text(open + 1..close);
    let is_short = condition.len() <= 40 && !condition.contains('\n');
    let help = match is_short {
        true => {
            format!("define a flow for the condition first: `on = {condition};`, then `x when on`")
        }
        false => "define a flow for the condition first: `on = ...;`, then `x when on`".to_owned(),
    };
    let diagnostic = foreign_syntax("a clock must be the name of a flow")
        .primary(
            found.range_span(open..close + 1),
            "a condition without a name",
        )
        .help(help);
    Some(remove_phrase(diagnostic))
}

/// Recognises a misplaced `every` or `restart`: `y = (F every c)(x)`, `y = F(x) every c`, `y = restart F(x) every c`.
pub(super) fn misplaced_every(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    let word = found.source_text(at);
    let begins = matches!(word, "restart" | "activate" | "reset") && found.expects(Token::Int);
    if word != "every" && !begins || found.expects_equation() {
        return None;
    }
    let diagnostic = foreign_syntax("a node is reset by `(restart F every c)(x)`")
        .primary(
            found.token_span(at),
            "the condition belongs to the node, not to its call",
        )
        .help("`(activate F every c initial default 0)(x)` runs it only when `c` holds");
    let diagnostic = match restart_form(found, at) {
        Some((place, meant)) => {
            diagnostic.fix(Fix::maybe(format!("write `{meant}`")).replace(place, meant))
        }
        None => diagnostic,
    };
    Some(remove_phrase(diagnostic))
}

/// Returns the source range of a call with a misplaced `every`, and its RPI form `(restart f every c)(x)`. `None`
/// unless callee and arguments are simple. `at` is the token of the misplaced word.
fn restart_form(found: &ErrorContext<'_, '_>, at: usize) -> Option<(rpi_diag::Span, String)> {
    let every = (at..at + 100).find(|at| found.source_text(*at) == "every")?;
    let close = every.checked_sub(1)?;
    let open = found
        .structure
        .partner(close)
        .filter(|_| found.token_at(close) == Some(Token::RParen))?;
    let callee = open
        .checked_sub(1)
        .filter(|at| found.token_at(*at) == Some(Token::Ident))?;
    let (start, end) = super::operators::operand_range(found, at);
    let is_whole = start == callee || start + 1 == callee && start == at;
    if !is_whole || found.token_at(open) != Some(Token::LParen) || every + 1 >= end {
        return None;
    }
    let condition = found.range_text(every + 1..end);
    let meant = format!(
        "(restart {} every {condition}){}",
        found.source_text(callee),
        found.range_text(open..close + 1)
    );
    Some((found.range_span(start..end), meant))
}

/// Modules of other languages whose functions RPI provides without a module prefix.
const FOREIGN_MODULES: [&str; 9] = [
    "math", "np", "numpy", "std", "cmath", "system", "util", "self", "this",
];

/// Recognises calls of methods and of module functions: `y = x.f(c);`, `math.sin(x)`, `arm.move(p);`.
pub(super) fn method_call(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    use Token::{Dot, Ident, LParen};
    let open = found.error.index;
    let base = open.checked_sub(3)?;
    let shape = [base, base + 1, base + 2, open].map(|at| found.token_at(at));
    if shape != [Some(Ident), Some(Dot), Some(Ident), Some(LParen)] {
        return None;
    }
    let (of, name) = (found.source_text(base), found.source_text(base + 2));
    let place = found.range_span(base..open);
    if FOREIGN_MODULES
        .iter()
        .any(|module| of.eq_ignore_ascii_case(module))
    {
        let diagnostic = foreign_syntax("functions of a module are called without the module name")
            .primary(place, format!("write `{name}(...)`"))
            .fix(Fix::maybe(format!("write `{name}`")).replace(place, name));
        let repair = Repair::ReplaceTokens(vec![(base..base + 2, Vec::new())]);
        return Some(ForeignSyntax { diagnostic, repair });
    }
    let diagnostic =
        foreign_syntax("values have no methods").primary(place, "method call of another language");
    let moves = ["mov", "lin", "ptp", "go", "drive"];
    let help = match moves
        .iter()
        .any(|word| name.to_ascii_lowercase().starts_with(word))
    {
        true => "a motion is a fragment: `way = Line(arm, p);`, then `arm.joints = way.joints;`"
            .to_owned(),
        false => format!("a node takes the value as an argument: `y = {name}({of}, ...);`"),
    };
    Some(remove_phrase(diagnostic.help(help)))
}

/// Recognises a call without parentheses: `y = f x c;`.
pub(super) fn call_without_parens(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    let callee = at.checked_sub(1)?;
    let is_name = found.token_at(callee) == Some(Token::Ident)
        && !found.cx.guessed_names.declares(found.source_text(callee));
    let is_argument = begins_operand(found, at) && found.token_at(at) != Some(Token::LParen);
    let is_value = found.expects(Token::Plus) && is_operand_position(found, callee);
    if !is_name || !is_argument || !is_value {
        return None;
    }
    let simple = |at: &usize| {
        matches!(
            found.token_at(*at),
            Some(Token::Ident | Token::Int | Token::Real | Token::True | Token::False)
        )
    };
    let end = (at..found.lexemes.len())
        .find(|at| !simple(at))
        .unwrap_or(at);
    let name = found.source_text(callee);
    let diagnostic = foreign_syntax("the arguments of a call are written in parentheses")
        .primary(found.token_span(at), format!("expected `(` after `{name}`"));
    let ends = matches!(
        found.token_at(end),
        Some(Token::Semi | Token::RParen | Token::Comma | Token::Then | Token::Else)
    );
    if !ends || end == at {
        return Some(remove_phrase(diagnostic.help(format!("`{name}(x, y)`"))));
    }
    let args: Vec<&str> = (at..end).map(|at| found.source_text(at)).collect();
    let meant = format!("{name}({})", args.join(", "));
    let fix = Fix::maybe(format!("write `{meant}`")).replace(found.range_span(callee..end), meant);
    let mut tokens = found.insertion(at, Token::LParen).1;
    for i in at..end {
        if i > at {
            tokens.extend(found.insertion(i, Token::Comma).1);
        }
        tokens.push(found.lexemes[i]);
    }
    tokens.extend(found.insertion(end, Token::RParen).1);
    Some(ForeignSyntax {
        diagnostic: diagnostic.fix(fix),
        repair: Repair::ReplaceTokens(vec![(at..end, tokens)]),
    })
}

/// Recognises a dictionary literal: `y = {1: a, 2: b}[x];`.
pub(super) fn dictionary(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    let open = at
        .checked_sub(1)
        .filter(|at| found.token_at(*at) == Some(Token::LBrace))?;
    let is_key = matches!(
        found.token_at(at),
        Some(Token::Int | Token::Str | Token::True | Token::False | Token::Ident)
    );
    if !is_key || found.token_at(at + 1) != Some(Token::Colon) || !is_operand_position(found, open)
    {
        return None;
    }
    if found.token_at(at) == Some(Token::Ident) {
        return None;
    }
    let diagnostic = foreign_syntax("a conditional expression is written `if x = 1 then a else b`")
        .primary(found.token_span(open), "braces enclose the fields of a struct")
        .help("for several cases: `y = if x = 1 then a else if x = 2 then b else c;`; the last `else` covers all other values");
    Some(remove_phrase(diagnostic))
}

/// Recognises a conditional expression with `unless`: `z = x unless c;`.
pub(super) fn unless_expression(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    if found.source_text(at) != "unless"
        || !found.expects(Token::Plus)
        || found.expects(Token::Then)
    {
        return None;
    }
    let diagnostic = foreign_syntax("a conditional expression is written `if c then x else y`")
        .primary(found.token_span(at), "the condition must come first")
        .help("to keep the value of the previous cycle while `c` is true: `y = first -> if c then pre y else x;`");
    Some(remove_phrase(diagnostic))
}

/// Recognises several indices in one pair of brackets: `f[x, y]`, `a[1, 2]`.
pub(super) fn several_indices(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    let open = found.structure.parent(at)?;
    let base = open
        .checked_sub(1)
        .filter(|at| found.token_at(*at) == Some(Token::Ident))?;
    let is_index = found.token_at(open) == Some(Token::LBracket) && found.expects(Token::RBracket);
    if found.token_at(at) != Some(Token::Comma) || !is_index {
        return None;
    }
    let name = found.source_text(base);
    let diagnostic = foreign_syntax("an index is a single value")
        .primary(found.token_span(at), "expected `]` after the index")
        .help(format!(
            "for nested arrays write `{name}[0][1]`; a call is written `{name}(x, y)`"
        ));
    Some(remove_phrase(diagnostic))
}

/// Recognises a redundant keyword before a call: `y = call f(x);`, `y = new f(x);`.
pub(super) fn call_keyword(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let fault = found.error.index;
    let at = fault.checked_sub(1)?;
    let is_word = matches!(
        found.source_text(at),
        "call" | "new" | "await" | "run" | "do" | "exec"
    );
    let is_call = found.token_at(fault) == Some(Token::Ident)
        && matches!(
            found.token_at(fault + 1),
            Some(Token::LParen | Token::LStatic)
        );
    if !is_word || !is_call || !is_operand_position(found, at) {
        return None;
    }
    let place = found
        .cx
        .span(found.lexemes[at].start, found.lexemes[fault].start);
    let diagnostic = foreign_syntax("a call needs no word")
        .primary(found.token_span(at), "keyword of another language")
        .fix(Fix::sure(format!("delete `{}`", found.source_text(at))).replace(place, ""));
    let repair = Repair::ReplaceTokens(vec![(at..fault, Vec::new())]);
    Some(ForeignSyntax { diagnostic, repair })
}
