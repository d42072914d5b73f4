//! Text of the module `points`: the entries of a file with points as constants and frames.

use std::fmt::Write as _;

use rpi_sim::{PointsFile, TaughtPoint, TaughtPose, Tool, WorkFrame};

/// Ending of the name of the constant with the joint positions of a point.
const JOINTS: &str = "_joints";

/// Returns the text of the module with the entries of a file. Frames that the file does not declare are those of the module
/// `program`. Each declaration is on the line of the name in `text`, the text of the file, so that diagnostics show the right
/// line.
pub(crate) fn module_text(file: &PointsFile, text: &str, program: &str) -> String {
    let mut lines = vec![String::new(); text.lines().count().max(1)];
    let starts: Vec<usize> = text.match_indices('\n').map(|(at, _)| at).collect();
    let mut put = |at: usize, declaration: String| {
        let line = starts.partition_point(|start| *start < at);
        lines[line.min(starts.len())] += &declaration;
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
    if foreign_frame(file).is_some() {
        lines[0].insert_str(0, &format!("use {program}; "));
    }
    lines.join("\n") + "\n"
}

/// Returns the names of all constants and frames that the module declares, each with the name of its entry in the file.
pub(crate) fn declared_names(file: &PointsFile) -> Vec<(String, &str)> {
    let mut names: Vec<(String, &str)> = Vec::new();
    let mut add = |entry, ending: &str| names.push((format!("{entry}{ending}"), entry));
    for frame in &file.frames {
        add(frame.name.as_str(), "");
    }
    for tool in &file.tools {
        for (ending, is_given) in [
            ("", true),
            ("_mass", tool.mass.is_some()),
            ("_centre", tool.centre.is_some()),
            ("_inertia", tool.inertia.is_some()),
        ] {
            is_given.then(|| add(tool.name.as_str(), ending));
        }
    }
    for point in &file.points {
        for (ending, is_given) in [("", point.pose.is_some()), (JOINTS, point.joints.is_some())] {
            is_given.then(|| add(point.name.as_str(), ending));
        }
    }
    names
}

/// Returns the first frame that an entry refers to and the file does not declare; `None` if there is none.
pub(crate) fn foreign_frame(file: &PointsFile) -> Option<&str> {
    let parents = file.frames.iter().map(|frame| frame.parent.as_deref());
    let mut parents = parents.chain(file.points.iter().map(|point| point.frame.as_deref()));
    let own: std::collections::BTreeSet<&str> = file
        .frames
        .iter()
        .map(|frame| frame.name.as_str())
        .collect();
    parents.find_map(|name| name.filter(|name| !own.contains(name)))
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
