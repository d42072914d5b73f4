//! The order of the stages: from a file to checked nets, from a net to an image.

use std::path::Path;

use rpi_diag::{Finding, Severity, SourceMap};
use rpi_image::Image;
use rpi_lower::{LowerOptions, Plan};
use rpi_net::Net;

use crate::input::{Input, InputError, Kind};
use crate::source;

/// What became of a file.
#[derive(Debug)]
pub struct Compiled {
    /// The texts that findings point into.
    pub sources: SourceMap,
    /// What was found, in the order of the stages.
    pub findings: Vec<Finding>,
    /// What there is to run.
    pub program: Program,
}

/// What there is to run.
#[derive(Debug)]
pub enum Program {
    /// Commands, each a net; only those without errors.
    Nets(Vec<Net>),
    /// A command that was compiled before.
    Image(Box<Image>),
}

/// Takes a file through all stages up to checked nets.
///
/// # Errors
/// If the content is not of its kind at all; faults of a program are findings, not errors.
pub fn compile(input: &Input) -> Result<Compiled, InputError> {
    match input.kind {
        Kind::Rpib => image(input),
        Kind::Rpinet => Ok(net(input, input.text()?)),
        Kind::Rpi | Kind::Lustre => Ok(program(input, input.text()?)),
    }
}

fn program(input: &Input, text: &str) -> Compiled {
    let mut sources = SourceMap::new();
    let built = source::build(
        &input.stem(),
        &display(&input.path),
        text,
        input.path.parent(),
        &mut sources,
    );
    Compiled {
        sources,
        findings: built.findings,
        program: Program::Nets(built.nets),
    }
}

fn image(input: &Input) -> Result<Compiled, InputError> {
    let image = Image::from_bytes(&input.bytes)
        .map_err(|e| InputError::new(&input.path, format!("this is no image: {e}")))?;
    Ok(Compiled {
        sources: SourceMap::new(),
        findings: Vec::new(),
        program: Program::Image(Box::new(image)),
    })
}

fn net(input: &Input, text: &str) -> Compiled {
    let mut sources = SourceMap::new();
    let file = sources.add(display(&input.path), text);
    let (net, findings) = rpi_net::rpinet::read(&input.stem(), file, text);
    Compiled {
        sources,
        findings,
        program: Program::Nets(net.into_iter().collect()),
    }
}

fn display(path: &Path) -> String {
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

/// Lowers a checked net to be looked at: every port can be seen.
///
/// # Errors
/// If something in it depends on itself, or it is too large to run.
pub fn lower_to_look(net: &Net, period_ns: u64) -> Result<Image, String> {
    lower(net, &LowerOptions::observed(period_ns))
}

fn lower(net: &Net, options: &LowerOptions<'_>) -> Result<Image, String> {
    let plan = Plan::new(net, options.may_be_absent);
    let plan = plan.ok_or("something in the net depends on itself")?;
    rpi_lower::lower(net, &plan, options)
}
