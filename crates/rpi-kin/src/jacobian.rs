//! Geometric Jacobian: the velocity of a point of the last link for given joint velocities.

use crate::Chain;
use crate::chain::JointType;
use crate::model::MAX_AXES;
use nalgebra::{SMatrix, Vector3, Vector6};

/// Returns the geometric Jacobian at the joint values `q` (rad, m): linear velocity (rows 0 to 2, m/s) of `point` and
/// angular velocity (rows 3 to 5, rad/s) of the last link per unit velocity of each joint, in base coordinates. `point`
/// is given in the base frame, in m: the origin of the flange or of a tool.
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

/// Maximum number of iterations of the singular value decomposition. It usually takes two for each value.
const MOST_ITERATIONS: usize = 64;

/// Returns the distance of an arm from its nearest singularity: the smallest singular value of its Jacobian at the joint
/// values `q` (rad, m), with all lengths in shares of the length of the chain, so that it has no unit. At a singularity, where
/// the last link cannot move in some direction, it is 0. `point` and `N` are as in [`geometric`].
///
/// A chain with fewer than six joints never moves its last link in all directions: only as many values as there are joints
/// count. NaN if a joint value is not finite. Source: Klein, Blaho, Dexterity measures for the design and control of
/// kinematically redundant manipulators, International Journal of Robotics Research 6 (1987).
#[must_use]
pub fn distance_to_singularity<const N: usize>(
    chain: &Chain,
    q: &[f64; N],
    point: &Vector3<f64>,
) -> f64 {
    let mut jacobian = geometric(chain, q, point);
    let length = chain.length();
    for (link, mut column) in chain.links.iter().zip(jacobian.column_iter_mut()) {
        // The joint value of a prismatic joint is a length, too.
        if link.joint == JointType::Revolute && length > 0.0 {
            let mut linear = column.fixed_rows_mut::<3>(0);
            linear /= length;
        }
    }
    if jacobian.iter().any(|entry| !entry.is_finite()) {
        return f64::NAN;
    }
    // The singular values of the Jacobian are those of the square matrix to which columns of zeros are added.
    let mut square = SMatrix::<f64, MAX_AXES, MAX_AXES>::zeros();
    for (from, mut to) in jacobian.column_iter().zip(square.column_iter_mut()) {
        to.fixed_rows_mut::<6>(0).copy_from(&from);
    }
    let found = square.try_svd_unordered(false, false, f64::EPSILON, MOST_ITERATIONS);
    let Some(mut values) = found.map(|found| found.singular_values) else {
        return f64::NAN;
    };
    let values = values.as_mut_slice();
    values.sort_unstable_by(|one, other| other.total_cmp(one));
    let count = chain.axes().clamp(1, 6);
    values[count - 1]
}

/// Returns the part of the acceleration of `point` that is due to the joint velocities alone: linear (m/s²), then
/// angular (rad/s²), in base coordinates. The whole acceleration is `geometric(...) * a` plus this part, where `a` are
/// the joint accelerations. `point` and `N` are as in [`geometric`].
///
/// The part is the product of the time derivative of the Jacobian and the joint velocities. Source: Siciliano,
/// Sciavicco, Villani, Oriolo, Robotics (2009), section 3.6.
#[must_use]
pub fn velocity_product<const N: usize>(
    chain: &Chain,
    q: &[f64; N],
    velocities: &[f64; N],
    point: &Vector3<f64>,
) -> Vector6<f64> {
    let tool = geometric(chain, q, point) * SMatrix::<f64, N, 1>::from(*velocities);
    let tool = tool.fixed_rows::<3>(0).into_owned();
    // Velocity of the link before the axis: of its point at `at`, and angular.
    let (mut at, mut linear, mut angular) = (Vector3::zeros(), Vector3::zeros(), Vector3::zeros());
    let mut product = Vector6::zeros();
    for (axis, rate) in chain.axes_in_base(q).zip(velocities) {
        linear += angular.cross(&(axis.point - at));
        at = axis.point;
        let turning = angular.cross(&axis.direction);
        let column = match axis.joint {
            JointType::Revolute => {
                turning.cross(&(point - at)) + axis.direction.cross(&(tool - linear))
            }
            JointType::Prismatic => turning,
        };
        let mut top = product.fixed_rows_mut::<3>(0);
        top += column * *rate;
        match axis.joint {
            JointType::Revolute => {
                let mut bottom = product.fixed_rows_mut::<3>(3);
                bottom += turning * *rate;
                angular += axis.direction * *rate;
            }
            JointType::Prismatic => linear += axis.direction * *rate,
        }
    }
    product
}
