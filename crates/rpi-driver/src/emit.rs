//! Intermediate and output forms of a program (`rpic compile --emit`).

use rpi_diag::{Diagnostic, SourceMap};
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
        units.iter().map(rpi_sema::typed::format_unit).collect()
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

/// Returns the net as C99 source. `period_ns` is the period of a cycle in nanoseconds.
///
/// # Errors
/// One diagnostic per type of primitive that is not supported in C.
pub fn c(net: &AnalysedNet, period_ns: u64) -> Result<String, Vec<Diagnostic>> {
    rpi_lower::emit_c(net, &net.plan(), &LowerOptions::running(period_ns))
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
