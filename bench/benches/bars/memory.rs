//! Memory per primitive, while running and while loading.

use crate::{MS, with_temp_dir};
use rpi_bench::table::Table;
use rpi_bench::{generate, image_compare};
use rpi_core::Instance;
use rpi_device::NoDevices;
use rpi_lower::LowerOptions;
use rpi_net::rpinet;
use rpi_testkit::resident_memory_kb;
use std::path::Path;
use std::process::Command;

/// First argument with which this benchmark starts itself as a process that loads a net and prints the memory used.
pub(crate) const CHILD: &str = "load-child";

/// Adds the memory per primitive in bytes to the table: while running, and the maximum while loading.
pub(crate) fn rows(table: &mut Table) {
    let size = 100_000;
    let net = generate::mixed(size, 1);
    if table.is_selected("memory, running") {
        let image =
            image_compare::lower_net(&net, &LowerOptions::running(MS)).expect("it can be lowered");
        let machine = Instance::load(image, &mut NoDevices).expect("there are no devices");
        let image = machine.image();
        // Names and source locations are for messages and are not touched by a cycle, so they do not count.
        let touched = machine.memory()
            + size_of_val(&*image.code)
            + size_of_val(&*image.steps)
            + size_of_val(&*image.commit)
            + size_of_val(&*image.init)
            + size_of_val(&*image.debug.origins);
        let bytes = touched as f64 / net.nodes.len() as f64;
        table.add_row(
            "memory, running",
            bytes,
            48.0,
            "B",
            "per primitive, irregular net of 100 000",
        );
    }
    if table.is_selected("memory, peak while loading") {
        let peak = |size: usize| with_temp_dir(|dir| peak(dir, size));
        if let (Some(large), Some(small)) = (peak(size), peak(100)) {
            let bytes = (large - small) * 1024.0 / net.nodes.len() as f64;
            let note = "per primitive: resident memory at its highest, from text to runnable";
            table.add_row("memory, peak while loading", bytes, 500.0, "B", note);
        }
    }
}

/// Returns the maximum resident memory in kB of a process that loads a net of `size` primitives from its text and does
/// no other work.
fn peak(dir: &Path, size: usize) -> Result<f64, String> {
    let path = dir.join("net.rpinet");
    let text = rpinet::write(&generate::mixed(size, 1));
    std::fs::write(&path, text).map_err(|e| e.to_string())?;
    let program = std::env::current_exe().map_err(|e| e.to_string())?;
    let output = Command::new(program).arg(CHILD).arg(path).output();
    let output = output.map_err(|e| e.to_string())?.stdout;
    let text = String::from_utf8_lossy(&output);
    text.trim().parse().map_err(|_| text.into_owned())
}

/// Loads a net from a text file and prints the maximum resident memory of the process in kB.
pub(crate) fn load_and_print(path: &Path) {
    let text = std::fs::read_to_string(path).unwrap_or_default();
    crate::loading::load(&text);
    println!("{}", resident_memory_kb("VmHWM:"));
}
