//! Statements of other languages, recognised by their first word, with their RPI counterparts.

use super::bodies::{block_end, defined};
use super::{Habit, Mend, habit};
use crate::explain::Found;
use crate::token::Token;
use rpi_diag::Finding;

/// Extent of a foreign statement.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Reach {
    /// Up to its `;`.
    Phrase,
    /// Up to the end of its block.
    Block,
    /// Up to its `returns ...;`, as for the blocks of SCADE.
    Returns,
}

/// Kind of foreign statement.
pub(super) struct Kind {
    /// First words of the statement, in lower case.
    words: &'static [&'static str],
    /// Message of the diagnostic.
    message: &'static str,
    /// Label at the first word.
    label: &'static str,
    /// Help for a statement in a body of equations.
    help: &'static str,
    /// Help for a statement among the steps of a task.
    step: &'static str,
    reach: Reach,
}

/// Help about repeated steps of a task.
const REPEATED: &str =
    "a task repeats steps with `repeat 3 times let ... tel`, or forever with `repeat let ... tel`";
/// Help about branches of a task.
const BRANCHED: &str =
    "a task branches on results: `first: Look() on found then second | on fail then end;`";
/// Help about waiting steps of a task.
const PAUSED: &str = "a step lasts as long as its command: `command Pause let finish over when time >= 2[s]; tel`, then `Pause();`";

/// Help for all other statements among the steps of a task.
const RUNS: &str = "the steps of a task run commands: `MoveTo(arm, p);`";

/// Table of foreign statements. The first row with the word applies.
const KINDS: &[Kind] = &[
    Kind {
        words: &[
            "for", "while", "loop", "foreach", "parfor", "repeat", "do", "forever",
        ],
        message: "there are no loops",
        label: "every equation is evaluated once per cycle",
        help: "use `map`, `fold` and `red` over the elements of an array; across cycles, read the previous value: `n = 0 -> pre n + 1`",
        step: REPEATED,
        reach: Reach::Block,
    },
    Kind {
        words: &["switch", "case", "select", "match", "inspect"],
        message: "a choice among values is an expression, not a statement",
        label: "keyword of another language",
        help: "each flow has one equation: `y = if x = 0 then a else if x = 1 then b else c;`",
        step: BRANCHED,
        reach: Reach::Block,
    },
    Kind {
        words: &["activate"],
        message: "write a choice of blocks as a conditional expression, or as one fragment per block",
        label: "keyword of another language",
        help: "`z = if c then 1 else 2;`; for equations that are inactive at times, use a fragment: `fragment A when c let z = 1; tel`, then `A.z ?? 2`",
        step: BRANCHED,
        reach: Reach::Returns,
    },
    Kind {
        words: &["present"],
        message: "write a choice among signals as a conditional expression, or as states of an automaton",
        label: "keyword of another language",
        help: "`y = if c then a else b;`; for equations that are inactive at times, use a `state` of an `automaton`, or a fragment",
        step: BRANCHED,
        reach: Reach::Block,
    },
    Kind {
        words: &["reset", "every"],
        message: "a node is reset by `(restart F every c)(x)`",
        label: "keyword of another language",
        help: "equations are reset in a fragment: `fragment A when true restart ...`, or by a conditional: `n = if c then 0 else 0 -> pre n + 1`",
        step: REPEATED,
        reach: Reach::Block,
    },
    Kind {
        words: &["emit", "sustain", "notify", "broadcast"],
        message: "a signal is a Boolean flow with an equation",
        label: "keyword of another language",
        help: "it is true when the signal is emitted: `s = c;`; in one state `s = true;`, in the others `s = false;`",
        step: RUNS,
        reach: Reach::Phrase,
    },
    Kind {
        words: &[
            "assume",
            "guarantee",
            "require",
            "requires",
            "ensure",
            "ensures",
            "invariant",
        ],
        message: "a contract is written before the body",
        label: "contract clause among the equations",
        help: "`con assume x > 0; noc let ... tel`; in the body, assert a condition of every cycle: `assert x > 0;`",
        step: RUNS,
        reach: Reach::Phrase,
    },
    Kind {
        words: &[
            "wait",
            "waittime",
            "waitfor",
            "waituntil",
            "wait_for",
            "wait_until",
            "wait_sec",
            "waitdi",
            "await",
            "sleep",
            "delay",
            "pause",
            "dwell",
        ],
        message: "a cycle cannot wait",
        label: "every equation is evaluated in every cycle",
        help: "write a delay as a condition: `finish done when time >= 2[s];`, `finish done when c;`; module `timers` has `on_delay`",
        step: PAUSED,
        reach: Reach::Phrase,
    },
    Kind {
        words: &[
            "ptp", "lin", "circ", "spl", "sptp", "slin", "scirc", "ptp_rel", "lin_rel", "movej",
            "movel", "movec", "movep", "moveabsj", "move", "moveto", "movelin", "moveptp", "movs",
            "mov", "mvs",
        ],
        message: "a motion is a fragment that computes the set-point of the arm",
        label: "keyword of another language",
        help: "`use motion;`, then `way = Line<<to: p, speed: 250[mm/s]>>(from: arm.pose);` and `arm.tcp = way.pose;`",
        step: "a task runs commands: `MoveTo(arm, p);`; the command holds the motion: `way = Line<<to: p>>(from: arm.pose);`",
        reach: Reach::Phrase,
    },
    Kind {
        words: &[
            "set",
            "setdo",
            "setgo",
            "setao",
            "pulsedo",
            "digitalout",
            "out",
        ],
        message: "an output is a port of a device, with one equation",
        label: "keyword of another language",
        help: "`use io;`, then in a command with `io: DigitalIo`: `io.set = [c, false, false, false, false, false, false, false];`",
        step: RUNS,
        reach: Reach::Phrase,
    },
    Kind {
        words: &[
            "print", "printf", "println", "echo", "disp", "display", "tpwrite", "write", "log",
            "msg", "cout",
        ],
        message: "a node cannot print",
        label: "keyword of another language",
        help: "its out-ports are visible while it runs, and so are flows that a command exports: `export x;`",
        step: RUNS,
        reach: Reach::Phrase,
    },
    Kind {
        words: &["throw", "raise", "panic", "error"],
        message: "there are no exceptions",
        label: "keyword of another language",
        help: "report an error as a flow: `wrong = x < 0;`, or as a result of a command: `fail wrong when x < 0;`",
        step: "branch on the result of a step: `first: Look() on found then end | on fail then retreat;`",
        reach: Reach::Phrase,
    },
    Kind {
        words: &["try", "catch", "except", "finally"],
        message: "there are no exceptions",
        label: "keyword of another language",
        help: "report an error as a flow: `wrong = x < 0;`, or as a result of a command: `fail wrong when x < 0;`",
        step: "branch on the result of a step: `first: Look() on found then end | on fail then retreat;`",
        reach: Reach::Block,
    },
    Kind {
        words: &[
            "goto", "jump", "gosub", "jmp", "break", "continue", "exit", "pass", "nop", "skip",
            "halt", "stop", "null",
        ],
        message: "there are no jumps: every equation holds in every cycle",
        label: "keyword of another language",
        help: "operating modes are the states of an `automaton`; a command ends with `finish done when c;`",
        step: BRANCHED,
        reach: Reach::Phrase,
    },
    Kind {
        words: &["call", "perform", "execute", "run", "start"],
        message: "a call needs no word",
        label: "keyword of another language",
        help: "use its result in an equation: `y = F(x);`",
        step: "write only the name of the command and its arguments: `MoveTo(arm, p);`",
        reach: Reach::Phrase,
    },
    Kind {
        words: &[
            "static",
            "global",
            "extern",
            "persistent",
            "auto",
            "mut",
            "local",
            "dim",
            "decl",
            "volatile",
            "register",
            "public",
            "private",
            "signal",
            "sig",
            "pers",
            "retain",
            "val",
            "def",
            "new",
        ],
        message: "a flow is declared by its equation",
        label: "keyword of another language",
        help: "`n = 0 -> pre n + 1;` keeps its value with `pre`; its type may be declared before `let`: `var n: int;`",
        step: RUNS,
        reach: Reach::Phrase,
    },
];

/// Recognises a statement of the table: `while (c) { ... }`, `wait for c;`, `emit s;`.
pub(super) fn statement(found: &Found<'_, '_>) -> Option<Habit> {
    let at = begin(found)?;
    let kind = kind_of(found.written(at))?;
    // In a task, `start` is an RPI step.
    if found.in_task() && found.token(at) == Some(Token::Start) {
        return None;
    }
    if kind.reach == Reach::Phrase && stands_alone(found, at) {
        let mend = Mend::Tokens(vec![(at..at + 1, Vec::new())]);
        let finding = finding(found, kind, at);
        return Some(Habit { finding, mend });
    }
    let end = end(found, kind.reach, at);
    found.cx.swallow_signs(found.span_of(at..end));
    Some(Habit {
        finding: finding(found, kind, at),
        mend: Mend::Phrase(at..end, targets(found, at, end)),
    })
}

fn finding(found: &Found<'_, '_>, kind: &Kind, at: usize) -> Finding {
    let (label, help) = match found.in_task() {
        true => ("keyword of another language", kind.step),
        false => (kind.label, kind.help),
    };
    habit(kind.message).at(found.span_at(at), label).help(help)
}

fn kind_of(word: &str) -> Option<&'static Kind> {
    let word = word.to_ascii_lowercase();
    KINDS.iter().find(|kind| kind.words.contains(&&*word))
}

/// Returns the first word of the statement with the error, if it may begin a foreign statement.
fn begin(found: &Found<'_, '_>) -> Option<usize> {
    use Token::{Colon, Comma, Dot, End, Eq, Let, Semi, Tel};
    let fault = found.fault.at;
    let places = [
        found.structure.phrase(fault).start,
        fault,
        fault.saturating_sub(1),
    ];
    let is_first = |at: &usize| {
        let before = at.checked_sub(1).and_then(|at| found.token(at));
        let is_head = matches!(before, Some(Let | Semi | Tel | End));
        let is_reserved = found
            .token(*at)
            .and_then(Token::keyword)
            .is_some_and(|word| word.is_reserved_in(found.cx.mode));
        let is_target = matches!(found.token(at + 1), Some(Eq | Dot | Comma));
        let is_repeat = found.in_task() && found.token(*at) == Some(Token::Repeat);
        let is_label = found.token(at + 1) == Some(Colon) && found.in_task();
        is_head && !is_repeat && !is_reserved && !is_target && !is_label && *at <= fault
    };
    let is_kind = |at: &usize| {
        let is_call = matches!(found.token(at + 1), Some(Token::LParen | Token::LStatic));
        kind_of(found.written(*at)).is_some_and(|kind| !is_call || kind.reach != Reach::Phrase)
    };
    places.into_iter().find(|at| is_first(at) && is_kind(at))
}

/// Returns whether the next token after token `at` is on another line, as after a statement without `;`.
fn stands_alone(found: &Found<'_, '_>, at: usize) -> bool {
    let (Some(this), Some(next)) = (found.lexemes.get(at), found.lexemes.get(at + 1)) else {
        return false;
    };
    found.cx.slice(this.end, next.start).contains('\n')
}

/// Returns the index one past the last token of a statement that begins at token `at`.
pub(super) fn end(found: &Found<'_, '_>, reach: Reach, at: usize) -> usize {
    let phrase = || {
        let end = found.structure.phrase(at).end.max(at + 1);
        end + usize::from(found.token(end) == Some(Token::Semi))
    };
    match reach {
        Reach::Phrase => phrase(),
        Reach::Block => nested_end(found, at),
        Reach::Returns => {
            let close = found
                .structure
                .parent(at)
                .and_then(|open| found.structure.partner(open));
            let close = close.unwrap_or(found.lexemes.len());
            let returns = (at..close).find(|at| found.token(*at) == Some(Token::Returns));
            let semi =
                returns.and_then(|at| (at..close).find(|at| found.token(*at) == Some(Token::Semi)));
            semi.map_or_else(|| nested_end(found, at), |semi| semi + 1)
        }
    }
}

/// Returns the index one past a block, which ends with its braces, its `let ... tel` or its closing keyword.
fn nested_end(found: &Found<'_, '_>, at: usize) -> usize {
    let (mut i, mut has_block) = (at, false);
    loop {
        match found.token(i) {
            None | Some(Token::Tel) => return i.max(at + 1),
            Some(Token::Semi) if has_block => return i + 1,
            Some(Token::Semi) => return block_end(found, at),
            Some(Token::LBrace | Token::Let) => {
                let Some(close) = found.structure.partner(i) else {
                    return block_end(found, at);
                };
                (i, has_block) = (close + 1, true);
                if !goes_on(found, i) {
                    return i + usize::from(found.token(i) == Some(Token::Semi));
                }
            }
            Some(Token::LParen | Token::LBracket) => {
                i = found
                    .structure
                    .partner(i)
                    .filter(|close| *close > i)
                    .unwrap_or(i)
                    + 1;
            }
            Some(_) => i += 1,
        }
    }
}

/// Returns whether token `at` continues a statement after one of its blocks, such as `else`.
fn goes_on(found: &Found<'_, '_>, at: usize) -> bool {
    let words = [
        "else", "elsif", "elif", "catch", "except", "finally", "while", "until", "case", "default",
        "times",
    ];
    words
        .iter()
        .any(|word| found.written(at).eq_ignore_ascii_case(word))
}

/// Returns the names that a statement seems to define.
fn targets(found: &Found<'_, '_>, at: usize, end: usize) -> Vec<crate::ast::Ident> {
    let mut names = defined(found, at..end);
    // `reset n = ...` defines the name after its keyword.
    if [found.token(at + 1), found.token(at + 2)] == [Some(Token::Ident), Some(Token::Eq)] {
        names.push(found.ident(at + 1));
    }
    names
}

impl Found<'_, '_> {
    /// Returns whether the syntax error is in a task.
    pub(super) fn in_task(&self) -> bool {
        self.token(0) == Some(Token::Task)
    }
}

/// Recognises an `if` among the steps of a task: `if Look() then Move(); end`.
pub(super) fn step_by_condition(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at;
    if found.token(at) != Some(Token::If) || !found.in_task() || !found.expects(Token::Repeat) {
        return None;
    }
    let end = nested_end(found, at);
    found.cx.swallow_signs(found.span_of(at..end));
    let finding = habit("a task branches on the results of its steps")
        .at(found.span_at(at), "expected a step")
        .help(BRANCHED);
    Some(Habit {
        finding,
        mend: Mend::Phrase(at..end, Vec::new()),
    })
}

/// Recognises a step without its argument list: `Rest;`.
pub(super) fn step_without_arguments(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at;
    let ends = matches!(found.token(at), Some(Token::Semi | Token::On | Token::Tel));
    let is_step = found.token_before() == Some(Token::Ident) && found.expects(Token::LParen);
    if !ends || !is_step || !found.in_task() || !found.expects(Token::Colon) {
        return None;
    }
    let name = found.span_at(at - 1);
    let finding = habit("a step needs parentheses after the command name")
        .at(name, "expected `()` after this")
        .fix(rpi_diag::Fix::sure("insert `()`").insert_after(name, "()"));
    let open = found.before_token(at, Token::LParen);
    let close = found.before_token(at, Token::RParen);
    let mend = Mend::Tokens(vec![(open.0, [open.1, close.1].concat())]);
    Some(Habit { finding, mend })
}

/// Recognises a repetition without `times`: `repeat 3 let Rest(); tel`.
pub(super) fn repeat_without_times(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at;
    if found.token(at) != Some(Token::Let) || !found.expects(Token::Times) || at == 0 {
        return None;
    }
    let finding = habit("the number of repetitions is followed by `times`")
        .at(found.span_at(at), "expected `times` before this")
        .fix(rpi_diag::Fix::sure("insert `times`").insert_after(found.span_at(at - 1), " times"));
    let mend = Mend::Tokens(vec![found.before_token(at, Token::Times)]);
    Some(Habit { finding, mend })
}

/// Recognises a repetition without `repeat`: `3 times let Rest(); tel`.
pub(super) fn times_without_repeat(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at;
    let is_count = matches!(found.token(at), Some(Token::Int | Token::Ident));
    let is_round = found.written(at + 1) == "times" && found.in_task();
    if !is_count || !is_round || !found.expects(Token::Repeat) {
        return None;
    }
    let finding = habit("a repetition begins with `repeat`")
        .at(found.span_of(at..at + 2), "expected `repeat` before this")
        .fix(rpi_diag::Fix::sure("insert `repeat`").insert_before(found.span_at(at), "repeat "));
    let word = found.before_token(at, Token::Repeat);
    let times = found.instead(at + 1, &[Token::Times]);
    Some(Habit {
        finding,
        mend: Mend::Tokens(vec![word, times]),
    })
}

/// Recognises steps that are separated by another token than `;`: `Rest(), Rest();`, `Rest() then Rest();`.
pub(super) fn steps_in_row(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at;
    let is_sign = matches!(
        found.token(at),
        Some(Token::Comma | Token::Then | Token::Arrow)
    ) || matches!(found.written(at), "then" | "and");
    let is_step = found.token_before() == Some(Token::RParen) && found.expects(Token::On);
    if !is_sign || !is_step || !found.in_task() {
        return None;
    }
    let gap = found
        .cx
        .span(found.lexemes[at - 1].end, found.lexemes[at].end);
    let finding = habit("steps are separated by `;`")
        .at(found.span_at(at), "expected `;`")
        .fix(rpi_diag::Fix::sure("write `;`").replace(gap, ";"));
    Some(Habit {
        finding,
        mend: Mend::Tokens(vec![found.instead(at, &[Token::Semi])]),
    })
}

/// Recognises an assignment of a step's result: `r = Rest();`.
pub(super) fn step_with_value(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at;
    let is_step = found.in_task() && found.expects(Token::LParen) && found.expects(Token::Colon);
    if found.token(at) != Some(Token::Eq) || !is_step {
        return None;
    }
    let finding = habit("a step has results, not a value")
        .at(found.span_at(at), "a task has no equations")
        .help(BRANCHED);
    Some(Habit {
        finding,
        mend: Mend::Usual,
    })
}

/// Recognises a result of a command without its keyword: `done when c;`.
pub(super) fn result_without_word(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at;
    let name = at
        .checked_sub(1)
        .filter(|at| found.token(*at) == Some(Token::Ident))?;
    let before = name.checked_sub(1).and_then(|at| found.token(at));
    let is_first = matches!(
        before,
        Some(Token::Let | Token::Semi | Token::Tel | Token::End)
    );
    let in_command = found.token(0) == Some(Token::Command);
    if found.token(at) != Some(Token::When) || !is_first || !in_command || !found.expects(Token::Eq)
    {
        return None;
    }
    let span = found.span_at(name);
    let finding = habit("a result begins with `finish`, `yield` or `fail`")
        .at(span, "expected `finish` before this")
        .fix(rpi_diag::Fix::maybe("insert `finish`").insert_before(span, "finish "));
    Some(Habit {
        finding,
        mend: Mend::Tokens(vec![found.before_token(name, Token::Finish)]),
    })
}
