//! Generated nets in the interpreter, compared with the same nets as C compiled by gcc -O2.

use rpi_bench::flat_c::flat_c_text;
use rpi_bench::gcc_reference::{CompiledNet, InterpretedNet};
use rpi_bench::generate;
use rpi_bench::table::Table;
use rpi_net::Net;
use tempfile::TempDir;

/// Family of generated nets: name, function that generates a net of a given number of primitives, and limit of the time
/// of the interpreter as a multiple of the time of the same net compiled by gcc.
type Kind = (&'static str, fn(usize) -> Net, f64);

const KINDS: [Kind; 3] = [
    ("regular, filter chain", |n| generate::biquad(n / 11), 5.0),
    // Control loops are independent, so gcc vectorises them; therefore they have a limit of their own.
    (
        "equal instances, control loops",
        |n| generate::pid(n / 26),
        1.2,
    ),
    ("irregular", |n| generate::mixed(n, 1), 12.0),
];

const SIZES: [usize; 3] = [1_000, 10_000, 100_000];

/// Maximum number of equations of a net that gcc can compile in one function. Larger nets are compared with the largest
/// net below this size.
const MAX_GCC_EQUATIONS: usize = 50_000;

/// Number of batches of cycles for each net, of which the fastest counts.
const BATCHES: usize = 20;

pub(crate) fn rows(table: &mut Table) {
    for (name, make, bar) in KINDS {
        let mut gcc = None;
        for size in SIZES {
            let row = format!("interpreter, {name}, {size}");
            let largest = SIZES.iter().rfind(|s| **s < MAX_GCC_EQUATIONS) == Some(&size);
            if !(table.is_selected(&row) || largest && gcc_is_needed(table, name)) {
                continue;
            }
            let net = make(size);
            if size < MAX_GCC_EQUATIONS {
                gcc = GccReference::new(&net);
            }
            if table.is_selected(&row) {
                measure(table, &row, bar, &net, gcc.as_mut());
            }
        }
    }
}

/// Returns whether a net too large for gcc is selected, so that a smaller net of the same family must be compiled as
/// its reference.
fn gcc_is_needed(table: &Table, name: &str) -> bool {
    let mut large = SIZES.iter().filter(|s| **s >= MAX_GCC_EQUATIONS);
    large.any(|size| table.is_selected(&format!("interpreter, {name}, {size}")))
}

/// Reference for the interpreter: a net compiled as C by gcc, with its number of primitives.
struct GccReference {
    gcc: CompiledNet,
    size: usize,
    /// Temporary folder that contains the compiled program; deleted on drop.
    _dir: TempDir,
}

impl GccReference {
    fn new(net: &Net) -> Option<GccReference> {
        let dir = tempfile::tempdir().ok()?;
        let gcc = flat_c_text(net).and_then(|text| CompiledNet::new(&text, dir.path()));
        let gcc = gcc.inspect_err(|e| eprintln!("no yardstick: {e}")).ok()?;
        let size = net.nodes.len();
        Some(GccReference {
            gcc,
            size,
            _dir: dir,
        })
    }
}

fn measure(table: &mut Table, row: &str, bar: f64, net: &Net, gcc: Option<&mut GccReference>) {
    let size = net.nodes.len();
    let Some(gcc) = gcc else {
        eprintln!("{row}: skipped, no C compiler");
        return;
    };
    let mut ours = InterpretedNet::new(net).expect("generated nets run");
    let mut best = [f64::MAX; 2];
    for _ in 0..BATCHES {
        let theirs = gcc.gcc.batch(cycles(gcc.size)).expect("it answers");
        best[0] = best[0].min(ours.batch(cycles(size)) / size as f64);
        best[1] = best[1].min(theirs / gcc.size as f64);
    }
    let [ours_ns, gcc_ns] = best;
    let note = match ours.last() == gcc.gcc.last() {
        _ if gcc.size != size => format!("gcc's figure is that of {}", gcc.size),
        true => "same bits as gcc".into(),
        false => "BITS DIFFER FROM GCC".into(),
    };
    let note = format!("{ours_ns:.2} ns, gcc {gcc_ns:.2} ns per primitive; {note}");
    table.add_row(row, ours_ns / gcc_ns, bar, "x", &note);
}

/// Returns the number of cycles of one batch for a net of `size` primitives, so that a batch takes some milliseconds.
fn cycles(size: usize) -> u64 {
    3_000_000 / size as u64 + 5
}
