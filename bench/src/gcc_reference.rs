//! The reference for the interpreter: the net as C, compiled by gcc and measured in batches.
//!
//! Both sides measure the processor time of their own thread. Batches alternate, so that disturbances affect both, and
//! the best batch of each counts.

use crate::BenchError;
use crate::clock::timed;
use crate::image_compare::lower_net;
use rpi_core::{CycleContext, Instance};
use rpi_device::NoDevices;
use rpi_lower::LowerOptions;
use rpi_net::Net;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

/// Number of cycles that run before the first measured batch of cycles, so that caches and branch predictors are warm.
const WARM_UP_CYCLES: u64 = 20;

/// Returns the value of the input `x` of the measured net in a cycle: a sawtooth from -1 to 0.99 with a period of 200
/// cycles. The net in C and the net in the interpreter get the same values.
fn x(cycle: u64) -> f64 {
    (cycle % 200) as f64 * 0.01 - 1.0
}

/// Net with the input `x` and the export `y`, run by the interpreter.
pub struct InterpretedNet {
    machine: Instance,
    cycle: u64,
}

impl InterpretedNet {
    /// Lowers and loads a net and runs the warm-up cycles.
    ///
    /// # Errors
    /// Returns the reason why the net cannot run.
    pub fn new(net: &Net) -> Result<InterpretedNet, BenchError> {
        let image = lower_net(net, &LowerOptions::running(1_000_000))?;
        let loaded = Instance::load(image, &mut NoDevices);
        let machine = loaded.map_err(|errors| {
            BenchError::new(errors.first().map_or(String::new(), ToString::to_string))
        })?;
        let mut ours = InterpretedNet { machine, cycle: 0 };
        ours.batch(WARM_UP_CYCLES);
        Ok(ours)
    }

    /// Runs a batch of cycles. Returns the processor time of a cycle in nanoseconds.
    pub fn batch(&mut self, cycles: u64) -> f64 {
        let ((), ns) = timed(|| (0..cycles).for_each(|_| self.step()));
        ns / cycles as f64
    }

    fn step(&mut self) {
        let machine = &mut self.machine;
        machine.set_input(0, &[x(self.cycle).to_bits()], 0);
        machine.read(&mut NoDevices, &CycleContext::default());
        machine.evaluate(&mut NoDevices);
        machine.commit();
        machine.hand_over(&mut NoDevices);
        self.cycle += 1;
    }

    /// Returns the number of cycles so far, and the bits of the export `y` in the last cycle.
    #[must_use]
    pub fn last(&self) -> (u64, u64) {
        let exports = &self.machine.image().exports;
        let y = exports.first().and_then(|e| self.machine.value(e.value));
        (self.cycle, y.map_or(0, |y| y[0]))
    }
}

/// Net compiled as C by gcc, as a process that runs batches of cycles on request: the reference for [`InterpretedNet`].
pub struct CompiledNet {
    child: Child,
    requests: Option<ChildStdin>,
    replies: BufReader<ChildStdout>,
    last: (u64, u64),
}

impl CompiledNet {
    /// Compiles a net in the folder `dir`, starts the program and runs the warm-up cycles. `text` is its C text, by
    /// [`emitted_c_text`] or [`flat_c_text`](crate::flat_c::flat_c_text). The net must have the input `x` and the export
    /// `y`.
    ///
    /// # Errors
    /// Returns the reason of a failure, such as a missing compiler.
    pub fn new(text: &str, dir: &Path) -> Result<CompiledNet, BenchError> {
        let program = compile(text, dir)?;
        let child = Command::new(program)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn();
        let mut child = child.map_err(BenchError::from_cause)?;
        let (requests, replies) = (child.stdin.take(), child.stdout.take());
        let mut gcc = CompiledNet {
            child,
            requests,
            replies: BufReader::new(replies.ok_or_else(|| BenchError::new("no pipe"))?),
            last: (0, 0),
        };
        gcc.batch(WARM_UP_CYCLES)?;
        Ok(gcc)
    }

    /// Runs a batch of cycles. Returns the processor time of a cycle in nanoseconds.
    ///
    /// # Errors
    /// Returns an error if the process does not answer.
    pub fn batch(&mut self, cycles: u64) -> Result<f64, BenchError> {
        let requests = self
            .requests
            .as_mut()
            .ok_or_else(|| BenchError::new("no pipe"))?;
        writeln!(requests, "{cycles}").map_err(BenchError::from_cause)?;
        let mut line = String::new();
        let read = self.replies.read_line(&mut line);
        read.map_err(BenchError::from_cause)?;
        let mut words = line.split_whitespace();
        let ns = words.next().and_then(|w| w.parse().ok());
        let y = words.next().and_then(|w| u64::from_str_radix(w, 16).ok());
        let (Some(ns), Some(y)) = (ns, y) else {
            return Err(BenchError::new(format!("unexpected output: {line}")));
        };
        self.last = (self.last.0 + cycles, y);
        Ok(ns)
    }

    /// Returns the number of cycles so far, and the bits of the export `y` in the last cycle.
    #[must_use]
    pub fn last(&self) -> (u64, u64) {
        self.last
    }
}

impl Drop for CompiledNet {
    fn drop(&mut self) {
        // Closing the pipe ends the process.
        drop(self.requests.take());
        let _ = self.child.wait();
    }
}

/// Returns the C text that the compiler emits for a net, with functions whose names start with `Net`.
///
/// # Errors
/// Returns the reason why the net cannot be lowered.
pub fn emitted_c_text(net: &Net) -> Result<String, BenchError> {
    let image = lower_net(net, &LowerOptions::running(1_000_000))?;
    let options = rpi_codegen::Options {
        name: "Net",
        header: None,
        locate: &|_| None,
        line_directives: false,
        origin: "",
    };
    Ok(rpi_codegen::emit(&image, &options).source)
}

/// Compiles the C text of a net in the folder `dir`. Returns the path of the program.
fn compile(text: &str, dir: &Path) -> Result<std::path::PathBuf, BenchError> {
    let (source, binary) = (dir.join("net.c"), dir.join("net"));
    std::fs::write(&source, format!("{text}{C_MAIN}")).map_err(BenchError::from_cause)?;
    let flags = ["-O2", "-std=c99", "-D_POSIX_C_SOURCE=199309L", "-o"];
    let compiled = Command::new("cc")
        .args(flags)
        .arg(&binary)
        .arg(&source)
        .output();
    let compiled = compiled.map_err(|e| BenchError::new(format!("cc: {e}")))?;
    match compiled.status.success() {
        true => Ok(binary),
        false => Err(BenchError::new(String::from_utf8_lossy(&compiled.stderr))),
    }
}

/// Main function of the compiled program in C. It reads numbers from standard input, runs so many cycles, and prints
/// nanoseconds per cycle and the bits of `y`.
const C_MAIN: &str = r#"
#include <stdio.h>
#include <string.h>
#include <time.h>

int main(void) {
  static Net_in in; static Net_state state; static Net_out out;
  unsigned long long n;
  uint64_t cycle = 0, bits;
  Net_init(&in);
  Net_reset(&state);
  while (scanf("%llu", &n) == 1) {
    struct timespec a, b;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &a);
    for (uint64_t k = 0; k < n; ++k, ++cycle) {
      in.x = (double)(cycle % 200) * 0.01 - 1.0;
      Net_step(&state, &in, &out);
      __asm__ volatile("" ::: "memory");
    }
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &b);
    double ns = ((b.tv_sec - a.tv_sec) * 1e9 + (b.tv_nsec - a.tv_nsec)) / n;
    memcpy(&bits, &out.y, sizeof bits);
    printf("%.3f %llx\n", ns, (unsigned long long)bits);
    fflush(stdout);
  }
  return 0;
}
"#;
