//! Table of statements of other languages, with the help for each.

/// Rule for where a statement of another language ends.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Extent {
    /// The statement ends at the next `;`.
    Phrase,
    /// The statement ends at the end of its block.
    Block,
    /// The statement ends after its clause `returns ...;`, as the blocks of SCADE do.
    Returns,
}

/// Row of the table of statements of other languages: first words, end, and texts of the diagnostic.
pub(super) struct StatementKind {
    /// Words that begin such a statement, in lower case.
    words: &'static [&'static str],
    /// Message of the diagnostic about a statement of this kind.
    pub(crate) message: &'static str,
    /// Text of the label at the first word.
    pub(crate) label: &'static str,
    /// Help text for a statement in a body of equations.
    pub(crate) help: &'static str,
    /// Help text for a statement among the steps of a task.
    pub(crate) step_help: &'static str,
    pub(crate) extent: Extent,
}

/// Help text on the repetition of steps in a task.
const REPEAT_HELP: &str =
    "a task repeats steps with `repeat 3 times let ... tel`, or forever with `repeat let ... tel`";

/// Help text on branches of a task.
pub(crate) const BRANCH_HELP: &str =
    "a task branches on results: `first: Look() on found then second | on fail then end;`";

/// Help text on waiting in a task.
const PAUSE_HELP: &str = "a step lasts as long as its command: `command Pause let finish over when time >= 2[s]; tel`, then `Pause();`";

/// Help text for all other statements among the steps of a task.
const COMMAND_HELP: &str = "the steps of a task run commands: `MoveTo(arm, p);`";

/// Table of statements of other languages. For a word, the first row that lists it applies.
const KINDS: &[StatementKind] = &[
    StatementKind {
        words: &[
            "for", "while", "loop", "foreach", "parfor", "repeat", "do", "forever",
        ],
        message: "there are no loops",
        label: "every equation is evaluated once per cycle",
        help: "use `map`, `fold` and `red` over the elements of an array; across cycles, read the previous value, as in the counter `n = 0 -> pre n + 1`",
        step_help: REPEAT_HELP,
        extent: Extent::Block,
    },
    StatementKind {
        words: &["switch", "case", "select", "match", "inspect"],
        message: "a choice among values is an expression, not a statement",
        label: "keyword of another language",
        help: "each flow has one equation with a value for every case: `... = if x = ... then ... else if x = ... then ... else ...;`",
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
        help: "`use motion;`, then `way = Line<<speed: 250[mm/s]>>(arm, p);` and `arm.joints = way.joints;`",
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

impl StatementKind {
    /// Returns whether the statement chooses among values: `switch (x) { ... }`.
    pub(super) fn is_choice(&self) -> bool {
        self.words.contains(&"switch")
    }
}

pub(crate) fn kind_of(word: &str) -> Option<&'static StatementKind> {
    let word = word.to_ascii_lowercase();
    KINDS.iter().find(|kind| kind.words.contains(&&*word))
}
