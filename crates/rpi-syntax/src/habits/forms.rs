//! Values in forms of other languages: choices by `case`, calls of methods, functions without a name.

use super::operators::own_if;
use super::words::{begins_operand, stands_for_operand};
use super::{Habit, Mend, habit};
use crate::ast::Ident;
use crate::explain::Found;
use crate::token::Token;
use rpi_diag::Fix;

/// The words of a choice among values.
const CASES: [&str; 6] = ["case", "match", "switch", "select", "cond", "when"];

/// `y = case x of 1: a; ...`, `y = match x { 1 => a, ... }`
pub(super) fn cases(found: &Found<'_, '_>) -> Option<Habit> {
    let fault = found.fault.at;
    let is_case = |at: &usize| {
        let word = found.written(*at).to_ascii_lowercase();
        found.token(*at) == Some(Token::Ident)
            && CASES.contains(&&*word)
            && stands_for_operand(found, *at)
    };
    let at = (fault.saturating_sub(4)..fault).rev().find(is_case)?;
    // A flow may have such a name.
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
    let finding = habit("a choice among values is written `if x = 1 then a else b`")
        .at(found.span_at(at), format!("`{word}` is of another language"))
        .help("several: `y = if x = 1 then a else if x = 2 then b else c;`, with the last one for all others");
    let names = equation_targets(found, equation.start, at);
    Some(Habit {
        finding,
        mend: Mend::Phrase(equation.start..end, names),
    })
}

/// Where the alternatives end, although there are `;` between them.
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

/// The names before the `=` of an equation.
fn equation_targets(found: &Found<'_, '_>, start: usize, end: usize) -> Vec<Ident> {
    let Some(sign) = (start..end).find(|at| found.token(*at) == Some(Token::Eq)) else {
        return Vec::new();
    };
    let names = (start..sign).filter(|at| found.token(*at) == Some(Token::Ident));
    names.map(|at| found.ident(at)).collect()
}

/// `y = lambda a: a + 1`
pub(super) fn lambda(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at.checked_sub(1)?;
    let is_word = matches!(found.written(at), "lambda" | "fn" | "func" | "fun" | "def");
    if !is_word || !stands_for_operand(found, at) || found.token(at) != Some(Token::Ident) {
        return None;
    }
    let finding = habit("a function is declared by itself, with a name")
        .at(found.span_at(at), "a word of another language")
        .help("`function f (a: int) returns (b: int) let b = a + 1; tel`");
    Some(usual(finding))
}

/// A finding that leaves the phrase out.
fn usual(finding: rpi_diag::Finding) -> Habit {
    Habit {
        finding,
        mend: Mend::Usual,
    }
}

/// `y = if(c, a, b)`
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
    let finding = habit("a choice is written `if c then x else y`")
        .at(found.span_at(own), "is not called")
        .fix(Fix::sure(format!("write `{meant}`")).replace(place, meant));
    let mend = Mend::Tokens(vec![
        found.instead(own, &[Token::LParen, Token::If]),
        (open..open + 1, Vec::new()),
        found.instead(first, &[Token::Then]),
        found.instead(second, &[Token::Else]),
    ]);
    Some(Habit { finding, mend })
}

/// The commas directly within a bracket.
fn commas(found: &Found<'_, '_>, open: usize, close: usize) -> Vec<usize> {
    let is = |i: &usize| {
        matches!(found.token(*i), Some(Token::Comma | Token::Semi))
            && found.structure.parent(*i) == Some(open)
    };
    (open + 1..close).filter(is).collect()
}

/// `merge c x y`, `merge(c, x, y)`
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
    let finding = habit("`merge` has a case in parentheses for each value of its clock")
        .at(found.span_at(fault), "no case is written like this")
        .help("`merge c (true -> a) (false -> b)`, where `a` is there when `c` and `b` when `not c`; otherwise it is `if c then a else b`");
    Some(usual(finding))
}

/// `y = x when (c and d)`
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
        true => format!("give the condition a name first: `on = {condition};`, then `x when on`"),
        false => "give the condition a name first: `on = ...;`, then `x when on`".to_owned(),
    };
    let finding = habit("a clock is the name of a flow")
        .at(found.span_of(open..close + 1), "a condition without a name")
        .help(help);
    Some(usual(finding))
}

/// `y = (F every c)(x)`, `y = F(x) every c`, `y = restart F(x) every c`
pub(super) fn every(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at;
    let word = found.written(at);
    let begins = matches!(word, "restart" | "activate" | "reset") && found.expects(Token::Int);
    if word != "every" && !begins || found.expects_equation() {
        return None;
    }
    let finding = habit("a node that starts afresh is written `(restart F every c)(x)`")
        .at(
            found.span_at(at),
            "a condition stands beside the node, not beside its call",
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

/// The right form, where all parts are there and plain.
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

/// Modules of other languages whose functions are there without them.
const MODULES: [&str; 9] = [
    "math", "np", "numpy", "std", "cmath", "system", "util", "self", "this",
];

/// `y = x.f(c);`, `math.sin(x)`, `arm.move(p);`
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
        let finding = habit("what a module declares is called by its name alone")
            .at(place, format!("here it is `{name}(...)`"))
            .fix(Fix::maybe(format!("write `{name}`")).replace(place, name));
        let mend = Mend::Tokens(vec![(base..base + 2, Vec::new())]);
        return Some(Habit { finding, mend });
    }
    let finding = habit("nothing is called on a value").at(place, "a call of another language");
    let moves = ["mov", "lin", "ptp", "go", "drive"];
    let help = match moves.iter().any(|word| name.to_ascii_lowercase().starts_with(word)) {
        true => "a motion is a fragment: `way = Line<<to: p>>(from: arm.pose);`, then `arm.tcp = way.pose;`".to_owned(),
        false => format!("a node takes the value as an argument: `y = {name}({of}, ...);`"),
    };
    Some(usual(finding.help(help)))
}

/// `y = f x c;`
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
    let finding = habit("the arguments of a call stand in parentheses")
        .at(found.span_at(at), format!("expected `(` behind `{name}`"));
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

/// `y = {1: a, 2: b}[x];`
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
    let finding = habit("a choice among values is written `if x = 1 then a else b`")
        .at(found.span_at(open), "braces hold the fields of a struct")
        .help("several: `y = if x = 1 then a else if x = 2 then b else c;`, with the last one for all others");
    Some(usual(finding))
}

/// `z = x unless c;`
pub(super) fn unless(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at;
    if found.written(at) != "unless" || !found.expects(Token::Plus) || found.expects(Token::Then) {
        return None;
    }
    let finding = habit("a choice is written `if c then x else y`")
        .at(found.span_at(at), "the condition stands first")
        .help("`y = if c then pre y else x;` keeps the value of the cycle before");
    Some(usual(finding))
}

/// `f[x, y]`, `a[1, 2]`
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
    let finding = habit("an index is one value")
        .at(found.span_at(at), "nothing follows the index")
        .help(format!(
            "an element of an element is `{name}[0][1]`; a call is written `{name}(x, y)`"
        ));
    Some(usual(finding))
}

/// `y = call f(x);`, `y = new f(x);`
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
        .at(found.span_at(at), "a word of another language")
        .fix(Fix::sure(format!("delete `{}`", found.written(at))).replace(place, ""));
    let mend = Mend::Tokens(vec![(at..fault, Vec::new())]);
    Some(Habit { finding, mend })
}
