//! Two set-points of one actuator in one command (M9): the diagnostics of the compiler are compared with runs of the
//! same equations in the reference interpreter.
//!
//! A plain run tests a few programs; `RPI_PROGRAMS=10000` sets their number, `RPI_SEED` the first seed.

mod generator;
#[path = "../properties/random.rs"]
mod random;

use generator::{GeneratedProgram, generate};
use random::Random;
use rpi_diag::Code;
use rpi_driver::{Input, InputKind, TypedProgram, check_typed, compile};
use rpi_reference::{Interpreter, Leaf, Value};

/// Number of programs in a plain run.
const PROGRAMS: u64 = 200;
/// First seed of a plain run.
const SEED: u64 = 20_261_125;
/// Runs per program, and cycles per run.
const RUNS: u64 = 60;
const CYCLES: usize = 16;
/// Period in seconds.
const DT: f64 = 1e-3;

/// Result of the compiler for two set-points.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Verdict {
    /// No diagnostic: they are proved mutually exclusive.
    Exclusive,
    /// Error: they conflict in some run.
    Together,
    /// Note: neither is proved; each cycle checks it.
    Open,
}

fn number(name: &str, otherwise: u64) -> u64 {
    let number = std::env::var(name).ok().and_then(|text| text.parse().ok());
    number.unwrap_or(otherwise)
}

fn input(text: &str) -> Input {
    Input {
        path: "random.rpi".into(),
        kind: InputKind::Rpi,
        bytes: text.as_bytes().to_vec(),
    }
}

/// Returns the result of the compiler for the command of a program.
fn output(made: &GeneratedProgram) -> Verdict {
    let text = made.command();
    let compiled = compile(&input(&text)).expect("it is text");
    let other = |f: &&rpi_diag::Diagnostic| {
        f.severity() == rpi_diag::Severity::Error && f.code != Code::RPI6101
    };
    if let Some(diagnostic) = compiled.diagnostics.iter().find(other) {
        panic!("{diagnostic:?}\n{text}");
    }
    let has = |code: Code| compiled.diagnostics.iter().any(|f| f.code == code);
    match (has(Code::RPI6101), has(Code::RPI6105)) {
        (true, _) => Verdict::Together,
        (false, true) => Verdict::Open,
        (false, false) => Verdict::Exclusive,
    }
}

/// Returns a row of inputs: mostly small values, so that conditions often hold, and sometimes extreme ones.
fn row(random: &mut Random, before: Option<&Vec<Leaf>>) -> Vec<Leaf> {
    let values = (0..7).map(|k| match (before, k) {
        (Some(before), _) if random.one_in(3) => before[k],
        (_, 0..=2) => Some(Value::Bool(random.one_in(2))),
        (_, 3 | 4) if random.one_in(60) => Some(Value::Int(*random.pick(&[
            i64::MIN,
            i64::MAX,
            i64::MIN + 1,
        ]))),
        (_, 3 | 4) => Some(Value::Int(random.below(12) as i64 - 4)),
        _ if random.one_in(30) => Some(Value::Real(*random.pick(&[
            f64::NAN,
            f64::INFINITY,
            f64::NEG_INFINITY,
        ]))),
        _ => Some(Value::Real(random.below(30) as f64 * 0.5 - 5.0)),
    });
    values.collect()
}

/// Returns whether both set-points are present in the same cycle of some run.
fn meets(program: &TypedProgram, seed: u64) -> bool {
    let unit = program.unit("main").expect("it has a node");
    (0..RUNS).any(|run| {
        let mut random = Random::new(seed ^ (run << 40));
        let mut reference = Interpreter::new(&program.units, unit, DT);
        let mut before = None;
        (0..CYCLES).any(|_| {
            let now = row(&mut random, before.as_ref());
            let both = match reference.cycle(&now) {
                Ok(cycle) => cycle.outputs == [Some(Value::Bool(true))],
                Err(_) => return false,
            };
            before = Some(now);
            both
        })
    })
}

/// Number of times each result occurred: for programs exclusive by construction, programs that conflict in a run, and
/// others.
#[derive(Default, Debug)]
struct Counts {
    exclusive: [u64; 3],
    meeting: [u64; 3],
    others: [u64; 3],
}

fn look_at(seed: u64, counts: &mut Counts) {
    let made = generate(seed);
    let text = made.node();
    let program = check_typed(&input(&text)).expect("it is text");
    let program = program.unwrap_or_else(|f| panic!("{f:?}\n{text}"));
    let (meets, output) = (meets(&program, seed), output(&made));
    let description = || format!("RPI_SEED={seed} RPI_PROGRAMS=1\n{}", made.command());
    assert!(
        !(meets && made.is_exclusive),
        "not exclusive: {}",
        description()
    );
    assert!(
        !(meets && output == Verdict::Exclusive),
        "wrongly proved: {}",
        description()
    );
    assert!(
        !(made.is_exclusive && output == Verdict::Together),
        "wrongly rejected: {}",
        description()
    );
    if output == Verdict::Open && std::env::var("RPI_TELL").is_ok() {
        println!("open, meets {meets}: {}", description());
    }
    let row = match (made.is_exclusive, meets) {
        (true, _) => &mut counts.exclusive,
        (_, true) => &mut counts.meeting,
        _ => &mut counts.others,
    };
    row[output as usize] += 1;
}

/// Returns the diagnostics of a program in `tests/exclusive`.
fn diagnostics(text: &str) -> Vec<rpi_diag::Diagnostic> {
    compile(&input(text)).expect("it is text").diagnostics
}

#[test]
fn set_points_that_exclude_each_other_are_accepted() {
    let programs = [
        include_str!("../../../../tests/exclusive/accepted.rpi"),
        include_str!("../../../../tests/exclusive/accepted_too.rpi"),
        include_str!("../../../../tests/exclusive/accepted_robots.rpi"),
        include_str!("../../../../tests/exclusive/accepted_robots_too.rpi"),
    ];
    for text in programs {
        let messages: Vec<String> = diagnostics(text)
            .iter()
            .filter(|f| f.severity() == rpi_diag::Severity::Error || f.code == Code::RPI6105)
            .map(|f| format!("{}: {} at {:?}", f.code, f.message, f.span()))
            .collect();
        assert!(messages.is_empty(), "{messages:?}");
    }
}

#[test]
fn set_points_that_meet_are_refused_with_the_values_of_a_run() {
    let text = include_str!("../../../../tests/exclusive/refused.rpi");
    let diagnostics = diagnostics(text);
    let errors = diagnostics
        .iter()
        .filter(|f| f.severity() == rpi_diag::Severity::Error);
    let refused = errors.filter(|f| {
        f.code == Code::RPI6101
            && f.notes
                .iter()
                .any(|note| note.starts_with("both are present"))
    });
    assert_eq!(refused.count(), text.matches("\ncommand ").count());
}

#[test]
fn what_is_said_of_two_set_points_agrees_with_runs() {
    let (programs, first) = (number("RPI_PROGRAMS", PROGRAMS), number("RPI_SEED", SEED));
    let mut counts = Counts::default();
    for seed in first..first + programs {
        look_at(seed, &mut counts);
    }
    println!("exclusive, together, open: {counts:?}");
    if programs < PROGRAMS {
        return;
    }
    let [proved, _, open] = counts.exclusive;
    assert!(proved >= 9 * open, "too little is proved: {counts:?}");
    let [_, refused, open] = counts.meeting;
    assert!(
        refused >= 99 * open,
        "too many conflicts are not reported: {counts:?}"
    );
}
