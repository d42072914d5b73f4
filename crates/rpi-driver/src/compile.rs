//! Order of the compiler stages: from a file to checked nets, and from a net to an image.

use std::ops::Range;
use std::path::Path;

use rpi_diag::{Diagnostic, Severity, SourceMap, Span};
use rpi_image::Image;
use rpi_net::Net;
use rpi_sema::elab::ClaimPolicy;
use rpi_syntax::Dialect;

use crate::analysed_net::AnalysedNet;
use crate::analysis_summary::AnalysisSummary;
use crate::cell::ArmAxes;
use crate::coverage_points::{self, CoveragePoints};
use crate::doctext;
use crate::file_loader::DiskLoader;
use crate::input::{Input, InputError, InputKind};
use crate::modules::Modules;
use crate::program::{self, has_errors};
use crate::program_tests::Test;
use crate::roots;
use crate::task::Task;
use crate::violation;
use crate::watch::UnknownFlow;

/// Result of compiling a file: its nets or its image, its tasks and tests, and the diagnostics.
#[derive(Debug)]
pub struct Compiled {
    /// Source texts to which the locations in the diagnostics refer.
    pub sources: SourceMap,
    /// Errors, warnings and notes of all compiler stages, in the order of the stages.
    pub diagnostics: Vec<Diagnostic>,
    /// Commands that can be run, as nets or as an image.
    pub program: Program,
    /// Tasks of the program, each with its plan: which command follows which result.
    pub tasks: Vec<Task>,
    /// Commands with parameters that have no value, which only a task can run, with arguments.
    pub unbound: Vec<UnboundCommand>,
    /// Tests of the program, each with its net.
    pub tests: Vec<Test>,
    /// Summary of the analyses of each command, node and task; empty unless requested.
    pub summaries: Vec<AnalysisSummary>,
    /// Fragments, branches and transitions of the program that a coverage measurement counts; empty unless requested.
    pub coverage_points: Vec<CoveragePoints>,
    /// Names of watched flows that no command has.
    pub unknown_flows: Vec<UnknownFlow>,
}

/// Command with a parameter that has no value: there is neither a constant of its name nor a default in its
/// declaration.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct UnboundCommand {
    /// Name of the command.
    pub command: String,
    /// Parameters without a value, as they are declared, such as `to: Pose`.
    pub params: Vec<String>,
}

/// Options for the compilation of a program: treatment of claims, reports, file access and period.
#[derive(Clone, PartialEq, Eq, Default, Debug)]
pub struct CompileOptions {
    /// Treatment of claims (assertions and contracts) in the compiled nets: left out, exported, or checked with a
    /// fault.
    pub claims: ClaimPolicy,
    /// Whether to return a summary of the analyses of each command, node and task.
    pub summaries: bool,
    /// Whether to return all operations that can fault at run time.
    pub faults: bool,
    /// Whether to return the coverage points: the fragments, branches and transitions that a coverage measurement
    /// counts.
    pub marks: bool,
    /// Whether the text comes from a client that must not read files of this machine. Then included files and modules
    /// are not searched for in folders.
    pub no_files: bool,
    /// Period of a cycle in nanoseconds, for the check of time budgets; `None` for that of the machine description.
    pub period_ns: Option<u64>,
    /// Where the number of axes of an `Arm` without a static argument comes from.
    pub arm_axes: ArmAxes,
    /// Flows that the nets of commands export besides those of the program: names of flows, calls, fragments or commands, with
    /// the path to them (`Move.Approach.way.travelled`). A name that is not one of a flow selects all flows inside.
    pub watch: Vec<String>,
}

impl From<ClaimPolicy> for CompileOptions {
    fn from(claims: ClaimPolicy) -> CompileOptions {
        CompileOptions {
            claims,
            ..CompileOptions::default()
        }
    }
}

/// Commands of a compiled file.
#[derive(Debug)]
pub enum Program {
    /// Commands as nets, compiled from a program or a net; only those without errors.
    Nets(Vec<AnalysedNet>),
    /// A single command that was compiled to an image earlier.
    Image(Box<Image>),
}

/// Compiles a file to nets on which all passes have run. Assertions and contracts are left out of the nets.
///
/// # Errors
/// If the content does not match the kind of the file. Errors in a program are diagnostics instead.
pub fn compile(input: &Input) -> Result<Compiled, InputError> {
    compile_with(input, ClaimPolicy::Off)
}

/// Compiles a file to nets on which all passes have run, with options.
///
/// # Errors
/// If the content does not match the kind of the file. Errors in a program are diagnostics instead.
pub fn compile_with(
    input: &Input,
    options: impl Into<CompileOptions>,
) -> Result<Compiled, InputError> {
    let options = options.into();
    let mut compiled = match input.kind {
        InputKind::Rpib => image(input)?,
        InputKind::Rpinet => net(input, input.text()?),
        InputKind::Rpi | InputKind::Lustre => return program(input, input.text()?, options),
    };
    // Images and nets have no flows with names but those that they export.
    let unknown = options.watch.into_iter();
    compiled.unknown_flows = unknown
        .map(|name| UnknownFlow { name, near: None })
        .collect();
    Ok(compiled)
}

fn program(input: &Input, text: &str, options: CompileOptions) -> Result<Compiled, InputError> {
    let mut sources = SourceMap::new();
    let (name, path) = (input.stem(), display(&input.path));
    let mut text = program_text(input, &name, &path, text);
    text.folder = text.folder.filter(|_| !options.no_files);
    let mut modules = text.modules(&mut sources);
    modules.arm_axes = options.arm_axes.or_from_file(modules.arm_axes);
    // Falling back to the default machine would check budgets against the wrong speed.
    if let Some(why) = modules.machine_error.take() {
        return Err(why);
    }
    modules.machine.period_ns = options.period_ns.unwrap_or(modules.machine.period_ns);
    let mode = Dialect::from_path(&path);
    let (mut built, _) = roots::build_modules(&modules, &sources, &options);
    let links = doctext::broken_links(&sources, mode, || modules.index());
    built.diagnostics.extend(links);
    if let Some((file, entries)) = modules.points.as_ref()
        && !has_errors(&built.diagnostics)
    {
        let unused = crate::points::unused_warnings(&modules.index(), *file, entries);
        built.diagnostics.extend(unused);
    }
    let mut diagnostics = built.diagnostics;
    crate::fixes::remove_library_fixes(&mut diagnostics, &sources);
    crate::fixes::delete_whole_lines(&mut diagnostics, &sources);
    Ok(Compiled {
        sources,
        diagnostics,
        program: Program::Nets(built.nets),
        tests: built.tests,
        summaries: built.summaries,
        tasks: built.tasks,
        unbound: built.unbound,
        unknown_flows: built.unknown_flows,
        coverage_points: match options.marks {
            true => coverage_points::coverage_points(&modules),
            false => Vec::new(),
        },
    })
}

/// Compiles an example in the doc comments of a program. `lines` are the byte ranges of its lines, as
/// [`examples`](crate::examples) returns them. The example is a separate program that imports the surrounding program
/// implicitly. Diagnostics refer to the location of the example.
///
/// # Errors
/// If the program is not text.
pub fn compile_example(input: &Input, lines: &[Range<usize>]) -> Result<Compiled, InputError> {
    let text = input.text()?;
    let (name, path) = (input.stem(), display(&input.path));
    let example = doctext::example_text(text, lines);
    let around = program_text(input, &name, &path, text);
    let mut sources = SourceMap::new();
    let modules = Modules::load_example(&example, &around, &DiskLoader, &mut sources);
    let (built, _) = roots::build_modules(&modules, &sources, &ClaimPolicy::Report.into());
    Ok(Compiled {
        sources,
        diagnostics: built.diagnostics,
        program: Program::Nets(built.nets),
        tests: built.tests,
        summaries: built.summaries,
        tasks: built.tasks,
        unbound: built.unbound,
        unknown_flows: built.unknown_flows,
        coverage_points: Vec::new(),
    })
}

pub(crate) fn program_text<'t>(
    input: &'t Input,
    name: &'t str,
    path: &'t str,
    text: &'t str,
) -> program::SourceText<'t> {
    program::SourceText {
        name,
        path,
        text,
        folder: input.path.parent(),
    }
}

fn image(input: &Input) -> Result<Compiled, InputError> {
    let image = Image::from_bytes(&input.bytes)
        .map_err(|e| InputError::new(&input.path, format!("not a valid image: {e}")))?;
    Ok(Compiled {
        sources: SourceMap::new(),
        diagnostics: Vec::new(),
        program: Program::Image(Box::new(image)),
        tasks: Vec::new(),
        unbound: Vec::new(),
        unknown_flows: Vec::new(),
        tests: Vec::new(),
        summaries: Vec::new(),
        coverage_points: Vec::new(),
    })
}

fn net(input: &Input, text: &str) -> Compiled {
    let mut sources = SourceMap::new();
    let file = sources.add(display(&input.path), text);
    let (net, mut diagnostics) = rpi_net::rpinet::parse(&input.stem(), file, text);
    let mut summaries = Vec::new();
    let net = net.and_then(|net| analyse_net(net, &mut diagnostics, &mut summaries));
    Compiled {
        sources,
        diagnostics,
        program: Program::Nets(net.into_iter().collect()),
        tasks: Vec::new(),
        unbound: Vec::new(),
        unknown_flows: Vec::new(),
        tests: Vec::new(),
        summaries,
        coverage_points: Vec::new(),
    }
}

/// Runs the compiler passes on a net and adds their diagnostics and summary. Returns the analysed net, or `None` if the
/// passes reported errors.
fn analyse_net(
    net: Net,
    diagnostics: &mut Vec<Diagnostic>,
    summaries: &mut Vec<AnalysisSummary>,
) -> Option<AnalysedNet> {
    match rpi_net::passes::analyse(net, |_| false) {
        Ok(mut analysis) => {
            diagnostics.append(&mut analysis.diagnostics);
            summaries.push(AnalysisSummary {
                name: analysis.net.name.clone(),
                lines: std::mem::take(&mut analysis.summary),
            });
            AnalysedNet::from_analysis(analysis)
        }
        Err(violation) => {
            diagnostics.push(violation::diagnostic(&violation, Span::NONE));
            None
        }
    }
}

pub(crate) fn display(path: &Path) -> String {
    path.display().to_string()
}

impl Compiled {
    /// Returns whether the diagnostics contain an error, which prevents the program from running.
    #[must_use]
    pub fn has_errors(&self) -> bool {
        self.diagnostics
            .iter()
            .any(|f| f.severity() == Severity::Error)
    }

    /// Returns the commands as nets; an empty list for an image.
    #[must_use]
    pub fn nets(&self) -> &[AnalysedNet] {
        match &self.program {
            Program::Nets(nets) => nets,
            Program::Image(_) => &[],
        }
    }
}
