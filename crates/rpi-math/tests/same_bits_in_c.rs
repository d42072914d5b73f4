//! The functions in C have the bits of those in Rust, with all compilers at hand and at all levels of optimisation.
//!
//! `RPI_MATH_ARGUMENTS` is the number of arguments of each function, by default 200 000.

mod common;
mod random;

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

use common::report_skip;
use random::random_bits;

type One = fn(f64) -> f64;
type Two = fn(f64, f64) -> f64;

/// Functions of one argument. Those of two arguments follow.
const ONE: &[(&str, One)] = &[
    ("sin", rpi_math::sin),
    ("cos", rpi_math::cos),
    ("tan", rpi_math::tan),
    ("asin", rpi_math::asin),
    ("acos", rpi_math::acos),
    ("atan", rpi_math::atan),
    ("exp", rpi_math::exp),
    ("expm1", rpi_math::expm1),
    ("tanh", rpi_math::tanh),
    ("log", rpi_math::log),
    ("cbrt", rpi_math::cbrt),
    ("sqrt", libm::sqrt),
];
const TWO: &[(&str, Two)] = &[
    ("atan2", rpi_math::atan2),
    ("hypot", rpi_math::hypot),
    ("pow", rpi_math::pow),
];

/// Options with which the text must have no warning, in C and in C++.
const STRICT: &[&str] = &[
    "-Wall",
    "-Wextra",
    "-Wconversion",
    "-Wshadow",
    "-pedantic",
    "-Werror",
    "-ffp-contract=off",
    "-lm",
];

/// Language and optimisation of each program.
const OPTIONS: &[&[&str]] = &[
    &["-std=c99", "-O0"],
    &["-std=c99", "-O2"],
    &["-std=gnu11", "-O3", "-march=native"],
    &["-std=c99", "-O2", "-DRPI_PORTABLE"],
    &["-x", "c++", "-std=c++17", "-O2"],
];

/// Options that end the program where the behaviour of C is undefined. Only gcc always has the libraries for them.
const SANITIZERS: &[&str] = &[
    "-std=c99",
    "-O1",
    "-fsanitize=undefined,address",
    "-fno-sanitize-recover=all",
];

/// Pairs of random arguments of usual and unusual sizes.
fn arguments() -> Vec<(f64, f64)> {
    let count =
        std::env::var("RPI_MATH_ARGUMENTS").map_or(200_000, |text| text.parse().expect("a number"));
    let mut bits = random_bits();
    let mut real = move || {
        let (kind, bits) = (bits() % 6, bits());
        let unit = (bits >> 11) as f64 / (1_u64 << 53) as f64;
        match kind {
            0 => f64::from_bits(bits),
            1 => 2.0 * unit - 1.0,
            2 => 20.0 * unit - 10.0,
            3 => 2000.0 * unit - 1000.0,
            4 => (1e6 * unit).floor() * std::f64::consts::FRAC_PI_2,
            // Near 1, and integers of both signs.
            _ if bits & 1 == 0 => 1.0 + unit * 1e-6,
            _ => (200.0 * unit).floor() - 100.0,
        }
    };
    (0..count).map(|_| (real(), real())).collect()
}

/// A program that reads pairs of arguments and writes the values of all functions.
fn program() -> String {
    let mut text = String::from(
        "#include <stdbool.h>\n#include <stdint.h>\n#include <stdio.h>\n#include <string.h>\n",
    );
    text.extend(rpi_math::C_SOURCES.iter().copied());
    text.push_str("int main(void) {\n  double x;\n  double y;\n");
    text.push_str(
        "  while (fread(&x, sizeof x, 1, stdin) == 1U && fread(&y, sizeof y, 1, stdin) == 1U) {\n",
    );
    let _ = writeln!(
        text,
        "    double results[{}];\n    uint32_t n = 0;",
        ONE.len() + TWO.len() + 2
    );
    for (name, _) in ONE {
        let _ = writeln!(text, "    results[n++] = rpi_{name}(x);");
    }
    for (name, _) in TWO {
        let _ = writeln!(text, "    results[n++] = rpi_{name}(x, y);");
    }
    text.push_str("    rpi_sincos(x, &results[n], &results[n + 1U]);\n");
    text.push_str("    (void)fwrite(results, sizeof results, 1, stdout);\n  }\n  return 0;\n}\n");
    text
}

/// The values of all functions, in the order of the program.
fn expected(x: f64, y: f64) -> Vec<f64> {
    let mut values: Vec<f64> = ONE.iter().map(|(_, function)| function(x)).collect();
    values.extend(TWO.iter().map(|(_, function)| function(x, y)));
    let (sin, cos) = rpi_math::sincos(x);
    values.extend([sin, cos]);
    values
}

fn is_installed(compiler: &str) -> bool {
    let output = Command::new(compiler).arg("--version").output();
    output.is_ok_and(|output| output.status.success())
}

fn build(compiler: &str, options: &[&str], folder: &Path) -> PathBuf {
    let (source, binary) = (folder.join("functions.c"), folder.join("functions"));
    std::fs::write(&source, program()).expect("the source");
    let mut command = Command::new(compiler);
    command
        .args(options)
        .args(["-o"])
        .arg(&binary)
        .arg(&source)
        .args(STRICT);
    let output = command.output().expect("the compiler");
    let messages = String::from_utf8_lossy(&output.stderr);
    assert!(
        output.status.success(),
        "{compiler} {options:?}:\n{messages}"
    );
    binary
}

/// Runs the program; its input is a file, because both pipes at once could block each other.
fn run(binary: &Path, input: &Path) -> Vec<u64> {
    let file = std::fs::File::open(input).expect("the arguments");
    let output = Command::new(binary)
        .stdin(file)
        .output()
        .expect("the program");
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let words = output.stdout.chunks_exact(8);
    words
        .map(|word| u64::from_le_bytes(word.try_into().expect("8 bytes")))
        .collect()
}

#[test]
fn all_compilers_give_the_bits_of_rust() {
    let compilers: Vec<&str> = ["gcc", "clang"]
        .into_iter()
        .filter(|name| is_installed(name))
        .collect();
    if compilers.is_empty() {
        report_skip("functions in C: there is no C compiler");
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let input = folder.path().join("arguments");
    let pairs = arguments();
    let bytes = pairs
        .iter()
        .flat_map(|(x, y)| [x.to_le_bytes(), y.to_le_bytes()]);
    std::fs::write(&input, bytes.flatten().collect::<Vec<u8>>()).expect("the arguments");
    let values: Vec<f64> = pairs.iter().flat_map(|(x, y)| expected(*x, *y)).collect();
    for compiler in compilers {
        let sanitizers = (compiler == "gcc").then_some(&SANITIZERS);
        for options in OPTIONS.iter().chain(sanitizers) {
            let results = run(&build(compiler, options, folder.path()), &input);
            compare(
                &format!("{compiler} {options:?}"),
                &results,
                &values,
                &pairs,
            );
        }
    }
}

/// Compares the bits of the results with the values for all pairs of arguments.
fn compare(program: &str, results: &[u64], values: &[f64], pairs: &[(f64, f64)]) {
    assert_eq!(results.len(), values.len(), "{program}");
    let per_pair = values.len() / pairs.len();
    for (index, (bits, value)) in results.iter().zip(values).enumerate() {
        let (arguments, function) = (pairs[index / per_pair], index % per_pair);
        // The processor decides the sign of the square root of a negative number.
        let is_root = function == ONE.len() - 1 && value.is_nan();
        assert!(
            *bits == value.to_bits() || is_root,
            "{program}: function {function} of {arguments:?} is {:e} instead of {value:e}",
            f64::from_bits(*bits)
        );
    }
    println!("{program}: {} values with the same bits", results.len());
}
