//! Expressions of other languages: `case` expressions, method calls, lambda expressions.

use super::operators::own_if;
use super::words::{begins_operand, stands_for_operand};
use super::{Habit, Mend, habit};
use crate::ast::Ident;
use crate::explain::Found;
use crate::token::Token;
use rpi_diag::Fix;

/// Keywords of `case` expressions in other languages, in lower case.
const CASES: [&str; 6] = ["case", "match", "switch", "select", "cond", "when"];

/// Recognises a `case` expression: `y = case x of 1: a; ...`, `y = match x { 1 => a, ... }`.
pub(super) fn cases(found: &Found<'_, '_>) -> Option<Habit> {
    let fault = found.fault.at;
    let is_case = |at: &usize| {
        let word = found.written(*at).to_ascii_lowercase();
        found.token(*at) == Some(Token::Ident)
            && CASES.contains(&&*word)
            && stands_for_operand(found, *at)
    };
    let at = (fault.saturating_sub(4)..fault).rev().find(is_case)?;
    // A flow may have such a name, so an error further away has another cause.
    if at + 1 < fault
        && found.token(at + 1) != Some(Token::When)
        && found.token(at + 1) != Some(Token::LParen)
    {
        return None;
    }
    let word = found.written(at).to_ascii_lowercase();
    let equation = found.structure.phrase(at);
    let end = cases_end(found, at, equation.end);
    found.cx.swallow_signs(found.span_of(at..end));
    let finding = habit("a conditional expression is written `if x = 1 then a else b`")
        .at(found.span_at(at), format!("`{word}` is from another language"))
        .help("for several cases: `y = if x = 1 then a else if x = 2 then b else c;`; the last `else` covers all other values");
    let names = equation_targets(found, equation.start, at);
    Some(Habit {
        finding,
        mend: Mend::Phrase(equation.start..end, names),
    })
}

/// Returns the index one past the cases of a `case` expression, which may be separated by `;`.
fn cases_end(found: &Found<'_, '_>, at: usize, end: usize) -> usize {
    use Token::{Arrow, Bar, Colon, Else, End, Implies, Semi};
    let mut end = end.max(at + 1);
    while found.token(end) == Some(Semi) {
        let next = end + 1;
        let word = found.written(next).to_ascii_lowercase();
        let is_case = matches!(found.token(next + 1), Some(Colon | Arrow | Implies))
            || matches!(found.token(next), Some(Bar | Else | End))
            || matches!(
                &*word,
                "default" | "otherwise" | "end" | "end_case" | "endcase" | "when"
            );
        if !is_case {
            break;
        }
        let is = |i: &usize| matches!(found.token(*i), Some(Semi | Token::Tel) | None);
        end = (next..).find(is).unwrap_or(next);
    }
    end
}

/// Returns the names before the `=` of an equation.
fn equation_targets(found: &Found<'_, '_>, start: usize, end: usize) -> Vec<Ident> {
    let Some(sign) = (start..end).find(|at| found.token(*at) == Some(Token::Eq)) else {
        return Vec::new();
    };
    let names = (start..sign).filter(|at| found.token(*at) == Some(Token::Ident));
    names.map(|at| found.ident(at)).collect()
}

/// Recognises a lambda expression: `y = lambda a: a + 1`.
pub(super) fn lambda(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at.checked_sub(1)?;
    let is_word = matches!(found.written(at), "lambda" | "fn" | "func" | "fun" | "def");
    if !is_word || !stands_for_operand(found, at) || found.token(at) != Some(Token::Ident) {
        return None;
    }
    let finding = habit("a function must be declared with a name")
        .at(found.span_at(at), "keyword of another language")
        .help("`function f (a: int) returns (b: int) let b = a + 1; tel`");
    Some(usual(finding))
}

/// Combines a diagnostic with the usual repair, which removes the phrase.
fn usual(finding: rpi_diag::Finding) -> Habit {
    Habit {
        finding,
        mend: Mend::Usual,
    }
}

/// Recognises `if` as a function: `y = if(c, a, b)`.
pub(super) fn called_if(found: &Found<'_, '_>) -> Option<Habit> {
    let own = own_if(found).filter(|_| found.expects(Token::Then))?;
    let open = own + 1;
    let close = found
        .structure
        .partner(open)
        .filter(|_| found.token(open) == Some(Token::LParen))?;
    let [first, second] = commas(found, open, close)[..] else {
        return None;
    };
    if close + 1 != found.fault.at {
        return None;
    }
    let [c, a, b] = [open + 1..first, first + 1..second, second + 1..close];
    if c.is_empty() || a.is_empty() || b.is_empty() {
        return None;
    }
    let meant = format!(
        "(if {} then {} else {})",
        found.text(c),
        found.text(a),
        found.text(b)
    );
    let place = found.span_of(own..close + 1);
    let finding = habit("a conditional expression is written `if c then x else y`")
        .at(found.span_at(own), "`if` is not a function")
        .fix(Fix::sure(format!("write `{meant}`")).replace(place, meant));
    let mend = Mend::Tokens(vec![
        found.instead(own, &[Token::LParen, Token::If]),
        (open..open + 1, Vec::new()),
        found.instead(first, &[Token::Then]),
        found.instead(second, &[Token::Else]),
    ]);
    Some(Habit { finding, mend })
}

/// Returns the commas and semicolons directly within a pair of brackets.
fn commas(found: &Found<'_, '_>, open: usize, close: usize) -> Vec<usize> {
    let is = |i: &usize| {
        matches!(found.token(*i), Some(Token::Comma | Token::Semi))
            && found.structure.parent(*i) == Some(open)
    };
    (open + 1..close).filter(is).collect()
}

/// Recognises a `merge` without cases: `merge c x y`, `merge(c, x, y)`.
pub(super) fn merge(found: &Found<'_, '_>) -> Option<Habit> {
    let fault = found.fault.at;
    let near = fault.saturating_sub(4)..fault;
    let at = near
        .rev()
        .find(|at| found.token(*at) == Some(Token::Merge))?;
    let is_called = found.token(at + 1) == Some(Token::LParen);
    let lacks_cases = fault == at + 2 && found.expects(Token::LParen);
    if !is_called && !lacks_cases {
        return None;
    }
    let finding = habit("`merge` needs one case in parentheses for each value of its clock")
        .at(found.span_at(fault), "expected a case such as `(true -> a)`")
        .help("`merge c (true -> a) (false -> b)`, where `a` is present when `c` and `b` when `not c`; for flows that are always present: `if c then a else b`");
    Some(usual(finding))
}

/// Recognises a clock that is not a name: `y = x when (c and d)`.
pub(super) fn clock(found: &Found<'_, '_>) -> Option<Habit> {
    let fault = found.fault.at;
    let when = (0..fault)
        .rev()
        .find(|at| found.token(*at) == Some(Token::When))?;
    let open = when + 1;
    let close = found
        .structure
        .partner(open)
        .filter(|close| *close >= fault)?;
    let is_value = when.checked_sub(1).is_some_and(|at| {
        matches!(
            found.token(at),
            Some(Token::Ident | Token::Int | Token::Real | Token::RParen | Token::RBracket)
        )
    });
    if found.token(open) != Some(Token::LParen) || !is_value || found.token(when - 1).is_none() {
        return None;
    }
    let condition = found.text(open + 1..close);
    let is_short = condition.len() <= 40 && !condition.contains('\n');
    let help = match is_short {
        true => {
            format!("define a flow for the condition first: `on = {condition};`, then `x when on`")
        }
        false => "define a flow for the condition first: `on = ...;`, then `x when on`".to_owned(),
    };
    let finding = habit("a clock must be the name of a flow")
        .at(found.span_of(open..close + 1), "a condition without a name")
        .help(help);
    Some(usual(finding))
}

/// Recognises a misplaced `every` or `restart`: `y = (F every c)(x)`, `y = F(x) every c`, `y = restart F(x) every c`.
pub(super) fn every(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at;
    let word = found.written(at);
    let begins = matches!(word, "restart" | "activate" | "reset") && found.expects(Token::Int);
    if word != "every" && !begins || found.expects_equation() {
        return None;
    }
    let finding = habit("a node is reset by `(restart F every c)(x)`")
        .at(
            found.span_at(at),
            "the condition belongs to the node, not to its call",
        )
        .help("`(activate F every c initial default 0)(x)` runs it only when `c` holds");
    let finding = match restarted(found, at) {
        Some((place, meant)) => {
            finding.fix(Fix::maybe(format!("write `{meant}`")).replace(place, meant))
        }
        None => finding,
    };
    Some(usual(finding))
}

/// Returns the span of a reset call and its RPI form, if all its parts are present and simple.
fn restarted(found: &Found<'_, '_>, at: usize) -> Option<(rpi_diag::Span, String)> {
    let every = (at..at + 100).find(|at| found.written(*at) == "every")?;
    let close = every.checked_sub(1)?;
    let open = found
        .structure
        .partner(close)
        .filter(|_| found.token(close) == Some(Token::RParen))?;
    let callee = open
        .checked_sub(1)
        .filter(|at| found.token(*at) == Some(Token::Ident))?;
    let (start, end) = super::operators::operand(found, at);
    let is_whole = start == callee || start + 1 == callee && start == at;
    if !is_whole || found.token(open) != Some(Token::LParen) || every + 1 >= end {
        return None;
    }
    let condition = found.text(every + 1..end);
    let meant = format!(
        "(restart {} every {condition}){}",
        found.written(callee),
        found.text(open..close + 1)
    );
    Some((found.span_of(start..end), meant))
}

/// Modules of other languages whose functions RPI provides without a module prefix.
const MODULES: [&str; 9] = [
    "math", "np", "numpy", "std", "cmath", "system", "util", "self", "this",
];

/// Recognises calls of methods and of module functions: `y = x.f(c);`, `math.sin(x)`, `arm.move(p);`.
pub(super) fn method(found: &Found<'_, '_>) -> Option<Habit> {
    use Token::{Dot, Ident, LParen};
    let open = found.fault.at;
    let base = open.checked_sub(3)?;
    let shape = [base, base + 1, base + 2, open].map(|at| found.token(at));
    if shape != [Some(Ident), Some(Dot), Some(Ident), Some(LParen)] {
        return None;
    }
    let (of, name) = (found.written(base), found.written(base + 2));
    let place = found.span_of(base..open);
    if MODULES.iter().any(|module| of.eq_ignore_ascii_case(module)) {
        let finding = habit("functions of a module are called without the module name")
            .at(place, format!("write `{name}(...)`"))
            .fix(Fix::maybe(format!("write `{name}`")).replace(place, name));
        let mend = Mend::Tokens(vec![(base..base + 2, Vec::new())]);
        return Some(Habit { finding, mend });
    }
    let finding = habit("values have no methods").at(place, "method call of another language");
    let moves = ["mov", "lin", "ptp", "go", "drive"];
    let help = match moves.iter().any(|word| name.to_ascii_lowercase().starts_with(word)) {
        true => "a motion is a fragment: `way = Line<<to: p>>(from: arm.pose);`, then `arm.tcp = way.pose;`".to_owned(),
        false => format!("a node takes the value as an argument: `y = {name}({of}, ...);`"),
    };
    Some(usual(finding.help(help)))
}

/// Recognises a call without parentheses: `y = f x c;`.
pub(super) fn applied(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at;
    let callee = at.checked_sub(1)?;
    let is_name = found.token(callee) == Some(Token::Ident)
        && !found.cx.seeming.declares(found.written(callee));
    let is_argument = begins_operand(found, at) && found.token(at) != Some(Token::LParen);
    let is_value = found.expects(Token::Plus) && stands_for_operand(found, callee);
    if !is_name || !is_argument || !is_value {
        return None;
    }
    let simple = |at: &usize| {
        matches!(
            found.token(*at),
            Some(Token::Ident | Token::Int | Token::Real | Token::True | Token::False)
        )
    };
    let end = (at..found.lexemes.len())
        .find(|at| !simple(at))
        .unwrap_or(at);
    let name = found.written(callee);
    let finding = habit("the arguments of a call are written in parentheses")
        .at(found.span_at(at), format!("expected `(` after `{name}`"));
    let ends = matches!(
        found.token(end),
        Some(Token::Semi | Token::RParen | Token::Comma | Token::Then | Token::Else)
    );
    if !ends || end == at {
        return Some(usual(finding.help(format!("`{name}(x, y)`"))));
    }
    let args: Vec<&str> = (at..end).map(|at| found.written(at)).collect();
    let meant = format!("{name}({})", args.join(", "));
    let fix = Fix::maybe(format!("write `{meant}`")).replace(found.span_of(callee..end), meant);
    let mut tokens = found.before_token(at, Token::LParen).1;
    for i in at..end {
        if i > at {
            tokens.extend(found.before_token(i, Token::Comma).1);
        }
        tokens.push(found.lexemes[i]);
    }
    tokens.extend(found.before_token(end, Token::RParen).1);
    Some(Habit {
        finding: finding.fix(fix),
        mend: Mend::Tokens(vec![(at..end, tokens)]),
    })
}

/// Recognises a dictionary literal: `y = {1: a, 2: b}[x];`.
pub(super) fn dictionary(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at;
    let open = at
        .checked_sub(1)
        .filter(|at| found.token(*at) == Some(Token::LBrace))?;
    let is_key = matches!(
        found.token(at),
        Some(Token::Int | Token::Str | Token::True | Token::False | Token::Ident)
    );
    if !is_key || found.token(at + 1) != Some(Token::Colon) || !stands_for_operand(found, open) {
        return None;
    }
    if found.token(at) == Some(Token::Ident) {
        return None;
    }
    let finding = habit("a conditional expression is written `if x = 1 then a else b`")
        .at(found.span_at(open), "braces enclose the fields of a struct")
        .help("for several cases: `y = if x = 1 then a else if x = 2 then b else c;`; the last `else` covers all other values");
    Some(usual(finding))
}

/// Recognises a conditional expression with `unless`: `z = x unless c;`.
pub(super) fn unless(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at;
    if found.written(at) != "unless" || !found.expects(Token::Plus) || found.expects(Token::Then) {
        return None;
    }
    let finding = habit("a conditional expression is written `if c then x else y`")
        .at(found.span_at(at), "the condition must come first")
        .help("`y = if c then pre y else x;` keeps the value of the previous cycle");
    Some(usual(finding))
}

/// Recognises several indices in one pair of brackets: `f[x, y]`, `a[1, 2]`.
pub(super) fn several_indices(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at;
    let open = found.structure.parent(at)?;
    let base = open
        .checked_sub(1)
        .filter(|at| found.token(*at) == Some(Token::Ident))?;
    let is_index = found.token(open) == Some(Token::LBracket) && found.expects(Token::RBracket);
    if found.token(at) != Some(Token::Comma) || !is_index {
        return None;
    }
    let name = found.written(base);
    let finding = habit("an index is a single value")
        .at(found.span_at(at), "expected `]` after the index")
        .help(format!(
            "for nested arrays write `{name}[0][1]`; a call is written `{name}(x, y)`"
        ));
    Some(usual(finding))
}

/// Recognises a keyword before a call: `y = call f(x);`, `y = new f(x);`.
pub(super) fn called_by_word(found: &Found<'_, '_>) -> Option<Habit> {
    let fault = found.fault.at;
    let at = fault.checked_sub(1)?;
    let is_word = matches!(
        found.written(at),
        "call" | "new" | "await" | "run" | "do" | "exec"
    );
    let is_call = found.token(fault) == Some(Token::Ident)
        && matches!(found.token(fault + 1), Some(Token::LParen | Token::LStatic));
    if !is_word || !is_call || !stands_for_operand(found, at) {
        return None;
    }
    let place = found
        .cx
        .span(found.lexemes[at].start, found.lexemes[fault].start);
    let finding = habit("a call needs no word")
        .at(found.span_at(at), "keyword of another language")
        .fix(Fix::sure(format!("delete `{}`", found.written(at))).replace(place, ""));
    let mend = Mend::Tokens(vec![(at..fault, Vec::new())]);
    Some(Habit { finding, mend })
}
