//! What to run and against what: images, their order, the cell.

use std::path::Path;
use std::sync::Arc;

use rpi_driver::{Compiled, Program};
use rpi_host::run::Sequence;
use rpi_image::Image;
use rpi_net::Net;
use rpi_sim::Cell;

use crate::args::Target;
use crate::program;

/// Period where nobody says another one: 1 ms.
const PERIOD: u64 = 1_000_000;

/// How a net is lowered: for running, or to be looked at.
pub(crate) type Lower = fn(&Net, u64) -> Result<Image, String>;

/// Commands and the order in which they run.
pub(crate) struct Script {
    /// The commands.
    pub(crate) images: Vec<Arc<Image>>,
    /// Their order.
    pub(crate) sequence: Sequence,
}

/// Makes images of what is to be run.
pub(crate) fn script(compiled: &Compiled, target: &Target, lower: Lower) -> Result<Script, String> {
    let image = match &compiled.program {
        Program::Image(image) => of_image(image, target)?,
        Program::Nets(nets) => {
            let net = program::choose(nets, target.command.as_deref())?;
            lower(net, target.period.unwrap_or(PERIOD))?
        }
    };
    Ok(Script {
        images: vec![Arc::new(image)],
        sequence: Sequence::once(0),
    })
}

/// An image has the period that it was compiled for.
fn of_image(image: &Image, target: &Target) -> Result<Image, String> {
    match target.period {
        Some(period) if period != image.period_ns => Err(format!(
            "this image was compiled for a period of {}, not {}",
            rpi_driver::period_text(image.period_ns),
            rpi_driver::period_text(period)
        )),
        _ => Ok(image.clone()),
    }
}

/// The cell that was named, or the one beside the program.
pub(crate) fn cell(program: &Path, target: &Target) -> Result<Cell, String> {
    let beside = program.with_file_name("cell.toml");
    let path = match &target.cell {
        Some(path) => path.as_path(),
        None if beside.is_file() => beside.as_path(),
        None => {
            return Err(
                "which cell? There is no cell.toml beside the program; say --cell FILE".into(),
            );
        }
    };
    let name = path.display().to_string();
    let text = std::fs::read_to_string(path).map_err(|e| format!("{name}: {e}"))?;
    Cell::parse(&name, &text).map_err(|errors| format!("the cell is wrong\n{errors}"))
}

/// Ticks after which a run is cut off.
pub(crate) fn ticks(target: &Target, tick_ns: u64) -> Option<u64> {
    target
        .cycles
        .or(target.time.map(|time| time.div_ceil(tick_ns)))
}
