//! The path in joint space: nodes with the derivatives of all axes along the path, built ahead of the motion.
//!
//! Nodes lie at equal distances within a stretch. Where the inverse kinematics bends too much for the present spacing,
//! a finer stretch begins; where it is smooth again, a coarser one. The table is a ring: nodes behind the motion make
//! room for those ahead.

use crate::path::{Curvature, Path};
use crate::{Arm, Joints};
use alloc::boxed::Box;
use alloc::vec;
use rpi_kin::state_to_rest::Bounds;
use rpi_kin::{InverseKinematicsError, MAX_AXES};

/// Share of the limits of velocity and acceleration that a plan uses. The rest covers the bending of the path between
/// samples of the verification (measured: at most 0.6 of 1 %).
pub const USED_SHARE: f64 = 0.99;

/// Share of the jerk limit that a plan uses (measured: at most 0.25 of 2 % are bending between samples).
pub const USED_JERK_SHARE: f64 = 0.98;

/// Greatest difference between the inverse half-way between two nodes and the cubic through four nodes, rad.
const RESOLUTION: f64 = 1e-8;

/// Spacing of nodes on a path of the tool, m: widest, and finest before the path is refused.
const WIDEST: f64 = 2e-3;
const FINEST: f64 = WIDEST / 64.0;

/// A step of an axis from its extrapolation above this is a change of configuration, rad.
const CONFIGURATION_STEP: f64 = 0.1;

/// Nodes that must be much better resolved than needed before the spacing is doubled.
const CALM_NODES: u32 = 16;

/// Why a path cannot be followed at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathError {
    /// The place: path parameter, m (rad on a joint line).
    pub s: f64,
    /// The reason.
    pub kind: PathErrorKind,
}

/// Kind of a [`PathError`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PathErrorKind {
    /// The inverse kinematics has no solution.
    NoInverse(InverseKinematicsError),
    /// The arm would have to change its configuration; the axis makes a jump.
    ConfigurationChange {
        /// The axis, from 0.
        axis: usize,
    },
    /// The path ends with the axis outside its range.
    OutOfRange {
        /// The axis, from 0.
        axis: usize,
    },
    /// The path is too near to a singularity, or the range of the elbow makes a kink: the derivatives of the joints
    /// cannot be resolved.
    Unresolved,
    /// The path has no length.
    NoLength,
}

impl core::fmt::Display for PathError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let at = self.s;
        match self.kind {
            PathErrorKind::NoInverse(InverseKinematicsError::OutOfReach) => {
                write!(
                    f,
                    "the path leaves the reach of the arm {at:.4} m from its start"
                )
            }
            PathErrorKind::NoInverse(_) => write!(
                f,
                "an axis would leave its range {at:.4} m from the start of the path"
            ),
            PathErrorKind::ConfigurationChange { axis } => write!(
                f,
                "axis {} would change the configuration {at:.4} m from the start of the path",
                axis + 1
            ),
            PathErrorKind::OutOfRange { axis } => {
                write!(f, "the path ends with axis {} outside its range", axis + 1)
            }
            PathErrorKind::Unresolved => write!(
                f,
                "the path comes too near to a singularity {at:.4} m from its start"
            ),
            PathErrorKind::NoLength => f.write_str("the path has no length"),
        }
    }
}

impl core::error::Error for PathError {}

/// Derivatives of the joints along the path at one place, and what they allow.
#[derive(Clone, Copy, Debug, Default)]
pub struct Node {
    /// Path parameter.
    pub s: f64,
    /// Joints, rad.
    pub joints: Joints,
    /// First derivatives, rad per unit of the path parameter.
    pub first: Joints,
    /// Second derivatives.
    pub second: Joints,
    /// Third derivatives.
    pub third: Joints,
    /// Curvature of the way of the tool.
    pub curvature: Curvature,
    /// Greatest velocity, acceleration and jerk of the path parameter here, each on its own.
    pub most: MostAllowed,
}

/// Greatest velocity, acceleration and jerk of the path parameter.
#[derive(Clone, Copy, Debug)]
pub struct MostAllowed {
    /// Velocity.
    pub velocity: f64,
    /// Acceleration.
    pub acceleration: f64,
    /// Jerk.
    pub jerk: f64,
}

impl Default for MostAllowed {
    fn default() -> Self {
        Self {
            velocity: f64::INFINITY,
            acceleration: f64::INFINITY,
            jerk: f64::INFINITY,
        }
    }
}

impl MostAllowed {
    /// Returns the smaller of both in each entry.
    #[must_use]
    pub fn min(self, other: Self) -> Self {
        Self {
            velocity: self.velocity.min(other.velocity),
            acceleration: self.acceleration.min(other.acceleration),
            jerk: self.jerk.min(other.jerk),
        }
    }
}

/// Ring of nodes of the present path.
#[derive(Clone, Debug)]
pub struct NodeTable {
    ring: Box<[Node]>,
    /// Number of the oldest node in the ring, and one behind the newest.
    oldest: usize,
    next: usize,
    path: Path,
    elbow: Joints,
    asked: Bounds,
    window: Window,
    error: Option<PathError>,
}

/// Joints at equal distances around the next node: offsets -2 to 3.
#[derive(Clone, Copy, Debug, Default)]
struct Window {
    joints: [Joints; 6],
    spacing: f64,
    /// Path parameter of offset 0.
    centre: f64,
    calm: u32,
}

impl NodeTable {
    /// Creates an empty table for `capacity` nodes. Allocates.
    #[must_use]
    pub fn with_capacity(capacity: usize) -> Self {
        let still = Path::joint_line(&[0.0; MAX_AXES], &[0.0; MAX_AXES], 0);
        Self {
            ring: vec![Node::default(); capacity.max(64)].into_boxed_slice(),
            oldest: 0,
            next: 0,
            path: still,
            elbow: [0.0; MAX_AXES],
            asked: Bounds {
                speed: 1.0,
                acceleration: 1.0,
                jerk: 1.0,
            },
            window: Window::default(),
            error: None,
        }
    }

    /// Begins a path, and makes its first node; `start` are joints at its start, or near to them. `asked` are the bounds
    /// of the tool along the path.
    ///
    /// # Errors
    /// A [`PathError`] if the start of the path cannot be reached.
    pub fn begin(
        &mut self,
        arm: &Arm,
        path: Path,
        start: &Joints,
        asked: Bounds,
    ) -> Result<(), PathError> {
        (self.oldest, self.next) = (0, 0);
        self.error = None;
        (self.path, self.elbow, self.asked) = (path, *start, asked);
        let length = path.length();
        if !(length > 0.0) {
            return Err(PathError {
                s: 0.0,
                kind: PathErrorKind::NoLength,
            });
        }
        self.window = Window {
            spacing: self.first_spacing(length),
            ..Window::default()
        };
        self.fill_window(arm, start)?;
        // The first node is a place where motions begin: its derivatives must be exact from the beginning.
        while self.window_bending(arm)? > RESOLUTION {
            self.change_spacing(arm, self.window.spacing / 2.0)?;
        }
        self.emit(arm);
        Ok(())
    }

    /// Begins a path without length: the joints `at`.
    pub fn begin_hold(&mut self, arm: &Arm, at: &Joints) {
        (self.oldest, self.next) = (0, 0);
        self.error = None;
        self.path = Path::joint_line(at, at, arm.axes());
        self.window = Window {
            joints: [*at; 6],
            spacing: 1.0,
            ..Window::default()
        };
        self.emit(arm);
    }

    fn first_spacing(&self, length: f64) -> f64 {
        match self.path {
            Path::Tool(_) => WIDEST.min(length / 16.0),
            Path::Joints(_) => length / 16.0,
        }
    }

    /// Returns the path.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the bounds that were asked for.
    #[must_use]
    pub fn asked(&self) -> Bounds {
        self.asked
    }

    /// Returns the end of the known part of the path: nothing may go beyond it.
    #[must_use]
    pub fn known_end(&self) -> f64 {
        self.newest().s.min(self.path.length())
    }

    /// Returns why the path cannot be followed beyond its known end.
    #[must_use]
    pub fn error(&self) -> Option<PathError> {
        self.error
    }

    /// Returns the oldest node that is kept.
    #[must_use]
    pub fn first_node(&self) -> &Node {
        self.node(self.oldest)
    }

    pub(crate) fn newest(&self) -> &Node {
        self.node(self.next.wrapping_sub(1))
    }

    fn node(&self, number: usize) -> &Node {
        &self.ring[number % self.ring.len()]
    }

    fn is_full(&self) -> bool {
        self.next - self.oldest == self.ring.len()
    }

    /// Makes up to `budget` further nodes; nodes before `behind` make room. Returns the number of nodes made.
    pub fn extend(&mut self, arm: &Arm, budget: usize, behind: f64) -> usize {
        let mut made = 0;
        while made < budget && self.error.is_none() && self.newest().s < self.path.length() {
            while self.is_full() && self.node(self.oldest + 1).s < behind {
                self.oldest += 1;
            }
            if self.is_full() {
                break;
            }
            made += 1;
            match self.advance(arm) {
                Ok(true) => self.emit(arm),
                Ok(false) => {}
                Err(error) => self.error = Some(error),
            }
        }
        made
    }

    /// Moves the window by one node. Returns false if it changed the spacing instead.
    fn advance(&mut self, arm: &Arm) -> Result<bool, PathError> {
        let Window {
            joints,
            spacing,
            centre,
            ..
        } = self.window;
        let guess = extrapolated(&joints[4], &joints[5]);
        let added = self.joints_at(arm, centre + 4.0 * spacing, &guess)?;
        let difference = match self.path {
            Path::Joints(_) => 0.0,
            Path::Tool(_) => self.bending(arm, &added)?,
        };
        if difference > RESOLUTION {
            self.change_spacing(arm, spacing / 2.0)?;
            return Ok(false);
        }
        let [_, rest @ ..] = joints;
        let [a, b, c, d, e] = rest;
        self.window.joints = [a, b, c, d, e, added];
        self.window.centre = centre + spacing;
        let calm = difference * 64.0 < RESOLUTION;
        self.window.calm = if calm { self.window.calm + 1 } else { 0 };
        if self.window.calm > CALM_NODES && spacing < WIDEST {
            let last = self.window.joints[1];
            self.window.centre = centre;
            self.window.spacing = 2.0 * spacing;
            self.window.calm = 0;
            self.move_centre(arm, &last)?;
        }
        Ok(true)
    }

    /// Difference of the inverse half-way between the two newest joints of the window and the cubic through them.
    fn bending(&self, arm: &Arm, added: &Joints) -> Result<f64, PathError> {
        let [_, _, _, one, two, three] = &self.window.joints;
        self.bending_between(arm, 2.5, [one, two, three, added])
    }

    /// The same for the whole window.
    fn window_bending(&self, arm: &Arm) -> Result<f64, PathError> {
        if let Path::Joints(_) = self.path {
            return Ok(0.0);
        }
        let mut most = 0.0f64;
        for (k, four) in self.window.joints.windows(4).enumerate() {
            let [one, two, three, last] = four else {
                continue;
            };
            most = most.max(self.bending_between(arm, k as f64 - 0.5, [one, two, three, last])?);
        }
        Ok(most)
    }

    /// Difference of the inverse at `offset` spacings from the centre, half-way between the second and the third of
    /// four joints, and the cubic through them; the largest of all axes, rad.
    fn bending_between(
        &self,
        arm: &Arm,
        offset: f64,
        [one, two, three, last]: [&Joints; 4],
    ) -> Result<f64, PathError> {
        let s = self.window.centre + offset * self.window.spacing;
        let middle = self.joints_at(arm, s, two)?;
        let off = |axis: usize| {
            let cubic = (9.0 * (two[axis] + three[axis]) - one[axis] - last[axis]) / 16.0;
            (cubic - middle[axis]).abs()
        };
        Ok((0..arm.axes()).map(off).fold(0.0, f64::max))
    }

    /// Begins a finer stretch behind the last node.
    fn change_spacing(&mut self, arm: &Arm, spacing: f64) -> Result<(), PathError> {
        if spacing < FINEST.min(self.path.length() / 1024.0) {
            return Err(PathError {
                s: self.window.centre + 2.5 * self.window.spacing,
                kind: PathErrorKind::Unresolved,
            });
        }
        let here = self.window.joints[2];
        self.window.spacing = spacing;
        self.window.calm = 0;
        self.fill_window(arm, &here)
    }

    /// Moves the centre of the window to one spacing behind the last node, and fills it.
    fn move_centre(&mut self, arm: &Arm, last: &Joints) -> Result<(), PathError> {
        let guess = *last;
        let next = self.window.centre + self.window.spacing;
        let joints = self.joints_at(arm, next, &guess)?;
        self.window.centre = next;
        self.fill_window(arm, &joints)
    }

    /// Computes all joints of the window from its centre, whose joints are near to `near`.
    fn fill_window(&mut self, arm: &Arm, near: &Joints) -> Result<(), PathError> {
        let (centre, spacing) = (self.window.centre, self.window.spacing);
        let here = self.joints_at(arm, centre, near)?;
        let mut joints = [here; 6];
        let mut hint = here;
        for back in 1..=2usize {
            hint = self.joints_at(arm, centre - back as f64 * spacing, &hint)?;
            joints[2 - back] = hint;
        }
        hint = here;
        for ahead in 1..=3usize {
            hint = self.joints_at(arm, centre + ahead as f64 * spacing, &hint)?;
            joints[2 + ahead] = hint;
        }
        self.window.joints = joints;
        Ok(())
    }

    /// Returns the joints of the path at a place, near to `hint`.
    ///
    /// # Errors
    /// A [`PathError`] if there are none, or if they belong to another configuration.
    pub fn joints_at(&self, arm: &Arm, s: f64, hint: &Joints) -> Result<Joints, PathError> {
        let path = match &self.path {
            Path::Joints(line) => return Ok(line.joints(s)),
            Path::Tool(path) => path,
        };
        let found = arm.inverse(&path.pose(s), hint, &self.elbow);
        let joints = found.map_err(|error| PathError {
            s,
            kind: PathErrorKind::NoInverse(error),
        })?;
        let jump =
            (0..arm.axes()).find(|axis| (joints[*axis] - hint[*axis]).abs() > CONFIGURATION_STEP);
        match jump {
            None => Ok(joints),
            Some(axis) => Err(PathError {
                s,
                kind: PathErrorKind::ConfigurationChange { axis },
            }),
        }
    }

    /// Writes the node at the centre of the window.
    fn emit(&mut self, arm: &Arm) {
        let Window {
            joints: q,
            spacing: h,
            centre,
            ..
        } = self.window;
        let mut node = Node {
            s: centre,
            joints: q[2],
            curvature: self.path.curvature(centre),
            ..Node::default()
        };
        for axis in 0..arm.axes() {
            let [a, b, c, d, e] = [q[0][axis], q[1][axis], q[2][axis], q[3][axis], q[4][axis]];
            // Central differences over five points.
            node.first[axis] = (a - 8.0 * b + 8.0 * d - e) / (12.0 * h);
            node.second[axis] = (-a + 16.0 * b - 30.0 * c + 16.0 * d - e) / (12.0 * h * h);
            node.third[axis] = (-a + 2.0 * b - 2.0 * d + e) / (2.0 * h * h * h);
        }
        if let Path::Joints(line) = &self.path {
            node.first = *line.direction();
            node.second = [0.0; MAX_AXES];
            node.third = [0.0; MAX_AXES];
        }
        node.most = axis_bounds(arm, &node).min(tool_bounds(self.asked, node.curvature));
        let slot = self.next % self.ring.len();
        self.ring[slot] = node;
        self.next += 1;
    }

    /// Returns the nodes around a place and its share of the way between them. `cursor` is the number of a node near
    /// to it, and becomes that of the node before it.
    #[must_use]
    pub fn around(&self, s: f64, cursor: &mut usize) -> (&Node, &Node, f64) {
        let last = self.next.saturating_sub(2).max(self.oldest);
        let mut k = (*cursor).clamp(self.oldest, last);
        while k < last && self.node(k + 1).s <= s {
            k += 1;
        }
        while k > self.oldest && self.node(k).s > s {
            k -= 1;
        }
        *cursor = k;
        let (one, other) = (self.node(k), self.node((k + 1).min(self.next - 1)));
        let width = other.s - one.s;
        let share = if width > 0.0 {
            (s - one.s) / width
        } else {
            0.0
        };
        (one, other, share.clamp(0.0, 1.0))
    }

    /// Returns the number of nodes of finer stretches between two places. `cursor` as in [`NodeTable::around`]; it stays
    /// at `from`.
    #[must_use]
    pub fn fine_nodes_between(&self, from: f64, to: f64, cursor: &mut usize) -> usize {
        let _ = self.around(from, cursor);
        let last = self.next.saturating_sub(1);
        let nodes = (*cursor..last).take_while(|k| self.node(*k).s < to);
        let widest = self.first_spacing(self.path.length());
        nodes
            .filter(|k| self.node(k + 1).s - self.node(*k).s < 0.75 * widest)
            .count()
    }

    /// Returns the places of the nodes in a stretch with the greatest speed of each. `cursor` as in
    /// [`NodeTable::around`].
    pub fn places_between(
        &self,
        from: f64,
        to: f64,
        cursor: &mut usize,
    ) -> impl Iterator<Item = (f64, f64)> + '_ {
        let _ = self.around(from, cursor);
        let nodes = (*cursor + 1..self.next).map(|k| self.node(k));
        nodes
            .take_while(move |node| node.s <= to)
            .map(|node| (node.s, node.most.velocity))
    }

    /// Returns whether the path is curved somewhere in a stretch.
    #[must_use]
    pub fn is_curved_between(&self, from: f64, to: f64) -> bool {
        let mut cursor = 0;
        let _ = self.around(from, &mut cursor);
        let nodes = (cursor..self.next).map(|k| self.node(k));
        nodes
            .take_while(|node| node.s <= to)
            .any(|node| node.curvature != Curvature::default())
    }

    /// Returns the smallest bounds of the nodes around a stretch. `cursor` as in [`NodeTable::around`].
    #[must_use]
    pub fn most_between(&self, from: f64, to: f64, cursor: &mut usize) -> MostAllowed {
        let _ = self.around(from, cursor);
        let mut most = MostAllowed::default();
        for k in *cursor..self.next {
            let node = self.node(k);
            most = most.min(node.most);
            if node.s >= to {
                break;
            }
        }
        most
    }
}

fn extrapolated(before: &Joints, last: &Joints) -> Joints {
    core::array::from_fn(|axis| 2.0 * last[axis] - before[axis])
}

/// What the limits of the axes allow at a node. The shares of acceleration (0.7) and jerk (0.6) that the speed may use
/// up alone leave room for the acceleration and the jerk of the path parameter.
fn axis_bounds(arm: &Arm, node: &Node) -> MostAllowed {
    let mut most = MostAllowed::default();
    for (axis, limits) in arm.limits().iter().enumerate() {
        let first = node.first[axis].abs().max(1e-9);
        let second = node.second[axis].abs().max(1e-9);
        let third = node.third[axis].abs().max(1e-9);
        let by_acceleration = libm::sqrt(0.7 * limits.acceleration / second);
        let by_jerk = libm::cbrt(0.6 * limits.jerk / third);
        most = most.min(MostAllowed {
            velocity: (USED_SHARE * limits.velocity / first)
                .min(by_acceleration)
                .min(by_jerk),
            acceleration: USED_SHARE * limits.acceleration / first,
            jerk: USED_JERK_SHARE * limits.jerk / first,
        });
    }
    most
}

/// What the bounds of the tool allow at a place with this curvature. At a steady speed the acceleration is k v² and the
/// jerk hypot(k', k²) v³; the verification looks at both together with those along the path.
fn tool_bounds(asked: Bounds, curvature: Curvature) -> MostAllowed {
    /// Shares that a steady speed uses of its own bounds, and that remain along a curved path.
    const STEADY: f64 = 0.985;
    const ALONG: f64 = 1.0;
    let Curvature { value, slope } = curvature;
    let share = if value == 0.0 && slope == 0.0 {
        1.0
    } else {
        ALONG
    };
    let sideways = libm::sqrt(asked.acceleration / value.max(1e-9));
    let turning = libm::hypot(slope, value * value).max(1e-9);
    let twisting = libm::cbrt(asked.jerk / turning);
    MostAllowed {
        velocity: asked.speed.min(STEADY * sideways).min(STEADY * twisting),
        acceleration: share * asked.acceleration,
        jerk: share * asked.jerk,
    }
}
