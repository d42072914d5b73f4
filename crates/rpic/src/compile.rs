//! `rpic compile`, `import` and `graph`: conversion of a program to other forms.

use std::path::{Path, PathBuf};

use rpi_diag::{Format, SourceMap};
use rpi_driver::{AnalysedNet, ClaimPolicy, Compiled, Input, InputKind, emit, graph as draw};
use rpi_image::hash::Fnv1a;
use rpi_net::lustre::NodeInterface;
use rpi_syntax::Dialect;

use crate::args::{CompileArgs, Drawing, Form, GraphArgs, ImportArgs};
use crate::check::{has_errors, print_diagnostics};
use crate::fmu;
use crate::outcome::{CommandResult, Exit, write_result};

/// Carries out `rpic compile`: compiles a program and writes an image, or prints an intermediate form.
pub(crate) fn compile(args: &CompileArgs) -> CommandResult {
    let input = rpi_driver::read(&args.file)?;
    let text = match args.emit {
        Some(Form::Tokens) => Some(emit::tokens(&input)?),
        Some(Form::Ast) => Some(emit::ast(&input)?),
        Some(Form::Typed) => Some(emit::typed(&input)?),
        _ => None,
    };
    if let Some(text) = text {
        write_result(&args.file, args.output.as_deref(), text.as_bytes())?;
        return Ok(Exit::Success);
    }
    let is_lustre = Dialect::from_path(&input.path.display().to_string()) == Dialect::Lustre;
    if is_node_form(args.emit) && (is_lustre || args.node.is_some()) {
        return write_node(&input, args);
    }
    let compiled = rpi_driver::compile_with(&input, rpi_driver::ClaimPolicy::from(args.contracts))?;
    print_diagnostics(Format::Human, &compiled.diagnostics, &compiled.sources)?;
    if compiled.has_errors() {
        return Ok(Exit::ErrorsReported);
    }
    if is_node_form(args.emit) && args.command.is_none() && compiled.nets().is_empty() {
        return write_node(&input, args);
    }
    let net = select_net(&compiled, args.command.as_deref())?;
    match args.emit {
        Some(Form::Fmu) => fmu::write_fmu(net, &input, &compiled.sources, args),
        Some(form) => show_form(form, net, &compiled, args),
        None => write_image(net, &input, args),
    }
}

/// Returns whether a form can be written for a single node.
fn is_node_form(form: Option<Form>) -> bool {
    matches!(form, Some(Form::Lustre | Form::C | Form::Fmu))
}

/// Carries out `rpic compile --emit` for a node. The Lustre text contains its assertions and contracts.
fn write_node(input: &Input, args: &CompileArgs) -> CommandResult {
    let claims = match args.emit {
        Some(Form::C | Form::Fmu) => ClaimPolicy::from(args.contracts),
        _ => ClaimPolicy::Fault,
    };
    let compiled = rpi_driver::compile_node(input, args.node.as_deref(), claims, false)?;
    print_diagnostics(Format::Human, &compiled.diagnostics, &compiled.sources)?;
    let Some(node) = compiled.node else {
        return Ok(Exit::ErrorsReported);
    };
    match args.emit {
        Some(Form::C) => return write_c(&node.net, &compiled.sources, args),
        Some(Form::Fmu) => return fmu::write_fmu(&node.net, input, &compiled.sources, args),
        _ => {}
    }
    let boundary = NodeInterface {
        inputs: &node.inputs,
        outputs: &node.outputs,
    };
    let (text, diagnostics) = emit::lustre(&node.net, &boundary, args.period);
    print_diagnostics(Format::Human, &diagnostics, &compiled.sources)?;
    write_result(&args.file, args.output.as_deref(), text.as_bytes())?;
    Ok(Exit::Success)
}

fn show_form(
    form: Form,
    net: &AnalysedNet,
    compiled: &Compiled,
    args: &CompileArgs,
) -> CommandResult {
    let text = match form {
        Form::Net => rpi_net::rpinet::write(net),
        Form::Rpinet => {
            let (text, diagnostics) = emit::rpinet(net);
            print_diagnostics(Format::Human, &diagnostics, &compiled.sources)?;
            text
        }
        Form::Schedule => emit::schedule(net),
        Form::Image => emit::image(net, args.period)?,
        Form::Dot => draw::dot(net),
        Form::Mermaid => draw::mermaid(net),
        Form::C => return write_c(net, &compiled.sources, args),
        Form::Lustre => {
            let (text, diagnostics) = emit::lustre(net, &NodeInterface::default(), args.period);
            print_diagnostics(Format::Human, &diagnostics, &compiled.sources)?;
            text
        }
        // These forms were already written.
        Form::Tokens | Form::Ast | Form::Typed | Form::Fmu => String::new(),
    };
    write_result(&args.file, args.output.as_deref(), text.as_bytes())?;
    Ok(Exit::Success)
}

/// Writes a net as C: a source file, and a header beside it unless a single file is requested.
fn write_c(net: &AnalysedNet, sources: &SourceMap, args: &CompileArgs) -> CommandResult {
    // An output that is itself called a header has all declarations.
    let is_header = |path: &PathBuf| path.extension().is_some_and(|ending| ending == "h");
    let header = args.output.as_ref();
    let header = header.filter(|path| !args.single_file && !is_header(path));
    let header = header.map(|path| path.with_extension("h"));
    let include = header.as_deref().and_then(Path::file_name);
    let options = emit::COptions {
        header: include.map(|name| name.to_string_lossy().into_owned()),
        ..c_options(args, sources)
    };
    let emitted = emit::c(net, sources, &options)?;
    if let Some(path) = header {
        write_result(&args.file, Some(&path), emitted.header.as_bytes())?;
    }
    write_result(
        &args.file,
        args.output.as_deref(),
        emitted.source.as_bytes(),
    )?;
    Ok(Exit::Success)
}

/// Returns the options of the translation to C for a single file. `sources` are the texts of the program.
pub(crate) fn c_options(args: &CompileArgs, sources: &SourceMap) -> emit::COptions {
    let source = args.file.file_name().unwrap_or_default();
    let texts = sources.files().map(|file| sources.text(file));
    let hash = texts.fold(Fnv1a::new(), |hash, text| hash.with_bytes(text.as_bytes()));
    emit::COptions {
        period_ns: args.period,
        header: None,
        line_directives: args.line_directives,
        origin: format!(
            "Compiled from {} (hash of all texts: {:016x}) by rpic {}.",
            source.to_string_lossy(),
            hash.finish(),
            env!("CARGO_PKG_VERSION")
        ),
    }
}

fn write_image(net: &AnalysedNet, input: &Input, args: &CompileArgs) -> CommandResult {
    let image = rpi_driver::lower_for_execution(net, args.period)?;
    let path = args
        .output
        .clone()
        .unwrap_or_else(|| with_extension(input, "rpib"));
    write_result(&args.file, Some(&path), &image.to_bytes())?;
    rpi_diag::println_stderr!("wrote {}", path.display());
    Ok(Exit::Success)
}

/// Returns the path of a source file with the extension `ending` in place of its own.
pub(crate) fn with_extension(input: &Input, ending: &str) -> PathBuf {
    let folder = input.path.parent().unwrap_or(Path::new(""));
    folder.join(format!("{}.{ending}", input.stem()))
}

/// Returns the net of the command called `name`, or of the only command if `name` is `None`.
///
/// # Errors
/// Returns a message if there is no such command, or if there are several and none is named.
fn select_net<'a>(compiled: &'a Compiled, name: Option<&str>) -> Result<&'a AnalysedNet, String> {
    let nets = compiled.nets();
    let names = || nets.iter().map(|net| net.name.as_str()).collect::<Vec<_>>();
    match (name, nets) {
        (Some(name), _) => nets.iter().find(|net| net.name == name).ok_or_else(|| {
            let near = rpi_diag::suggest(name, names().into_iter());
            let near = near.map_or(String::new(), |near| format!("; did you mean `{near}`?"));
            format!("no command `{name}` without parameters{near}")
        }),
        (None, [net]) => Ok(net),
        (None, []) => Err(
            "no command without parameters; `rpi run FILE --node NAME` runs a node, `--emit c --node NAME` writes it as C, `--emit lustre --node NAME` as Lustre"
                .to_owned(),
        ),
        (None, _) => Err(format!(
            "several commands: choose one with --command ({})",
            names().join(", ")
        )),
    }
}

/// Carries out `rpic import`: converts a net of the reference system (.rpinet) to a program.
pub(crate) fn import(args: &ImportArgs) -> CommandResult {
    let input = rpi_driver::read(&args.file)?;
    if input.kind != InputKind::Rpinet {
        return Err(format!(
            "{}: only nets (.rpinet) can be imported",
            args.file.display()
        )
        .into());
    }
    let compiled = rpi_driver::compile(&input)?;
    print_diagnostics(Format::Human, &compiled.diagnostics, &compiled.sources)?;
    if has_errors(&compiled.diagnostics) {
        return Ok(Exit::ErrorsReported);
    }
    let text = rpi_driver::import::to_program(select_net(&compiled, None)?);
    write_result(&args.file, args.output.as_deref(), text.as_bytes())?;
    Ok(Exit::Success)
}

/// Carries out `rpic graph`: writes a drawing of the net of a command.
pub(crate) fn graph(args: &GraphArgs) -> CommandResult {
    let compiled = rpi_driver::compile(&rpi_driver::read(&args.file)?)?;
    print_diagnostics(Format::Human, &compiled.diagnostics, &compiled.sources)?;
    if compiled.has_errors() {
        return Ok(Exit::ErrorsReported);
    }
    let net = select_net(&compiled, args.command.as_deref())?;
    let text = match args.format {
        Drawing::Dot => draw::dot(net),
        Drawing::Mermaid => draw::mermaid(net),
    };
    write_result(&args.file, args.output.as_deref(), text.as_bytes())?;
    Ok(Exit::Success)
}
