//! Poses in descriptions: a position, and an orientation as roll, pitch and yaw or as a quaternion.

use super::quantity::Dimension::{Angle, Length, Number};
use super::reader::TableReader;
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};

/// Reads a pose: `{ position = [x, y, z], rpy = [roll, pitch, yaw] }`, or the same with `quaternion = [x, y, z, w]`.
/// Missing parts are 0.
pub(super) fn read_pose_at(reader: &mut TableReader<'_>, key: &'static str) -> Isometry3<f64> {
    let Some(mut table) = reader.table(key) else {
        return Isometry3::identity();
    };
    let pose = read_pose(&mut table);
    table.finish();
    pose
}

/// Reads the keys of a pose: `position`, and `rpy` or `quaternion`. Missing parts are 0.
pub(super) fn read_pose(pose: &mut TableReader<'_>) -> Isometry3<f64> {
    let position = pose
        .reals("position", Length, 3)
        .unwrap_or_else(|| vec![0.0; 3]);
    let rpy = pose.reals("rpy", Angle, 3);
    let quaternion = pose.reals("quaternion", Number, 4);
    if rpy.is_some() && quaternion.is_some() {
        pose.error_at(
            "rpy",
            "`rpy` and `quaternion` cannot be combined".to_owned(),
            None,
        );
    }
    let rotation = match (rpy.as_deref(), quaternion.as_deref()) {
        (Some([roll, pitch, yaw]), _) => from_rpy(*roll, *pitch, *yaw),
        (_, Some([x, y, z, w])) => checked_unit_quaternion(pose, Quaternion::new(*w, *x, *y, *z)),
        _ => UnitQuaternion::identity(),
    };
    Isometry3::from_parts(
        Translation3::new(position[0], position[1], position[2]),
        rotation,
    )
}

/// Returns the rotation `Rz(yaw) Ry(pitch) Rx(roll)` for angles in rad, with the same bits on every machine.
fn from_rpy(roll: f64, pitch: f64, yaw: f64) -> UnitQuaternion<f64> {
    let about = |angle: f64, x: f64, y: f64, z: f64| {
        let (sin, cos) = rpi_math::sincos(angle / 2.0);
        UnitQuaternion::new_unchecked(Quaternion::new(cos, x * sin, y * sin, z * sin))
    };
    about(yaw, 0.0, 0.0, 1.0) * about(pitch, 0.0, 1.0, 0.0) * about(roll, 1.0, 0.0, 0.0)
}

fn checked_unit_quaternion(
    reader: &TableReader<'_>,
    quaternion: Quaternion<f64>,
) -> UnitQuaternion<f64> {
    let length = quaternion.norm();
    if (length - 1.0).abs() > 1e-3 {
        let message = format!("`quaternion` has length {length:.4}, expected 1");
        let help = "the order is x, y, z, w".to_owned();
        reader.error_at("quaternion", message, Some(help));
        return UnitQuaternion::identity();
    }
    UnitQuaternion::new_unchecked(quaternion / length)
}
