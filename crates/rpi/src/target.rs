//! What to run and against what: images, their order, the cell.

use std::path::Path;
use std::sync::Arc;

use rpi_driver::{Compiled, Program, Task, TaskStep};
use rpi_host::run::{Item, Sequence};
use rpi_image::Image;
use rpi_net::Net;
use rpi_sim::Cell;

use crate::args::Target;
use crate::program;

/// Period where nobody says another one: 1 ms.
pub(crate) const PERIOD: u64 = 1_000_000;

/// How a net is lowered: for running, or to be looked at.
pub(crate) type Lower = fn(&Net, u64) -> Result<Image, String>;

/// Commands and the order in which they run.
pub(crate) struct Script {
    /// The commands.
    pub(crate) images: Vec<Arc<Image>>,
    /// Their order.
    pub(crate) sequence: Sequence,
}

/// Makes images of what is to be run: the command or task that was named, else the only task, else the only command.
pub(crate) fn script(compiled: &Compiled, target: &Target, lower: Lower) -> Result<Script, String> {
    if let Program::Image(image) = &compiled.program {
        return once(of_image(image, target)?);
    }
    let (nets, period) = (compiled.nets(), target.period.unwrap_or(PERIOD));
    if let Some(task) = task(&compiled.tasks, target.command.as_deref()) {
        return of_task(task, nets, |net| lower(net, period));
    }
    let net = program::choose(nets, target.command.as_deref())?;
    once(lower(net, period)?)
}

fn once(image: Image) -> Result<Script, String> {
    Ok(Script {
        images: vec![Arc::new(image)],
        sequence: Sequence::once(0),
    })
}

fn task<'a>(tasks: &'a [Task], name: Option<&str>) -> Option<&'a Task> {
    match (tasks, name) {
        ([only], None) => Some(only),
        (_, Some(name)) => tasks.iter().find(|task| task.name == name),
        (_, None) => None,
    }
}

fn of_task(
    task: &Task,
    nets: &[Net],
    lower: impl Fn(&Net) -> Result<Image, String>,
) -> Result<Script, String> {
    let name = &task.name;
    let steps = task.steps.as_ref();
    let steps = steps.map_err(|why| format!("task {name} needs what cannot be run yet: {why}"))?;
    let mut used: Vec<String> = Vec::new();
    let sequence = Sequence(items(steps, &mut used));
    let images = used.iter().map(|command| {
        let net = nets.iter().find(|net| net.name == *command);
        lower(net.ok_or_else(|| format!("{command} cannot be run by itself"))?).map(Arc::new)
    });
    Ok(Script {
        images: images.collect::<Result<_, _>>()?,
        sequence,
    })
}

/// The steps with commands as indices into `used`.
fn items(steps: &[TaskStep], used: &mut Vec<String>) -> Vec<Item> {
    let item = |step: &TaskStep| match step {
        TaskStep::Repeat(times, body) => Item::Repeat {
            times: *times,
            body: items(body, used),
        },
        TaskStep::Run(name) => {
            let known = used.iter().position(|u| u == name);
            Item::Run(known.unwrap_or_else(|| {
                used.push(name.clone());
                used.len() - 1
            }))
        }
    };
    steps.iter().map(item).collect()
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
