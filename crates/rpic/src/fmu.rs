//! `rpic compile --emit fmu`: writes a command or node as a Functional Mock-up Unit.

use rpi_c_target::CCompiler;
use rpi_diag::SourceMap;
use rpi_driver::{AnalysedNet, Input, emit};

use crate::args::CompileArgs;
use crate::compile::{c_options, with_extension};
use crate::outcome::{CommandResult, Exit, write_result};

/// Writes a net as a unit with its C source and its library for this machine.
pub(crate) fn write_fmu(
    net: &AnalysedNet,
    input: &Input,
    sources: &SourceMap,
    args: &CompileArgs,
) -> CommandResult {
    let fmu = emit::fmu(net, sources, &c_options(args, sources))?;
    let compiler = CCompiler::new(&args.compiler.cc);
    let bytes = rpi_c_target::package(&fmu, &compiler)?;
    let path = args.output.clone();
    let path = path.unwrap_or_else(|| with_extension(input, "fmu"));
    write_result(&args.file, Some(&path), &bytes)?;
    rpi_diag::println_stderr!("wrote {}", path.display());
    Ok(Exit::Success)
}
