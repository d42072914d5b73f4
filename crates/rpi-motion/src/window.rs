//! Joints at equal distances on a path, from which the derivatives at a node are taken.

use crate::joint_path::JointPath;
use crate::path::Path;
use crate::path_error::{PathError, PathErrorKind};
use crate::{Arm, Joints};

/// Maximum difference between the inverse kinematics halfway between two nodes and the cubic through four nodes, rad.
/// With larger differences, the nodes must be closer.
const RESOLUTION: f64 = 1e-8;

/// Maximum distance between nodes on a path of the tool, m.
const WIDEST: f64 = 2e-3;
/// Minimum distance between nodes on a path of the tool, m. A path that needs closer nodes is rejected.
const FINEST: f64 = WIDEST / 512.0;

/// Number of successive nodes with far smaller differences than needed, after which the distance of the nodes is
/// doubled.
const CALM_NODES: u32 = 16;

/// Joint positions at six equally spaced places of a path, at the offsets -2 to 3 (in spacings) from the place of the
/// next node. Finite differences of them give the derivatives at the node.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Window {
    pub(crate) joints: [Joints; 6],
    pub(crate) spacing: f64,
    /// Position along the path (path parameter) of the next node, at offset 0, m.
    pub(crate) centre: f64,
    widest: f64,
    finest: f64,
    /// Number of successive nodes so far at which the path was resolved far better than needed.
    calm: u32,
    /// True if the joint positions are known; false while they could not be computed at this spacing.
    is_filled: bool,
    /// Error because of which the spacing was reduced; `None` if it was reduced only because the path bends.
    cause: Option<PathError>,
}

impl Window {
    /// Computes the window around the start of a path, near to the joint positions `start` (rad), with a spacing that
    /// resolves the path.
    pub(crate) fn first(arm: &Arm, path: &JointPath, start: &Joints) -> Result<Self, PathError> {
        let length = path.path.length();
        let widest = widest_spacing(&path.path);
        let mut window = Self {
            spacing: widest,
            widest,
            finest: FINEST.min(length / 1024.0),
            ..Self::default()
        };
        // The first node is a place where motions begin: its derivatives must be exact from the beginning.
        while let Err(cause) = window.fill_resolved(arm, path, start) {
            window.halve_spacing(cause)?;
        }
        Ok(window)
    }

    /// Creates the window of a path without length: all joint positions are `at` (rad).
    pub(crate) fn still(at: &Joints) -> Self {
        Self {
            joints: [*at; 6],
            spacing: 1.0,
            ..Self::default()
        }
    }

    /// Returns the joint positions (rad) of the place in the window that is nearest to the position `s` along the path.
    pub(crate) fn nearest(&self, s: f64) -> &Joints {
        let offset = libm::rint((s - self.centre) / self.spacing).clamp(-2.0, 3.0);
        &self.joints[(offset + 2.0) as usize]
    }

    /// Returns the position along the path of the last place in the window (m; rad on a joint line).
    pub(crate) fn end(&self) -> f64 {
        self.centre + 3.0 * self.spacing
    }

    /// Moves the window by one node and returns true. Returns false if it reduced the spacing instead: a jump or a
    /// missing solution may lie between the places, so a finer spacing is tried before the error is returned.
    pub(crate) fn advance(&mut self, arm: &Arm, path: &JointPath) -> Result<bool, PathError> {
        let (added, difference) = match self.next_joints(arm, path) {
            Ok(next) => next,
            Err(cause) => {
                let here = self.joints[2];
                self.halve_spacing(cause)?;
                // While the window cannot be filled, the spacing is halved again in the next step.
                self.is_filled = self.fill(arm, path, &here).is_ok();
                return Ok(false);
            }
        };
        let [_, rest @ ..] = self.joints;
        let [a, b, c, d, e] = rest;
        self.joints = [a, b, c, d, e, added];
        self.centre += self.spacing;
        self.cause = None;
        let calm = difference * 64.0 < RESOLUTION;
        self.calm = if calm { self.calm + 1 } else { 0 };
        if self.calm > CALM_NODES && self.spacing < self.widest {
            self.double_spacing(arm, path);
        }
        Ok(true)
    }

    /// Returns the joint positions (rad) at the place after the window, and the difference (rad) of the inverse
    /// kinematics from a cubic there.
    fn next_joints(&self, arm: &Arm, path: &JointPath) -> Result<(Joints, f64), PathError> {
        if !self.is_filled {
            return Err(self.unresolved(path, self.fastest_axis(arm)));
        }
        let [_, _, _, one, two, three] = &self.joints;
        let guess = extrapolated(two, three);
        let added = path.joints_at(arm, self.centre + 4.0 * self.spacing, &guess)?;
        let (difference, axis) = match path.path {
            Path::Joints(_) => (0.0, 0),
            Path::Tool(_) => self.bending(arm, path, 2.5, [one, two, three, &added])?,
        };
        let is_resolved = self.spacing <= path.path.resolution(self.centre + 2.0 * self.spacing);
        match difference <= RESOLUTION && is_resolved {
            true => Ok((added, difference)),
            false => Err(self.unresolved(path, axis)),
        }
    }

    fn unresolved(&self, path: &JointPath, axis: usize) -> PathError {
        let s = self.centre + 2.5 * self.spacing;
        path.error_at(s, PathErrorKind::Unresolved { axis })
    }

    /// Returns the axis (from 0) that turns fastest at the last known places.
    fn fastest_axis(&self, arm: &Arm) -> usize {
        let [.., before, last] = &self.joints;
        let way = |axis: &usize| (last[*axis] - before[*axis]).abs();
        let axes = 0..arm.axes();
        axes.max_by(|one, other| way(one).total_cmp(&way(other)))
            .unwrap_or(0)
    }

    fn fill_resolved(
        &mut self,
        arm: &Arm,
        path: &JointPath,
        near: &Joints,
    ) -> Result<(), PathError> {
        self.fill(arm, path, near)?;
        if let Path::Joints(_) = path.path {
            return Ok(());
        }
        for (k, four) in self.joints.windows(4).enumerate() {
            let [one, two, three, last] = four else {
                continue;
            };
            let offset = k as f64 - 0.5;
            let (difference, axis) = self.bending(arm, path, offset, [one, two, three, last])?;
            if difference > RESOLUTION {
                return Err(self.unresolved(path, axis));
            }
        }
        Ok(())
    }

    /// Returns the largest difference of an axis (rad) between the inverse kinematics at `offset` spacings from the
    /// centre and the cubic through the four given joint positions, halfway between the second and the third of them;
    /// and this axis, from 0.
    fn bending(
        &self,
        arm: &Arm,
        path: &JointPath,
        offset: f64,
        [one, two, three, last]: [&Joints; 4],
    ) -> Result<(f64, usize), PathError> {
        let s = self.centre + offset * self.spacing;
        let middle = path.joints_at(arm, s, two)?;
        let off = |axis: usize| {
            let cubic = (9.0 * (two[axis] + three[axis]) - one[axis] - last[axis]) / 16.0;
            (cubic - middle[axis]).abs()
        };
        let differences = (0..arm.axes()).map(|axis| (off(axis), axis));
        let largest = differences.max_by(|one, other| one.0.total_cmp(&other.0));
        Ok(largest.unwrap_or_default())
    }

    /// Halves the spacing because of the error `cause`; returns an error if the spacing is already the finest.
    fn halve_spacing(&mut self, cause: PathError) -> Result<(), PathError> {
        let cause = self.cause.unwrap_or(cause);
        let finer = self.spacing / 2.0;
        if finer < self.finest {
            return Err(cause);
        }
        if !matches!(cause.kind, PathErrorKind::Unresolved { .. }) {
            self.cause = Some(cause);
        }
        self.spacing = finer;
        self.calm = 0;
        Ok(())
    }

    /// Doubles the spacing after the last node, if the joint positions of the path can be computed with it.
    fn double_spacing(&mut self, arm: &Arm, path: &JointPath) {
        let before = *self;
        let last = before.joints[1];
        self.spacing = 2.0 * before.spacing;
        self.centre = before.centre + before.spacing;
        self.calm = 0;
        if self.fill(arm, path, &last).is_err() {
            *self = before;
        }
    }

    /// Computes the joint positions at all places of the window, beginning near to `near` (rad) at its centre.
    fn fill(&mut self, arm: &Arm, path: &JointPath, near: &Joints) -> Result<(), PathError> {
        let place = |offset: f64| self.centre + offset * self.spacing;
        let here = path.joints_at(arm, place(0.0), near)?;
        let mut joints = [here; 6];
        let mut hint = here;
        for back in 1..=2usize {
            hint = path.joints_at(arm, place(-(back as f64)), &hint)?;
            joints[2 - back] = hint;
        }
        hint = here;
        for ahead in 1..=3usize {
            hint = path.joints_at(arm, place(ahead as f64), &hint)?;
            joints[2 + ahead] = hint;
        }
        self.joints = joints;
        self.is_filled = true;
        Ok(())
    }
}

/// Returns the widest spacing of nodes on a path: m, or rad on a joint line.
pub(crate) fn widest_spacing(path: &Path) -> f64 {
    match path {
        Path::Tool(_) => WIDEST.min(path.length() / 16.0),
        Path::Joints(_) => path.length() / 16.0,
    }
}

fn extrapolated(before: &Joints, last: &Joints) -> Joints {
    core::array::from_fn(|axis| 2.0 * last[axis] - before[axis])
}
