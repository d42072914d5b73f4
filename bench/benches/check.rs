//! Measures `rpic check` for programs of all shapes and sizes, and whether its time grows linearly.
//!
//! `cargo bench -p rpi-bench --bench check [-- NAME...]` prints one table; each NAME selects the rows that contain it.
//! `.. -- program SHAPE SIZE` prints the program that the row `check, SHAPE` measures. This benchmark is separate from
//! the others because it uses the allocator of `rpic`.

use mimalloc::MiMalloc;
use rpi_bench::clock::{process_ns, timed};
use rpi_bench::program::{INVALID, Shape, VALID};
use rpi_bench::table::Table;
use rpi_testkit::resident_memory_kb;
use std::path::Path;
use std::process::Command;

#[global_allocator]
static ALLOCATOR: MiMalloc = MiMalloc;

/// First argument with which this benchmark starts itself as a process that checks a file and prints the cost.
const CHILD: &str = "check-child";

/// First argument with which this benchmark prints a generated program; the shape and the size of the program follow.
const PRINT: &str = "program";

/// Sizes of the generated programs, in equations. The limits apply to the last size.
const SIZES: [usize; 3] = [1_000, 10_000, 100_000];

/// Limits for checking a program of 100 000 equations: processor time in milliseconds, and resident memory in
/// megabytes.
const LIMITS: (f64, f64) = (1_000.0, 500.0);

/// Limit of the processor time in milliseconds for checking a file of 300 lines with the modules that it uses.
const FILE_LIMIT_MS: f64 = 5.0;

/// Number of times that one process checks the file of 300 lines. The fastest check counts.
const REPETITIONS: usize = 50;

/// Cost of a process that checks a program: processor time in milliseconds, resident memory in megabytes, and the
/// number of reported diagnostics.
#[derive(Clone, Copy)]
struct Cost {
    ms: f64,
    mb: f64,
    diagnostics: u64,
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let done = match words[..] {
        [CHILD, path] => check_and_print(Path::new(path)),
        [PRINT, shape, size] => print(shape, size.parse().unwrap_or(0)),
        _ => {
            let names = words.iter().filter(|word| !word.starts_with('-'));
            measure(names.map(ToString::to_string).collect())
        }
    };
    done.unwrap_or_else(|error| eprintln!("{error}"));
}

/// Measures programs with and without errors in three sizes, then a hand-written file, and prints the table. Only rows
/// whose names contain one of `names` are measured; without names, all rows.
fn measure(names: Vec<String>) -> Result<(), String> {
    let dir = tempfile::tempdir().map_err(|e| e.to_string())?;
    let mut table = Table::new(names);
    for shape in VALID.iter().chain(INVALID) {
        let name = format!("check, {}.{}", shape.name, shape.extension);
        if table.is_selected(&name) {
            measure_shape(&mut table, dir.path(), shape, &name)?;
        }
    }
    let name = "check, file of 300 lines";
    if table.is_selected(name) {
        measure_library(&mut table, dir.path(), name)?;
    }
    table.print();
    Ok(())
}

fn measure_shape(table: &mut Table, dir: &Path, shape: &Shape, name: &str) -> Result<(), String> {
    let mut costs = Vec::with_capacity(SIZES.len());
    for size in SIZES {
        let path = dir.join(format!("p{size}.{}", shape.extension));
        costs.push(best(&path, &shape.text(size))?);
    }
    let [small, middle, large] = costs[..] else {
        return Ok(());
    };
    let note = format!(
        "1 000 {:.1}, 10 000 {:.1} ms; then {:.1} x; {} diagnostics",
        small.ms,
        middle.ms,
        large.ms / middle.ms,
        large.diagnostics
    );
    table.add_row(name, large.ms, LIMITS.0, "ms", &note);
    table.add_row(
        &format!("{name}, memory"),
        large.mb,
        LIMITS.1,
        "MB",
        "resident at most",
    );
    Ok(())
}

/// Measures the check of the largest module of the library as a program of its own, repeatedly in one process, and adds
/// the fastest check to the table. `dir` is a temporary folder.
fn measure_library(table: &mut Table, dir: &Path, name: &str) -> Result<(), String> {
    let text = rpi_bench::program::library_program();
    let path = dir.join("written.rpi");
    std::fs::write(&path, text).map_err(|e| e.to_string())?;
    let input = rpi_driver::read(&path).map_err(|e| e.to_string())?;
    let runs = (0..REPETITIONS).map(|_| timed(|| rpi_driver::compile(&input)).1 / 1e6);
    let warm = runs.fold(f64::INFINITY, f64::min);
    let alone = child(&path)?;
    let note = format!(
        "{} lines and the library's modules; {:.1} ms in a process of its own",
        text.lines().count(),
        alone.ms
    );
    table.add_row(name, warm, FILE_LIMIT_MS, "ms", &note);
    Ok(())
}

/// Returns the cost of the fastest of three processes that check `text`. `path` is the file to which the text is
/// written.
fn best(path: &Path, text: &str) -> Result<Cost, String> {
    std::fs::write(path, text).map_err(|e| e.to_string())?;
    let mut best = child(path)?;
    for _ in 0..2 {
        let next = child(path)?;
        if next.ms < best.ms {
            best = next;
        }
    }
    Ok(best)
}

fn child(path: &Path) -> Result<Cost, String> {
    let program = std::env::current_exe().map_err(|e| e.to_string())?;
    let output = Command::new(program).arg(CHILD).arg(path).output();
    let output = output.map_err(|e| e.to_string())?.stdout;
    let text = String::from_utf8_lossy(&output).into_owned();
    let figures: Vec<f64> = text.split_whitespace().flat_map(str::parse).collect();
    match figures[..] {
        [ms, mb, diagnostics] => Ok(Cost {
            ms,
            mb,
            diagnostics: diagnostics as u64,
        }),
        _ => Err(text),
    }
}

/// Checks a program like `rpic check`, and prints the processor time in milliseconds, the resident memory in megabytes,
/// and the number of diagnostics.
fn check_and_print(path: &Path) -> Result<(), String> {
    let input = rpi_driver::read(path).map_err(|e| e.to_string())?;
    let compiled = rpi_driver::compile(&input).map_err(|e| e.to_string())?;
    let style = rpi_diag::Style::PLAIN;
    let text = rpi_diag::render(&compiled.diagnostics, &compiled.sources, style);
    std::fs::write(path.with_extension("txt"), text).map_err(|e| e.to_string())?;
    let mb = resident_memory_kb("VmHWM:") as f64 / 1024.0;
    println!("{} {mb} {}", process_ns() / 1e6, compiled.diagnostics.len());
    Ok(())
}

/// Prints the generated program of a shape, such as `chain.lus`, with about `size` equations.
fn print(shape: &str, size: usize) -> Result<(), String> {
    let named = |s: &&Shape| format!("{}.{}", s.name, s.extension) == shape;
    match VALID.iter().chain(INVALID).find(named) {
        Some(shape) => print!("{}", shape.text(size)),
        None if shape == "written.rpi" => print!("{}", rpi_bench::program::library_program()),
        None => return Err(format!("there is no shape {shape}")),
    }
    Ok(())
}
