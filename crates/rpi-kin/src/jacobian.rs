//! Geometric Jacobian: the velocity of a point of the last link for given joint velocities.

use crate::Chain;
use crate::chain::JointType;
use nalgebra::{SMatrix, Vector3};

/// Returns the geometric Jacobian: linear velocity (rows 0 to 2, m/s) of `point` and angular velocity (rows 3 to 5,
/// rad/s) of the last link per unit velocity of each joint, in base coordinates. `point` is given in the base frame, in
/// m: the origin of the flange or of a tool.
///
/// `N` is the number of joints. Columns beyond the joints of the chain are zero. Source: Siciliano, Sciavicco, Villani,
/// Oriolo, Robotics (2009), section 3.1.
#[must_use]
pub fn geometric<const N: usize>(
    chain: &Chain,
    q: &[f64; N],
    point: &Vector3<f64>,
) -> SMatrix<f64, 6, N> {
    let mut jacobian = SMatrix::<f64, 6, N>::zeros();
    for (axis, mut column) in chain.axes_in_base(q).zip(jacobian.column_iter_mut()) {
        let (linear, angular) = match axis.joint {
            JointType::Revolute => (axis.direction.cross(&(point - axis.point)), axis.direction),
            JointType::Prismatic => (axis.direction, Vector3::zeros()),
        };
        column.copy_from_slice(&[
            linear.x, linear.y, linear.z, angular.x, angular.y, angular.z,
        ]);
    }
    jacobian
}
