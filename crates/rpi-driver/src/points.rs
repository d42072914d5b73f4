//! Module `points`: the taught points and work frames of `points.toml` beside a program, as constants and frames.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::Path;

use rpi_diag::{Code, Diagnostic, FileId};
use rpi_sema::query::{DefKind, Index};
use rpi_sim::{PointsFile, TaughtPoint, TaughtPose, Tool, WorkFrame};

use crate::input::InputError;

/// Name of the module, for which programs write `use points;`.
pub(crate) const MODULE: &str = "points";
/// Name of the file from which the module is made.
pub(crate) const FILE: &str = "points.toml";
/// Ending of the name of the constant with the joint positions of a point.
const JOINTS: &str = "_joints";
/// Endings of the names of the constants of one entry, besides that with its own name.
const ENDINGS: [&str; 4] = [JOINTS, "_mass", "_centre", "_inertia"];

/// Returns the text of the module with the points of a file. Frames that the file does not declare are those of the module
/// `program`. Each declaration is on the line of the name in the file, so that
/// diagnostics show the right line.
///
/// # Errors
/// If the text is not a valid list of points.
pub(crate) fn module_text(path: &Path, text: &str, program: &str) -> Result<String, InputError> {
    let name = path.display().to_string();
    let file = PointsFile::parse(&name, text).map_err(|errors| {
        let Some(first) = errors.errors.first() else {
            return InputError::new(path, "invalid points");
        };
        let message = format!("line {}: {}", errors.line_column(first).0, first.message);
        InputError {
            help: first.help.clone(),
            ..InputError::new(path, message)
        }
    })?;
    let mut lines = vec![String::new(); text.lines().count().max(1)];
    let mut put = |at: usize, declaration: String| {
        let line = text[..at].matches('\n').count();
        lines[line] += &declaration;
    };
    for frame in &file.frames {
        put(frame.span.start, frame_text(frame));
    }
    for tool in &file.tools {
        put(tool.span.start, tool_text(tool));
    }
    for point in &file.points {
        put(point.span.start, point_text(point));
    }
    if needs_other_frames(&file) {
        lines[0].insert_str(0, &format!("use {program}; "));
    }
    Ok(lines.join("\n") + "\n")
}

/// Returns whether a frame or point is given in a frame that the file does not declare.
fn needs_other_frames(file: &PointsFile) -> bool {
    let parents = file.frames.iter().map(|frame| frame.parent.as_ref());
    let parents = parents.chain(file.points.iter().map(|point| point.frame.as_ref()));
    let is_own = |name: &String| file.frames.iter().any(|frame| frame.name == *name);
    parents.flatten().any(|name| !is_own(name))
}

fn frame_text(frame: &WorkFrame) -> String {
    let parent = frame.parent.as_ref();
    let parent = parent.map_or_else(String::new, |parent| format!(" in {parent}"));
    format!(
        "frame {}{parent} = {}; ",
        frame.name,
        pose_text(&frame.pose)
    )
}

fn tool_text(tool: &Tool) -> String {
    let name = &tool.name;
    let mut text = format!("const {name}: Pose = {}; ", pose_text(&tool.pose));
    if let Some(mass) = tool.mass {
        let _ = write!(
            text,
            "const {name}_mass: real[kg] = {}; ",
            quantity(mass, "kg")
        );
    }
    if let Some(centre) = tool.centre {
        let _ = write!(
            text,
            "const {name}_centre: Vector<<real[m]>> = vector({}); ",
            list(&centre, "m")
        );
    }
    if let Some(inertia) = tool.inertia {
        let inertia = list(&inertia, "kg*m^2");
        let _ = write!(text, "const {name}_inertia: real[kg*m^2]^6 = [{inertia}]; ");
    }
    text
}

fn point_text(point: &TaughtPoint) -> String {
    let mut text = String::new();
    let frame = point.frame.as_deref();
    let ty = frame.map_or("Pose".to_owned(), |frame| format!("Pose({frame})"));
    if let Some(pose) = &point.pose {
        let _ = write!(text, "const {}: {ty} = {}; ", point.name, pose_text(pose));
    }
    if let Some(joints) = &point.joints {
        let count = joints.len();
        let all = list(joints, "rad");
        let _ = write!(
            text,
            "const {}{JOINTS}: real[rad]^{count} = [{all}]; ",
            point.name
        );
    }
    text
}

/// Returns an expression for a pose (m). The orientation is its rotation vector (axis times angle), which is well-conditioned
/// for all orientations.
fn pose_text(pose: &TaughtPose) -> String {
    format!(
        "Pose{{position = vector({}); rotation = rotation_by(vector({}))}}",
        list(&pose.position, "m"),
        list(&pose.rotation, "rad")
    )
}

fn list(values: &[f64], unit: &str) -> String {
    let all: Vec<String> = values.iter().map(|value| quantity(*value, unit)).collect();
    all.join(", ")
}

fn quantity(value: f64, unit: &str) -> String {
    format!("{value:?}[{unit}]")
}

/// Returns warnings about the entries of the file `points` that no other file of the program names. An entry with several
/// constants, such as a pose and joint positions, is used if one of them is.
pub(crate) fn unused_warnings(index: &Index, points: FileId) -> Vec<Diagnostic> {
    let defs = index.defs_in(points);
    let named = defs.filter(|(_, def)| matches!(def.kind, DefKind::Const | DefKind::Frame));
    let is_used = |id| index.references(id).any(|place| place.file != points);
    let named: Vec<_> = named.map(|(id, def)| (def, is_used(id))).collect();
    let point_of = |name: &str| {
        let ending = ENDINGS.iter().find_map(|ending| name.strip_suffix(ending));
        ending.unwrap_or(name).to_owned()
    };
    let used: BTreeSet<String> = named
        .iter()
        .filter(|(_, is_used)| *is_used)
        .map(|(def, _)| point_of(&def.name))
        .collect();
    let mut reported = BTreeSet::new();
    let mut warnings = Vec::new();
    for (def, _) in named {
        let name = point_of(&def.name);
        if !used.contains(&name) && reported.insert(name.clone()) {
            let message = format!("`{name}` of {FILE} is never used");
            let warning = Diagnostic::new(Code::RPI1016, message).primary(def.span, "never used");
            warnings.push(warning.help("delete it, or name it in the program"));
        }
    }
    warnings
}
