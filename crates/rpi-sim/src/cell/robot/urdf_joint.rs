//! Joints of a URDF.

use super::kinematics::KnownLimits;
use core::ops::Range;
use nalgebra::{Matrix3, Rotation3, Translation3, Vector3};
use roxmltree::Node;
use rpi_kin::Transform;
use rpi_kin::angle::SinCos;

/// Error in a URDF: byte range in the text, message, and suggested correction.
pub(super) type UrdfError = (Range<usize>, String, Option<String>);

/// Type of a joint in a URDF.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum UrdfJointType {
    Revolute,
    Continuous,
    Prismatic,
    Fixed,
    /// Joint of type `planar` or `floating`, with more than one degree of freedom.
    Free,
}

/// Joint between two links of a URDF.
#[derive(Clone, Debug)]
pub(super) struct UrdfJoint {
    pub(super) name: String,
    pub(super) kind: UrdfJointType,
    pub(super) parent: String,
    pub(super) child: String,
    /// Frame of the joint in the frame of its parent link.
    pub(super) origin: Transform,
    /// Unit vector of the axis in the frame of the joint.
    pub(super) axis: Vector3<f64>,
    pub(super) limits: KnownLimits,
    /// Name of the joint whose motion this joint follows; `None` for an independent joint.
    pub(super) mimic: Option<String>,
    pub(super) span: Range<usize>,
}

impl UrdfJoint {
    /// Reads the element `joint` of a URDF.
    pub(super) fn read(node: Node<'_, '_>) -> Result<Self, UrdfError> {
        let name = attribute(node, "name")?.to_owned();
        let kind = kind(node, &name)?;
        let link = |tag| -> Result<String, UrdfError> {
            let missing = || error(node, format!("joint `{name}` has no <{tag} link=\"..\">"));
            let link = child(node, tag).and_then(|end| end.attribute("link"));
            link.map(str::to_owned).ok_or_else(missing)
        };
        Ok(Self {
            kind,
            parent: link("parent")?,
            child: link("child")?,
            origin: child(node, "origin").map_or(Ok(Transform::identity()), origin)?,
            axis: axis(node, &name)?,
            limits: limits(node, kind)?,
            mimic: child(node, "mimic")
                .and_then(|mimic| mimic.attribute("joint"))
                .map(str::to_owned),
            span: node.range(),
            name,
        })
    }
}

fn kind(node: Node<'_, '_>, name: &str) -> Result<UrdfJointType, UrdfError> {
    match attribute(node, "type")? {
        "revolute" => Ok(UrdfJointType::Revolute),
        "continuous" => Ok(UrdfJointType::Continuous),
        "prismatic" => Ok(UrdfJointType::Prismatic),
        "fixed" => Ok(UrdfJointType::Fixed),
        "planar" | "floating" => Ok(UrdfJointType::Free),
        other => {
            let help = "types: revolute, continuous, prismatic, fixed, planar, floating";
            let message = format!("unknown type \"{other}\" of joint `{name}`");
            Err((node.range(), message, Some(help.to_owned())))
        }
    }
}

/// Reads the element `<origin xyz=".." rpy="..">` as a transform; missing attributes are 0.
pub(super) fn origin(node: Node<'_, '_>) -> Result<Transform, UrdfError> {
    let xyz = vector(node, "xyz")?.unwrap_or_default();
    let rpy = vector(node, "rpy")?.unwrap_or_default();
    let [roll, pitch, yaw] = [rpy.x, rpy.y, rpy.z].map(SinCos::from_angle);
    let about_x = Matrix3::new(
        1.0, 0.0, 0.0, 0.0, roll.cos, -roll.sin, 0.0, roll.sin, roll.cos,
    );
    let about_y = Matrix3::new(
        pitch.cos, 0.0, pitch.sin, 0.0, 1.0, 0.0, -pitch.sin, 0.0, pitch.cos,
    );
    let about_z = Matrix3::new(yaw.cos, -yaw.sin, 0.0, yaw.sin, yaw.cos, 0.0, 0.0, 0.0, 1.0);
    let rotation = Rotation3::from_matrix_unchecked(about_z * about_y * about_x);
    Ok(Transform::from_parts(Translation3::from(xyz), rotation))
}

fn axis(node: Node<'_, '_>, name: &str) -> Result<Vector3<f64>, UrdfError> {
    let Some(axis) = child(node, "axis") else {
        return Ok(Vector3::x());
    };
    let given = vector(axis, "xyz")?.unwrap_or(Vector3::x());
    let length = given.norm();
    if length < 1e-9 {
        return Err(error(
            axis,
            format!("the axis of joint `{name}` has no direction"),
        ));
    }
    Ok(given / length)
}

fn limits(node: Node<'_, '_>, kind: UrdfJointType) -> Result<KnownLimits, UrdfError> {
    let Some(limit) = child(node, "limit") else {
        return Ok(KnownLimits::default());
    };
    // A velocity of 0 stands for a limit that the author did not know.
    let positive = |key| Ok(number(limit, key)?.filter(|value| *value > 0.0));
    let is_bounded = kind != UrdfJointType::Continuous;
    // By the specification of URDF, a bound that is left out is 0.
    let bound = |key| Ok(is_bounded.then_some(number(limit, key)?.unwrap_or(0.0)));
    Ok(KnownLimits {
        lower: bound("lower")?,
        upper: bound("upper")?,
        velocity: positive("velocity")?,
        acceleration: positive("acceleration")?,
        jerk: positive("jerk")?,
    })
}

/// Returns the first child element with the name `tag`; `None` if there is none.
pub(super) fn child<'a, 'b>(node: Node<'a, 'b>, tag: &str) -> Option<Node<'a, 'b>> {
    node.children().find(|child| child.has_tag_name(tag))
}

fn attribute<'a>(node: Node<'a, '_>, key: &str) -> Result<&'a str, UrdfError> {
    let missing = || error(node, format!("<{}> has no `{key}`", node.tag_name().name()));
    node.attribute(key).ok_or_else(missing)
}

fn error(node: Node<'_, '_>, message: String) -> UrdfError {
    (node.range(), message, None)
}

/// Reads a finite number from the attribute `key`; `None` if the attribute is missing. An attribute with a namespace
/// prefix, such as `drake:acceleration`, counts if there is none without a prefix.
fn number(node: Node<'_, '_>, key: &str) -> Result<Option<f64>, UrdfError> {
    let named = || {
        node.attributes()
            .filter(|attribute| attribute.name() == key)
    };
    let own = named().find(|attribute| attribute.namespace().is_none());
    let Some(text) = own.or_else(|| named().next()).map(|found| found.value()) else {
        return Ok(None);
    };
    let value = text.trim().parse().ok();
    let value = value.filter(|value: &f64| value.is_finite());
    let bad = || {
        error(
            node,
            format!("`{key}` is \"{text}\", expected a finite number"),
        )
    };
    value.map(Some).ok_or_else(bad)
}

/// Reads three finite numbers from the attribute `key`; `None` if the attribute is missing.
fn vector(node: Node<'_, '_>, key: &str) -> Result<Option<Vector3<f64>>, UrdfError> {
    let Some(text) = node.attribute(key) else {
        return Ok(None);
    };
    let numbers: Result<Vec<f64>, _> = text.split_whitespace().map(str::parse).collect();
    let numbers = numbers.unwrap_or_default();
    match numbers.as_slice() {
        &[x, y, z] if numbers.iter().all(|value| value.is_finite()) => {
            Ok(Some(Vector3::new(x, y, z)))
        }
        _ => {
            let help = Some("write numbers: xacro expressions must be expanded".to_owned());
            let message = format!("`{key}` is \"{text}\", expected three finite numbers");
            Err((node.range(), message, help))
        }
    }
}
