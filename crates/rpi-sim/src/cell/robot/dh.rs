//! Arms by a Denavit-Hartenberg table.

use super::kinematics::{Joint, Kinematics, Row};
use super::opw::SIGN;
use crate::cell::pose::read_pose_at;
use crate::cell::quantity::Dimension::{Angle, Length};
use crate::cell::reader::TableReader;
use crate::cell::shape::ListLength;
use rpi_kin::chain::{JointType, LinkTwist};
use rpi_kin::{Convention, Link, MAX_AXES, Transform, to_transform};

const CONVENTIONS: &[&str] = &["standard", "modified"];
const JOINT_TYPES: &[&str] = &["revolute", "prismatic"];

/// Reads the table `dh`, kinematics as a Denavit-Hartenberg table: `convention`, one row for each joint, and fixed
/// transforms at both ends.
pub(super) fn read(table: &mut TableReader<'_>) -> Option<Kinematics> {
    let convention = match table.keyword("convention", CONVENTIONS) {
        Some("modified") => Convention::Modified,
        _ => Convention::Standard,
    };
    let help = "write \"standard\" (1955) or \"modified\" (Craig)";
    table.require("convention", help);
    let base = read_transform(table, "base");
    let count = ListLength {
        least: 1,
        most: Some(MAX_AXES),
    };
    let help = format!("an arm has 1 to {MAX_AXES} axes, each with a row");
    let rows = table.tables_within("joints", count, &help);
    table.require("joints", &help);
    let flange = table.tables("flange");
    let end = read_transform(table, "end");
    let rows: Vec<_> = rows?.into_iter().map(read_row).collect();
    if rows.is_empty() {
        return None;
    }
    let (mut rows, joints): (Vec<Row>, Vec<Joint>) = rows.into_iter().unzip();
    rows[0].before = base;
    let names = |(axis, joint): (usize, Joint)| match joint.name.is_empty() {
        true => Joint {
            name: format!("axis {}", axis + 1),
            ..joint
        },
        false => joint,
    };
    let mut flange: Vec<Row> = flange.into_iter().map(read_fixed_row).collect();
    let end = end.map(|end| Row::placed(end, JointType::Revolute));
    flange.extend(end);
    Some(Kinematics {
        convention,
        inverse: super::closed_form::of_table(convention, &rows, &flange),
        rows,
        flange,
        joints: joints.into_iter().enumerate().map(names).collect(),
        meshes: Vec::new(),
        name: None,
    })
}

/// Reads a pose as a transform; `None` if the key is missing or the pose is the identity.
fn read_transform(table: &mut TableReader<'_>, key: &'static str) -> Option<Transform> {
    let pose = read_pose_at(table, key);
    (pose != rpi_kin::Pose::identity()).then(|| to_transform(&pose))
}

fn read_row(mut table: TableReader<'_>) -> (Row, Joint) {
    let name = table.text("name").unwrap_or_default().to_owned();
    let kind = match table.keyword("type", JOINT_TYPES) {
        Some("prismatic") => JointType::Prismatic,
        _ => JointType::Revolute,
    };
    let offset = table.real("offset", Angle).unwrap_or(0.0);
    let sign = table.real("sign", SIGN).unwrap_or(1.0);
    check_sign(&table, sign);
    let link = Link {
        joint: kind,
        ..lengths(&mut table).with_sense(sign, offset)
    };
    table.finish();
    (Row::new(link), Joint::new(name, kind))
}

fn read_fixed_row(mut table: TableReader<'_>) -> Row {
    let theta = table.real("theta", Angle).unwrap_or(0.0);
    let link = lengths(&mut table).with_sense(1.0, theta);
    table.finish();
    Row::new(link)
}

fn lengths(table: &mut TableReader<'_>) -> Link {
    let a = table.real("a", Length).unwrap_or(0.0);
    let alpha = table.real("alpha", Angle).unwrap_or(0.0);
    let d = table.real("d", Length).unwrap_or(0.0);
    Link::new(a, LinkTwist::from_angle(alpha), d)
}

/// Reads the key `sign`: +1 or -1 for each of `count` axes; all +1 if it is missing. `None` after an error.
pub(super) fn signs(table: &mut TableReader<'_>, count: usize) -> Option<Vec<f64>> {
    let signs = table.reals("sign", SIGN, count).unwrap_or(vec![1.0; count]);
    let good = signs.iter().all(|sign| check_sign(table, *sign));
    good.then_some(signs)
}

fn check_sign(table: &TableReader<'_>, sign: f64) -> bool {
    let good = sign == 1.0 || sign == -1.0;
    if !good {
        let help = Some("-1 if the vendor counts the other way round".to_owned());
        table.error_at("sign", format!("`sign` is {sign}, expected 1 or -1"), help);
    }
    good
}
