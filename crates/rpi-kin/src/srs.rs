//! Arms with spherical shoulder, revolute elbow and spherical wrist (S-R-S): seven axes.
//!
//! The elbow can move on a circle about the line from shoulder to wrist without moving the flange. Its position on the
//! circle is the *arm angle*. It is measured about that line, from the direction on the circle nearest to z of the base
//! frame, so that it keeps its meaning when the arm moves. For a given arm angle there are eight solutions, one for
//! each combination of signs of the bends of shoulder, elbow and wrist.
//!
//! Source of the method: Shimizu et al., Analytical inverse kinematic computation for 7-DOF redundant manipulators with
//! joint limits, IEEE T-RO 24(5), 2008. The solver uses one canonical chain, `z y z y z y z` (the axes of the KUKA LBR
//! arms with all joints at zero). An arm differs from it in its lengths and in the sense of each axis.
//!
//! - [`geometry`](self): lengths, senses, elbow and shoulder angles of a pose;
//! - [`elbow`]: position of the elbow, from joints or from an arm angle;
//! - [`branches`]: the eight solutions for one position of the elbow;
//! - [`arm_angle_limits`]: arm angles at which a joint is at a limit of its range;
//! - [`selection`]: choice among all solutions by a hint.

pub mod arm_angle_limits;
pub mod branches;
pub mod elbow;
pub mod selection;

use crate::{InverseKinematicsError, Transform};
use nalgebra::Vector3;

/// Joint values of a seven-axis arm, in rad.
pub type Joints = [f64; 7];

/// Lengths of an S-R-S arm, and the sense of each axis. Canonical angles, with which the solver computes, are the joint
/// values in the senses of the chain `z y z y z y z`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Geometry {
    /// Distance from the base to the shoulder along z of the base frame, in m.
    pub base: f64,
    /// Distance from the shoulder to the elbow, in m.
    pub upper: f64,
    /// Distance from the elbow to the wrist, in m.
    pub fore: f64,
    /// Distance from the wrist to the flange along the last axis, in m.
    pub hand: f64,
    /// For each axis, +1 or -1: canonical angle = sense * joint value.
    pub sense: Joints,
}

/// Tolerance by which rounding may raise the cosine of the bend of the elbow above 1, for a wrist beyond the
/// outstretched arm (no unit). It covers rounding and moves the wrist by less than 1e-9 m.
const REACH_TOLERANCE: f64 = 1e-9;

/// Triangle of shoulder, elbow and wrist of an S-R-S arm for a pose of the flange: the line from shoulder to wrist, and
/// the angles of the arm.
#[derive(Clone, Copy, Debug)]
pub struct ElbowTriangle {
    /// Orientation of the flange in the base frame, as a rotation matrix.
    pub flange_rotation: nalgebra::Matrix3<f64>,
    /// Unit vector from the shoulder to the wrist, in the base frame.
    pub line: Vector3<f64>,
    /// Cosine and sine of the angle between upper arm and forearm, 0 for a straight arm; the sine is not negative.
    pub elbow_bend: crate::angle::SinCos,
    /// Cosine and sine of the angle at the shoulder between the line to the wrist and the upper arm; the sine is not
    /// negative.
    pub shoulder_angle: crate::angle::SinCos,
}

impl Geometry {
    /// Returns the triangle of shoulder, elbow and wrist for a pose of the flange in the base frame.
    ///
    /// # Errors
    /// [`InverseKinematicsError::OutOfReach`] if the wrist is too far from the shoulder or too near to it,
    /// [`InverseKinematicsError::NotFinite`] if the pose is NaN or infinite.
    pub fn elbow_triangle(
        &self,
        flange: &Transform,
    ) -> Result<ElbowTriangle, InverseKinematicsError> {
        let rotation = *flange.rotation.matrix();
        let wrist =
            flange.translation.vector - rotation.column(2) * self.hand - Vector3::z() * self.base;
        let distance = libm::sqrt(wrist.norm_squared());
        if !(distance.is_finite() && rotation.iter().all(|entry| entry.is_finite())) {
            return Err(InverseKinematicsError::NotFinite);
        }
        let cos = self.elbow_cosine(distance)?;
        let bend = crate::angle::SinCos {
            sin: libm::sqrt((1.0 - cos) * (1.0 + cos)),
            cos,
        };
        // The triangle shoulder, elbow, wrist. Its sides are computed from the bend and not from the distance, so that
        // both angles are consistent to the last bit even for a straight arm.
        let (along, across) = (self.upper + self.fore * bend.cos, self.fore * bend.sin);
        let third = libm::sqrt(along * along + across * across);
        if third < REACH_TOLERANCE {
            return Err(InverseKinematicsError::OutOfReach);
        }
        let lift = crate::angle::SinCos {
            sin: across / third,
            cos: along / third,
        };
        Ok(ElbowTriangle {
            flange_rotation: rotation,
            line: wrist / distance,
            elbow_bend: bend,
            shoulder_angle: lift,
        })
    }

    /// Returns the cosine of the bend of the elbow (0 for a straight arm) for which the wrist has this distance (m)
    /// from the shoulder (law of cosines). The error is [`InverseKinematicsError::OutOfReach`] if there is none.
    fn elbow_cosine(&self, distance: f64) -> Result<f64, InverseKinematicsError> {
        let (upper, fore) = (self.upper, self.fore);
        let cos = (distance * distance - upper * upper - fore * fore) / (2.0 * upper * fore);
        if cos.abs() > 1.0 + REACH_TOLERANCE {
            return Err(InverseKinematicsError::OutOfReach);
        }
        Ok(cos.clamp(-1.0, 1.0))
    }

    /// Converts joint values to canonical angles (the angles of the chain `z y z y z y z`), or back; the conversion is
    /// its own inverse.
    #[must_use]
    pub fn apply_sense(&self, joints: &Joints) -> Joints {
        core::array::from_fn(|axis| self.sense[axis] * joints[axis])
    }
}
