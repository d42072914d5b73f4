//! Taught points, work frames and tools (`points.toml`): places that programs name.

use super::error::CellErrors;
use super::pose::read_pose;
use super::quantity::Dimension::{Angle, Inertia, Length, Mass};
use super::read_document;
use super::reader::TableReader;
use core::ops::Range;
use nalgebra::{Isometry3, Vector3};
use rpi_kin::rotation::{from_rotation_vector, rotation_vector};

/// Points, work frames and tools of a file `points.toml`, each list in text order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PointsFile {
    /// Work frames, such as that of a table.
    pub frames: Vec<WorkFrame>,
    /// Tools that an arm may hold.
    pub tools: Vec<Tool>,
    /// Points that were taught.
    pub points: Vec<TaughtPoint>,
}

/// Work frame: a coordinate frame in which points are given.
#[derive(Clone, Debug, PartialEq)]
pub struct WorkFrame {
    /// Name of the frame.
    pub name: String,
    /// Bytes of the name in the text.
    pub span: Range<usize>,
    /// Frame in which the pose is given; `None` for the base of the arm.
    pub parent: Option<String>,
    /// Pose of the frame in its parent.
    pub pose: TaughtPose,
}

/// Tool that an arm may hold, with its load.
#[derive(Clone, Debug, PartialEq)]
pub struct Tool {
    /// Name of the tool.
    pub name: String,
    /// Bytes of the name in the text.
    pub span: Range<usize>,
    /// Pose of the tip in the frame of the arm's own tool: the flange, unless the cell describes another one.
    pub pose: TaughtPose,
    /// Mass, kg; `None` if the file does not give it.
    pub mass: Option<f64>,
    /// Centre of mass in the frame of the arm's own tool, m; `None` if the file does not give it.
    pub centre: Option<[f64; 3]>,
    /// Moments of inertia xx, yy, zz, xy, xz, yz about the centre of mass, kg m²; `None` if the file does not give them.
    pub inertia: Option<[f64; 6]>,
}

/// Pose of a work frame or of the tool at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TaughtPose {
    /// Position, m.
    pub position: [f64; 3],
    /// Orientation as a rotation vector: the axis of the rotation times its angle, rad.
    pub rotation: [f64; 3],
}

impl TaughtPose {
    fn new(pose: &Isometry3<f64>) -> Self {
        Self {
            position: pose.translation.vector.into(),
            rotation: rotation_vector(&pose.rotation).into(),
        }
    }

    fn isometry(&self) -> Isometry3<f64> {
        let rotation = from_rotation_vector(Vector3::from(self.rotation));
        Isometry3::from_parts(Vector3::from(self.position).into(), rotation)
    }

    /// Returns this pose, given in the frame in which `frame` is given, in coordinates of `frame`.
    #[must_use]
    pub fn relative_to(&self, frame: &Self) -> Self {
        Self::new(&(frame.isometry().inverse() * self.isometry()))
    }

    /// Returns the orientation as a unit quaternion: x, y, z, w.
    #[must_use]
    pub fn quaternion(&self) -> [f64; 4] {
        let rotation = self.isometry().rotation;
        [rotation.i, rotation.j, rotation.k, rotation.w]
    }
}

/// Point that was taught: a pose of the tool, joint positions, or both.
#[derive(Clone, Debug, PartialEq)]
pub struct TaughtPoint {
    /// Name of the point.
    pub name: String,
    /// Bytes of the name in the text.
    pub span: Range<usize>,
    /// Frame in which the pose is given; `None` for the base of the arm.
    pub frame: Option<String>,
    /// Pose of the tool in the frame; `None` for a point that has joint positions only.
    pub pose: Option<TaughtPose>,
    /// Joint positions at which the point was taken, rad; `None` if the file does not give them.
    pub joints: Option<Vec<f64>>,
}

impl PointsFile {
    /// Parses a file with points. `file` is the name of the file, for messages only.
    ///
    /// # Errors
    /// Returns all errors of the text, with their positions.
    pub fn parse(file: &str, text: &str) -> Result<Self, CellErrors> {
        read_document(file, text, read)
    }
}

fn read(mut reader: TableReader<'_>) -> PointsFile {
    let frames = read_entries(&mut reader, "frames", read_frame);
    let points = read_entries(&mut reader, "points", read_point);
    let tools = read_entries(&mut reader, "tools", read_tool);
    let names = frames.iter().map(|frame| (&frame.name, &frame.span));
    let names = names.chain(tools.iter().map(|tool| (&tool.name, &tool.span)));
    let names = names.chain(points.iter().map(|point| (&point.name, &point.span)));
    check_names(&reader, names.collect());
    reader.finish();
    PointsFile {
        frames,
        tools,
        points,
    }
}

/// Reads the tables of the table at `key`, whose keys are names, by `read`.
fn read_entries<T>(
    reader: &mut TableReader<'_>,
    key: &'static str,
    read: fn(&str, Range<usize>, TableReader<'_>) -> T,
) -> Vec<T> {
    let mut all = Vec::new();
    let tables = reader.table(key);
    for (name, span, entry) in tables.iter().flat_map(TableReader::named_tables) {
        match entry {
            Some(entry) => all.push(read(name, span, entry)),
            None => {
                let message = format!("`{name}` must be a table");
                let help = format!("write [{key}.{name}]");
                reader.errors.add(span, message, Some(help));
            }
        }
    }
    all
}

fn read_frame(name: &str, span: Range<usize>, mut reader: TableReader<'_>) -> WorkFrame {
    let parent = reader.text("in").map(str::to_owned);
    let pose = TaughtPose::new(&read_pose(&mut reader));
    reader.finish();
    WorkFrame {
        name: name.to_owned(),
        span,
        parent,
        pose,
    }
}

fn read_tool(name: &str, span: Range<usize>, mut reader: TableReader<'_>) -> Tool {
    let pose = TaughtPose::new(&read_pose(&mut reader));
    let mass = reader.magnitude("mass", Mass);
    let centre = reader.reals("centre", Length, 3);
    let inertia = reader.reals("inertia", Inertia, 6);
    reader.finish();
    Tool {
        name: name.to_owned(),
        span,
        pose,
        mass,
        centre: centre.and_then(|centre| centre.try_into().ok()),
        inertia: inertia.and_then(|inertia| inertia.try_into().ok()),
    }
}

fn read_point(name: &str, span: Range<usize>, mut reader: TableReader<'_>) -> TaughtPoint {
    let frame = reader.text("in").map(str::to_owned);
    let has_pose = ["position", "rpy", "quaternion"]
        .iter()
        .any(|key| reader.has(key));
    let pose = TaughtPose::new(&read_pose(&mut reader));
    let joints = reader.reals_of_any_length("joints", Angle);
    if joints.as_ref().is_some_and(Vec::is_empty) {
        let help = "write one position for each axis".to_owned();
        reader.error_at("joints", "`joints` has no entries".to_owned(), Some(help));
    }
    if !has_pose && !reader.has("joints") && reader.recorder.is_none() {
        let message = format!("the point `{name}` has no place");
        let help = "write `position = [x, y, z]` and `rpy = [..]` or `quaternion = [..]`, or `joints = [..]`";
        reader.error_at("position", message, Some(help.to_owned()));
    }
    reader.finish();
    TaughtPoint {
        name: name.to_owned(),
        span,
        frame,
        pose: has_pose.then_some(pose),
        joints,
    }
}

/// Reports names that programs cannot write, and equal names of entries of different kinds.
fn check_names(reader: &TableReader<'_>, mut names: Vec<(&String, &Range<usize>)>) {
    for (name, span) in &names {
        if !is_name(name) {
            let message = format!("`{name}` is not a name that a program can write");
            let help = "use letters, digits and `_`, with a letter first".to_owned();
            reader.errors.add((*span).clone(), message, Some(help));
        }
    }
    names.sort_by_key(|(name, span)| (*name, span.start));
    for pair in names.windows(2) {
        if let [(first, _), (second, span)] = pair
            && first == second
        {
            let message = format!("`{second}` is the name of two entries");
            let help = "give them different names".to_owned();
            reader.errors.add((*span).clone(), message, Some(help));
        }
    }
}

fn is_name(name: &str) -> bool {
    let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
    name.starts_with(|c: char| c.is_ascii_alphabetic()) && name.chars().all(is_word)
}
