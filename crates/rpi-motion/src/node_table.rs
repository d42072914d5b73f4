//! Nodes of the path in joint space, built ahead of the motion.
//!
//! Nodes lie at equal distances within a stretch. Where the inverse kinematics bends too much for the present spacing,
//! a finer stretch begins; where it is smooth again, a coarser one. The table is a ring: nodes behind the motion make
//! room for those ahead.

use crate::curve_bound::CurveBound;
use crate::joint_path::JointPath;
use crate::node::{MostAllowed, Node, USED_JERK_SHARE, USED_JERK_SHARE_ON_SPLINE, bounds_at};
use crate::path::{Curvature, Path};
use crate::path_error::{PathError, PathErrorKind};
use crate::ranges::{Ranges, first_outside, path_ranges, whole_ranges};
use crate::third_derivative;
use crate::window::{Window, widest_spacing};
use crate::{Arm, Joints};
use alloc::boxed::Box;
use alloc::vec;
use rpi_kin::state_to_rest::Bounds;
use rpi_kin::{MAX_AXES, Range};

/// Table of nodes, ahead of the motion along a path, as a ring buffer: places with the derivatives of the joint
/// positions.
#[derive(Clone, Debug)]
pub struct NodeTable {
    ring: Box<[Node]>,
    /// Number of the oldest node in the ring, counted from the start of the path; the index is the remainder by the
    /// size.
    oldest: usize,
    next: usize,
    path: JointPath,
    requested: Bounds,
    window: Window,
    error: Option<PathError>,
    /// True if a piece of the path belongs to a spline.
    has_spline: bool,
    /// Ranges that the axes keep on the path, rad.
    ranges: Ranges,
}

/// Number of steps by which the arm angle (position of the elbow) is planned ahead when a path begins.
const FIRST_LOOK: usize = 10;
/// Number of steps by which the arm angle (position of the elbow) is planned ahead at each further node.
const LOOK: usize = 1;

impl NodeTable {
    /// Creates an empty table with memory for `capacity` nodes, at least 64. Allocates.
    #[must_use]
    pub fn with_capacity(capacity: usize) -> Self {
        let still = Path::joint_line(&[0.0; MAX_AXES], &[0.0; MAX_AXES], 0);
        Self {
            ring: vec![Node::default(); capacity.max(64)].into_boxed_slice(),
            oldest: 0,
            next: 0,
            path: JointPath::still(still),
            requested: Bounds {
                speed: 1.0,
                acceleration: 1.0,
                jerk: 1.0,
            },
            window: Window::default(),
            error: None,
            has_spline: false,
            ranges: [Range::symmetric(0.0); MAX_AXES],
        }
    }

    /// Replaces the path of the table and computes its first node. `start` are joint positions (rad) at the start of
    /// the path, or near to them. `requested` are the bounds of the tool along the path.
    ///
    /// # Errors
    /// A [`PathError`] if the start of the path cannot be reached.
    pub fn begin(
        &mut self,
        arm: &Arm,
        path: Path,
        start: &Joints,
        requested: Bounds,
    ) -> Result<(), PathError> {
        (self.oldest, self.next) = (0, 0);
        self.error = None;
        (self.path, self.requested) = (JointPath::new(arm, path, start), requested);
        self.has_spline = matches!(&path, Path::Tool(path) if path.has_spline());
        let length = path.length();
        if length <= 0.0 || length.is_nan() {
            return Err(PathError {
                s: 0.0,
                kind: PathErrorKind::NoLength,
            });
        }
        let window = Window::first(arm, &self.path, start);
        self.window = window.map_err(|error| self.path.with_axis(arm, error, start))?;
        self.path.look_ahead(arm, self.window.end(), FIRST_LOOK);
        self.ranges = path_ranges(arm, &path, &self.window.joints[2]);
        self.emit(arm);
        self.error.map_or(Ok(()), Err)
    }

    /// Replaces the path of the table by a path without length, on which the arm holds the joint positions `at` (rad).
    pub fn begin_hold(&mut self, arm: &Arm, at: &Joints) {
        (self.oldest, self.next) = (0, 0);
        self.error = None;
        self.path = JointPath::still(Path::joint_line(at, at, arm.axes()));
        self.has_spline = false;
        self.window = Window::still(at);
        self.ranges = whole_ranges(arm, at);
        self.emit(arm);
    }

    /// Returns the joint positions (rad) at the start of the path and, on a joint line, at its end; otherwise those at
    /// the start twice. Only for a table whose first node is still known.
    pub(crate) fn ends(&self) -> [Joints; 2] {
        let start = self.first_node().joints;
        match self.path() {
            Path::Joints(line) => [start, line.joints(self.path().length())],
            Path::Tool(_) => [start; 2],
        }
    }

    /// Returns the path whose nodes the table holds.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path.path
    }

    /// Returns the share of the jerk limits of the axes that plans on this path use.
    pub(crate) fn jerk_share(&self) -> f64 {
        match self.has_spline {
            true => USED_JERK_SHARE_ON_SPLINE,
            false => USED_JERK_SHARE,
        }
    }

    /// Returns the path of the table in joint space.
    pub(crate) fn joint_path(&self) -> &JointPath {
        &self.path
    }

    /// Returns the requested bounds of the tool along the path.
    #[must_use]
    pub fn requested(&self) -> Bounds {
        self.requested
    }

    /// Returns the position along the path (m; rad on a joint line) up to which nodes are known: no motion may go
    /// beyond it.
    #[must_use]
    pub fn known_end(&self) -> f64 {
        self.newest().s.min(self.path().length())
    }

    /// Returns the position along the path (m; rad on a joint line) at which a motion must end: the end of the path, or
    /// a point shortly before the place where it cannot be followed.
    #[must_use]
    pub fn goal(&self) -> f64 {
        /// Distance (m) that a motion keeps from the end of the part of the path that can be followed, so that rounding
        /// does not lead beyond it.
        const BEFORE: f64 = 1e-9;
        match self.error {
            Some(_) => (self.known_end() - BEFORE).max(0.0),
            None => self.path().length(),
        }
    }

    /// Returns the reason why the path cannot be followed beyond the last node; `None` while there is none.
    #[must_use]
    pub fn error(&self) -> Option<PathError> {
        self.error
    }

    /// Returns the oldest node in the table.
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

    /// Computes at most `budget` further nodes ahead. Nodes before the position `behind` along the path may be removed
    /// for them. Returns the number of nodes computed.
    pub fn extend(&mut self, arm: &Arm, budget: usize, behind: f64) -> usize {
        let mut made = 0;
        while made < budget && self.error.is_none() && self.newest().s < self.path().length() {
            while self.is_full() && self.node(self.oldest + 1).s < behind {
                self.oldest += 1;
            }
            if self.is_full() {
                break;
            }
            made += 1;
            self.path.look_ahead(arm, self.window.end(), LOOK);
            match self.window.advance(arm, &self.path) {
                Ok(true) => self.emit(arm),
                Ok(false) => {}
                Err(error) => {
                    let last = &self.window.joints[5];
                    self.error = Some(self.path.with_axis(arm, error, last));
                }
            }
        }
        made
    }

    /// Returns the joint positions (rad) of the path at the position `s` along it, near to `hint` (rad).
    ///
    /// # Errors
    /// A [`PathError`] if there are none, or if they belong to another configuration than `hint`.
    pub fn joints_at(&self, arm: &Arm, s: f64, hint: &Joints) -> Result<Joints, PathError> {
        self.path.joints_at(arm, s, hint)
    }

    /// Computes the node at the centre of the window (joint positions at equal distances) and appends it to the table.
    /// If an axis is out of its range there, the path ends before the node.
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
            curvature: self.path().curvature(centre),
            kink: self.kink_before(centre),
            resolution: self.path().resolution(centre),
            ..Node::default()
        };
        if let Some(axis) = self.axis_out_of_range(arm) {
            let kind = PathErrorKind::OutOfRange { axis };
            self.error = Some(self.path.error_at(centre, kind));
            return;
        }
        let [a, b, c, d, e, _] = &self.window.joints;
        // Central differences over five points.
        node.first = core::array::from_fn(|k| (a[k] - 8.0 * b[k] + 8.0 * d[k] - e[k]) / (12.0 * h));
        node.second = core::array::from_fn(|k| {
            (-a[k] + 16.0 * b[k] - 30.0 * c[k] + 16.0 * d[k] - e[k]) / (12.0 * h * h)
        });
        node.third =
            third_derivative::extent(arm, &self.path, &self.window, self.last_node_place(centre));
        if let Path::Joints(line) = self.path() {
            node.first = *line.direction();
            node.second = [0.0; MAX_AXES];
            node.third = [[0.0; MAX_AXES]; 2];
        }
        (node.most, node.speed_bound) = bounds_at(arm, &node, self.requested, self.jerk_share());
        let slot = self.next % self.ring.len();
        self.ring[slot] = node;
        self.next += 1;
    }

    /// Returns the curvature at the points of a spline between the last node and the position `s` along the path, and the
    /// position of the last of them.
    fn kink_before(&self, s: f64) -> Option<(f64, CurveBound)> {
        let Path::Tool(path) = self.path() else {
            return None;
        };
        let kinks = || path.kinks_between(self.last_node_place(s), s);
        let bound = CurveBound::of_all(kinks().flat_map(|kink| path.curvatures_beside(kink)));
        kinks().last().map(|kink| kink.s).zip(bound)
    }

    /// Returns the position of the last node along the path; `first` if there is none.
    fn last_node_place(&self, first: f64) -> f64 {
        let last = self.next.checked_sub(1);
        last.map_or(first, |last| self.node(last).s)
    }

    /// Returns the first axis that is out of its range at the centre of the window, or at the end of the path if the
    /// centre lies beyond.
    fn axis_out_of_range(&self, arm: &Arm) -> Option<usize> {
        let (here, length) = (self.window.joints[2], self.path().length());
        let joints = match self.window.centre > length {
            true => self.path.joints_at(arm, length, &here).unwrap_or(here),
            false => here,
        };
        first_outside(arm, &self.ranges, &joints)
    }

    /// Returns the nodes before and after the position `s` along the path, and the share (0 to 1) of the distance
    /// between them at `s`. `cursor` is the number of a node near to `s`; it is set to the number of the node before
    /// `s`.
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
        let (one, other) = (
            self.node(k),
            self.node((k + 1).min(self.next.saturating_sub(1))),
        );
        let width = other.s - one.s;
        let share = if width > 0.0 {
            (s - one.s) / width
        } else {
            0.0
        };
        (one, other, share.clamp(0.0, 1.0))
    }

    /// Returns the position along the path of the next sample of a verification after `from`, at most `to`: the next
    /// node of a finely spaced part, the next point of a spline, or the next place on a curve at the
    /// distance that its curvature needs. `cursor` is
    /// as in [`NodeTable::around`]; it stays at `from`.
    #[must_use]
    pub fn next_sample(&self, from: f64, to: f64, cursor: &mut usize) -> f64 {
        let _ = self.around(from, cursor);
        let last = self.next.saturating_sub(1);
        let widest = 0.75 * widest_spacing(self.path());
        for k in *cursor..last {
            let (one, other) = (self.node(k), self.node(k + 1));
            if one.s >= to {
                break;
            }
            let spacing = other.s - one.s;
            let needed = one.resolution.min(other.resolution);
            let distance = if spacing < widest {
                spacing.min(needed)
            } else {
                needed
            };
            let kink = other.kink.map_or(f64::INFINITY, |(place, _)| place);
            let place = match distance.is_finite() {
                true if one.s > from => one.s,
                true => from + distance,
                false => f64::INFINITY,
            };
            let next = if kink > from { place.min(kink) } else { place };
            if next.is_finite() {
                return next.min(to);
            }
        }
        to
    }

    /// Returns the nodes after the position `from` along the path up to the position `to`, in order. `cursor` is as in
    /// [`NodeTable::around`].
    pub fn nodes_between(
        &self,
        from: f64,
        to: f64,
        cursor: &mut usize,
    ) -> impl Iterator<Item = &Node> + '_ {
        let _ = self.around(from, cursor);
        let nodes = (*cursor + 1..self.next).map(|k| self.node(k));
        nodes.take_while(move |node| node.s <= to)
    }

    /// Returns true if the path is curved somewhere between two positions along it.
    #[must_use]
    pub fn is_curved_between(&self, from: f64, to: f64) -> bool {
        let mut cursor = 0;
        let _ = self.around(from, &mut cursor);
        let nodes = (cursor..self.next).map(|k| self.node(k));
        nodes
            .take_while(|node| node.s <= to)
            .any(|node| node.curvature != Curvature::default())
    }

    /// Returns the smallest velocity, acceleration and jerk allowed at the nodes from just before `from` to just after
    /// `to`. `cursor` is as in [`NodeTable::around`].
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
