//! Arms by the lengths of their ortho-parallel basis and spherical wrist (OPW).

use super::kinematics::{Joint, Kinematics, Row};
use crate::cell::quantity::Dimension::{Angle, Length, Number};
use crate::cell::reader::TableReader;
use rpi_kin::chain::JointType;
use rpi_kin::opw::Geometry;
use rpi_kin::{Convention, InverseKinematics};

/// Reads the table `opw`, kinematics of a six-axis arm by its lengths. The keys have the meaning of the published
/// parameter files of ROS-Industrial: the angle of an axis, zero in the upright position, is `sign * joint - offset`.
pub(super) fn read(table: &mut TableReader<'_>) -> Option<Kinematics> {
    let mut length = |key| table.real(key, Length).unwrap_or(0.0);
    let [a1, a2, b] = [length("a1"), length("a2"), length("b")];
    let [c1, c2, c3, c4] = [length("c1"), length("c2"), length("c3"), length("c4")];
    let sense = super::dh::signs(table, 6)?;
    let offset = table.reals("offset", Angle, 6).unwrap_or(vec![0.0; 6]);
    for (key, length) in [("c2", c2), ("c3", c3)] {
        if length <= 0.0 {
            let help = Some("the lengths of upper arm and forearm are in m".to_owned());
            let message = format!("`{key}` is {length} m, expected more than 0 m");
            table.error_at(key, message, help);
            return None;
        }
    }
    let geometry = Geometry {
        a1,
        a2,
        b,
        c1,
        c2,
        c3,
        c4,
        sense: core::array::from_fn(|axis| sense[axis]),
        offset: core::array::from_fn(|axis| 0.0 - offset[axis]),
    };
    let joint = |axis: usize| Joint::new(format!("axis {}", axis + 1), JointType::Revolute);
    Some(Kinematics {
        convention: Convention::Standard,
        rows: geometry.links().into_iter().map(Row::new).collect(),
        flange: Vec::new(),
        joints: (0..6).map(joint).collect(),
        inverse: Some(InverseKinematics::Opw(geometry)),
        meshes: Vec::new(),
        name: None,
    })
}

/// Dimension of the key `sign` (1 or -1), which is a number without a unit.
pub(super) const SIGN: crate::cell::quantity::Dimension = Number;
