//! `rpi run --inputs`, `rpi run --step`: runs a single node with a table, typed rows or random rows.

use std::error::Error;
use std::fs::File;
use std::io::{BufRead, BufReader, BufWriter, Write, stdin, stdout};
use std::path::Path;

use rpi_c_target::{CCompiler, ExternalBank};
use rpi_diag::{Severity, SourceMap, Style, render};
use rpi_driver::{ClaimPolicy, CompiledNode, Input, InputKind};
use rpi_net::Column;
use rpi_replay::node_runner::{ColumnValues, NodeRun, TableReader, header_line, row_line};

use crate::args::{ContractsMode, NodeArgs, RunArgs};
use crate::c_target::ShadowedNode;
use crate::exit::{CommandResult, Exit};
use crate::output::create;
use crate::random::InputGenerator;
use crate::random_inputs::InputSearch;
use crate::target::PERIOD;

/// Carries out `rpi run` for a single node: compiles it and runs it on a table of inputs, on typed inputs or on random
/// inputs.
pub(crate) fn run(args: &RunArgs) -> CommandResult {
    check_options(args)?;
    let input = rpi_driver::read(&args.program)?;
    let name = args.node.node.as_deref();
    let compiled = rpi_driver::compile_node(&input, name, args.contracts.into(), args.node.locals)?;
    let style = Style::for_stream(&std::io::stderr());
    rpi_diag::print_stderr!(
        "{}",
        render(&compiled.diagnostics, &compiled.sources, style)
    );
    let CompiledNode { sources, node, .. } = compiled;
    let Some(mut node) = node else {
        return Err(format!("{} does not compile", args.program.display()).into());
    };
    if args.node.numbers {
        let outputs = node.outputs.iter_mut().chain(&mut node.locals);
        outputs.for_each(|column| column.enum_values.clear());
    }
    let files = &args.execution.external;
    let unlinked = rpi_driver::unlinked_functions(&node.net);
    if files.is_empty() && !unlinked.is_empty() {
        rpi_diag::print_stderr!("{}", render(&unlinked, &sources, style));
        return Ok(Exit::BadInput);
    }
    let image = rpi_driver::lower_for_execution(&node.net, args.target.period.unwrap_or(PERIOD))?;
    let compiler = CCompiler::new(&args.execution.compiler.cc);
    let bank = ExternalBank::without_devices(&image, files, &compiler)?;
    let failed = bank.error();
    let bank = Box::new(bank);
    let shown: Vec<Column> = node.outputs.into_iter().chain(node.locals).collect();
    let mut session = NodeSession {
        in_c: ShadowedNode::start(&image, &args.execution)?,
        run: NodeRun::load_with(image, bank, &node.inputs, &shown, &node.net.claims)?,
        shown,
        out: output(&args.program, &args.node)?,
        sources,
        style,
        holds_last: input.kind == InputKind::Lustre,
        last: ColumnValues::new(),
    };
    session.header()?;
    let exit = match (&args.node.inputs, args.node.step) {
        (Some(path), _) => session.table(path, &node.inputs, args.target.cycles),
        (None, true) => session.steps(&node.inputs),
        (None, false) => {
            let rows = generate_inputs(args, &input, &node.inputs)?;
            session.rows(&rows)
        }
    };
    session.out.flush()?;
    if let Some(error) = failed.take() {
        return Err(error.into());
    }
    rpi_diag::print_stderr!("{}", session.run.summary());
    if let Some(in_c) = session.in_c.as_mut().filter(|_| exit.is_ok()) {
        rpi_diag::println_stderr!("{}", in_c.summary()?);
    }
    exit
}

/// Returns an error if an option is present that does not apply to the run of a single node.
fn check_options(args: &RunArgs) -> Result<(), String> {
    let target = &args.target;
    let given = [
        ("--cell", target.cell.is_some()),
        ("--command", target.command.is_some()),
        ("--time", target.time.is_some()),
        ("--set", !target.settings.is_empty()),
        ("--real-time", args.clock.real_time),
        ("--planning-time", args.planning_time.is_some()),
        ("--override", args.speed_override < 1.0),
        ("--record", args.record.is_some()),
        ("--digest", args.digest),
        ("--plot", args.plot.is_some()),
        ("--report", args.report.is_some()),
        ("--json", args.json),
    ];
    match given.iter().find(|(_, is_given)| *is_given) {
        Some((option, _)) => Err(format!(
            "{option} applies to commands and tasks only; a node takes --inputs or --step, --outputs, --locals and --cycles"
        )),
        None => Ok(()),
    }
}

fn output(program: &Path, args: &NodeArgs) -> Result<Box<dyn Write>, Box<dyn Error>> {
    let Some(path) = args
        .outputs
        .as_deref()
        .filter(|path| *path != Path::new("-"))
    else {
        return Ok(Box::new(BufWriter::new(stdout())));
    };
    let read = std::iter::once(program).chain(args.inputs.as_deref());
    let file = create(path, &read.collect::<Vec<_>>())?;
    Ok(Box::new(BufWriter::new(file)))
}

/// Run of a single node, with the destination of its outputs.
struct NodeSession {
    run: NodeRun,
    /// The node in C, if it is requested.
    in_c: Option<ShadowedNode>,
    shown: Vec<Column>,
    out: Box<dyn Write>,
    sources: SourceMap,
    style: Style,
    /// True if an absent value of a flow is shown as the latest value of the flow.
    holds_last: bool,
    last: ColumnValues,
}

impl NodeSession {
    fn header(&mut self) -> std::io::Result<()> {
        writeln!(self.out, "{}", header_line(self.shown.iter()))
    }

    /// Runs one cycle with the given inputs (one for each in-port, as memory slots), writes the outputs and prints
    /// diagnostics. Returns false if there was an error.
    fn cycle(&mut self, given: &[Option<Vec<u64>>]) -> Result<bool, Box<dyn Error>> {
        let in_c = &mut self.in_c;
        let mut cycle = self.run.cycle_observed(given, &mut |instance| {
            in_c.iter_mut().for_each(|in_c| in_c.cycle(instance));
        });
        rpi_diag::fill_quotes(&mut cycle.diagnostics, &self.sources);
        if let Some(row) = cycle.row {
            let row = self.hold_absent(row);
            let columns: Vec<&Column> = self.shown.iter().collect();
            writeln!(self.out, "{}", row_line(&columns, &row))?;
        }
        if !cycle.diagnostics.is_empty() {
            rpi_diag::print_stderr!("{}", render(&cycle.diagnostics, &self.sources, self.style));
        }
        if let Some(text) = self.in_c.as_ref().and_then(ShadowedNode::difference) {
            return Err(format!("the program in C differs from the core: {text}").into());
        }
        let mut severities = cycle
            .diagnostics
            .iter()
            .map(|diagnostic| diagnostic.severity());
        Ok(!severities.any(|severity| severity == Severity::Error))
    }

    /// Returns the row of outputs with each absent value replaced by the latest one, as Lustre tools do for a sampled
    /// flow between its ticks. Does nothing unless `holds_last` is true.
    fn hold_absent(&mut self, row: ColumnValues) -> ColumnValues {
        if !self.holds_last {
            return row;
        }
        self.last.resize(row.len(), None);
        for (last, value) in self.last.iter_mut().zip(row) {
            *last = value.or_else(|| last.take());
        }
        self.last.clone()
    }

    fn table(&mut self, path: &Path, columns: &[Column], most: Option<u64>) -> CommandResult {
        let name = path.display();
        let source: Box<dyn BufRead> = match path == Path::new("-") {
            true => Box::new(stdin().lock()),
            false => Box::new(BufReader::new(
                File::open(path).map_err(|e| rpi_driver::read_error(path, &e))?,
            )),
        };
        let mut lines = rpi_files::lines(source, rpi_files::MAX_LINE);
        let first = lines.next().transpose();
        let first = first.map_err(|e| rpi_driver::read_error(path, &e))?;
        let first = first.unwrap_or_default();
        let reader = TableReader::new(columns, &first).map_err(|e| format!("{name}:{e}"))?;
        let mut left = most.unwrap_or(u64::MAX);
        for (number, line) in (2..).zip(lines) {
            if left == 0 {
                break;
            }
            let line = line.map_err(|e| format!("{name}:{number}: {e}"))?;
            if line.trim().is_empty() && !columns.is_empty() && !reader.accepts_empty_lines() {
                continue;
            }
            left -= 1;
            let given = reader.row(number, &line);
            if !self.cycle(&given.map_err(|e| format!("{name}:{e}"))?)? {
                return Ok(Exit::Fault);
            }
        }
        Ok(Exit::Success)
    }

    /// Runs the node with inputs that the user types: reads a line with the inputs of each cycle from standard input
    /// until its end.
    fn steps(&mut self, columns: &[Column]) -> CommandResult {
        let names = header_line(columns.iter());
        let reader = TableReader::new(columns, &names).map_err(|e| e.to_string())?;
        match reader.accepts_empty_lines() {
            true => rpi_diag::println_stderr!("input: {names}; an empty line for an absent value"),
            false => rpi_diag::println_stderr!(
                "inputs, separated by commas: {names}; an empty line repeats the last row"
            ),
        }
        let mut given: Option<ColumnValues> = columns.is_empty().then(Vec::new);
        for (number, line) in (1..).zip(rpi_files::lines(stdin().lock(), rpi_files::MAX_LINE)) {
            let line = line.map_err(|e| format!("line {number} of the input: {e}"))?;
            if !line.trim().is_empty() || reader.accepts_empty_lines() {
                match reader.row(number, &line) {
                    Ok(row) => given = Some(row),
                    Err(error) => {
                        rpi_diag::println_stderr!("{}", error.message);
                        continue;
                    }
                }
            }
            let Some(given) = &given else { continue };
            if !self.cycle(given)? {
                return Ok(Exit::Fault);
            }
            self.out.flush()?;
        }
        Ok(Exit::Success)
    }

    fn rows(&mut self, rows: &[ColumnValues]) -> CommandResult {
        for row in rows {
            if !self.cycle(row)? {
                return Ok(Exit::Fault);
            }
        }
        Ok(Exit::Success)
    }
}

/// Returns the inputs for each cycle of `--cycles`: random ones that satisfy the assumptions of the node, or empty ones
/// for a node without in-ports.
fn generate_inputs(
    args: &RunArgs,
    input: &Input,
    columns: &[Column],
) -> Result<Vec<ColumnValues>, Box<dyn Error>> {
    if let (Some(column), None) = (columns.first(), args.node.random) {
        let key = &column.key;
        return Err(format!(
            "the node has the input `{key}`; add --inputs FILE, --step or --random SEED"
        )
        .into());
    }
    let cycles = args
        .target
        .cycles
        .ok_or("the number of cycles is missing; add --cycles N")?;
    let Some(seed) = args.node.random else {
        return Ok(vec![ColumnValues::new(); usize::try_from(cycles)?]);
    };
    let claims = match args.contracts {
        ContractsMode::Off => ClaimPolicy::Off,
        ContractsMode::Report | ContractsMode::Fault => ClaimPolicy::Report,
    };
    let name = args.node.node.as_deref();
    let compiled = rpi_driver::compile_node(input, name, claims, false)?;
    let node = compiled.node.ok_or("the node does not compile")?;
    let image = rpi_driver::lower_for_execution(&node.net, args.target.period.unwrap_or(PERIOD))?;
    let trial = InputSearch::new(image, columns, &node.net.claims);
    Ok(trial.rows(&mut InputGenerator::new(seed), cycles)?)
}
