//! `rpic compile`.

use rpi_diag::{Style, render};
use rpi_image::PrimDesc;
use rpi_net::Net;
use rpi_prims::PrimId;

use crate::Outcome;
use crate::args::{CompileArgs, Emit};

/// Writes an image, or prints a form in between.
pub(crate) fn compile(args: &CompileArgs) -> Outcome {
    let input = rpi_driver::read(&args.file)?;
    let compiled = rpi_driver::compile(&input)?;
    let style = Style::of(&std::io::stderr());
    eprint!("{}", render(&compiled.findings, &compiled.sources, style));
    if compiled.has_errors() {
        return Ok(false);
    }
    let net = choose(compiled.nets(), args.command.as_deref())?;
    let image = rpi_driver::lower_to_run(net, args.period)?;
    match args.emit {
        Some(Emit::Rpinet) => println!("{}", rpi_net::rpinet::write(net)),
        Some(Emit::Image) => print!("{}", rpi_image::print::print(&image, &declaration)),
        None => {
            let beside = args.file.with_file_name(format!("{}.rpib", input.stem()));
            let path = args.output.as_ref().unwrap_or(&beside);
            std::fs::write(path, image.to_bytes())?;
        }
    }
    Ok(true)
}

fn declaration(name: &str) -> Option<&'static PrimDesc> {
    PrimId::of(name).map(PrimId::desc)
}

fn choose<'a>(nets: &'a [Net], name: Option<&str>) -> Result<&'a Net, String> {
    let names = || {
        nets.iter()
            .map(|n| n.name.as_str())
            .collect::<Vec<_>>()
            .join(", ")
    };
    match (nets, name) {
        ([], _) => Err("there is no command in it".to_owned()),
        ([only], None) => Ok(only),
        (_, None) => Err(format!(
            "which command? There are {}; say --command NAME",
            names()
        )),
        (_, Some(name)) => {
            let found = nets.iter().find(|n| n.name == name);
            found.ok_or_else(|| format!("there is no command {name}, there are {}", names()))
        }
    }
}
