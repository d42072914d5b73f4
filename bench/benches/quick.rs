//! Quick look at the interpreter beside gcc.

use rpi_bench::{generate, yardstick};

fn main() {
    let nets = [
        ("biquad", 1001, generate::biquad(91)),
        ("biquad", 9999, generate::biquad(909)),
        ("pid", 1040, generate::pid(40)),
        ("pid", 10400, generate::pid(400)),
        ("mixed", 1000, generate::mixed(1000, 1)),
        ("mixed", 10000, generate::mixed(10000, 1)),
    ];
    let only: Vec<String> = std::env::args()
        .skip(1)
        .filter(|a| !a.starts_with('-'))
        .collect();
    for (name, size, net) in nets {
        if !only.is_empty() && !only.iter().any(|o| o == name) {
            continue;
        }
        let cycles = (3_000_000 / size).max(10) as u64;
        let dir = tempfile::tempdir().unwrap();
        let gcc = yardstick::gcc(&net, cycles, dir.path());
        let ours = yardstick::ours(&net, cycles).unwrap();
        match gcc {
            Ok(gcc) => println!(
                "{name:8} {size:6} ours {:7.3} gcc {:7.3} ns per equation: {:5.2}x {}",
                ours.ns / size as f64,
                gcc.ns / size as f64,
                ours.ns / gcc.ns,
                if gcc.y == ours.y { "same" } else { "DIFFERENT" },
            ),
            Err(error) => println!(
                "{name:8} {size:6} ours {:7.3}; {error}",
                ours.ns / size as f64
            ),
        }
    }
}
