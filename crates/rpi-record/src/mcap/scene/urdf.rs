//! Description of the arms of a cell in URDF, the format of ROS (<http://wiki.ros.org/urdf/XML>).

use std::fmt::Write;

use nalgebra::{Rotation3, UnitQuaternion, Vector3};
use rpi_kin::Pose;
use rpi_kin::chain::JointType;

use super::arm_view::{ArmView, WORLD};

/// Radius in m of the cylinders by which the robot description shows the links.
const RADIUS: f64 = 0.04;
/// Length in m up to which a link is shown without a cylinder.
const SHORTEST: f64 = 1e-3;

/// Returns the URDF description of all arms: one robot with the common root frame `world`.
pub(super) fn describe(arms: &[ArmView]) -> String {
    let mut out = "<?xml version=\"1.0\"?>\n<robot name=\"cell\">\n".to_owned();
    link(&mut out, WORLD, &[]);
    for arm in arms {
        describe_arm(&mut out, arm);
    }
    out += "</robot>\n";
    out
}

fn describe_arm(out: &mut String, arm: &ArmView) {
    fixed(out, (WORLD, &arm.base()), &arm.spec.base);
    let count = arm.axes.len();
    let flange_at_zero = arm.spec.model.forward(&vec![0.0; count]);
    let end = flange_at_zero.translation.vector;
    link(out, &arm.base(), &[arm.point(0)]);
    let mut parent = (arm.base(), Vector3::zeros());
    for k in 0..count {
        let (name, point) = (arm.link_name(k), arm.point(k));
        let next = if k + 1 < count { arm.point(k + 1) } else { end };
        joint(out, arm, k, (&parent.0, &(point - parent.1)));
        link(out, &name, &[next - point]);
        parent = (name, point);
    }
    let origin = parent.1;
    let flange = Pose::translation(-origin.x, -origin.y, -origin.z) * flange_at_zero;
    fixed(out, (&parent.0, &arm.flange()), &flange);
    link(out, &arm.flange(), &[]);
    fixed(out, (&arm.flange(), &arm.tool()), &arm.spec.tool);
    link(out, &arm.tool(), &[]);
}

/// Appends a URDF link with this name to `out`, with a cylinder from its origin to each of the points `ends`, in m.
fn link(out: &mut String, name: &str, ends: &[Vector3<f64>]) {
    // Writing to a string cannot fail.
    let _ = write!(out, "  <link name=\"{}\">", escaped(name));
    for end in ends.iter().filter(|end| end.norm() > SHORTEST) {
        let turn = Rotation3::rotation_between(&Vector3::z(), end);
        let turn = turn.unwrap_or_else(|| {
            Rotation3::from_axis_angle(&Vector3::x_axis(), core::f64::consts::PI)
        });
        let middle = Pose::from_parts(
            (end / 2.0).into(),
            UnitQuaternion::from_rotation_matrix(&turn),
        );
        let length = end.norm();
        let _ = write!(
            out,
            "<visual>{}<geometry><cylinder radius=\"{RADIUS}\" length=\"{length}\"/></geometry></visual>",
            origin(&middle)
        );
    }
    *out += "</link>\n";
}

fn joint(out: &mut String, arm: &ArmView, k: usize, (parent, at): (&str, &Vector3<f64>)) {
    let Some((limits, kind)) = arm.limits(k) else {
        return;
    };
    let kind = match kind {
        JointType::Revolute => "revolute",
        JointType::Prismatic => "prismatic",
    };
    let axis = arm.axes[k].direction;
    let (lower, upper) = (limits.position.lower, limits.position.upper);
    let _ = writeln!(
        out,
        "  <joint name=\"{}\" type=\"{kind}\"><parent link=\"{}\"/><child link=\"{}\"/>{}<axis xyz=\"{} {} {}\"/>\
         <limit lower=\"{lower}\" upper=\"{upper}\" velocity=\"{}\" effort=\"0\"/></joint>",
        escaped(&arm.joint_name(k)),
        escaped(parent),
        escaped(&arm.link_name(k)),
        origin(&Pose::translation(at.x, at.y, at.z)),
        axis.x,
        axis.y,
        axis.z,
        limits.velocity,
    );
}

fn fixed(out: &mut String, (parent, child): (&str, &str), pose: &Pose) {
    let _ = writeln!(
        out,
        "  <joint name=\"{0}_fixed\" type=\"fixed\"><parent link=\"{1}\"/><child link=\"{0}\"/>{2}</joint>",
        escaped(child),
        escaped(parent),
        origin(pose)
    );
}

/// Returns a URDF element with a pose: position in m, rotation as roll, pitch and yaw in rad.
fn origin(pose: &Pose) -> String {
    let (roll, pitch, yaw) = pose.rotation.euler_angles();
    let at = pose.translation;
    format!(
        "<origin xyz=\"{} {} {}\" rpy=\"{roll} {pitch} {yaw}\"/>",
        at.x, at.y, at.z
    )
}

/// Returns a name with the characters escaped that XML reserves.
fn escaped(name: &str) -> String {
    let name = name.replace('&', "&amp;").replace('<', "&lt;");
    name.replace('>', "&gt;").replace('"', "&quot;")
}
