//! The S-R-S arm: seven axes, three of them meeting in the shoulder, one in the elbow, three in the wrist.
//!
//! The elbow can swing about the line from shoulder to wrist without moving the flange; where it stands is the *arm
//! angle*. It is measured about that line, from the side of it that looks up (the base's z) to the elbow, so that it keeps
//! its meaning when the arm moves. For a given arm angle there are eight sets of joints, one for each sign of the bend of
//! shoulder, elbow and wrist.
//!
//! Source of the idea: Shimizu et al., Analytical inverse kinematic computation for 7-DOF redundant manipulators with
//! joint limits, IEEE T-RO 24(5), 2008. The solver works on one canonical chain, `z y z y z y z` (the axes of KUKA's LBR
//! arms with all joints at zero); an arm differs from it by lengths and by the sense in which it counts an axis.
//!
//! - [`geometry`](self): lengths, senses, forward direction;
//! - [`elbow`]: where the elbow stands, from joints or from an arm angle;
//! - [`branches`]: the eight sets of joints for one place of the elbow;
//! - [`swing`]: for which arm angles the joints stay in their ranges;
//! - [`choose`]: which of all those the hint asks for.

pub mod branches;
pub mod choose;
pub mod elbow;
pub mod swing;

use crate::{NoSolution, Transform};
use nalgebra::Vector3;

/// Joint values of a seven-axis arm, in rad.
pub type Joints = [f64; 7];

/// Lengths of the canonical chain and the sense in which the arm counts each axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Geometry {
    /// From the base to the shoulder, along the base's z, in m.
    pub base: f64,
    /// From the shoulder to the elbow, in m.
    pub upper: f64,
    /// From the elbow to the wrist, in m.
    pub fore: f64,
    /// From the wrist to the flange, along the last axis, in m.
    pub hand: f64,
    /// +1 or -1 for each axis: canonical angle = sense * joint value.
    pub sense: Joints,
}

/// How far beyond the outstretched arm a wrist may lie and still count as reached, as an excess of the elbow's cosine.
/// It covers rounding (about 1e-16 m) with room to spare and moves the wrist by less than 1e-9 m.
const REACH_TOLERANCE: f64 = 1e-9;

/// A flange pose as seen from the shoulder: the line to the wrist and the bend of the elbow that spans it.
#[derive(Clone, Copy, Debug)]
pub struct Reach {
    /// The wanted orientation of the flange, in the base.
    pub flange: nalgebra::Matrix3<f64>,
    /// Unit vector from the shoulder to the wrist.
    pub axis: Vector3<f64>,
    /// Cosine and sine (not negative) of the elbow's bend.
    pub bend: crate::angle::SinCos,
    /// Cosine and sine (not negative) of the angle at the shoulder between that line and the upper arm.
    pub lift: crate::angle::SinCos,
}

impl Geometry {
    /// What reaching `flange` (in the base) asks of shoulder and elbow.
    ///
    /// # Errors
    /// [`NoSolution::OutOfReach`] if the wrist lies too far away or too near, [`NoSolution::NotFinite`] for NaN or infinity.
    pub fn reach(&self, flange: &Transform) -> Result<Reach, NoSolution> {
        let rotation = *flange.rotation.matrix();
        let wrist =
            flange.translation.vector - rotation.column(2) * self.hand - Vector3::z() * self.base;
        let distance = libm::sqrt(wrist.norm_squared());
        if !(distance.is_finite() && rotation.iter().all(|entry| entry.is_finite())) {
            return Err(NoSolution::NotFinite);
        }
        let cos = self.elbow_cosine(distance)?;
        let bend = crate::angle::SinCos {
            sin: libm::sqrt((1.0 - cos) * (1.0 + cos)),
            cos,
        };
        // The triangle shoulder, elbow, wrist, with the sides taken from the bend and not from the distance, so that
        // the two angles agree to the last bit with each other even where the arm is straight.
        let (along, across) = (self.upper + self.fore * bend.cos, self.fore * bend.sin);
        let third = libm::sqrt(along * along + across * across);
        if third < REACH_TOLERANCE {
            return Err(NoSolution::OutOfReach);
        }
        let lift = crate::angle::SinCos {
            sin: across / third,
            cos: along / third,
        };
        Ok(Reach {
            flange: rotation,
            axis: wrist / distance,
            bend,
            lift,
        })
    }

    /// The cosine of the elbow's bend that puts the wrist at `distance` from the shoulder (law of cosines).
    fn elbow_cosine(&self, distance: f64) -> Result<f64, NoSolution> {
        let (upper, fore) = (self.upper, self.fore);
        let cos = (distance * distance - upper * upper - fore * fore) / (2.0 * upper * fore);
        if cos.abs() > 1.0 + REACH_TOLERANCE {
            return Err(NoSolution::OutOfReach);
        }
        Ok(cos.clamp(-1.0, 1.0))
    }

    /// Joint values as angles of the canonical chain, or back (a sense is its own inverse).
    #[must_use]
    pub fn counted(&self, joints: &Joints) -> Joints {
        core::array::from_fn(|axis| self.sense[axis] * joints[axis])
    }
}
