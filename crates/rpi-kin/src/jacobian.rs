//! The geometric Jacobian: how the joints' velocities move a point of the last link.

use crate::Chain;
use crate::chain::Joint;
use nalgebra::{SMatrix, Vector3};

/// Linear velocity (rows 0 to 2, m/s) of `point` and angular velocity (rows 3 to 5, rad/s) of the last link, both in base
/// coordinates, for each joint's unit velocity. `point` is given in the base, in m: the flange's origin, or a tool's.
///
/// `N` is the number of joints; columns beyond the chain's joints are zero.
/// Source: Siciliano, Sciavicco, Villani, Oriolo, Robotics (2009), section 3.1.
#[must_use]
pub fn geometric<const N: usize>(
    chain: &Chain,
    q: &[f64; N],
    point: &Vector3<f64>,
) -> SMatrix<f64, 6, N> {
    let mut jacobian = SMatrix::<f64, 6, N>::zeros();
    for (axis, mut column) in chain.axes_in_base(q).zip(jacobian.column_iter_mut()) {
        let (linear, angular) = match axis.joint {
            Joint::Turns => (axis.direction.cross(&(point - axis.point)), axis.direction),
            Joint::Slides => (axis.direction, Vector3::zeros()),
        };
        column.copy_from_slice(&[
            linear.x, linear.y, linear.z, angular.x, angular.y, angular.z,
        ]);
    }
    jacobian
}
