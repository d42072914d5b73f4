//! Time per cycle of nets recorded from the reference system.

use crate::MS;
use rpi_bench::clock::timed;
use rpi_bench::table::Table;
use rpi_bench::{FakeDevices, image_compare};
use rpi_core::{CycleContext, Instance};
use rpi_diag::FileId;
use rpi_lower::LowerOptions;
use rpi_net::{Net, rpinet};

/// Adds the time per cycle of nets from the reference system to the table.
pub(crate) fn rows(table: &mut Table) {
    let nets = [
        ("authors' LIN net", "nets/traces/lin-3.rpinet.gz", 2.0),
        (
            "authors' 16-LIN net",
            "nets/v1/seq-011-opt-contSequential_16_lin.rpinet.gz",
            10.0,
        ),
    ];
    for (name, path, bar) in nets {
        let row = format!("{name}, cycle");
        if !table.is_selected(&row) {
            continue;
        }
        let Some(net) = recorded(path) else { continue };
        let us = cycle_us(&net);
        let (all, active) = (net.nodes.len(), active(&net));
        let each = us * 1e3 / active as f64;
        let note = format!("{all} primitives, {active} active, {each:.1} ns each of these");
        table.add_row(&row, us, bar, "us", &note);
    }
}

fn recorded(path: &str) -> Option<Net> {
    let text = crate::read_shared(path)?;
    rpinet::parse("net", FileId(0), &text).0
}

/// Returns the time of a cycle of a net in microseconds. The measured cycles are the first ones of the command, in
/// which the robot moves; the command is restarted repeatedly, and the fastest pass counts.
fn cycle_us(net: &Net) -> f64 {
    let image = image_compare::lower_net(net, &LowerOptions::running(25 * MS))
        .expect("recorded nets are right");
    let mut bank = FakeDevices::new();
    let mut machine = Instance::load(image, &mut bank).expect("every device is there");
    let mut best = f64::MAX;
    for batch in 0..60 {
        machine.reset();
        let ((), ns) = timed(|| (0..MOVING).for_each(|_| cycle(&mut machine, &mut bank)));
        if batch > 2 {
            best = best.min(ns / 1e3 / f64::from(MOVING));
        }
    }
    best
}

/// Number of cycles that are measured after each start of the command.
const MOVING: u32 = 100;

fn cycle(machine: &mut Instance, bank: &mut FakeDevices) {
    bank.advance();
    machine.read(bank, &CycleContext::default());
    machine.evaluate(bank);
    machine.commit();
    machine.hand_over(bank);
}

/// Returns the average number of primitives of a net that are in active fragments, over the measured cycles.
fn active(net: &Net) -> usize {
    let image = image_compare::lower_net(net, &LowerOptions::observed(25 * MS))
        .expect("recorded nets are right");
    let mut bank = FakeDevices::new();
    let mut machine = Instance::load(image, &mut bank).expect("every device is there");
    let mut sum = 0;
    for _ in 0..MOVING {
        cycle(&mut machine, &mut bank);
        sum += net
            .nodes
            .iter()
            .filter(|n| machine.is_active(n.fragment.0))
            .count();
    }
    sum / MOVING as usize
}
