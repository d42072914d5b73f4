//! Line simplification (Ramer 1972, Douglas and Peucker 1973).

type Point = (f64, f64);

/// Returns a line with fewer points, whose distance from each removed point is at most `tolerance`. Points with
/// non-finite coordinates are removed as well.
pub(super) fn simplify(points: &[Point], tolerance: f64) -> Vec<Point> {
    let points: Vec<Point> = points
        .iter()
        .copied()
        .filter(|p| p.0.is_finite() && p.1.is_finite())
        .collect();
    let mut keep = vec![false; points.len()];
    // Open ranges on a stack instead of a recursion, whose depth a path of a million points could exhaust.
    let mut open = vec![(0, points.len().saturating_sub(1))];
    keep.iter_mut().take(1).for_each(|first| *first = true);
    keep.iter_mut().rev().take(1).for_each(|last| *last = true);
    while let Some((first, last)) = open.pop() {
        if let Some(far) = farthest_point(&points, first, last, tolerance) {
            keep[far] = true;
            open.extend([(first, far), (far, last)]);
        }
    }
    let kept = points.iter().zip(&keep).filter(|(_, keep)| **keep);
    kept.map(|(point, _)| *point).collect()
}

/// Returns the index of the point between `first` and `last` with the largest distance from the segment between these
/// two; `None` if the distance does not exceed the tolerance.
fn farthest_point(points: &[Point], first: usize, last: usize, tolerance: f64) -> Option<usize> {
    let off = |k: usize| distance(points[k], points[first], points[last]);
    let far = (first + 1..last).max_by(|&a, &b| off(a).total_cmp(&off(b)))?;
    (off(far) > tolerance).then_some(far)
}

/// Returns the distance of the point `p` from the segment between `a` and `b`.
fn distance(p: Point, a: Point, b: Point) -> f64 {
    let (dx, dy) = (b.0 - a.0, b.1 - a.1);
    let (px, py) = (p.0 - a.0, p.1 - a.1);
    let length = dx * dx + dy * dy;
    let along = if length > 0.0 {
        ((px * dx + py * dy) / length).clamp(0.0, 1.0)
    } else {
        0.0
    };
    let (ex, ey) = (px - along * dx, py - along * dy);
    (ex * ex + ey * ey).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_stay_and_straights_go() {
        let points: Vec<Point> = (0..=20)
            .map(|k| (f64::from(k), f64::from(10 - (k - 10i32).abs())))
            .collect();
        assert_eq!(
            simplify(&points, 0.1),
            [(0.0, 0.0), (10.0, 10.0), (20.0, 0.0)]
        );
    }

    #[test]
    fn a_closed_way_keeps_its_far_side() {
        let points = [(0.0, 0.0), (5.0, 0.0), (5.0, 5.0), (0.0, 0.0)];
        assert_eq!(simplify(&points, 0.1), points);
    }

    #[test]
    fn few_or_broken_points_are_no_matter() {
        assert_eq!(simplify(&[], 0.1), []);
        assert_eq!(simplify(&[(1.0, f64::NAN), (2.0, 3.0)], 0.1), [(2.0, 3.0)]);
    }
}
