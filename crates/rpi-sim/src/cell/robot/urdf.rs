//! Arms in the Unified Robot Description Format (URDF) of ROS.
//!
//! The XML is read by `roxmltree`, because errors then have a line and a column. `urdf-rs` reports none, and depends on
//! four XML parsers.

use super::description::{Mesh, RobotDescription};
use super::files::{FolderView, RobotFiles};
use super::kinematics::{Joint, Kinematics, Row};
use super::limits;
use super::urdf_joint::{UrdfError, UrdfJoint, UrdfJointType, child};
use super::urdf_tree::{UrdfTree, is_movable};
use crate::cell::collector::ErrorCollector;
use crate::cell::error::{CellError, CellErrors};
use crate::cell::reader::TableReader;
use nalgebra::{Matrix3, Rotation3, Translation3, Vector3};
use roxmltree::{Document, Node, ParsingOptions};
use rpi_kin::chain::JointType;
use rpi_kin::{Convention, MAX_AXES, Transform};

/// Maximum number of XML nodes of a URDF. The largest humanoid robots have some 10 000.
const MAX_NODES: u32 = 1_000_000;

/// Names of the links between which the axes of an arm lie; `None` for the root and for the end of the longest chain.
#[derive(Clone, Copy, Debug, Default)]
struct Ends<'a> {
    base: Option<&'a str>,
    tip: Option<&'a str>,
}

/// Reads a URDF that no TOML description refers to: limits, base and tip are those of the URDF.
pub(super) fn read_alone(file: &str, text: &str) -> Result<RobotDescription, CellErrors> {
    let kinematics = read(file, text, Ends::default())?;
    let errors = ErrorCollector::default();
    let reader = TableReader::empty(&errors);
    let name = kinematics
        .name
        .clone()
        .unwrap_or_else(|| "robot".to_owned());
    let described = super::description::described(reader, &name, kinematics, limits::read);
    let of_file = |message: &str, help| CellErrors::of_file(file, message.to_owned(), help);
    match (described, errors.sorted()) {
        (Some(described), errors) if errors.is_empty() => Ok(described),
        (_, errors) if errors.is_empty() => Err(of_file("the description is invalid", None)),
        (_, mut errors) => {
            let help = "write a TOML file beside the URDF, with [urdf] file = \"..\" and [limits]";
            errors
                .iter_mut()
                .for_each(|error| error.help = Some(help.to_owned()));
            Err(CellErrors {
                file: file.to_owned(),
                text: text.to_owned(),
                errors,
            })
        }
    }
}

/// Reads the table `urdf`, kinematics from a URDF: `file`, and the links `base` and `tip`. `folder` is the path of the
/// description, to which `file` is relative. Errors of the URDF are reported at `file`.
pub(super) fn read_table(
    table: &mut TableReader<'_>,
    folder: &str,
    files: &dyn RobotFiles,
) -> Option<Kinematics> {
    let file = table.text("file");
    let ends = Ends {
        base: table.text("base"),
        tip: table.text("tip"),
    };
    table.require("file", "expected the path of a URDF relative to this file");
    let file = file?;
    let text = match (FolderView { folder, files }).read(file) {
        Ok(text) => text,
        Err(why) => {
            table.error_at("file", why.to_string(), None);
            return None;
        }
    };
    read(file, &text, ends)
        .map_err(|errors| table.nested_errors("file", &errors))
        .ok()
}

fn read(file: &str, text: &str, ends: Ends<'_>) -> Result<Kinematics, CellErrors> {
    let fail = |(span, message, help): UrdfError| CellErrors {
        file: file.to_owned(),
        text: text.to_owned(),
        errors: vec![CellError {
            span,
            message,
            help,
        }],
    };
    let declared = DeclaredText::new(text);
    let document = Document::parse_with_options(&declared.text, options());
    let document = document.map_err(|why| fail(declared.own(xml_error(&declared.text, &why))))?;
    let robot = document.root_element();
    kinematics(robot, ends).map_err(|error| fail(declared.own(error)))
}

fn options<'a>() -> ParsingOptions<'a> {
    ParsingOptions {
        nodes_limit: MAX_NODES,
        ..ParsingOptions::default()
    }
}

/// Text of a URDF to which declarations of its namespace prefixes are added. Many tools write attributes such as
/// `drake:acceleration` without a declaration, which the XML parsers of ROS accept.
struct DeclaredText {
    text: String,
    /// Byte position at which the declarations were inserted.
    at: usize,
    /// Length of the inserted declarations, in bytes.
    length: usize,
}

impl DeclaredText {
    /// Maximum number of prefixes that are declared.
    const MOST: usize = 8;

    fn new(text: &str) -> Self {
        let at = text.find("<robot").map_or(0, |at| at + "<robot".len());
        let mut declared = Self {
            text: text.to_owned(),
            at,
            length: 0,
        };
        for _ in 0..Self::MOST {
            let parsed = Document::parse_with_options(&declared.text, options());
            let prefix = match parsed.err() {
                Some(roxmltree::Error::UnknownNamespace(prefix, _)) => prefix,
                _ => break,
            };
            let declaration = format!(" xmlns:{prefix}=\"{prefix}\"");
            declared.text.insert_str(at, &declaration);
            declared.length += declaration.len();
        }
        declared
    }

    /// Returns the error with its position in the original text, without the inserted declarations.
    fn own(&self, (span, message, help): UrdfError) -> UrdfError {
        let own = |at: usize| match at > self.at {
            true => at.saturating_sub(self.length).max(self.at),
            false => at,
        };
        (own(span.start)..own(span.end), message, help)
    }
}

/// Makes the error for invalid XML, with its position in the text. The position at the end of the library's message is
/// removed.
fn xml_error(text: &str, why: &roxmltree::Error) -> UrdfError {
    let place = why.pos();
    let lines = text
        .split_inclusive('\n')
        .take(place.row.saturating_sub(1) as usize);
    let start: usize = lines.map(str::len).sum();
    let line = text.get(start..).unwrap_or_default();
    let before = line.chars().take(place.col.saturating_sub(1) as usize);
    let at = start + before.map(char::len_utf8).sum::<usize>();
    let message = why.to_string();
    let message = message
        .rsplit_once(" at ")
        .map_or(message.as_str(), |(text, _)| text);
    (at..at, format!("invalid XML: {message}"), None)
}

fn kinematics(robot: Node<'_, '_>, ends: Ends<'_>) -> Result<Kinematics, UrdfError> {
    if !robot.has_tag_name("robot") {
        let message = format!("expected <robot>, found <{}>", robot.tag_name().name());
        return Err((robot.range(), message, None));
    }
    refuse_xacro(robot)?;
    let children = |tag: &'static str| robot.children().filter(move |node| node.has_tag_name(tag));
    let links = children("link").filter_map(|link| link.attribute("name"));
    let links: Vec<String> = links.map(str::to_owned).collect();
    let joints: Result<Vec<UrdfJoint>, UrdfError> =
        children("joint").map(UrdfJoint::read).collect();
    let tree = UrdfTree::new(links, joints?, robot.range())?;
    let path = tree.path(ends.base, ends.tip)?;
    let mut found = chain_of(&path)?;
    if found.joints.len() > MAX_AXES {
        let count = found.joints.len();
        let help = "write [urdf] with `base` and `tip` in a TOML file beside the URDF".to_owned();
        let message = format!("{count} axes lie between base and tip, at most {MAX_AXES} can");
        return Err((robot.range(), message, Some(help)));
    }
    found.meshes = children("link").flat_map(meshes).collect();
    found.name = robot.attribute("name").map(str::to_owned);
    Ok(found)
}

/// Returns an error if the file is a xacro macro file, which must first be expanded to a URDF.
fn refuse_xacro(robot: Node<'_, '_>) -> Result<(), UrdfError> {
    let is_xacro = |node: &Node<'_, '_>| {
        let space = node.tag_name().namespace();
        space.is_some_and(|space| space.contains("xacro"))
    };
    match robot.descendants().find(is_xacro) {
        Some(node) => {
            let help = Some("expand it first: xacro ROBOT.xacro > ROBOT.urdf".to_owned());
            Err((
                node.range(),
                "the file is a xacro, not a URDF".to_owned(),
                help,
            ))
        }
        None => Ok(()),
    }
}

/// Returns the kinematic chain of the joints on a path through a URDF. Fixed joints become part of the transform of the
/// next joint.
fn chain_of(path: &[&UrdfJoint]) -> Result<Kinematics, UrdfError> {
    let (mut rows, mut joints) = (Vec::new(), Vec::new());
    let mut fixed = Transform::identity();
    for joint in path {
        fixed *= joint.origin;
        if joint.kind == UrdfJointType::Fixed {
            continue;
        }
        let kind = moving_kind(joint)?;
        let turned = towards(&joint.axis);
        rows.push(Row::placed(fixed * turned, kind));
        fixed = turned.inverse();
        joints.push(Joint {
            name: joint.name.clone(),
            kind,
            limits: joint.limits,
            is_continuous: joint.kind == UrdfJointType::Continuous,
        });
    }
    let flange = (fixed != Transform::identity()).then(|| Row::placed(fixed, JointType::Revolute));
    Ok(Kinematics {
        convention: Convention::Modified,
        rows,
        flange: flange.into_iter().collect(),
        joints,
        inverse: None,
        meshes: Vec::new(),
        name: None,
    })
}

fn moving_kind(joint: &UrdfJoint) -> Result<JointType, UrdfError> {
    let name = &joint.name;
    let fail = |message: String, help: &str| (joint.span.clone(), message, Some(help.to_owned()));
    match joint.kind {
        UrdfJointType::Free => Err(fail(
            format!("joint `{name}` has several degrees of freedom"),
            "an arm has revolute and prismatic joints: choose a `base` below this one",
        )),
        _ if !is_movable(joint) => Err(fail(
            format!("joint `{name}` follows another joint"),
            "the joints of an arm move on their own: choose a `tip` above this one",
        )),
        UrdfJointType::Prismatic => Ok(JointType::Prismatic),
        _ => Ok(JointType::Revolute),
    }
}

/// Returns a rotation that turns z into the unit vector `axis`; it is exact for the axes of the frame.
fn towards(axis: &Vector3<f64>) -> Transform {
    let aside = match axis.x.abs() < 0.9 {
        true => Vector3::x(),
        false => Vector3::y(),
    };
    let x = (aside - axis * axis.dot(&aside)).normalize();
    let columns = Matrix3::from_columns(&[x, axis.cross(&x), *axis]);
    let rotation = Rotation3::from_matrix_unchecked(columns);
    Transform::from_parts(Translation3::identity(), rotation)
}

/// Returns references to the meshes of a link, for graphical views. The meshes themselves are not read.
fn meshes(link: Node<'_, '_>) -> Vec<Mesh> {
    let name = link.attribute("name").unwrap_or_default();
    let visuals = link.children().filter(|node| node.has_tag_name("visual"));
    let mesh = |visual: Node<'_, '_>| {
        let mesh = child(child(visual, "geometry")?, "mesh")?;
        Some(Mesh {
            link: name.to_owned(),
            file: mesh.attribute("filename")?.to_owned(),
        })
    };
    visuals.filter_map(mesh).collect()
}
