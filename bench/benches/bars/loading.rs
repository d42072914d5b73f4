//! Time from a net's text to a runnable command.

use crate::MS;
use rpi_bench::clock::timed;
use rpi_bench::table::Table;
use rpi_bench::{FakeDevices, generate};
use rpi_core::Instance;
use rpi_diag::FileId;
use rpi_lower::LowerOptions;
use rpi_net::rpinet;

/// Adds the time from the text of a net to a command that can run to the table, for nets of several sizes.
pub(crate) fn rows(table: &mut Table) {
    for (size, bar) in [(1_000, 2.0), (10_000, 15.0), (100_000, 200.0)] {
        let row = format!("text to runnable, {size}");
        if table.is_selected(&row) {
            let net = generate::mixed(size, 1);
            let text = rpinet::write(&net);
            stages(table, &row, &text, bar);
        }
    }
    let row = "text to runnable, authors' 16-LIN net";
    if table.is_selected(row)
        && let Some(text) =
            crate::read_shared("nets/v1/seq-011-opt-contSequential_16_lin.rpinet.gz")
    {
        stages(table, row, &text, 150.0);
    }
}

fn stages(table: &mut Table, row: &str, text: &str, bar: f64) {
    let mut best = [f64::MAX; 4];
    for _ in 0..5 {
        let times = load(text);
        if times.iter().sum::<f64>() < best.iter().sum() {
            best = times;
        }
    }
    let [read, check, lower, load] = best;
    let note =
        format!("read {read:.1}, check {check:.1}, lower {lower:.1}, verify and load {load:.1} ms");
    table.add_row(row, best.iter().sum(), bar, "ms", &note);
}

/// Returns the times in milliseconds for reading the text of a net, checking the net, lowering it to an image, and
/// verifying and loading the image.
pub(crate) fn load(text: &str) -> [f64; 4] {
    let (net, read) = timed(|| {
        let net = rpinet::parse("net", FileId(0), text).0;
        net.expect("it was written by us")
    });
    let (analysis, check) =
        timed(|| rpi_net::passes::analyse(net, |_| false).expect("a net in order"));
    let (image, lower) = timed(|| {
        let plan = rpi_lower::Plan::from_analysis(&analysis).expect("no rings");
        let options = LowerOptions::running(MS);
        rpi_lower::lower(&analysis.net, &plan, &options).expect("small enough")
    });
    let (machine, load) = timed(|| Instance::load(image, &mut FakeDevices::new()));
    assert!(machine.is_ok());
    [read, check, lower, load].map(|ns| ns / MS as f64)
}
