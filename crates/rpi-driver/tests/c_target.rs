//! Programs in the core and in C, compared bit by bit: all commands of the examples, and all nodes of the tests and of
//! the standard library.
//!
//! Each program is compiled with one of the compilers below in turn. `RPI_C_COMPILERS=all` uses all of them for each.

mod c_programs;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use c_programs::{for_each_command, for_each_node};
use rpi_c_target::{CCompiler, Lockstep};
use rpi_core::CycleContext;
use rpi_driver::emit::lower_for_c;
use rpi_driver::{AnalysedNet, ClaimPolicy, compile, compile_node, read};
use rpi_image::{Scalar, Type};
use rpi_sim::robot::FolderFiles;
use rpi_sim::{Cell, SimBank};
use rpi_testkit::workspace_root;

/// Period of all programs in ns: 1 ms.
const PERIOD_NS: u64 = 1_000_000;
/// Number of cycles of a node.
const NODE_CYCLES: u64 = 60;
/// Number of cycles of a command.
const COMMAND_CYCLES: u64 = 3000;

const COMPILERS: &[&str] = &[
    "gcc -std=c99 -O2",
    "gcc -std=c99 -O0",
    "gcc -std=c99 -O3 -march=native",
    "gcc -std=c99 -O1 -fsanitize=undefined,address -fno-sanitize-recover=all",
    "g++ -std=c++17 -O1",
    "clang -std=c99 -O2 -march=native",
];
const WARNINGS: &str = "-Wall -Wextra -Wconversion -Wshadow -pedantic -Werror";

fn compilers() -> Vec<CCompiler> {
    let all = COMPILERS
        .iter()
        .map(|c| CCompiler::new(&format!("{c} {WARNINGS}")));
    let (installed, missing): (Vec<_>, Vec<_>) = all.partition(CCompiler::is_installed);
    for compiler in missing {
        println!("SKIPPED: not installed: {compiler:?}");
    }
    installed
}

/// Compilers for the programs, in turn.
struct Turns {
    compilers: Vec<CCompiler>,
    next: usize,
}

impl Turns {
    fn new() -> Turns {
        Turns {
            compilers: compilers(),
            next: 0,
        }
    }

    fn compilers(&mut self) -> Vec<CCompiler> {
        if std::env::var("RPI_C_COMPILERS").is_ok_and(|text| text == "all") {
            return self.compilers.clone();
        }
        self.next += 1;
        let turn = self.compilers.get(self.next % self.compilers.len().max(1));
        turn.into_iter().cloned().collect()
    }
}

struct Random(u64);

impl Random {
    fn roll(&mut self) -> u64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        self.0 >> 33
    }

    /// Returns a value of a type, small enough for counters and indices.
    fn value(&mut self, ty: Type) -> Vec<u64> {
        let element = match ty {
            Type::Scalar(s) | Type::Array(s, _) => s,
            Type::Matrix(..) => Scalar::Real,
        };
        let count = ty.slots() / element.slots();
        (0..count).flat_map(|_| self.element(element)).collect()
    }

    fn element(&mut self, scalar: Scalar) -> Vec<u64> {
        match scalar {
            Scalar::Bool => vec![self.roll() & 1],
            Scalar::Int => vec![(self.roll() % 5).wrapping_sub(1)],
            Scalar::Time => vec![self.roll()],
            Scalar::Rotation => [0.0, 0.6, 0.0, 0.8].map(f64::to_bits).to_vec(),
            Scalar::Pose => [1.0, 2.0, 3.0, 0.0, 0.6, 0.0, 0.8]
                .map(f64::to_bits)
                .to_vec(),
            scalar => (0..scalar.slots()).map(|_| self.real().to_bits()).collect(),
        }
    }

    fn real(&mut self) -> f64 {
        (self.roll() % 4001) as f64 / 1000.0 - 2.0
    }
}

/// Runs a net in the core and in C, with random inputs. Returns the number of cycles.
fn compare(
    net: &AnalysedNet,
    cell: &Cell,
    compiler: &CCompiler,
    cycles: u64,
) -> Result<u64, String> {
    let image = Arc::new(lower_for_c(net, PERIOD_NS).map_err(|e| e.to_string())?);
    let mut bank = SimBank::new(cell, PERIOD_NS as f64 * 1e-9);
    let both = Lockstep::start(&image, &mut bank, compiler);
    let mut both = both.map_err(|e| e.to_string())?;
    let mut random = Random(1);
    for cycle in 0..cycles {
        for (k, input) in image.inputs.iter().enumerate() {
            let value = random.value(input.value.ty);
            both.instance().set_input(k, &value, 0);
            if input.value.present > rpi_image::image::TRUE && random.roll().is_multiple_of(3) {
                both.instance().force(input.value, None);
            }
        }
        let context = CycleContext {
            net_ns: (PERIOD_NS * cycle) as i64,
            wall_ns: (PERIOD_NS * cycle) as i64,
            ..CycleContext::default()
        };
        let goes_on = both.cycle(&mut bank, &context).map_err(|e| e.to_string())?;
        if !goes_on {
            return Ok(cycle + 1);
        }
        bank.step();
    }
    Ok(cycles)
}

fn cell_beside(program: &Path) -> Cell {
    let path = program.with_file_name("cell.toml");
    let Ok(text) = std::fs::read_to_string(&path) else {
        return Cell::default();
    };
    Cell::parse_with("cell.toml", &text, &FolderFiles::beside(&path)).expect("the cell is valid")
}

#[test]
fn commands_of_the_examples_give_the_same_bits() {
    let (mut turns, mut count, mut wrong) = (Turns::new(), 0, Vec::new());
    for_each_command(&mut |path, net| {
        let cell = cell_beside(path);
        for compiler in turns.compilers() {
            count += 1;
            if let Err(error) = compare(net, &cell, &compiler, COMMAND_CYCLES) {
                let (path, name) = (path.display(), &net.name);
                wrong.push(format!("{path}: {name} {compiler:?}\n{error}"));
            }
        }
    });
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(
        count >= 14 || turns.compilers.is_empty(),
        "{count} commands"
    );
}

/// Compares all nodes of the programs in a folder. Returns the number of nodes.
fn compare_nodes(folder: &str, ending: &str) -> usize {
    let (mut turns, mut count, mut wrong) = (Turns::new(), 0, Vec::new());
    for_each_node(folder, ending, &mut |path, net| {
        for compiler in turns.compilers() {
            count += 1;
            if let Err(error) = compare(net, &Cell::default(), &compiler, NODE_CYCLES) {
                let (path, name) = (path.display(), &net.name);
                wrong.push(format!("{path}: {name} {compiler:?}\n{error}"));
            }
        }
    });
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    count
}

#[test]
fn nodes_of_lustre_programs_give_the_same_bits() {
    assert!(compare_nodes("tests/lustre", ".lus") > 20);
}

#[test]
fn nodes_of_programs_give_the_same_bits() {
    assert!(compare_nodes("tests/nodes", ".rpi") > 1);
}

#[test]
fn nodes_of_the_tests_of_the_language_give_the_same_bits() {
    assert!(compare_nodes("tests/meaning", ".rpi") > 20);
}

#[test]
fn nodes_of_the_standard_library_give_the_same_bits() {
    assert!(compare_nodes("stdlib", ".rpi") > 10);
}

/// Returns the stack of a cycle in bytes as GCC reports it: that of the step, of its largest part and of the largest chain
/// of three functions of primitives.
fn stack_usage(text: &str, options: &str) -> usize {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    std::fs::write(folder.path().join("program.c"), text).expect("it can be written");
    let mut command = std::process::Command::new("gcc");
    command.args(["-std=c99", "-c", "-fstack-usage", options, "program.c"]);
    let status = command.current_dir(folder.path()).status();
    assert!(status.expect("gcc starts").success());
    let report = std::fs::read_to_string(folder.path().join("program.su")).expect("a report");
    let (mut own, mut parts, mut others) = (0, 0, Vec::new());
    for line in report.lines() {
        let mut columns = line.split('\t');
        let name = columns.next().and_then(|place| place.rsplit(':').next());
        let (name, size) = (name.unwrap_or(""), columns.next().unwrap_or("0"));
        let size: usize = size.parse().expect("a number");
        match name {
            name if name.starts_with("rpi_") => others.push(size),
            name if name.contains("_part_") => parts = parts.max(size),
            name if name.ends_with("_step") => own = size,
            _ => {}
        }
    }
    others.sort_unstable();
    own + parts + others.iter().rev().take(3).sum::<usize>()
}

#[test]
fn the_stack_bound_holds() {
    if !has_gcc() {
        return;
    }
    let mut wrong = Vec::new();
    for_each_command(&mut |path, net| {
        let options = rpi_driver::emit::COptions {
            period_ns: PERIOD_NS,
            header: None,
            line_directives: false,
            origin: String::new(),
        };
        let sources = rpi_diag::SourceMap::new();
        let text = rpi_driver::emit::c(net, &sources, &options).expect("it lowers");
        let (_, bound) = text.source.split_once("Needs at most ").expect("a bound");
        let bound: usize = bound
            .split(' ')
            .next()
            .unwrap_or("")
            .parse()
            .expect("a bound");
        for level in ["-O0", "-O2"] {
            let usage = stack_usage(&text.source, level);
            if usage > bound {
                wrong.push(format!("{} {level}: {usage} > {bound}", path.display()));
            }
        }
    });
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// A text that does not depend on the program, so that a change of the folder of the repository cannot matter.
#[test]
fn the_text_is_the_same_each_time() {
    let path: PathBuf = workspace_root().join("examples/motor/motor.rpi");
    let compiled = compile(&read(&path).expect("it can be read")).expect("it compiles");
    let text = || -> Vec<String> {
        let options = rpi_driver::emit::COptions {
            period_ns: PERIOD_NS,
            header: None,
            line_directives: true,
            origin: String::new(),
        };
        let emitted = compiled.nets().iter();
        let emitted = emitted.map(|net| rpi_driver::emit::c(net, &compiled.sources, &options));
        emitted
            .map(|emitted| emitted.expect("it lowers").source)
            .collect()
    };
    assert_eq!(text(), text());
}

/// Program with an operation that compilers like to contract, and a counter that overflows in line 4.
const PROGRAM: &str = "node Filter (x: real; n: int) returns (y: real; m: int);
let
  y = (0.0 -> pre y) * 0.9 + x;
  m = n * n;
tel
";

fn program() -> rpi_driver::CompiledNode {
    compile_text("filter.rpi", PROGRAM, "Filter")
}

fn compile_text(path: &str, text: &str, node: &str) -> rpi_driver::CompiledNode {
    let input = rpi_driver::Input {
        path: path.into(),
        kind: rpi_driver::InputKind::Rpi,
        bytes: text.as_bytes().to_vec(),
    };
    compile_node(&input, Some(node), ClaimPolicy::Off, false).expect("it compiles")
}

fn emitted() -> rpi_codegen::Emitted {
    emit(&program())
}

fn emit(compiled: &rpi_driver::CompiledNode) -> rpi_codegen::Emitted {
    let options = rpi_driver::emit::COptions {
        period_ns: PERIOD_NS,
        header: None,
        line_directives: false,
        origin: String::new(),
    };
    let node = compiled.node.as_ref().expect("it has no errors");
    rpi_driver::emit::c(&node.net, &compiled.sources, &options).expect("it lowers")
}

/// Runs requests to the program of a text. Returns the output, or the messages of the compiler.
fn run(text: &str, options: &str, requests: &str) -> Result<String, String> {
    use std::io::Write;
    let compiled = program();
    let node = compiled.node.expect("it has no errors");
    let image = lower_for_c(&node.net, PERIOD_NS).expect("it lowers");
    let text = text.to_owned() + &rpi_codegen::driver(&image, "Filter", &emitted().interface);
    let compiler = CCompiler::new(&format!("gcc -std=c99 {options}"));
    let binary = compiler.compile(&text).map_err(|e| e.to_string())?;
    let mut command = std::process::Command::new(binary.path());
    let piped = std::process::Stdio::piped;
    let child = command.stdin(piped()).stdout(piped()).spawn();
    let mut child = child.expect("it starts");
    let mut pipe = child.stdin.take().expect("it has a pipe");
    pipe.write_all(requests.as_bytes()).expect("it reads");
    drop(pipe);
    let output = child.wait_with_output().expect("it ends");
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

fn has_gcc() -> bool {
    let found = CCompiler::new("gcc").is_installed();
    if !found {
        println!("SKIPPED: gcc is not installed");
    }
    found
}

#[test]
fn the_text_does_not_compile_with_fast_mathematics() {
    if has_gcc() {
        let error = run(&emitted().source, "-O2 -ffast-math", "t\n");
        assert!(error.is_err_and(|e| e.contains("IEEE 754")));
    }
}

#[test]
fn the_self_test_detects_contraction() {
    if !has_gcc() {
        return;
    }
    let text = emitted().source;
    let cpu = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    if !cpu.split_whitespace().any(|flag| flag == "fma") {
        return println!("SKIPPED: the processor has no fused multiplication and addition");
    }
    let options = "-O2 -mfma -ffp-contract=fast";
    assert_eq!(run(&text, options, "t\n"), Ok("1\n".to_owned()));
    let pragma = "#pragma GCC optimize(\"fp-contract=off\")";
    assert!(text.contains(pragma));
    let without = text.replace(pragma, "");
    assert_eq!(run(&without, options, "t\n"), Ok("0\n".to_owned()));
}

#[test]
fn a_fault_has_a_code_and_the_line_of_the_program() {
    if has_gcc() {
        let emitted = emitted();
        let request = |n: &str| {
            let fields = emitted.interface.of(rpi_codegen::Direction::Input);
            let words = fields.map(|f| if f.name == "n" { n } else { "0" });
            format!("s {}\n", words.collect::<Vec<_>>().join(" "))
        };
        let requests = request("2") + &request("7fffffffffffffff");
        let output = run(&emitted.source, "-O2", &requests).expect("it compiles");
        let lines: Vec<&str> = output.lines().collect();
        assert!(
            lines.len() == 2 && lines[0].starts_with("0 0 "),
            "{lines:?}"
        );
        assert!(lines[1].starts_with("1 4 "), "{lines:?}");
    }
}

/// Constants, delays and conversions between units have no influence: inputs and outputs are in units of the SI.
#[test]
fn the_text_has_the_units_of_inputs_and_outputs() {
    let text = "type Load = struct { mass: real[kg]; count: int };\n\
                node Total (way: real[mm]; wait: time; load: Load; n: int) returns (force: real[N]; ratio: real; late: time)\n\
                let force = load.mass * way / 1[s] / 1[s]; ratio = way / 1[m]; late = wait; tel\n";
    let emitted = emit(&compile_text("total.rpi", text, "Total"));
    for field in [
        "input `way`: real[m] */",
        "input `wait`: real[s] */",
        "input `load.mass`: real[kg] */",
        "input `load.count`: int */",
        "input `n`: int */",
        "flow `force`: real[N] */",
        "flow `ratio`: real */",
        "flow `late`: real[s] */",
    ] {
        assert!(
            emitted.source.contains(field),
            "{field}\n{}",
            emitted.source
        );
    }
}

#[test]
fn the_header_and_the_source_are_two_files_on_request() {
    let compiled = program();
    let options = rpi_driver::emit::COptions {
        period_ns: PERIOD_NS,
        header: Some("filter.h".to_owned()),
        line_directives: true,
        origin: "Compiled by a test.".to_owned(),
    };
    let node = compiled.node.expect("it has no errors");
    let emitted = rpi_driver::emit::c(&node.net, &compiled.sources, &options).expect("it lowers");
    assert!(emitted.header.contains("int32_t Filter_step("));
    assert!(emitted.source.contains("#include \"filter.h\""));
    assert!(emitted.source.contains("#line 4 \"filter.rpi\""));
    assert!(!emitted.source.contains("typedef struct Filter_in"));
}
