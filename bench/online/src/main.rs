//! Comparison of the online trajectory generator with the Python package `ruckig` and the crate `rsruckig`.
//!
//! `rpi-bench-online compare COUNT SEED` plans random motions of one axis and reports where a motion fails, breaks a
//! limit or takes longer than that of `ruckig`. `rpi-bench-online together COUNT SEED` does so for synchronised motions
//! of three axes. `rpi-bench-online cost` measures the time of a calculation. The interpreter is `python3` or the value
//! of `RPI_PYTHON`.

#[path = "../../../crates/rpi-motion/tests/online/cases.rs"]
mod cases;
mod compare;
mod cost;
mod reference;
#[path = "../../../crates/rpi-motion/tests/online/verify.rs"]
mod verify;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |at: usize, default: u64| {
        arguments
            .get(at)
            .and_then(|text| text.parse().ok())
            .unwrap_or(default)
    };
    match arguments.first().map(String::as_str) {
        Some("compare") => compare::single(number(1, 100_000), number(2, 1)),
        Some("together") => compare::together(number(1, 20_000), number(2, 1)),
        Some("cost") => cost::measure(),
        _ => eprintln!("usage: rpi-bench-online compare|together COUNT SEED, or cost"),
    }
}
