//! Emitted C compared with flat C of the same nets, both compiled by gcc -O2.

use crate::inactive::{MANY, inactive_net};
use crate::with_temp_dir;
use rpi_bench::flat_c::flat_c_text;
use rpi_bench::gcc_reference::{CompiledNet, emitted_c_text};
use rpi_bench::table::Table;
use rpi_bench::{BenchError, generate};
use rpi_net::Net;

/// Family of nets: name, and function that generates a net of a number of primitives.
type Kind = (&'static str, fn(usize) -> Net);

const KINDS: [Kind; 3] = [
    ("filter chain", |n| generate::biquad(n / 11)),
    ("control loops", |n| generate::pid(n / 26)),
    ("irregular", |n| generate::mixed(n, 1)),
];

const SIZES: [usize; 3] = [100, 1_000, 10_000];

/// Limit of the time of emitted C as a multiple of the time of flat C.
const BAR: f64 = 1.1;

/// Number of batches of cycles, of which the fastest counts.
const BATCHES: usize = 40;

pub(crate) fn rows(table: &mut Table) {
    for (name, make) in KINDS {
        for size in SIZES {
            let row = format!("emitted C, {name}, {size}");
            if table.is_selected(&row) && measure(table, &row, &make(size)).is_none() {
                eprintln!("{row}: skipped, no C compiler");
            }
        }
    }
    // gcc takes minutes for the text of larger fragments.
    for size in [1, 100, 1_000] {
        let row = format!("emitted C, inactive fragment, {size} inside");
        if table.is_selected(&row) && measure_inactive(table, &row, size).is_none() {
            eprintln!("{row}: skipped, no C compiler");
        }
    }
}

/// Adds the time of an inactive fragment in emitted C, from that of nets with and without such fragments.
fn measure_inactive(table: &mut Table, row: &str, size: usize) -> Option<()> {
    let texts = [true, false].map(|fragments| emitted_c_text(&inactive_net(fragments, size)));
    let texts = texts.map(|text| text.expect("the nets of the benchmark have C"));
    let best = best_times(&texts, 100_000)?.best;
    let ns = (best[0] - best[1]) / MANY as f64;
    table.add_row(row, ns, 2.0, "ns", "per fragment and cycle");
    Some(())
}

fn measure(table: &mut Table, row: &str, net: &Net) -> Option<()> {
    let size = net.nodes.len();
    let cycles = 10_000_000 / size as u64 + 5;
    let texts = [emitted_c_text(net), flat_c_text(net)];
    let texts = texts.map(|text| text.expect("the nets of the benchmark have C"));
    let Measured { best, last } = best_times(&texts, cycles)?;
    let bits = match last[0] == last[1] {
        true => "same bits",
        false => "OTHER BITS",
    };
    let [emitted, flat] = best.map(|ns| ns / size as f64);
    let note = format!("{emitted:.2} ns, flat {flat:.2} ns per primitive; {bits}");
    table.add_row(row, emitted / flat, BAR, "x", &note);
    Some(())
}

/// Times of two programs: the shortest time of a cycle of each in ns, and the number of cycles and the bits of its export.
struct Measured {
    best: [f64; 2],
    last: [(u64, u64); 2],
}

/// Compiles two programs and runs batches of cycles in turn. Returns `None` without a C compiler.
fn best_times(texts: &[String; 2], cycles: u64) -> Option<Measured> {
    with_temp_dir(|dir| {
        let compile = |name: &str, text: &str| {
            let dir = dir.join(name);
            std::fs::create_dir(&dir).map_err(BenchError::from_cause)?;
            CompiledNet::new(text, &dir)
        };
        let mut programs = [compile("one", &texts[0])?, compile("other", &texts[1])?];
        let mut best = [f64::MAX; 2];
        for _ in 0..BATCHES {
            for (best, program) in best.iter_mut().zip(&mut programs) {
                *best = best.min(program.batch(cycles)?);
            }
        }
        let last = programs.map(|program| program.last());
        Ok::<_, BenchError>(Measured { best, last })
    })
}
