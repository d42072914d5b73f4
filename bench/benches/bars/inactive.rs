//! Cost of inactive fragments, which must not depend on their contents.

use crate::{MS, with_temp_dir};
use rpi_bench::gcc_reference::InterpretedNet;
use rpi_bench::table::Table;
use rpi_bench::{NetBuilder, image_compare, net_builder};
use rpi_core::{CycleContext, Instance};
use rpi_device::NoDevices;
use rpi_lower::LowerOptions;
use rpi_net::{FragmentId, Input, Net, Restart};
use std::path::Path;
use std::process::Command;

/// First argument with which this benchmark starts itself as a process that runs cycles under callgrind.
pub(crate) const CHILD: &str = "cycles-child";

/// Number of inactive fragments in the measured net.
pub(crate) const MANY: usize = 64;

/// Returns a net with many fragments that are never active, each with `size` primitives. If `fragments` is false, the
/// net contains only the activation conditions of these fragments.
pub(crate) fn inactive_net(fragments: bool, size: usize) -> Net {
    let mut b = NetBuilder::new("sleeping");
    let root = FragmentId::ROOT;
    let key = ("Key", rpi_image::Value::Str("x".into()));
    let x = b.add_with(root, "Core::DoubleNetcommIn", &[], &[key]);
    b.export("y", x);
    let whole = b.add(root, "Core::IntFromDouble", &[Input::Port(x)]);
    for k in 0..MANY {
        let limit = Input::constant(rpi_image::Value::int(10 + k as i64));
        let awake = b.add(root, "Core::IntGreater", &[Input::Port(whole), limit]);
        let params = [("Key", rpi_image::Value::Str(format!("awake{k}")))];
        b.add_with(
            root,
            "Core::BooleanNetcommOut",
            &[Input::Port(awake)],
            &params,
        );
        if !fragments {
            continue;
        }
        let f = b.fragment(root, &format!("f{k}"), awake, Restart::Never);
        let mut y = x;
        for _ in 0..size {
            let half = b.add(
                f,
                "Core::DoubleMultiply",
                &[Input::Port(y), net_builder::real(0.9)],
            );
            y = half;
        }
        b.export(&format!("y{k}"), y);
    }
    b.net
}

/// Adds the cost of an inactive fragment to the table: time, steps, and processor instructions if valgrind is
/// available.
pub(crate) fn rows(table: &mut Table) {
    for size in [1, 100, 10_000] {
        let row = format!("inactive fragment, {size} inside");
        if !table.is_selected(&row) {
            continue;
        }
        let (with, without) = (inactive_net(true, size), inactive_net(false, size));
        let ns = difference(&with, &without) / MANY as f64;
        let steps = (steps_per_cycle(&with) - steps_per_cycle(&without)) as f64 / MANY as f64;
        let instructions = match (instructions(&with), instructions(&without)) {
            (Some(a), Some(b)) => format!("{:.2} instructions", (a - b) / MANY as f64),
            _ => "no valgrind".into(),
        };
        let note = format!("{instructions} and {steps:.2} steps each");
        table.add_row(&row, ns, 2.0, "ns", &note);
    }
}

/// Returns the difference of the times of two nets in nanoseconds per cycle. Batches of cycles of both nets alternate,
/// and the fastest batch of each net counts.
fn difference(with: &Net, without: &Net) -> f64 {
    let mut nets = [with, without].map(|n| InterpretedNet::new(n).expect("there are no devices"));
    let mut best = [f64::MAX; 2];
    for _ in 0..15 {
        for (net, best) in nets.iter_mut().zip(&mut best) {
            *best = best.min(net.batch(20_000));
        }
    }
    best[0] - best[1]
}

fn steps_per_cycle(net: &Net) -> usize {
    let image =
        image_compare::lower_net(net, &LowerOptions::running(MS)).expect("it can be lowered");
    let end = image.steps.len();
    let mut machine = Instance::load(image, &mut NoDevices).expect("there are no devices");
    machine.read(&mut NoDevices, &CycleContext::default());
    let (mut pc, mut steps) = (0, 0);
    while pc < end {
        pc = machine.step(pc, &mut NoDevices);
        steps += 1;
    }
    steps
}

/// Returns the number of processor instructions in a cycle of a net, counted by callgrind; `None` if valgrind is not
/// available. Two runs that differ only in the number of cycles are subtracted, and both read the image from a file, so
/// that the start does not count.
fn instructions(net: &Net) -> Option<f64> {
    let image = image_compare::lower_net(net, &LowerOptions::running(MS))
        .ok()?
        .to_bytes();
    let count = |cycles: u32| {
        with_temp_dir(|dir| {
            let path = dir.join("net.rpib");
            std::fs::write(&path, &image).map_err(|e| e.to_string())?;
            callgrind(&path, cycles).ok_or_else(String::new)
        })
    };
    Some((count(2000)? - count(1000)?) / 1000.0)
}

fn callgrind(path: &Path, cycles: u32) -> Option<f64> {
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(std::env::current_exe().ok()?)
        .arg(CHILD)
        .arg(path)
        .arg(cycles.to_string())
        .output()
        .ok()?;
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    let line = text.lines().find(|l| l.contains("Collected"))?;
    line.split_whitespace().last()?.parse().ok()
}

/// Loads an image from a file and runs it for a number of cycles, without any other work that callgrind would count.
pub(crate) fn run_cycles(path: &Path, cycles: usize) {
    let bytes = std::fs::read(path).unwrap_or_default();
    let image = rpi_image::Image::from_bytes(&bytes).expect("it was written by us");
    let mut machine = Instance::load(image, &mut NoDevices).expect("there are no devices");
    for _ in 0..cycles {
        machine.read(&mut NoDevices, &CycleContext::default());
        machine.evaluate(&mut NoDevices);
        machine.commit();
        machine.hand_over(&mut NoDevices);
    }
}
