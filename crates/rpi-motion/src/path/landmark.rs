//! Places on a path that programs name: the points that it was given, and the beginning and end of rounded corners.

use super::{Path, Piece, ToolPath};

/// Kind of a place on a path that programs name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Landmark {
    /// Start of the path.
    Start,
    /// End of the path.
    End,
    /// Point of a spline with this index, from 0 for the first one that the program gave; on a path with rounded corners, the
    /// middle of the corner with this index, which is the place nearest to the corner.
    Point(usize),
    /// Place at which the rounded corner with this index begins, from 0.
    ZoneEntry(usize),
    /// Place at which the rounded corner with this index ends, from 0.
    ZoneExit(usize),
}

impl Path {
    /// Returns the position of a landmark along the path (path parameter: m, or rad on a joint line); `None` if the path
    /// has no such landmark.
    #[must_use]
    pub fn landmark(&self, landmark: Landmark) -> Option<f64> {
        match (landmark, self) {
            (Landmark::Start, _) => Some(0.0),
            (Landmark::End, _) => Some(self.length()),
            (Landmark::Point(k), Path::Tool(path)) => path.point(k),
            (Landmark::ZoneEntry(k), Path::Tool(path)) => path.corner(k).map(|(entry, _)| entry),
            (Landmark::ZoneExit(k), Path::Tool(path)) => path.corner(k).map(|(_, exit)| exit),
            (_, Path::Joints(_)) => None,
        }
    }
}

impl ToolPath {
    /// Returns the places between which the rounded corner with the index `k` lies, m.
    fn corner(&self, k: usize) -> Option<(f64, f64)> {
        let pieces = self.starts.iter().zip(self.pieces());
        let mut corners = pieces.filter(|(_, piece)| matches!(piece, Piece::Corner(_)));
        let (start, piece) = corners.nth(k)?;
        Some((*start, start + piece.length()))
    }

    /// Counts `count` points that a program gave for a spline and that are at its start: they have the first indices.
    #[must_use]
    pub fn with_points_at_start(self, count: usize) -> Self {
        Self {
            points_at_start: count,
            ..self
        }
    }

    /// Returns the place of the point with the index `k`, m. The last point of a spline is the end of the path.
    fn point(&self, k: usize) -> Option<f64> {
        if !self.has_spline() {
            return self
                .corner(k)
                .map(|(entry, exit)| f64::midpoint(entry, exit));
        }
        let Some(k) = k.checked_sub(self.points_at_start) else {
            return Some(0.0);
        };
        match (k + 1).cmp(&self.count) {
            core::cmp::Ordering::Less => Some(self.starts[k + 1]),
            core::cmp::Ordering::Equal => Some(self.length),
            core::cmp::Ordering::Greater => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rpi_kin::Pose;

    fn at(x: f64, y: f64) -> Pose {
        Pose::translation(x, y, 0.0)
    }

    #[test]
    fn landmarks_of_a_corner_are_around_its_middle() {
        let path = ToolPath::polyline(&[at(0.0, 0.0), at(0.4, 0.0), at(0.4, 0.3)], &[0.05]);
        let path = Path::Tool(path.expect("a right angle has a corner"));
        let place = |landmark| path.landmark(landmark);
        assert_eq!(place(Landmark::Start), Some(0.0));
        assert_eq!(place(Landmark::End), Some(path.length()));
        let entry = place(Landmark::ZoneEntry(0)).expect("it has a corner");
        let exit = place(Landmark::ZoneExit(0)).expect("it has a corner");
        assert!((entry - 0.35).abs() < 1e-12, "{entry}");
        assert!((path.length() - exit - 0.25).abs() < 1e-12, "{exit}");
        assert_eq!(place(Landmark::Point(0)), Some(f64::midpoint(entry, exit)));
        assert_eq!(place(Landmark::ZoneEntry(1)), None);
    }

    #[test]
    fn landmarks_of_a_spline_are_its_points() {
        let points = [at(0.0, 0.0), at(0.1, 0.0), at(0.2, 0.1), at(0.3, 0.3)];
        let path = ToolPath::spline(&points).expect("a smooth curve");
        for (k, point) in points[1..].iter().enumerate() {
            let place = Path::Tool(path).landmark(Landmark::Point(k));
            let place = place.expect("each point is on the path");
            let off = path.pose(place).translation.vector - point.translation.vector;
            assert!(off.norm() < 1e-9, "{k}: {off}");
        }
        assert_eq!(Path::Tool(path).landmark(Landmark::Point(3)), None);
        // The tool was at the first point of the program: it has the index 0, and the next one the index 1.
        let path = Path::Tool(path.with_points_at_start(1));
        assert_eq!(path.landmark(Landmark::Point(0)), Some(0.0));
        assert_eq!(path.landmark(Landmark::Point(3)), Some(path.length()));
        assert_eq!(path.landmark(Landmark::Point(4)), None);
    }
}
