//! Statements of other languages, recognised by their first word, with their RPI counterparts.

use super::imperative::{self, block_end};
use super::{ForeignSyntax, Repair, foreign_syntax};
use crate::syntax_errors::ErrorContext;
use crate::token::Token;
use rpi_diag::Diagnostic;

/// Extent of a foreign statement.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Extent {
    /// Up to its `;`.
    Phrase,
    /// Up to the end of its block.
    Block,
    /// Up to its `returns ...;`, as for the blocks of SCADE.
    Returns,
}

/// Kind of foreign statement.
pub(super) struct StatementKind {
    /// First words of the statement, in lower case.
    words: &'static [&'static str],
    /// Message of the diagnostic.
    message: &'static str,
    /// Label at the first word.
    label: &'static str,
    /// Help for a statement in a body of equations.
    help: &'static str,
    /// Help for a statement among the steps of a task.
    step_help: &'static str,
    extent: Extent,
}

/// Help about repeated steps of a task.
const REPEAT_HELP: &str =
    "a task repeats steps with `repeat 3 times let ... tel`, or forever with `repeat let ... tel`";
/// Help about branches of a task.
const BRANCH_HELP: &str =
    "a task branches on results: `first: Look() on found then second | on fail then end;`";
/// Help about waiting steps of a task.
const PAUSE_HELP: &str = "a step lasts as long as its command: `command Pause let finish over when time >= 2[s]; tel`, then `Pause();`";

/// Help for all other statements among the steps of a task.
const COMMAND_HELP: &str = "the steps of a task run commands: `MoveTo(arm, p);`";

/// Table of foreign statements. The first row with the word applies.
const KINDS: &[StatementKind] = &[
    StatementKind {
        words: &[
            "for", "while", "loop", "foreach", "parfor", "repeat", "do", "forever",
        ],
        message: "there are no loops",
        label: "every equation is evaluated once per cycle",
        help: "use `map`, `fold` and `red` over the elements of an array; across cycles, read the previous value: `n = 0 -> pre n + 1`",
        step_help: REPEAT_HELP,
        extent: Extent::Block,
    },
    StatementKind {
        words: &["switch", "case", "select", "match", "inspect"],
        message: "a choice among values is an expression, not a statement",
        label: "keyword of another language",
        help: "each flow has one equation: `y = if x = 0 then a else if x = 1 then b else c;`",
        step_help: BRANCH_HELP,
        extent: Extent::Block,
    },
    StatementKind {
        words: &["activate"],
        message: "write a choice of blocks as a conditional expression, or as one fragment per block",
        label: "keyword of another language",
        help: "`z = if c then 1 else 2;`; for equations that are inactive at times, use a fragment: `fragment A when c let z = 1; tel`, then `A.z ?? 2`",
        step_help: BRANCH_HELP,
        extent: Extent::Returns,
    },
    StatementKind {
        words: &["present"],
        message: "write a choice among signals as a conditional expression, or as states of an automaton",
        label: "keyword of another language",
        help: "`y = if c then a else b;`; for equations that are inactive at times, use a `state` of an `automaton`, or a fragment",
        step_help: BRANCH_HELP,
        extent: Extent::Block,
    },
    StatementKind {
        words: &["reset", "every"],
        message: "a node is reset by `(restart F every c)(x)`",
        label: "keyword of another language",
        help: "equations are reset in a fragment: `fragment A when true restart ...`, or by a conditional: `n = if c then 0 else 0 -> pre n + 1`",
        step_help: REPEAT_HELP,
        extent: Extent::Block,
    },
    StatementKind {
        words: &["emit", "sustain", "notify", "broadcast"],
        message: "a signal is a Boolean flow with an equation",
        label: "keyword of another language",
        help: "it is true when the signal is emitted: `s = c;`; in one state `s = true;`, in the others `s = false;`",
        step_help: COMMAND_HELP,
        extent: Extent::Phrase,
    },
    StatementKind {
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
        step_help: COMMAND_HELP,
        extent: Extent::Phrase,
    },
    StatementKind {
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
        step_help: PAUSE_HELP,
        extent: Extent::Phrase,
    },
    StatementKind {
        words: &[
            "ptp", "lin", "circ", "spl", "sptp", "slin", "scirc", "ptp_rel", "lin_rel", "movej",
            "movel", "movec", "movep", "moveabsj", "move", "moveto", "movelin", "moveptp", "movs",
            "mov", "mvs",
        ],
        message: "a motion is a fragment that computes the set-point of the arm",
        label: "keyword of another language",
        help: "`use motion;`, then `way = Line<<speed: 250[mm/s]>>(arm, p);` and `arm.tcp = way.pose;`",
        step_help: "a task runs commands: `MoveTo(arm, p);`; the command holds the motion: `way = Line(arm, p);`",
        extent: Extent::Phrase,
    },
    StatementKind {
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
        step_help: COMMAND_HELP,
        extent: Extent::Phrase,
    },
    StatementKind {
        words: &[
            "print", "printf", "println", "echo", "disp", "display", "tpwrite", "write", "log",
            "msg", "cout",
        ],
        message: "a node cannot print",
        label: "keyword of another language",
        help: "its out-ports are visible while it runs, and so are flows that a command exports: `export x;`",
        step_help: COMMAND_HELP,
        extent: Extent::Phrase,
    },
    StatementKind {
        words: &["throw", "raise", "panic", "error"],
        message: "there are no exceptions",
        label: "keyword of another language",
        help: "report an error as a flow: `wrong = x < 0;`, or as a result of a command: `fail wrong when x < 0;`",
        step_help: "branch on the result of a step: `first: Look() on found then end | on fail then retreat;`",
        extent: Extent::Phrase,
    },
    StatementKind {
        words: &["try", "catch", "except", "finally"],
        message: "there are no exceptions",
        label: "keyword of another language",
        help: "report an error as a flow: `wrong = x < 0;`, or as a result of a command: `fail wrong when x < 0;`",
        step_help: "branch on the result of a step: `first: Look() on found then end | on fail then retreat;`",
        extent: Extent::Block,
    },
    StatementKind {
        words: &[
            "goto", "jump", "gosub", "jmp", "break", "continue", "exit", "pass", "nop", "skip",
            "halt", "stop", "null",
        ],
        message: "there are no jumps: every equation holds in every cycle",
        label: "keyword of another language",
        help: "operating modes are the states of an `automaton`; a command ends with `finish done when c;`",
        step_help: BRANCH_HELP,
        extent: Extent::Phrase,
    },
    StatementKind {
        words: &["call", "perform", "execute", "run", "start"],
        message: "a call needs no word",
        label: "keyword of another language",
        help: "use its result in an equation: `y = F(x);`",
        step_help: "write only the name of the command and its arguments: `MoveTo(arm, p);`",
        extent: Extent::Phrase,
    },
    StatementKind {
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
        step_help: COMMAND_HELP,
        extent: Extent::Phrase,
    },
];

/// Recognises a statement of the table: `while (c) { ... }`, `wait for c;`, `emit s;`.
pub(super) fn statement(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = statement_start(found)?;
    let kind = kind_of(found.source_text(at))?;
    // In a task, `start` is an RPI step.
    if found.in_task() && found.token_at(at) == Some(Token::Start) {
        return None;
    }
    if kind.extent == Extent::Phrase && ends_line(found, at) {
        let repair = Repair::ReplaceTokens(vec![(at..at + 1, Vec::new())]);
        let diagnostic = diagnostic(found, kind, at);
        return Some(ForeignSyntax { diagnostic, repair });
    }
    let end = statement_end(found, kind.extent, at);
    found
        .cx
        .suppress_foreign_operators(found.range_span(at..end));
    Some(ForeignSyntax {
        diagnostic: diagnostic(found, kind, at),
        repair: Repair::RemovePhrase(at..end, defined_names(found, at, end)),
    })
}

fn diagnostic(found: &ErrorContext<'_, '_>, kind: &StatementKind, at: usize) -> Diagnostic {
    let (label, help) = match found.in_task() {
        true => ("keyword of another language", kind.step_help),
        false => (kind.label, kind.help),
    };
    foreign_syntax(kind.message)
        .primary(found.token_span(at), label)
        .help(help)
}

fn kind_of(word: &str) -> Option<&'static StatementKind> {
    let word = word.to_ascii_lowercase();
    KINDS.iter().find(|kind| kind.words.contains(&&*word))
}

/// Returns the first word of the statement with the error, if it may begin a foreign statement.
fn statement_start(found: &ErrorContext<'_, '_>) -> Option<usize> {
    use Token::{Colon, Comma, Dot, End, Eq, Let, Semi, Tel};
    let fault = found.error.index;
    let places = [
        found.structure.phrase(fault).start,
        fault,
        fault.saturating_sub(1),
    ];
    let is_first = |at: &usize| {
        let before = at.checked_sub(1).and_then(|at| found.token_at(at));
        let is_head = matches!(before, Some(Let | Semi | Tel | End));
        let is_reserved = found
            .token_at(*at)
            .and_then(Token::keyword)
            .is_some_and(|word| word.is_reserved_in(found.cx.dialect));
        let is_target = matches!(found.token_at(at + 1), Some(Eq | Dot | Comma));
        let is_repeat = found.in_task() && found.token_at(*at) == Some(Token::Repeat);
        let is_label = found.token_at(at + 1) == Some(Colon) && found.in_task();
        is_head && !is_repeat && !is_reserved && !is_target && !is_label && *at <= fault
    };
    let is_kind = |at: &usize| {
        let is_call = matches!(found.token_at(at + 1), Some(Token::LParen | Token::LStatic));
        kind_of(found.source_text(*at))
            .is_some_and(|kind| !is_call || kind.extent != Extent::Phrase)
    };
    places.into_iter().find(|at| is_first(at) && is_kind(at))
}

/// Returns whether the next token after token `at` is on another line, as after a statement without `;`.
fn ends_line(found: &ErrorContext<'_, '_>, at: usize) -> bool {
    let (Some(this), Some(next)) = (found.lexemes.get(at), found.lexemes.get(at + 1)) else {
        return false;
    };
    found.cx.slice(this.end, next.start).contains('\n')
}

/// Returns the index one past the last token of a statement that begins at token `at`.
pub(super) fn statement_end(found: &ErrorContext<'_, '_>, reach: Extent, at: usize) -> usize {
    let phrase = || {
        let end = found.structure.phrase(at).end.max(at + 1);
        end + usize::from(found.token_at(end) == Some(Token::Semi))
    };
    match reach {
        Extent::Phrase => phrase(),
        Extent::Block => nested_block_end(found, at),
        Extent::Returns => {
            let close = found
                .structure
                .parent(at)
                .and_then(|open| found.structure.partner(open));
            let close = close.unwrap_or(found.lexemes.len());
            let returns = (at..close).find(|at| found.token_at(*at) == Some(Token::Returns));
            let semi = returns
                .and_then(|at| (at..close).find(|at| found.token_at(*at) == Some(Token::Semi)));
            semi.map_or_else(|| nested_block_end(found, at), |semi| semi + 1)
        }
    }
}

/// Returns the index one past a block, which ends with its braces, its `let ... tel` or its closing keyword.
fn nested_block_end(found: &ErrorContext<'_, '_>, at: usize) -> usize {
    let (mut i, mut has_block) = (at, false);
    loop {
        match found.token_at(i) {
            None | Some(Token::Tel) => return i.max(at + 1),
            Some(Token::Semi) if has_block => return i + 1,
            Some(Token::Semi) => return block_end(found, at),
            Some(Token::LBrace | Token::Let) => {
                let Some(close) = found.structure.partner(i) else {
                    return block_end(found, at);
                };
                (i, has_block) = (close + 1, true);
                if !continues_statement(found, i) {
                    return i + usize::from(found.token_at(i) == Some(Token::Semi));
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
fn continues_statement(found: &ErrorContext<'_, '_>, at: usize) -> bool {
    let words = [
        "else", "elsif", "elif", "catch", "except", "finally", "while", "until", "case", "default",
        "times",
    ];
    words
        .iter()
        .any(|word| found.source_text(at).eq_ignore_ascii_case(word))
}

/// Returns the names that a statement seems to define.
fn defined_names(found: &ErrorContext<'_, '_>, at: usize, end: usize) -> Vec<crate::ast::Ident> {
    let mut names = imperative::defined_names(found, at..end);
    // `reset n = ...` defines the name after its keyword.
    if [found.token_at(at + 1), found.token_at(at + 2)] == [Some(Token::Ident), Some(Token::Eq)] {
        names.push(found.ident(at + 1));
    }
    names
}

impl ErrorContext<'_, '_> {
    /// Returns whether the syntax error is in a task.
    pub(super) fn in_task(&self) -> bool {
        self.token_at(0) == Some(Token::Task)
    }
}

/// Recognises an `if` among the steps of a task: `if Look() then Move(); end`.
pub(super) fn step_by_condition(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    if found.token_at(at) != Some(Token::If) || !found.in_task() || !found.expects(Token::Repeat) {
        return None;
    }
    let end = nested_block_end(found, at);
    found
        .cx
        .suppress_foreign_operators(found.range_span(at..end));
    let diagnostic = foreign_syntax("a task branches on the results of its steps")
        .primary(found.token_span(at), "expected a step")
        .help(BRANCH_HELP);
    Some(ForeignSyntax {
        diagnostic,
        repair: Repair::RemovePhrase(at..end, Vec::new()),
    })
}

/// Recognises a step without its argument list: `Rest;`.
pub(super) fn step_without_arguments(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    let ends = matches!(
        found.token_at(at),
        Some(Token::Semi | Token::On | Token::Tel)
    );
    let is_step = found.token_before() == Some(Token::Ident) && found.expects(Token::LParen);
    if !ends || !is_step || !found.in_task() || !found.expects(Token::Colon) {
        return None;
    }
    let name = found.token_span(at - 1);
    let diagnostic = foreign_syntax("a step needs parentheses after the command name")
        .primary(name, "expected `()` after this")
        .fix(rpi_diag::Fix::sure("insert `()`").insert_after(name, "()"));
    let open = found.insertion(at, Token::LParen);
    let close = found.insertion(at, Token::RParen);
    let repair = Repair::ReplaceTokens(vec![(open.0, [open.1, close.1].concat())]);
    Some(ForeignSyntax { diagnostic, repair })
}

/// Recognises a repetition without `times`: `repeat 3 let Rest(); tel`.
pub(super) fn repeat_without_times(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    if found.token_at(at) != Some(Token::Let) || !found.expects(Token::Times) || at == 0 {
        return None;
    }
    let diagnostic = foreign_syntax("the number of repetitions is followed by `times`")
        .primary(found.token_span(at), "expected `times` before this")
        .fix(
            rpi_diag::Fix::sure("insert `times`").insert_after(found.token_span(at - 1), " times"),
        );
    let repair = Repair::ReplaceTokens(vec![found.insertion(at, Token::Times)]);
    Some(ForeignSyntax { diagnostic, repair })
}

/// Recognises a repetition without `repeat`: `3 times let Rest(); tel`.
pub(super) fn times_without_repeat(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    let is_count = matches!(found.token_at(at), Some(Token::Int | Token::Ident));
    let is_round = found.source_text(at + 1) == "times" && found.in_task();
    if !is_count || !is_round || !found.expects(Token::Repeat) {
        return None;
    }
    let diagnostic = foreign_syntax("a repetition begins with `repeat`")
        .primary(
            found.range_span(at..at + 2),
            "expected `repeat` before this",
        )
        .fix(rpi_diag::Fix::sure("insert `repeat`").insert_before(found.token_span(at), "repeat "));
    let word = found.insertion(at, Token::Repeat);
    let times = found.replacement(at + 1, &[Token::Times]);
    Some(ForeignSyntax {
        diagnostic,
        repair: Repair::ReplaceTokens(vec![word, times]),
    })
}

/// Recognises steps that are separated by another token than `;`: `Rest(), Rest();`, `Rest() then Rest();`.
pub(super) fn steps_without_semi(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    let is_sign = matches!(
        found.token_at(at),
        Some(Token::Comma | Token::Then | Token::Arrow)
    ) || matches!(found.source_text(at), "then" | "and");
    let is_step = found.token_before() == Some(Token::RParen) && found.expects(Token::On);
    if !is_sign || !is_step || !found.in_task() {
        return None;
    }
    let gap = found
        .cx
        .span(found.lexemes[at - 1].end, found.lexemes[at].end);
    let diagnostic = foreign_syntax("steps are separated by `;`")
        .primary(found.token_span(at), "expected `;`")
        .fix(rpi_diag::Fix::sure("write `;`").replace(gap, ";"));
    Some(ForeignSyntax {
        diagnostic,
        repair: Repair::ReplaceTokens(vec![found.replacement(at, &[Token::Semi])]),
    })
}

/// Recognises an assignment of a step's result: `r = Rest();`.
pub(super) fn step_with_value(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    let is_step = found.in_task() && found.expects(Token::LParen) && found.expects(Token::Colon);
    if found.token_at(at) != Some(Token::Eq) || !is_step {
        return None;
    }
    let diagnostic = foreign_syntax("a step has results, not a value")
        .primary(found.token_span(at), "a task has no equations")
        .help(BRANCH_HELP);
    Some(ForeignSyntax {
        diagnostic,
        repair: Repair::RemoveErrorPhrase,
    })
}

/// Recognises a result of a command without its keyword: `done when c;`.
pub(super) fn result_without_keyword(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    let name = at
        .checked_sub(1)
        .filter(|at| found.token_at(*at) == Some(Token::Ident))?;
    let before = name.checked_sub(1).and_then(|at| found.token_at(at));
    let is_first = matches!(
        before,
        Some(Token::Let | Token::Semi | Token::Tel | Token::End)
    );
    let in_command = found.token_at(0) == Some(Token::Command);
    if found.token_at(at) != Some(Token::When)
        || !is_first
        || !in_command
        || !found.expects(Token::Eq)
    {
        return None;
    }
    let span = found.token_span(name);
    let diagnostic = foreign_syntax("a result begins with `finish`, `yield` or `fail`")
        .primary(span, "expected `finish` before this")
        .fix(rpi_diag::Fix::maybe("insert `finish`").insert_before(span, "finish "));
    Some(ForeignSyntax {
        diagnostic,
        repair: Repair::ReplaceTokens(vec![found.insertion(name, Token::Finish)]),
    })
}
