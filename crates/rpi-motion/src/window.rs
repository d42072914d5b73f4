//! Joints at equal distances on a path, from which the derivatives at a node are taken.

use crate::joint_path::JointPath;
use crate::path::Path;
use crate::path_error::{PathError, PathErrorKind};
use crate::{Arm, Joints};

/// Greatest difference between the inverse half-way between two nodes and the cubic through four nodes, rad.
const RESOLUTION: f64 = 1e-8;

/// Widest spacing of nodes on a path of the tool, m, followed by the finest, below which the path is rejected.
const WIDEST: f64 = 2e-3;
const FINEST: f64 = WIDEST / 512.0;

/// Nodes that must be much better resolved than needed before the spacing is doubled.
const CALM_NODES: u32 = 16;

/// Joints at six successive places of a path, at the offsets -2 to 3 (in spacings) from the next node. Finite
/// differences over them give the derivatives of the node.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Window {
    pub(crate) joints: [Joints; 6],
    pub(crate) spacing: f64,
    /// Path parameter of offset 0.
    pub(crate) centre: f64,
    widest: f64,
    finest: f64,
    /// Number of nodes in a row for which the path was much better resolved than needed.
    calm: u32,
    /// False while the joints could not be computed at this spacing.
    is_filled: bool,
    /// Error that made the present stretch finer; `None` if only the bending of the path did.
    cause: Option<PathError>,
}

impl Window {
    /// Fills the window around the start of a path, near to the joints `start`.
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

    /// Creates the window of a path without length: all joints are equal.
    pub(crate) fn still(at: &Joints) -> Self {
        Self {
            joints: [*at; 6],
            spacing: 1.0,
            ..Self::default()
        }
    }

    /// Returns the path parameter of the last joints.
    pub(crate) fn end(&self) -> f64 {
        self.centre + 3.0 * self.spacing
    }

    /// Moves the window by one node. Returns false if it changed the spacing instead: a jump or a missing solution can
    /// be that of the next but one place, too, so that a finer stretch is tried first.
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

    /// Returns the joints behind the window, and how much the path bends there.
    fn next_joints(&self, arm: &Arm, path: &JointPath) -> Result<(Joints, f64), PathError> {
        if !self.is_filled {
            return Err(self.unresolved());
        }
        let [_, _, _, one, two, three] = &self.joints;
        let guess = extrapolated(two, three);
        let added = path.joints_at(arm, self.centre + 4.0 * self.spacing, &guess)?;
        let difference = match path.path {
            Path::Joints(_) => 0.0,
            Path::Tool(_) => self.bending(arm, path, 2.5, [one, two, three, &added])?,
        };
        let is_resolved = self.spacing <= path.path.resolution(self.centre + 2.0 * self.spacing);
        match difference <= RESOLUTION && is_resolved {
            true => Ok((added, difference)),
            false => Err(self.unresolved()),
        }
    }

    fn unresolved(&self) -> PathError {
        PathError {
            s: self.centre + 2.5 * self.spacing,
            kind: PathErrorKind::Unresolved,
        }
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
            if self.bending(arm, path, offset, [one, two, three, last])? > RESOLUTION {
                return Err(self.unresolved());
            }
        }
        Ok(())
    }

    /// Difference of the inverse at `offset` spacings from the centre, half-way between the second and the third of
    /// four joints, and the cubic through them; the largest of all axes, rad.
    fn bending(
        &self,
        arm: &Arm,
        path: &JointPath,
        offset: f64,
        [one, two, three, last]: [&Joints; 4],
    ) -> Result<f64, PathError> {
        let s = self.centre + offset * self.spacing;
        let middle = path.joints_at(arm, s, two)?;
        let off = |axis: usize| {
            let cubic = (9.0 * (two[axis] + three[axis]) - one[axis] - last[axis]) / 16.0;
            (cubic - middle[axis]).abs()
        };
        Ok((0..arm.axes()).map(off).fold(0.0, f64::max))
    }

    /// Halves the spacing because of an error; returns the error if the spacing is already the finest.
    fn halve_spacing(&mut self, cause: PathError) -> Result<(), PathError> {
        let cause = self.cause.unwrap_or(cause);
        let finer = self.spacing / 2.0;
        if finer < self.finest {
            return Err(cause);
        }
        if cause.kind != PathErrorKind::Unresolved {
            self.cause = Some(cause);
        }
        self.spacing = finer;
        self.calm = 0;
        Ok(())
    }

    /// Begins a coarser stretch behind the last node, if the path can be followed there.
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

    /// Computes all joints of the window from its centre, whose joints are near to `near`.
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

/// Returns the widest spacing of nodes on a path.
pub(crate) fn widest_spacing(path: &Path) -> f64 {
    match path {
        Path::Tool(_) => WIDEST.min(path.length() / 16.0),
        Path::Joints(_) => path.length() / 16.0,
    }
}

fn extrapolated(before: &Joints, last: &Joints) -> Joints {
    core::array::from_fn(|axis| 2.0 * last[axis] - before[axis])
}
