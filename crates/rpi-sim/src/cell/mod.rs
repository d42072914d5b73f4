//! Cell descriptions (`cell.toml`): the devices of a robot cell by name.
//!
//! Parsing does not stop at the first error. The result is either a complete cell or all errors with their positions.

mod arm;
mod arm_driver;
mod collector;
mod descriptions;
mod error;
mod faults;
mod io;
mod json;
mod kind;
mod numbers;
mod periods;
mod points;
mod pose;
pub(crate) mod quantity;
mod reader;
pub mod robot;
mod schema;
mod shape;
mod simple_devices;
mod suggestion;
mod value;
mod words;

pub use arm::{ArmSpec, EnforcedLimits, Surface};
pub use arm_driver::ArmDriver;
pub use error::{CellError, CellErrors};
pub use io::{InputChange, IoSpec, TerminalSpec};
pub use kind::{DeviceKind, KindInfo};
pub use points::{PointsFile, TaughtPoint, TaughtPose, Tool, WorkFrame};
pub use simple_devices::BaseSpec;

use collector::ErrorCollector;
use core::cell::RefCell;
use reader::TableReader;
use robot::{AttachedFiles, NoFiles, RobotDescription, RobotFiles, is_robot_file};
use std::collections::{BTreeMap, BTreeSet};
use toml::de::DeTable;

/// Description of a robot cell: its devices and common settings.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Cell {
    /// Name of the cell for display; empty if not set.
    pub name: String,
    /// Seed for the noise of all devices. The same seed gives the same bits.
    pub seed: u64,
    /// Devices of the cell, in text order.
    pub devices: Vec<DeviceSpec>,
    /// Texts of the robot descriptions that the cell uses, by their paths, so that a recording can contain them.
    pub robot_files: BTreeMap<String, String>,
}

/// Device of a cell as `cell.toml` describes it.
#[derive(Clone, Debug, PartialEq)]
pub struct DeviceSpec {
    /// Name by which programs refer to the device.
    pub name: String,
    /// Kind of the device, with its settings.
    pub kind: DeviceKind,
}

impl Cell {
    /// Parses the description of a cell that names no files. `file` is the name of the file, for messages only.
    ///
    /// # Errors
    /// Returns all errors of the description, with their positions.
    pub fn parse(file: &str, text: &str) -> Result<Self, CellErrors> {
        Self::parse_with(file, text, &NoFiles)
    }

    /// Parses the description of a cell. `file` is the name of the file, for messages only. `files` reads the robot
    /// descriptions that the cell names.
    ///
    /// # Errors
    /// Returns all errors of the description and of the named files, with their positions.
    pub fn parse_with(file: &str, text: &str, files: &dyn RobotFiles) -> Result<Self, CellErrors> {
        let mut used = BTreeMap::new();
        let cell = read_document_with(
            file,
            text,
            |document, errors| read_robots(document, errors, files, &mut used),
            Self::read,
        )?;
        Ok(Self {
            robot_files: used,
            ..cell
        })
    }

    /// Returns the JSON schema of cell descriptions, for editors.
    #[must_use]
    pub fn schema() -> String {
        schema::schema("cell", "Cell description (cell.toml)", |reader| {
            Self::read(reader);
        })
    }

    /// Returns the text of this cell with the texts of the files that it names, so that it can be parsed without them.
    /// `text` is the text from which the cell was parsed.
    #[must_use]
    pub fn self_contained(&self, text: &str) -> String {
        let mut all = text.to_owned();
        for (path, content) in &self.robot_files {
            let quoted = |text: &str| toml::Value::String(text.to_owned()).to_string();
            let [path, content] = [quoted(path), quoted(content)];
            all += &format!("\n[[robot_files]]\npath = {path}\ntext = {content}\n");
        }
        all
    }

    /// Returns the name of the device that owns a resource of a bank with these devices, and the number of the resource
    /// within the device; `None` if there is no such device.
    #[must_use]
    pub fn resource_owner(&self, resource: u32) -> Option<(&str, u32)> {
        let (place, own) = crate::bank::split_resource(resource);
        self.devices.get(place).map(|d| (d.name.as_str(), own))
    }

    /// Returns the description of the device with this name; `None` if there is none.
    #[must_use]
    pub fn device(&self, name: &str) -> Option<&DeviceSpec> {
        self.devices.iter().find(|device| device.name == name)
    }

    /// Returns the names of the arms (also linear units and positioners) with their numbers of axes, in text order.
    pub fn arms(&self) -> impl Iterator<Item = (&str, usize)> {
        self.devices.iter().filter_map(|device| match &device.kind {
            DeviceKind::Arm(arm) => Some((device.name.as_str(), arm.model.axes())),
            _ => None,
        })
    }

    /// Returns the number of axes that all arms of the cell have; `None` if the cell has no arm or different ones. An arm can
    /// place its tool freely, so devices with one or two axes do not count.
    #[must_use]
    pub fn arm_axes(&self) -> Option<u32> {
        let free = self.arms().map(|(_, axes)| axes).filter(|axes| *axes >= 3);
        let mut different = free.collect::<BTreeSet<usize>>().into_iter();
        let only = different.next().filter(|_| different.next().is_none());
        only.and_then(|axes| u32::try_from(axes).ok())
    }

    fn read(mut reader: TableReader<'_>) -> Self {
        let name = reader.text("name").unwrap_or_default().to_owned();
        let seed = reader.index("seed", u64::MAX).unwrap_or(0);
        let devices = match reader.table("devices") {
            Some(devices) => read_devices(&devices),
            None => Vec::new(),
        };
        reader.tables("robot_files").into_iter().for_each(|file| {
            read_attached(file);
        });
        reader.finish();
        Self {
            name,
            seed,
            devices,
            robot_files: BTreeMap::new(),
        }
    }
}

/// Parses TOML and passes its top-level table to `read`.
///
/// # Errors
/// Returns all errors of the text, with their positions.
fn read_document<T>(
    file: &str,
    text: &str,
    read: impl FnOnce(TableReader<'_>) -> T,
) -> Result<T, CellErrors> {
    read_document_with(file, text, |_, _| BTreeMap::new(), read)
}

/// Parses TOML, passes it to `read_robots`, which reads the robot descriptions that its devices name, and then passes
/// its top-level table to `read`.
///
/// # Errors
/// Returns all errors of the text, with their positions.
fn read_document_with<T>(
    file: &str,
    text: &str,
    read_robots: impl FnOnce(&DeTable<'_>, &ErrorCollector) -> BTreeMap<String, RobotDescription>,
    read: impl FnOnce(TableReader<'_>) -> T,
) -> Result<T, CellErrors> {
    let faults = ErrorCollector::default();
    let (document, broken) = DeTable::parse_recoverable(text);
    for error in &broken {
        let span = error.span().unwrap_or(0..0);
        faults.add(span, error.message().replace('\n', ": "), None);
    }
    let document = document.get_ref();
    let robots = match broken.is_empty() {
        true => read_robots(document, &faults),
        false => BTreeMap::new(),
    };
    let faults = faults.with_robots(robots);
    let found = broken
        .is_empty()
        .then(|| read(TableReader::new(document, 0..0, &faults)));
    let errors = faults.sorted();
    match found {
        Some(found) if errors.is_empty() => Ok(found),
        _ => Err(CellErrors {
            file: file.to_owned(),
            text: text.to_owned(),
            errors,
        }),
    }
}

/// Reads the robot descriptions that the devices of a cell name, and returns them by path. Errors of a description are
/// reported at the key that names it. `used` receives the texts of the files.
fn read_robots(
    document: &DeTable<'_>,
    errors: &ErrorCollector,
    files: &dyn RobotFiles,
    used: &mut BTreeMap<String, String>,
) -> BTreeMap<String, RobotDescription> {
    let silent = ErrorCollector::default();
    let mut reader = TableReader::new(document, 0..0, &silent);
    let attached = reader.tables("robot_files").into_iter();
    let attached: BTreeMap<String, String> = attached.filter_map(read_attached).collect();
    let files = AttachedFiles {
        attached: &attached,
        others: files,
        used: RefCell::new(BTreeMap::new()),
    };
    let mut robots = BTreeMap::new();
    let devices = reader.table("devices");
    for (_, _, device) in devices.iter().flat_map(TableReader::entries) {
        let model = device
            .get_ref()
            .as_table()
            .and_then(|table| table.get("model"));
        let Some((node, path)) = model.and_then(|node| Some((node, node.get_ref().as_str()?)))
        else {
            continue;
        };
        if !is_robot_file(path) || robots.contains_key(path) {
            continue;
        }
        match RobotDescription::open(path, &files) {
            Ok(found) => drop(robots.insert(path.to_owned(), found)),
            Err(nested) => errors.add_nested(node.span(), &nested),
        }
    }
    let new = files.used.into_inner().into_iter();
    used.extend(new.filter(|(path, _)| !attached.contains_key(path)));
    robots
}

/// Reads a table `{ path, text }`: a file that is contained in the description of the cell.
fn read_attached(mut file: TableReader<'_>) -> Option<(String, String)> {
    let [path, text] = [file.text("path"), file.text("text")];
    file.require("path", "expected the path as `model` names it");
    file.require("text", "expected the text of the file");
    file.finish();
    Some((path?.to_owned(), text?.to_owned()))
}

fn read_devices(devices: &TableReader<'_>) -> Vec<DeviceSpec> {
    let mut all = Vec::new();
    for (name, span, device) in devices.named_tables() {
        match device {
            Some(device) => all.extend(read_device(name, device)),
            None => {
                let message = format!("device `{name}` must be a table");
                devices
                    .errors
                    .add(span, message, Some(format!("write [devices.{name}]")));
            }
        }
    }
    all
}

fn read_device(name: &str, mut reader: TableReader<'_>) -> Option<DeviceSpec> {
    let kinds: Vec<&'static str> = kind::all().map(|kind| kind.name).collect();
    if !reader.has("kind") {
        let help = format!("expected one of {}", kinds.join(", "));
        reader.error_at("kind", format!("device `{name}` has no `kind`"), Some(help));
    }
    let found = reader.variant("kind", &kinds, |reader, word| {
        let kind = kind::all().find(|kind| kind.name == word)?;
        // A valid kind with invalid keys is `Some(None)`: then, the other keys are still checked.
        Some(kind.read(reader))
    })?;
    reader.finish();
    Some(DeviceSpec {
        name: name.to_owned(),
        kind: found?,
    })
}
