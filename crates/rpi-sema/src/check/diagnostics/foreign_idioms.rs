//! Help texts for functions of other languages that are written in another form here.

use rpi_diag::Quote;
use rpi_syntax::ast::Arg;

/// Function names of other languages, in lower case, with help texts that show the syntax of RPI. `{x}`, `{y}` and
/// `{z}` stand for the first three arguments of the call.
const CALL_FORMS: &[(&[&str], &str)] = &[
    (
        &[
            "ifelse", "if_else", "iif", "iff", "ite", "select", "sel", "cond", "where", "choose",
            "mux", "switch",
        ],
        "a choice is written `if {x} then {y} else {z}`; among several: `if ... then ... else if ... then ... else ...`",
    ),
    (
        &["limit", "limiter"],
        "`use control;` has `clamp({x}, {y}, {z})`",
    ),
    (
        &["sqr", "square"],
        "a square is written `{x} * {x}`; the square root is `sqrt({x})`",
    ),
    (
        &["fmod", "rem", "remainder", "modulo"],
        "the remainder is written `{x} mod {y}`",
    ),
    (
        &["idiv", "floordiv", "quotient"],
        "the integer quotient is written `{x} div {y}`",
    ),
    (
        &["and", "land", "logical_and"],
        "conjunction is written `{x} and {y}`",
    ),
    (
        &["or", "lor", "logical_or"],
        "disjunction is written `{x} or {y}`",
    ),
    (
        &["not", "lnot", "logical_not"],
        "negation is written `not {x}`",
    ),
    (
        &["xor", "logical_xor"],
        "exclusive or is written `{x} xor {y}`",
    ),
    (
        &["eq", "equals", "isequal"],
        "equality is written `{x} = {y}`",
    ),
    (&["ne", "neq"], "inequality is written `{x} <> {y}`"),
    (&["add", "plus"], "a sum is written `{x} + {y}`"),
    (&["sub", "minus"], "a difference is written `{x} - {y}`"),
    (&["mul", "times"], "a product is written `{x} * {y}`"),
    (
        &["div", "divide"],
        "a quotient is written `{x} / {y}`, of integers `{x} div {y}`",
    ),
    (
        &["bool", "boolean", "to_bool", "tobool"],
        "a condition is a comparison: `{x} <> 0`",
    ),
    (
        &["unitdelay", "unit_delay", "memory", "z"],
        "a delay of one cycle is `... fby {x}`, or `... -> pre {x}`",
    ),
    (
        &["ic", "init", "initial", "initialize"],
        "the initial value is written before `->`: `... -> pre {x}`",
    ),
    (
        &["rand", "random", "randint", "rnd"],
        "random numbers are not available: the same inputs always give the same outputs",
    ),
    (
        &[
            "time", "now", "clock", "millis", "micros", "gettime", "tic", "toc",
        ],
        "the time since the first cycle is the flow `time`, the period `dt`",
    ),
    (
        &["zeros", "ones", "repmat", "fill_n"],
        "an array of equal elements is written `0^3`",
    ),
    (
        &["range", "linspace", "arange", "iota"],
        "an array has its elements in brackets: `[0, 1, 2]`",
    ),
    (
        &["append", "push", "push_back", "concat", "cat", "strcat"],
        "arrays are joined by `|`: `{x} | {y}`; an element is written `[...]`",
    ),
    (&["isnan", "is_nan"], "test for NaN by `{x} <> {x}`"),
    (
        &["exit", "abort", "stop", "halt", "quit", "terminate"],
        "end a command by a result: `finish done when c;`, `fail broken when c;`",
    ),
    (
        &["error", "raise", "throw", "panic", "signal_error"],
        "signal an error by a flow, or by a result of the command: `fail broken when c;`",
    ),
    (
        &[
            "ptp", "lin", "circ", "movej", "movel", "movec", "movep", "move", "moveto", "moveabsj",
            "move_to", "goto",
        ],
        "use a motion fragment: `use motion;`, then `way = Line(arm, p);` and `arm.joints = way.joints;`",
    ),
    (
        &["moving_average", "movmean"],
        "`use filters;` has `average`",
    ),
    (
        &["push_front", "pop", "pop_back", "insert", "remove", "erase"],
        "the size of an array is fixed: `({x} with [...] = ...)` changes an element",
    ),
];

/// Returns the help text for a call of a function of another language; `None` if there is none. `name` is in lower
/// case, and `args` are quoted in the text.
pub(crate) fn call_help(name: &str, args: &[Arg]) -> Option<String> {
    let (_, help) = CALL_FORMS.iter().find(|(names, _)| names.contains(&name))?;
    let mut text = (*help).to_owned();
    for (k, place) in ["{x}", "{y}", "{z}"].into_iter().enumerate() {
        let arg = args.get(k).map(|arg| Quote::operand(arg.value.span));
        let written = arg.map_or("...".to_owned(), |quote| quote.to_string());
        text = text.replace(place, &written);
    }
    Some(text)
}

/// Returns the help text for a task step whose name is a function in other languages, such as a wait; `None` if there
/// is none. `name` is as written in the program.
pub(crate) fn step_help(name: &str) -> Option<&'static str> {
    let name = name.to_lowercase();
    let starts = |words: &[&str]| words.iter().any(|word| name.starts_with(word));
    if starts(&["wait", "sleep", "delay", "pause", "dwell"]) {
        return Some(
            "a step lasts as long as its command: `command Pause let finish over when time >= 2[s]; tel`, then `Pause();`",
        );
    }
    if starts(&["mov", "ptp", "lin", "circ"]) {
        return Some(
            "write a motion in a command: `command MoveTo (arm: Arm; to: Pose) let way = Line(arm, to); ... tel`",
        );
    }
    if starts(&["print", "log", "msg", "tpwrite"]) {
        return Some("a task has no output; export flows of a command instead: `export x;`");
    }
    None
}
