//! The bars: what the interpreter, the loader and the memory do, beside the yardsticks, in one run.
//!
//! `cargo bench -p rpi-bench --bench bars [-- NAME...]` prints one table; names choose rows by their first word.

mod table;

use rpi_bench::{Build, Puppet, build, generate, twin, yardstick};
use rpi_core::{Machine, Moment};
use rpi_device::NoDevices;
use rpi_diag::FileId;
use rpi_lower::LowerOptions;
use rpi_net::{FragmentId, Input, Net, Restart, rpinet};
use std::path::Path;
use std::process::Command;
use std::time::Instant;
use table::Table;

const MS: u64 = 1_000_000;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let [mode, path, cycles] = &arguments[..]
        && mode == "cycles-child"
    {
        return run_cycles(Path::new(path), cycles.parse().unwrap_or(0));
    }
    if let [mode, path] = &arguments[..]
        && mode == "load-child"
    {
        return load_and_tell(Path::new(path));
    }
    let only = arguments
        .into_iter()
        .filter(|a| !a.starts_with('-'))
        .collect();
    let mut table = Table::new(only);
    interpreter(&mut table);
    authors(&mut table);
    inactive(&mut table);
    loading(&mut table);
    memory(&mut table);
    table.print();
}

/// Generated nets beside gcc -O2 of the same net as C.
fn interpreter(table: &mut Table) {
    type Make = fn(usize) -> Net;
    let kinds: [(&str, Make, f64); 3] = [
        ("regular, filter chain", |n| generate::biquad(n / 11), 5.0),
        ("regular, control loops", |n| generate::pid(n / 26), 5.0),
        ("irregular", |n| generate::mixed(n, 1), 12.0),
    ];
    for (name, make, bar) in kinds {
        let mut gcc = None;
        for size in [1_000, 10_000, 100_000] {
            let row = format!("interpreter, {name}, {size}");
            if !table.wants(&row) {
                continue;
            }
            let net = make(size);
            let size = net.nodes.len() as f64;
            let cycles = (3e6 / size) as u64 + 5;
            // gcc does not get through a function of 100 000 equations; its figure per equation is that of 10 000.
            if size < 50_000.0 {
                gcc = scratch(|dir| yardstick::gcc(&net, cycles, dir))
                    .map(|run| (run.ns / size, run.y));
            }
            let ours = yardstick::ours(&net, cycles).expect("generated nets run");
            let (yard, note) = match gcc {
                Some((ns, _)) if size > 50_000.0 => (ns, "gcc's figure is that of 10 000"),
                Some((ns, y)) if y == ours.y => (ns, "same bits as gcc"),
                Some((ns, _)) => (ns, "BITS DIFFER FROM GCC"),
                None => (0.3, "no C compiler: recorded 0.3 ns"),
            };
            let ours = ours.ns / size;
            let text = format!("{ours:.2} ns, gcc {yard:.2} ns");
            table.row(&row, ours / yard, bar, "x", &format!("{text}; {note}"));
        }
    }
}

fn scratch<T, E>(with: impl FnOnce(&Path) -> Result<T, E>) -> Option<T> {
    let dir = tempfile::tempdir().ok()?;
    with(dir.path()).ok()
}

/// The authors' nets, per cycle.
fn authors(table: &mut Table) {
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
        if !table.wants(&row) {
            continue;
        }
        let Some(net) = recorded(path) else { continue };
        let us = cycle_us(&net);
        let (all, active) = (net.nodes.len(), active(&net));
        let each = us * 1e3 / active as f64;
        let note = format!("{all} primitives, {active} active, {each:.1} ns each of these");
        table.row(&row, us, bar, "us", &note);
    }
}

fn recorded(path: &str) -> Option<Net> {
    let text = text(path)?;
    rpinet::read("net", FileId(0), &text).0
}

fn text(path: &str) -> Option<String> {
    rpi_testkit::read_maybe_gz(rpi_testkit::shared_path(path)?).ok()
}

/// Microseconds per cycle over the first cycles of the command, again and again from its start: that is when it moves.
fn cycle_us(net: &Net) -> f64 {
    let image = twin::image(net, &LowerOptions::running(25 * MS)).expect("recorded nets are right");
    let mut bank = Puppet::new();
    let mut machine = Machine::load(image, &mut bank).expect("every device is there");
    let mut best = f64::MAX;
    for batch in 0..60 {
        machine.reset();
        let start = Instant::now();
        for _ in 0..MOVING {
            cycle(&mut machine, &mut bank);
        }
        if batch > 2 {
            best = best.min(start.elapsed().as_nanos() as f64 / 1e3 / f64::from(MOVING));
        }
    }
    best
}

/// Cycles that are measured.
const MOVING: u32 = 100;

fn cycle(machine: &mut Machine, bank: &mut Puppet) {
    bank.advance();
    machine.read(bank, &Moment::default());
    machine.evaluate(bank);
    machine.commit();
    machine.hand_over(bank);
}

/// How many of a net's primitives are in active fragments, on average over the measured cycles.
fn active(net: &Net) -> usize {
    let image =
        twin::image(net, &LowerOptions::observed(25 * MS)).expect("recorded nets are right");
    let mut bank = Puppet::new();
    let mut machine = Machine::load(image, &mut bank).expect("every device is there");
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

/// How many fragments sleep.
const MANY: usize = 64;

/// Many fragments that are never active, with so many primitives inside of each; or only what would activate them.
fn sleeping(fragments: bool, size: usize) -> Net {
    let mut b = Build::new("sleeping");
    let root = FragmentId::ROOT;
    let key = ("Key", rpi_image::Value::Str("x".into()));
    let x = b.add_with(root, "Core::DoubleNetcommIn", &[], &[key]);
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
                &[Input::Port(y), build::real(0.9)],
            );
            y = half;
        }
        b.export(&format!("y{k}"), y);
    }
    b.net
}

/// What an inactive fragment costs: time, steps, and instructions where valgrind is there.
fn inactive(table: &mut Table) {
    for size in [1, 100, 10_000] {
        let row = format!("inactive fragment, {size} inside");
        if !table.wants(&row) {
            continue;
        }
        let (with, without) = (sleeping(true, size), sleeping(false, size));
        let time = |net: &Net| yardstick::ours(net, 20_000).map_or(0.0, |r| r.ns);
        let ns = (time(&with) - time(&without)) / MANY as f64;
        let steps = (steps_per_cycle(&with) - steps_per_cycle(&without)) as f64 / MANY as f64;
        let instructions = match (instructions(&with), instructions(&without)) {
            (Some(a), Some(b)) => format!("{:.2} instructions", (a - b) / MANY as f64),
            _ => "no valgrind".into(),
        };
        let note = format!("{instructions} and {steps:.2} steps each");
        table.row(&row, ns, 2.0, "ns", &note);
    }
}

fn steps_per_cycle(net: &Net) -> usize {
    let image = twin::image(net, &LowerOptions::running(MS)).expect("it can be lowered");
    let end = image.steps.len();
    let mut machine = Machine::load(image, &mut NoDevices).expect("there are no devices");
    machine.read(&mut NoDevices, &Moment::default());
    let (mut pc, mut steps) = (0, 0);
    while pc < end {
        pc = machine.step(pc, &mut NoDevices);
        steps += 1;
    }
    steps
}

/// Instructions of such a cycle, as callgrind counts them: two runs of this program that differ in the number of cycles
/// only. Both read the image from a file, so that nothing else differs.
fn instructions(net: &Net) -> Option<f64> {
    let image = twin::image(net, &LowerOptions::running(MS))
        .ok()?
        .to_bytes();
    let count = |cycles: u32| {
        scratch(|dir| {
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
        .arg("cycles-child")
        .arg(path)
        .arg(cycles.to_string())
        .output()
        .ok()?;
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    let line = text.lines().find(|l| l.contains("Collected"))?;
    line.split_whitespace().last()?.parse().ok()
}

fn run_cycles(path: &Path, cycles: usize) {
    let bytes = std::fs::read(path).unwrap_or_default();
    let image = rpi_image::Image::from_bytes(&bytes).expect("it was written by us");
    let mut machine = Machine::load(image, &mut NoDevices).expect("there are no devices");
    for _ in 0..cycles {
        machine.read(&mut NoDevices, &Moment::default());
        machine.evaluate(&mut NoDevices);
        machine.commit();
        machine.hand_over(&mut NoDevices);
    }
}

/// From text to a command that can run.
fn loading(table: &mut Table) {
    for (size, bar) in [(1_000, 2.0), (10_000, 15.0), (100_000, 200.0)] {
        let row = format!("text to runnable, {size}");
        if table.wants(&row) {
            let net = generate::mixed(size, 1);
            let text = rpinet::write(&net);
            stages(table, &row, &text, bar);
        }
    }
    let row = "text to runnable, authors' 16-LIN net";
    if table.wants(row)
        && let Some(text) = text("nets/v1/seq-011-opt-contSequential_16_lin.rpinet.gz")
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
    table.row(row, best.iter().sum(), bar, "ms", &note);
}

/// Milliseconds for reading, checking, lowering and loading.
fn load(text: &str) -> [f64; 4] {
    let ms = |start: Instant| start.elapsed().as_nanos() as f64 / 1e6;
    let start = Instant::now();
    let net = rpinet::read("net", FileId(0), text)
        .0
        .expect("it was written by us");
    let read = ms(start);
    let start = Instant::now();
    let analysis = rpi_net::passes::analyse(net, |_| false).expect("a net in order");
    let check = ms(start);
    let start = Instant::now();
    let plan = rpi_lower::Plan::of(&analysis).expect("no rings");
    let image =
        rpi_lower::lower(&analysis.net, &plan, &LowerOptions::running(MS)).expect("small enough");
    let lower = ms(start);
    let start = Instant::now();
    let machine = Machine::load(image, &mut Puppet::new());
    let load = ms(start);
    assert!(machine.is_ok());
    [read, check, lower, load]
}

/// Bytes per primitive, running and at most while loading.
fn memory(table: &mut Table) {
    let size = 100_000;
    let net = generate::mixed(size, 1);
    if table.wants("memory, running") {
        let image = twin::image(&net, &LowerOptions::running(MS)).expect("it can be lowered");
        let machine = Machine::load(image, &mut NoDevices).expect("there are no devices");
        let bytes = machine.footprint() as f64 / net.nodes.len() as f64;
        table.row(
            "memory, running",
            bytes,
            48.0,
            "B",
            "per primitive, irregular net of 100 000",
        );
    }
    if table.wants("memory, peak while loading") {
        let peak = |size: usize| scratch(|dir| peak(dir, size));
        if let (Some(large), Some(small)) = (peak(size), peak(100)) {
            let bytes = (large - small) * 1024.0 / net.nodes.len() as f64;
            let note = "per primitive: resident memory at its highest, from text to runnable";
            table.row("memory, peak while loading", bytes, 500.0, "B", note);
        }
    }
}

/// Highest resident memory in kB of a process that loads a net of this size from its text and does nothing else.
fn peak(dir: &Path, size: usize) -> Result<f64, String> {
    let path = dir.join("net.rpinet");
    let text = rpinet::write(&generate::mixed(size, 1));
    std::fs::write(&path, text).map_err(|e| e.to_string())?;
    let program = std::env::current_exe().map_err(|e| e.to_string())?;
    let output = Command::new(program).arg("load-child").arg(path).output();
    let output = output.map_err(|e| e.to_string())?.stdout;
    let text = String::from_utf8_lossy(&output);
    text.trim().parse().map_err(|_| text.into_owned())
}

fn load_and_tell(path: &Path) {
    let text = std::fs::read_to_string(path).unwrap_or_default();
    load(&text);
    println!("{}", resident("VmHWM:"));
}

fn resident(what: &str) -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find(|l| l.starts_with(what));
    let number = line.and_then(|l| l.split_whitespace().nth(1));
    number.and_then(|n| n.parse().ok()).unwrap_or(0)
}
