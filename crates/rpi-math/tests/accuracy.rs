//! Errors of all functions against values of high precision, which `tools/reference.py` writes.
//!
//! `RPI_MATH_SAMPLES=1000000` compares as many random arguments of each function in addition. This needs Python 3 with
//! mpmath and takes some minutes; `RPI_MATH_SEED` is the seed of the arguments.

use std::collections::BTreeMap;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};

enum Function {
    One(fn(f64) -> f64),
    Two(fn(f64, f64) -> f64),
}
use Function::{One, Two};

/// The functions, and the greatest allowed error in units in the last place. Subnormal results are rounded twice.
const FUNCTIONS: &[(&str, Function, f64)] = &[
    ("sin", One(rpi_math::sin), 0.52),
    ("cos", One(rpi_math::cos), 0.52),
    ("tan", One(rpi_math::tan), 0.52),
    ("asin", One(rpi_math::asin), 0.75),
    ("acos", One(rpi_math::acos), 0.75),
    ("atan", One(rpi_math::atan), 0.52),
    ("exp", One(rpi_math::exp), 0.76),
    ("expm1", One(rpi_math::expm1), 0.58),
    ("tanh", One(rpi_math::tanh), 0.58),
    ("log", One(rpi_math::log), 0.52),
    ("cbrt", One(rpi_math::cbrt), 0.501),
    ("atan2", Two(rpi_math::atan2), 0.52),
    ("hypot", Two(rpi_math::hypot), 0.96),
    ("pow", Two(rpi_math::pow), 0.76),
];

/// Greatest error of a function so far, and its arguments.
#[derive(Default)]
struct Worst {
    error: f64,
    arguments: Vec<f64>,
    count: usize,
}

impl Worst {
    /// Compares a function with a line of reference values.
    fn compare(&mut self, function: &Function, line: &str) {
        let numbers: Vec<u64> = line
            .split(' ')
            .map(|word| u64::from_str_radix(word, 16).expect("bits in hexadecimal"))
            .collect();
        let reals: Vec<f64> = numbers.iter().map(|bits| f64::from_bits(*bits)).collect();
        let (value, nearest, rest) = match (function, &reals[..]) {
            (One(function), [x, nearest, rest]) => (function(*x), *nearest, *rest),
            (Two(function), [x, y, nearest, rest]) => (function(*x, *y), *nearest, *rest),
            _ => panic!("a line with the wrong number of words: {line}"),
        };
        self.count += 1;
        let error = (places(value, nearest) - rest).abs();
        if error > self.error {
            self.error = error;
            self.arguments = reals[..reals.len() - 2].to_vec();
        }
    }

    fn check(&self, name: &str, bound: f64) {
        println!(
            "{name}: {:.4} ulp at {:?}, {} arguments",
            self.error, self.arguments, self.count
        );
        assert!(self.count >= 1000, "{name}: only {} arguments", self.count);
        assert!(
            self.error <= bound,
            "{name}{:?} has an error of {} units in the last place",
            self.arguments,
            self.error
        );
    }
}

/// Number of reals from `nearest` to `value`, both of the same sign.
fn places(value: f64, nearest: f64) -> f64 {
    if value.is_nan() || value.is_sign_negative() != nearest.is_sign_negative() {
        return f64::INFINITY;
    }
    let size = |x: f64| x.abs().to_bits() as i64;
    let steps = (size(value) - size(nearest)) as f64;
    steps.copysign(steps * nearest)
}

#[test]
fn errors_are_below_one_unit_in_the_last_place() {
    for (name, function, bound) in FUNCTIONS {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/data/{name}.txt"));
        let text = std::fs::read_to_string(path).expect("the file of the function");
        let mut worst = Worst::default();
        text.lines().for_each(|line| worst.compare(function, line));
        worst.check(name, *bound);
    }
}

#[test]
fn errors_of_many_random_arguments_are_below_one_unit_in_the_last_place() {
    let Ok(samples) = std::env::var("RPI_MATH_SAMPLES") else {
        return;
    };
    let seed = std::env::var("RPI_MATH_SEED").unwrap_or_else(|_| "2".to_owned());
    let mut child = Command::new("python3")
        .arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("tools/reference.py"))
        .args([samples, seed])
        .stdout(Stdio::piped())
        .spawn()
        .expect("Python 3");
    let mut all: BTreeMap<String, Worst> = BTreeMap::new();
    let mut current = String::new();
    for line in BufReader::new(child.stdout.take().expect("a pipe")).lines() {
        let line = line.expect("a line of text");
        match FUNCTIONS.iter().find(|(name, ..)| *name == current) {
            Some((_, function, _)) if line.contains(' ') => {
                all.entry(current.clone())
                    .or_default()
                    .compare(function, &line);
            }
            _ => current = line,
        }
    }
    assert!(
        child.wait().expect("the exit status").success(),
        "Python 3 with mpmath is needed"
    );
    for (name, _, bound) in FUNCTIONS {
        all[*name].check(name, *bound);
    }
}
