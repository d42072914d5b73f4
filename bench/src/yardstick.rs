//! The yardstick: the net as C, compiled by gcc, timing itself.

use crate::twin::image;
use rpi_core::{Machine, Moment};
use rpi_device::NoDevices;
use rpi_lower::{LowerOptions, Plan, emit_c};
use rpi_net::Net;
use rpi_net::passes::analyse;
use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

/// What a run took and gave.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Run {
    /// Nanoseconds per cycle: the best of all batches.
    pub ns: f64,
    /// Bits of `y` in the last cycle.
    pub y: u64,
}

/// Batches of which the best counts.
const BATCHES: u64 = 15;
/// Cycles before the first batch.
const WARM: u64 = 20;

/// The input of a cycle, the same in both languages.
fn x(cycle: u64) -> f64 {
    (cycle % 200) as f64 * 0.01 - 1.0
}

/// Runs a net with the input `x` and the export `y` in the interpreter.
///
/// # Errors
/// What kept it from running.
pub fn ours(net: &Net, cycles: u64) -> Result<Run, String> {
    let image = image(net, &LowerOptions::running(1_000_000))?;
    let loaded = Machine::load(image, &mut NoDevices);
    let mut machine = loaded.map_err(|f| f.first().map_or(String::new(), ToString::to_string))?;
    let mut cycle = 0;
    let mut run = |machine: &mut Machine, cycles: u64| {
        let start = Instant::now();
        for _ in 0..cycles {
            machine.set_input(0, &[x(cycle).to_bits()], 0);
            machine.read(&mut NoDevices, &Moment::default());
            machine.evaluate(&mut NoDevices);
            machine.commit();
            machine.hand_over(&mut NoDevices);
            cycle += 1;
        }
        start.elapsed().as_nanos() as f64 / cycles as f64
    };
    run(&mut machine, WARM);
    let ns = (0..BATCHES)
        .map(|_| run(&mut machine, cycles))
        .fold(f64::MAX, f64::min);
    let y = machine
        .image()
        .exports
        .first()
        .and_then(|e| machine.value(e.value));
    Ok(Run {
        ns,
        y: y.map_or(0, |y| y[0]),
    })
}

/// The C text of a net.
///
/// # Errors
/// What has no form in C.
pub fn c_text(net: &Net) -> Result<String, String> {
    let options = LowerOptions::running(1_000_000);
    let analysis = analyse(net.clone(), |_| false).map_err(|v| v.to_string())?;
    let plan = Plan::of(&analysis).ok_or("it depends on itself")?;
    emit_c(&analysis.net, &plan, &options).map_err(|f| {
        f.first()
            .map_or(String::new(), |finding| finding.message.clone())
    })
}

/// Compiles a net with gcc and runs it.
///
/// # Errors
/// What kept it from it; a missing compiler, too.
pub fn gcc(net: &Net, cycles: u64, dir: &Path) -> Result<Run, String> {
    let source = dir.join("net.c");
    let binary = dir.join("net");
    let text = c_text(net)? + &driver(cycles);
    std::fs::write(&source, text).map_err(|e| e.to_string())?;
    let flags = [
        "-O2",
        "-std=c99",
        "-D_POSIX_C_SOURCE=199309L",
        "-ffp-contract=off",
        "-o",
    ];
    let compiled = Command::new("cc")
        .args(flags)
        .arg(&binary)
        .arg(&source)
        .arg("-lm")
        .output();
    let compiled = compiled.map_err(|e| format!("cc: {e}"))?;
    if !compiled.status.success() {
        return Err(String::from_utf8_lossy(&compiled.stderr).into_owned());
    }
    let output = Command::new(&binary).output().map_err(|e| e.to_string())?;
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let mut words = text.split_whitespace();
    let ns = words.next().and_then(|w| w.parse().ok());
    let y = words.next().and_then(|w| u64::from_str_radix(w, 16).ok());
    let (Some(ns), Some(y)) = (ns, y) else {
        return Err(format!("what it printed: {text}"));
    };
    Ok(Run { ns, y })
}

fn driver(cycles: u64) -> String {
    let mut text = String::from("\n#include <stdio.h>\n#include <string.h>\n#include <time.h>\n");
    // Writing to a string cannot fail.
    let _ = write!(
        text,
        "
int main(void) {{
  static Inputs in; static State state; static Outputs out;
  double best = 1e300; uint64_t cycle = 0, bits;
  reset(&state);
  for (int batch = 0; batch <= {BATCHES}; ++batch) {{
    uint64_t n = batch == 0 ? {WARM} : {cycles};
    struct timespec a, b;
    clock_gettime(CLOCK_MONOTONIC, &a);
    for (uint64_t k = 0; k < n; ++k, ++cycle) {{
      in.n0_outValue = (double)(cycle % 200) * 0.01 - 1.0;
      step(&in, &state, &out);
      __asm__ volatile(\"\" ::: \"memory\");
    }}
    clock_gettime(CLOCK_MONOTONIC, &b);
    double ns = ((b.tv_sec - a.tv_sec) * 1e9 + (b.tv_nsec - a.tv_nsec)) / n;
    if (batch > 0 && ns < best) best = ns;
  }}
  memcpy(&bits, &out.y_, sizeof bits);
  printf(\"%.3f %llx\\n\", best, (unsigned long long)bits);
  return 0;
}}
"
    );
    text
}
