//! A robot description, read from TOML.

use super::kinematics::{Joint, Kinematics};
use super::limits::{self, Limits};
use super::store::{MAX_MODELS, NewModel};
use super::{RobotFiles, dh, opw, urdf};
use crate::cell::arm::{position_out_of_range, range_help};
use crate::cell::error::CellErrors;
use crate::cell::reader::TableReader;
use rpi_kin::{ArmModel, AxisLimits, InverseKinematics, MAX_AXES};

/// Robot as its description file gives it.
#[derive(Clone, Debug)]
pub struct RobotDescription {
    /// Kinematics, limits and inverse kinematics of the robot. The model lives as long as the process.
    pub model: &'static ArmModel,
    /// Names of the axes, in order from the base.
    pub axes: Vec<String>,
    /// Joint positions, in rad (m for a prismatic axis), at which arms of a cell can start: `joints = "home"`. `None` if the
    /// description has none.
    pub home: Option<Vec<f64>>,
    /// Limits that are assumed because the description does not give them, one text for each, such as `jerk
    /// (acceleration / 0.05 s)`.
    pub assumed: Vec<String>,
    /// Files with the meshes of the links, for graphical views.
    pub meshes: Vec<Mesh>,
}

/// Reference to the file with the mesh of a link.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mesh {
    /// Name of the link to which the mesh belongs.
    pub link: String,
    /// Path of the mesh as in the description: relative to it, or `package://NAME/..`.
    pub file: String,
}

/// Names of the tables that can give the kinematics, of which a description has exactly one.
const KINEMATICS: [&str; 3] = ["dh", "opw", "urdf"];

pub(super) fn read(
    file: &str,
    text: &str,
    files: &dyn RobotFiles,
) -> Result<RobotDescription, CellErrors> {
    let read = crate::cell::read_document(file, text, |reader| read_table(reader, file, files))?;
    let incomplete = || CellErrors::of_file(file, "the description is invalid".to_owned(), None);
    read.ok_or_else(incomplete)
}

/// Reads a robot description from its top-level table. Reports errors and returns `None` if something is missing.
pub(super) fn read_table(
    mut reader: TableReader<'_>,
    file: &str,
    files: &dyn RobotFiles,
) -> Option<RobotDescription> {
    let name = reader.text("name");
    reader.require("name", "write name = \"..\": cells refer to it");
    let Some(kinematics) = read_kinematics(&mut reader, file, files) else {
        for joints in Joint::extremes() {
            let count = joints.len() as u64;
            reader.mark_known(|reader| drop(limits::read(reader, &joints)));
            reader.mark_known(|reader| _ = (texts(reader), reader.index("held_axis", count)));
            reader.mark_known(|reader| drop(read_home(reader, &joints, &[])));
        }
        reader.finish();
        return None;
    };
    described(reader, name?, kinematics, limits::read)
}

/// Makes a robot description from kinematics that have been read, and reads its limits and texts. Reports errors and
/// returns `None` if something is missing.
pub(super) fn described(
    mut reader: TableReader<'_>,
    name: &str,
    kinematics: Kinematics,
    read_limits: fn(&mut TableReader<'_>, &[Joint]) -> Option<Limits>,
) -> Option<RobotDescription> {
    let count = kinematics.joints.len();
    let limits = read_limits(&mut reader, &kinematics.joints);
    let ranges = limits.as_ref().map_or(&[][..], |limits| &limits.axes);
    let home = read_home(&mut reader, &kinematics.joints, ranges);
    let held_axis = reader.index("held_axis", count as u64);
    let held_axis = held_axis.and_then(|axis| usize::try_from(axis).ok());
    let [title, source] = texts(&mut reader).map(|text| text.map(str::to_owned));
    let described = limits.and_then(|limits| {
        let held_axis = held_axis.or((count == MAX_AXES).then_some(MAX_AXES - 1));
        let iterative = match count {
            // Fewer axes reach too few poses to be commanded by poses.
            0..=2 => InverseKinematics::NoClosedForm,
            _ => InverseKinematics::DampedLeastSquares { held_axis },
        };
        let new = NewModel {
            id: name.to_owned(),
            display_name: title.unwrap_or_else(|| name.to_owned()),
            source: source.unwrap_or_else(|| "not stated".to_owned()),
            convention: kinematics.convention,
            rows: kinematics.rows,
            flange: kinematics.flange,
            limits: limits.axes,
            inverse: kinematics.inverse.unwrap_or(iterative),
        };
        Some((kept(&reader, new)?, limits.assumed))
    });
    reader.finish();
    let (model, assumed) = described?;
    let axes = kinematics.joints.into_iter().map(|joint| joint.name);
    Some(RobotDescription {
        model,
        axes: axes.collect(),
        home,
        assumed,
        meshes: kinematics.meshes,
    })
}

/// Reads the key `home`: joint positions within the ranges of `limits`, in rad (m for a prismatic axis). Reports positions
/// outside of their range.
fn read_home(
    reader: &mut TableReader<'_>,
    joints: &[Joint],
    limits: &[AxisLimits],
) -> Option<Vec<f64>> {
    let own: Vec<_> = joints
        .iter()
        .map(|joint| limits::dimensions(joint)[0])
        .collect();
    let home = reader.list_of("home", &own)?;
    for (axis, (position, limits)) in home.iter().zip(limits).enumerate() {
        if !limits.position.contains(*position) {
            let message = position_out_of_range("position", axis, *position, own[axis]);
            let help = range_help(&limits.position, own[axis]);
            reader.error_at_entry("home", axis, message, Some(help));
        }
    }
    Some(home)
}

fn kept(reader: &TableReader<'_>, new: NewModel) -> Option<&'static ArmModel> {
    let model = new.keep();
    if model.is_none() {
        let message = format!("more than {MAX_MODELS} different robots were read");
        reader.error_at("name", message, Some("start a new process".to_owned()));
    }
    model
}

/// Reads the texts for people: the name of the robot as its vendor writes it (`title`), and the source of the numbers.
fn texts<'a>(reader: &mut TableReader<'a>) -> [Option<&'a str>; 2] {
    [reader.text("title"), reader.text("source")]
}

fn read_kinematics(
    reader: &mut TableReader<'_>,
    file: &str,
    files: &dyn RobotFiles,
) -> Option<Kinematics> {
    let given: Vec<&str> = KINEMATICS
        .into_iter()
        .filter(|key| reader.has(key))
        .collect();
    if given.len() != 1 {
        let message = match given.as_slice() {
            [] => "the kinematics are missing".to_owned(),
            several => format!("{} cannot be combined", several.join(" and ")),
        };
        let help = Some("write one of the tables [dh], [opw] and [urdf]".to_owned());
        reader.error_at(given.last().unwrap_or(&"dh"), message, help);
    }
    let mut found = None;
    for key in KINEMATICS {
        let Some(mut table) = reader.table(key) else {
            continue;
        };
        found = match key {
            "dh" => dh::read(&mut table),
            "opw" => opw::read(&mut table),
            _ => urdf::read_table(&mut table, file, files),
        };
        table.finish();
    }
    found.filter(|_| given.len() == 1)
}
