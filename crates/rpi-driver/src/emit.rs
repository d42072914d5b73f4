//! Intermediate and output forms of a program (`rpic compile --emit`).

use rpi_diag::{Diagnostic, FileId, SourceMap, Span};
use rpi_image::Image;
use rpi_image::image::SourceLocation;
use rpi_lower::LowerOptions;
use rpi_net::lustre::NodeInterface;
use rpi_net::passes::Item;
use rpi_sema::program::Program;
use rpi_syntax::{Dialect, Parens, with_large_stack};
use std::fmt::Write as _;

use crate::analysed_net::AnalysedNet;
use crate::file_loader::DiskLoader;
use crate::input::{Input, InputError};
use crate::lowering::{LowerError, lower};
use crate::modules::Modules;

/// Returns the tokens of a program as text, one per line.
///
/// # Errors
/// If the file is not text.
pub fn tokens(input: &Input) -> Result<String, InputError> {
    Ok(rpi_syntax::dump_tokens(input.text()?, mode(input)))
}

/// Returns the syntax tree of a program as text.
///
/// # Errors
/// If the file is not text.
pub fn ast(input: &Input) -> Result<String, InputError> {
    let mut sources = SourceMap::new();
    let text = input.text()?;
    let file = sources.add(input.path.display().to_string(), text);
    let parse = rpi_syntax::parse(file, text, mode(input));
    Ok(rpi_syntax::dump_ast(&parse.file, Parens::Keep))
}

/// Returns the nodes, commands and other units of a program after type checking as text, including those of the
/// imported modules.
///
/// # Errors
/// If the file is not text.
pub fn typed(input: &Input) -> Result<String, InputError> {
    let mut sources = SourceMap::new();
    let path = input.path.display().to_string();
    let folder = input.path.parent();
    let text = input.text()?;
    let modules = Modules::load(
        &input.stem(),
        &path,
        text,
        folder,
        &DiskLoader,
        &mut sources,
    );
    let texts = modules.sources();
    let (program, _) = Program::collect(&texts);
    Ok(with_large_stack(|| {
        let units = rpi_sema::check(&program).units;
        units
            .iter()
            .map(|unit| rpi_sema::typed::format_unit(unit))
            .collect()
    }))
}

fn mode(input: &Input) -> Dialect {
    Dialect::from_path(&input.path.display().to_string())
}

/// Returns the order of evaluation of a net as text: one line per primitive, indented by fragment.
#[must_use]
pub fn schedule(net: &AnalysedNet) -> String {
    let mut out = String::new();
    for item in net.plan().schedule.items() {
        let depth = |fragment| net.ancestors(fragment).count() - 1;
        // Writing to a string cannot fail.
        let _ = match item {
            Item::Node(id) => {
                let node = net.node(id);
                let indent = "  ".repeat(depth(node.fragment));
                writeln!(out, "{indent}{} = {}", node.name, node.desc().name)
            }
            Item::Fragment(id) => {
                let indent = "  ".repeat(depth(id) - 1);
                writeln!(out, "{indent}fragment {}", net.fragment(id).name)
            }
        };
    }
    out
}

/// Returns the net in the text format `.rpinet` of the Robotics API, and diagnostics for the parts that this format
/// cannot represent.
#[must_use]
pub fn rpinet(net: &AnalysedNet) -> (String, Vec<Diagnostic>) {
    let (net, diagnostics) = rpi_net::rpinet::results_to_ports(net.analysis());
    (rpi_net::rpinet::write(&net), diagnostics)
}

/// Returns the image of a net as text, one line per step. `period_ns` is the period of a cycle in nanoseconds.
///
/// # Errors
/// If the net cannot be lowered.
pub fn image(net: &AnalysedNet, period_ns: u64) -> Result<String, LowerError> {
    let image = lower(net, &LowerOptions::running(period_ns))?;
    let catalogue = |name: &str| rpi_prims::PrimId::from_name(name).map(rpi_prims::PrimId::desc);
    Ok(rpi_image::text::print(&image, &catalogue))
}

/// Choices for the translation of a net to C.
#[derive(Clone, Debug)]
pub struct COptions {
    /// Period of a cycle in nanoseconds.
    pub period_ns: u64,
    /// Name of the header that the source includes; `None` for a single file.
    pub header: Option<String>,
    /// Whether the text contains `#line` directives.
    pub line_directives: bool,
    /// Text for the first comment: the source and the version of the compiler.
    pub origin: String,
}

/// Translates a net to C. `sources` are the texts to which its locations refer.
///
/// # Errors
/// If the net cannot be lowered.
pub fn c(
    net: &AnalysedNet,
    sources: &SourceMap,
    options: &COptions,
) -> Result<rpi_codegen::Emitted, LowerError> {
    let image = lower_for_c(net, options.period_ns)?;
    Ok(with_emission(&image, sources, options, rpi_codegen::emit))
}

/// Translates a net to the files of a Functional Mock-up Unit. `sources` are the texts to which its locations refer.
///
/// # Errors
/// If the net cannot be lowered, or calls functions of devices.
pub fn fmu(
    net: &AnalysedNet,
    sources: &SourceMap,
    options: &COptions,
) -> Result<rpi_codegen::Fmu, Box<dyn std::error::Error>> {
    let image = lower_for_c(net, options.period_ns)?;
    Ok(with_emission(&image, sources, options, rpi_codegen::fmu)?)
}

/// Calls a function of the translation to C with its options for an image.
fn with_emission<T>(
    image: &Image,
    sources: &SourceMap,
    options: &COptions,
    translate: impl Fn(&Image, &rpi_codegen::Options<'_>) -> T,
) -> T {
    let locate = |location: &SourceLocation| place(sources, location);
    let name = rpi_codegen::program_name(&image.name);
    let emission = rpi_codegen::Options {
        name: &name,
        header: options.header.as_deref(),
        locate: &locate,
        line_directives: options.line_directives,
        origin: &options.origin,
    };
    translate(image, &emission)
}

/// Lowers a net to the image from which C is emitted: the image for execution, with the locations of all operations.
///
/// # Errors
/// If the net is too large.
pub fn lower_for_c(net: &AnalysedNet, period_ns: u64) -> Result<Image, LowerError> {
    let options = LowerOptions {
        locates_all: true,
        ..LowerOptions::running(period_ns)
    };
    lower(net, &options)
}

fn place(sources: &SourceMap, location: &SourceLocation) -> Option<rpi_codegen::SourcePlace> {
    let range = location.range?;
    let file = FileId(range.file);
    let at = sources.line_col(Span::new(file, range.start, range.start));
    Some(rpi_codegen::SourcePlace {
        file: sources.name(file).to_owned(),
        line: at.line,
        column: at.col,
    })
}

/// Returns a net as the source of a Lustre node, and diagnostics for the primitives that became inputs of the node.
/// `boundary` describes the inputs and outputs of the node; `period_ns` is the period of a cycle in nanoseconds.
#[must_use]
pub fn lustre(
    net: &AnalysedNet,
    boundary: &NodeInterface<'_>,
    period_ns: u64,
) -> (String, Vec<Diagnostic>) {
    let lustre = rpi_net::lustre::to_lustre(net.analysis(), boundary, period_ns);
    (lustre.text, lustre.diagnostics)
}
