//! Order of the compiler stages: from a file to checked nets, and from a net to an image.

use std::ops::Range;
use std::path::Path;

use rpi_diag::{Finding, Severity, SourceMap, Span};
use rpi_image::Image;
use rpi_lower::{LowerOptions, Plan};
use rpi_net::passes::analyse;
use rpi_net::{FragmentId, Net};
use rpi_sema::elab::Claims;
use rpi_syntax::Mode;

use crate::doctext;
use crate::files::Disk;
use crate::input::{Input, InputError, Kind};
use crate::marks::{self, Marks};
use crate::modules::Modules;
use crate::source::{self, Told};
use crate::task::Task;
use crate::tests::Test;
use crate::violation;

/// Result of compiling a file.
#[derive(Debug)]
pub struct Compiled {
    /// Source texts that the diagnostics refer to.
    pub sources: SourceMap,
    /// Diagnostics, in the order of the stages.
    pub findings: Vec<Finding>,
    /// Commands that can be run.
    pub program: Program,
    /// Tasks of the program: which command follows which.
    pub tasks: Vec<Task>,
    /// Commands that can only run with the arguments given by a task.
    pub unset: Vec<Unset>,
    /// Tests of the program.
    pub tests: Vec<Test>,
    /// Summary of the analyses of each command and node, if requested.
    pub told: Vec<Told>,
    /// Coverage points, if requested.
    pub marks: Vec<Marks>,
}

/// Command with a parameter that has no value: there is neither a constant of its name nor a default in its
/// declaration.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Unset {
    /// Name of the command.
    pub command: String,
    /// Parameters without a value, as declared: `to: Pose`.
    pub params: Vec<String>,
}

/// Options of the compiler.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct Asked {
    /// Treatment of assertions and contracts in the compiled nets.
    pub claims: Claims,
    /// Whether to summarise the results of the analyses.
    pub told: bool,
    /// Whether to report operations that can fault at run time.
    pub faults: bool,
    /// Whether to return the coverage points.
    pub marks: bool,
    /// Whether the text comes from a client that may not read files of this machine. Other files are not searched for
    /// then.
    pub alone: bool,
    /// Period of a cycle in ns; default: that of the machine.
    pub period_ns: Option<u64>,
}

impl From<Claims> for Asked {
    fn from(claims: Claims) -> Asked {
        Asked {
            claims,
            told: false,
            faults: false,
            marks: false,
            alone: false,
            period_ns: None,
        }
    }
}

/// Commands that can be run.
#[derive(Debug)]
pub enum Program {
    /// Commands as nets; only those without errors.
    Nets(Vec<Net>),
    /// Command compiled earlier.
    Image(Box<Image>),
}

/// Compiles a file up to checked nets, without assertions and contracts.
///
/// # Errors
/// If the content does not match the kind of the file. Errors in a program are diagnostics instead.
pub fn compile(input: &Input) -> Result<Compiled, InputError> {
    compile_with(input, Claims::Off)
}

/// Compiles a file up to checked nets, with options.
///
/// # Errors
/// If the content does not match the kind of the file. Errors in a program are diagnostics instead.
pub fn compile_with(input: &Input, asked: impl Into<Asked>) -> Result<Compiled, InputError> {
    match input.kind {
        Kind::Rpib => image(input),
        Kind::Rpinet => Ok(net(input, input.text()?)),
        Kind::Rpi | Kind::Lustre => program(input, input.text()?, asked.into()),
    }
}

fn program(input: &Input, text: &str, asked: Asked) -> Result<Compiled, InputError> {
    let mut sources = SourceMap::new();
    let (name, path) = (input.stem(), display(&input.path));
    let mut text = program_text(input, &name, &path, text);
    text.folder = text.folder.filter(|_| !asked.alone);
    let mut modules = text.modules(&mut sources);
    // Falling back to the default machine would check budgets against the wrong speed.
    if let Some(why) = modules.no_machine.take() {
        return Err(why);
    }
    modules.machine.period_ns = asked.period_ns.unwrap_or(modules.machine.period_ns);
    let mode = Mode::of_path(&path);
    let (mut built, _) = source::build_modules(&modules, &sources, asked);
    let links = doctext::broken_links(&sources, mode, &|| modules.index());
    built.findings.extend(links);
    let mut findings = built.findings;
    crate::fixes::of_the_program(&mut findings, &sources);
    crate::fixes::whole_lines(&mut findings, &sources);
    Ok(Compiled {
        sources,
        findings,
        program: Program::Nets(built.nets),
        tests: built.tests,
        told: built.told,
        tasks: built.tasks,
        unset: built.unset,
        marks: match asked.marks {
            true => marks::of_modules(&modules),
            false => Vec::new(),
        },
    })
}

/// Compiles an example in the doc comments of a program ([`examples`](crate::examples)). The example is a separate
/// program that imports the surrounding program implicitly. Diagnostics refer to the location of the example.
///
/// # Errors
/// If the program is not text.
pub fn compile_example(input: &Input, lines: &[Range<usize>]) -> Result<Compiled, InputError> {
    let text = input.text()?;
    let (name, path) = (input.stem(), display(&input.path));
    let example = doctext::example_text(text, lines);
    let around = program_text(input, &name, &path, text);
    let mut sources = SourceMap::new();
    let modules = Modules::load_example(&example, &around, &Disk, &mut sources);
    let (built, _) = source::build_modules(&modules, &sources, Claims::Report.into());
    Ok(Compiled {
        sources,
        findings: built.findings,
        program: Program::Nets(built.nets),
        tests: built.tests,
        told: built.told,
        tasks: built.tasks,
        unset: built.unset,
        marks: Vec::new(),
    })
}

pub(crate) fn program_text<'t>(
    input: &'t Input,
    name: &'t str,
    path: &'t str,
    text: &'t str,
) -> source::Text<'t> {
    source::Text {
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
        findings: Vec::new(),
        program: Program::Image(Box::new(image)),
        tasks: Vec::new(),
        unset: Vec::new(),
        tests: Vec::new(),
        told: Vec::new(),
        marks: Vec::new(),
    })
}

fn net(input: &Input, text: &str) -> Compiled {
    let mut sources = SourceMap::new();
    let file = sources.add(display(&input.path), text);
    let (net, mut findings) = rpi_net::rpinet::read(&input.stem(), file, text);
    let mut told = Vec::new();
    let net = net.and_then(|net| checked(net, &mut findings, &mut told));
    Compiled {
        sources,
        findings,
        program: Program::Nets(net.into_iter().collect()),
        tasks: Vec::new(),
        unset: Vec::new(),
        tests: Vec::new(),
        told,
        marks: Vec::new(),
    }
}

/// Returns the net after the passes, or `None` if they reported errors.
fn checked(net: Net, findings: &mut Vec<Finding>, told: &mut Vec<Told>) -> Option<Net> {
    match rpi_net::passes::analyse(net, |_| false) {
        Ok(analysis) => {
            findings.extend(analysis.findings);
            told.push(Told {
                name: analysis.net.name.clone(),
                lines: analysis.told,
            });
            analysis.schedule.map(|_| analysis.net)
        }
        Err(violation) => {
            findings.push(violation::finding(&violation, Span::NONE));
            None
        }
    }
}

pub(crate) fn display(path: &Path) -> String {
    path.display().to_string()
}

impl Compiled {
    /// Returns whether there is an error, which prevents the program from running.
    #[must_use]
    pub fn has_errors(&self) -> bool {
        self.findings
            .iter()
            .any(|f| f.severity() == Severity::Error)
    }

    /// Returns the commands that can be run.
    #[must_use]
    pub fn nets(&self) -> &[Net] {
        match &self.program {
            Program::Nets(nets) => nets,
            Program::Image(_) => &[],
        }
    }
}

/// Lowers a checked net for execution: only the outputs of the command can be observed.
///
/// # Errors
/// If the net has a dependency cycle or is too large.
pub fn lower_to_run(net: &Net, period_ns: u64) -> Result<Image, String> {
    lower(net, &LowerOptions::running(period_ns))
}

/// Like [`lower_to_run`], and also returns the work bound of a cycle in elementary operations. Of mutually exclusive
/// fragments only the most expensive counts.
///
/// # Errors
/// As [`lower_to_run`].
pub fn lower_with_work(net: &Net, period_ns: u64) -> Result<(Image, u64), String> {
    lower_for_tick(net, period_ns, period_ns)
}

/// Like [`lower_with_work`] for a core whose tick, in ns, is shorter than the period.
///
/// # Errors
/// As [`lower_to_run`].
pub fn lower_for_tick(net: &Net, period_ns: u64, tick_ns: u64) -> Result<(Image, u64), String> {
    lowered(net, &LowerOptions::running(period_ns).with_tick(tick_ns))
}

/// Lowers a checked net for observation: every port can be observed.
///
/// # Errors
/// If the net has a dependency cycle or is too large.
pub fn lower_to_look(net: &Net, period_ns: u64) -> Result<Image, String> {
    lower(net, &LowerOptions::observed(period_ns))
}

pub(crate) fn lower(net: &Net, options: &LowerOptions<'_>) -> Result<Image, String> {
    lowered(net, options).map(|(image, _)| image)
}

fn lowered(net: &Net, options: &LowerOptions<'_>) -> Result<(Image, u64), String> {
    let analysis = analyse(net.clone(), options.may_be_absent).map_err(|v| v.to_string())?;
    let plan = Plan::of(&analysis).ok_or("the net has a dependency cycle")?;
    let image = rpi_lower::lower(&analysis.net, &plan, options)?;
    Ok((image, analysis.work.of(FragmentId::ROOT)))
}
