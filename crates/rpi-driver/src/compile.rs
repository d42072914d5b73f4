//! The order of the stages: from a file to checked nets, from a net to an image.

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

/// What became of a file.
#[derive(Debug)]
pub struct Compiled {
    /// The texts that findings point into.
    pub sources: SourceMap,
    /// What was found, in the order of the stages.
    pub findings: Vec<Finding>,
    /// What there is to run.
    pub program: Program,
    /// Which command follows which, as the program's tasks say.
    pub tasks: Vec<Task>,
    /// The commands that only run where a task gives them their arguments.
    pub unset: Vec<Unset>,
    /// What the program claims of itself.
    pub tests: Vec<Test>,
    /// What the analyses established about each thing that can be run, if that was asked for.
    pub told: Vec<Told>,
    /// What tests can reach, if that was asked for.
    pub marks: Vec<Marks>,
}

/// A command with a parameter for which nothing is there: neither a constant of its name nor a value in its declaration.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Unset {
    /// Name of the command.
    pub command: String,
    /// Its parameters without a value, as they are declared: `to: Pose`.
    pub params: Vec<String>,
}

/// What is asked for besides the findings.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct Asked {
    /// What becomes of the program's claims in what can be run.
    pub claims: Claims,
    /// Whether the analyses tell what they established.
    pub told: bool,
    /// Whether it is told what can fault while the program runs.
    pub faults: bool,
    /// Whether it is told what tests can reach.
    pub marks: bool,
    /// Whether the text comes from somebody who may not read files of this machine: none but itself is looked for.
    pub alone: bool,
    /// The period of a cycle, nanoseconds, where it is not the one of the machine.
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

/// What there is to run.
#[derive(Debug)]
pub enum Program {
    /// Commands, each a net; only those without errors.
    Nets(Vec<Net>),
    /// A command that was compiled before.
    Image(Box<Image>),
}

/// Takes a file through all stages up to checked nets, without the claims of the program.
///
/// # Errors
/// If the content is not of its kind at all; faults of a program are findings, not errors.
pub fn compile(input: &Input) -> Result<Compiled, InputError> {
    compile_with(input, Claims::Off)
}

/// Takes a file through all stages up to checked nets; gives what is asked for.
///
/// # Errors
/// If the content is not of its kind at all; faults of a program are findings, not errors.
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

/// Compiles an example from a program's documentation ([`examples`](crate::examples)): a program of its own that has the
/// program around it without `use`. Findings stand where the example stands.
///
/// # Errors
/// If the program is no text.
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
        .map_err(|e| InputError::new(&input.path, format!("this is no image: {e}")))?;
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

/// The net as the passes left it, if they found nothing against it.
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
    /// Whether something was found that keeps the program from running.
    #[must_use]
    pub fn has_errors(&self) -> bool {
        self.findings
            .iter()
            .any(|f| f.severity() == Severity::Error)
    }

    /// The commands that can be run.
    #[must_use]
    pub fn nets(&self) -> &[Net] {
        match &self.program {
            Program::Nets(nets) => nets,
            Program::Image(_) => &[],
        }
    }
}

/// Lowers a checked net to run: only what leaves the command can be seen.
///
/// # Errors
/// If something in it depends on itself, or it is too large to run.
pub fn lower_to_run(net: &Net, period_ns: u64) -> Result<Image, String> {
    lower(net, &LowerOptions::running(period_ns))
}

/// As [`lower_to_run`], with a bound on what its primitives do in a cycle, in elementary operations: of fragments that exclude one
/// another only the most expensive counts.
///
/// # Errors
/// As there.
pub fn lower_with_work(net: &Net, period_ns: u64) -> Result<(Image, u64), String> {
    lower_for_tick(net, period_ns, period_ns)
}

/// As [`lower_with_work`] for a core whose tick, in nanoseconds, is shorter than the period.
///
/// # Errors
/// As there.
pub fn lower_for_tick(net: &Net, period_ns: u64, tick_ns: u64) -> Result<(Image, u64), String> {
    lowered(net, &LowerOptions::running(period_ns).with_tick(tick_ns))
}

/// Lowers a checked net to be looked at: every port can be seen.
///
/// # Errors
/// If something in it depends on itself, or it is too large to run.
pub fn lower_to_look(net: &Net, period_ns: u64) -> Result<Image, String> {
    lower(net, &LowerOptions::observed(period_ns))
}

pub(crate) fn lower(net: &Net, options: &LowerOptions<'_>) -> Result<Image, String> {
    lowered(net, options).map(|(image, _)| image)
}

fn lowered(net: &Net, options: &LowerOptions<'_>) -> Result<(Image, u64), String> {
    let analysis = analyse(net.clone(), options.may_be_absent).map_err(|v| v.to_string())?;
    let plan = Plan::of(&analysis).ok_or("something in the net depends on itself")?;
    let image = rpi_lower::lower(&analysis.net, &plan, options)?;
    Ok((image, analysis.work.of(FragmentId::ROOT)))
}
