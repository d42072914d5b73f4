//! What to run and with which cell: images, their order, devices.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use rpi_driver::{AnalysedNet, ArmAxes, ClaimPolicy, CompileOptions, Compiled, Program, Task};
use rpi_image::Image;
use rpi_serve::TaskBundle;
use rpi_sim::Cell;

use crate::cell_file;
use crate::program;
use crate::target_args::Target;

/// Default period of a command in nanoseconds: 1 ms.
pub(crate) const PERIOD: u64 = 1_000_000;

/// Function that lowers a net to an image for a period in nanoseconds. Also returns the upper bound of the work of a
/// cycle in elementary operations, or `None` if it is not needed.
pub(crate) type Lower = fn(&AnalysedNet, u64) -> Result<(Image, Option<u64>), Box<dyn Error>>;

/// Lowers a net to an image for `rpi run`, for a period in nanoseconds. Also returns the upper bound of the work of a
/// cycle in elementary operations.
pub(crate) fn lower_for_run(
    net: &AnalysedNet,
    period: u64,
) -> Result<(Image, Option<u64>), Box<dyn Error>> {
    let (image, work) = rpi_driver::lower_with_work(net, period)?;
    Ok((image, Some(work)))
}

/// Returns whether any of the commands uses a device.
fn needs_devices(images: &[Arc<Image>]) -> bool {
    let needs = |image: &Arc<Image>| {
        let ports = image.sensors.len() + image.actuators.len() + image.functions.len();
        ports > 0
    };
    images.iter().any(needs)
}

/// Returns the images and the plan to run: of the command or task that the options name, else of the only task, else of
/// the only command. `lower` converts each net to an image.
pub(crate) fn task_bundle(
    compiled: &Compiled,
    target: &Target,
    lower: Lower,
) -> Result<TaskBundle, Box<dyn Error>> {
    if let Program::Image(image) = &compiled.program {
        return check_image_period(image, target).map(|image| TaskBundle::single((image, None)));
    }
    let (nets, period) = (compiled.nets(), target.period.unwrap_or(PERIOD));
    if let Some(task) = task(&compiled.tasks, target.command.as_deref()) {
        return Ok(TaskBundle::from_task(task, nets, |net| lower(net, period))?);
    }
    let net = program::select_command(compiled, &compiled.tasks, target.command.as_deref())?;
    lower(net, period).map(TaskBundle::single)
}

/// Returns an error if a command runs alone and needs inputs from a predecessor that the options do not set.
pub(crate) fn ensure_inputs_set(
    compiled: &Compiled,
    target: &Target,
    bundle: &TaskBundle,
) -> Result<(), Box<dyn Error>> {
    let (tasks, name) = (&compiled.tasks, target.command.as_deref());
    let image = bundle.images.first().map(|image| image.name.as_str());
    let net = compiled.nets().iter().find(|net| Some(&*net.name) == image);
    let Some(net) = net.filter(|_| task(tasks, name).is_none()) else {
        return Ok(());
    };
    let is_set = |key: &str| target.settings.iter().any(|set| set.key == key);
    let needed = net
        .command_inputs
        .iter()
        .map(|given| (given.key.as_str(), given));
    let needed = needed.filter(|(key, given)| given.is_required && !is_set(key));
    let needed: Vec<&str> = needed.map(|(key, _)| key).collect();
    let [first, ..] = needed[..] else {
        return Ok(());
    };
    Err(format!(
        "{} takes over {} but no command runs before it; set it with --set {first}=VALUE",
        net.name,
        needed.join(", ")
    )
    .into())
}

fn task<'a>(tasks: &'a [Task], name: Option<&str>) -> Option<&'a Task> {
    match (tasks, name) {
        ([only], None) => Some(only),
        (_, Some(name)) => tasks.iter().find(|task| task.name == name),
        (_, None) => None,
    }
}

/// Returns a copy of the image. Returns an error if the options name another period than that for which the image was
/// compiled.
fn check_image_period(image: &Image, target: &Target) -> Result<Image, Box<dyn Error>> {
    match target.period {
        Some(period) if period != image.period_ns => Err(format!(
            "the image was compiled for a period of {}, not {}",
            rpi_driver::format_duration(image.period_ns),
            rpi_driver::format_duration(period)
        )
        .into()),
        _ => Ok(image.clone()),
    }
}

/// Returns the path of the cell description that the option names, else of `cell.toml` beside the program, which need
/// not exist.
pub(crate) fn cell_file(program: &Path, target: &Target) -> PathBuf {
    let beside = || program.with_file_name("cell.toml");
    target.cell.clone().unwrap_or_else(beside)
}

/// Returns the options for the compilation of a program for its cell: the one that the option names, else `cell.toml` beside the
/// program. Assertions and contracts are left out.
pub(crate) fn compile_options(target: &Target) -> Result<CompileOptions, Box<dyn Error>> {
    let axes = match &target.cell {
        Some(path) => cell_file::read(path)?.0.arm_axes().into(),
        None => ArmAxes::CellFile,
    };
    Ok(CompileOptions {
        arm_axes: axes,
        claims: ClaimPolicy::Off,
        watch: target.watch.clone(),
        ..CompileOptions::default()
    })
}

/// Reads the cell description, and returns the cell and the text of the description. Without a file, returns a cell
/// without devices, or an error if a command uses devices.
pub(crate) fn cell(
    program: &Path,
    target: &Target,
    bundle: &TaskBundle,
) -> Result<(Cell, String), Box<dyn Error>> {
    let path = cell_file(program, target);
    if target.cell.is_none() && !path.is_file() {
        return match needs_devices(&bundle.images) {
            false => Ok((Cell::default(), String::new())),
            true => Err("there is no cell.toml beside the program; add --cell FILE".into()),
        };
    }
    cell_file::read(&path)
}

/// Returns the maximum number of ticks of the run from the options `--cycles` and `--time`; `None` if the run is not
/// limited. `tick_ns` is the length of a tick in ns.
pub(crate) fn ticks(target: &Target, tick_ns: u64) -> Option<u64> {
    target
        .cycles
        .or(target.time.map(|time| time.div_ceil(tick_ns)))
}
