//! Places for labels beside points of a path, clear of the path and of each other.

use super::frame::{Frame, TICK_LABEL};
use super::palette::AXIS;
use super::svg::{Anchor, Svg, TextStyle};

type Point = (f64, f64);

/// Rectangle on the page, in pixels: left upper and right lower corner.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Area {
    from: Point,
    to: Point,
}

/// Smallest distance of a label from the path, from marks and from other labels, in pixels.
const CLEARANCE: f64 = 4.0;

/// Distances of a label from its point that are tried in turn, in pixels.
const DISTANCES: [f64; 7] = [9.0, 16.0, 24.0, 36.0, 52.0, 72.0, 96.0];

/// Directions from a point to its label that are tried in turn at each distance.
const DIRECTIONS: [Point; 8] = [
    (1.0, -0.7),
    (-1.0, -0.7),
    (1.0, 0.7),
    (-1.0, 0.7),
    (1.0, 0.0),
    (-1.0, 0.0),
    (0.0, -1.0),
    (0.0, 1.0),
];

/// Distance from which on a line leads from the point to its label, in pixels.
const LEADER: f64 = 20.0;

/// Approximate width of a character and height of a line of a label, as parts of the size of the text.
const CHARACTER: (f64, f64) = (0.58, 1.1);

/// Labels of one plot area, and what they must not cover.
pub(super) struct Labels<'p> {
    frame: &'p Frame,
    /// Lines of the path, in pixels.
    path: &'p [Vec<Point>],
    taken: Vec<Area>,
}

impl<'p> Labels<'p> {
    /// Creates the labels of a plot area without any. `path` are the lines that they must not cover, `marks` the points with
    /// a mark of the radius `radius`, in pixels.
    pub(super) fn new(
        frame: &'p Frame,
        path: &'p [Vec<Point>],
        marks: &[Point],
        radius: f64,
    ) -> Self {
        let around = |mark: &Point| Area {
            from: (mark.0 - radius, mark.1 - radius),
            to: (mark.0 + radius, mark.1 + radius),
        };
        Self {
            frame,
            path,
            taken: marks.iter().map(around).collect(),
        }
    }

    /// Draws a label for the point `at`, where it is clear of everything else; not at all if there is no such place.
    pub(super) fn draw(&mut self, svg: &mut Svg, at: Point, color: &'static str, text: &str) {
        let Some((area, distance)) = self.place(at, text) else {
            return;
        };
        self.taken.push(area);
        let nearest = (
            at.0.clamp(area.from.0, area.to.0),
            at.1.clamp(area.from.1, area.to.1),
        );
        if distance >= LEADER {
            svg.line(at, nearest, AXIS, 0.8);
        }
        let style = TextStyle {
            color,
            anchor: Anchor::Start,
            ..TICK_LABEL
        };
        let baseline = area.to.1 - 0.25 * TICK_LABEL.size;
        svg.text((area.from.0, baseline), style, text);
    }

    /// Returns the first place for a label at the point `at` that is clear, and its distance from the point.
    fn place(&self, at: Point, text: &str) -> Option<(Area, f64)> {
        let characters = text.chars().count() as f64;
        let size = (
            characters * CHARACTER.0 * TICK_LABEL.size,
            CHARACTER.1 * TICK_LABEL.size,
        );
        let places = DISTANCES.iter().flat_map(|distance| {
            let area =
                move |direction: &Point| (beside(at, *direction, *distance, size), *distance);
            DIRECTIONS.iter().map(area)
        });
        let mut places = places.filter(|(area, _)| self.is_clear(area));
        places.next()
    }

    fn is_clear(&self, area: &Area) -> bool {
        let frame = self.frame;
        let is_inside = area.from.0 >= frame.left()
            && area.to.0 <= frame.right()
            && area.from.1 >= frame.top()
            && area.to.1 <= frame.bottom();
        let wide = Area {
            from: (area.from.0 - CLEARANCE, area.from.1 - CLEARANCE),
            to: (area.to.0 + CLEARANCE, area.to.1 + CLEARANCE),
        };
        let mut segments = self.path.iter().flat_map(|line| line.windows(2));
        is_inside
            && !self.taken.iter().any(|other| overlap(&wide, other))
            && !segments.any(|pair| crosses(pair[0], pair[1], &wide))
    }
}

/// Returns the rectangle of this size whose nearest side or corner is `distance` from `at` in a direction.
fn beside(at: Point, direction: Point, distance: f64, size: Point) -> Area {
    let start = |at: f64, direction: f64, size: f64| {
        let anchor = at + direction * distance;
        match direction {
            d if d > 0.0 => anchor,
            d if d < 0.0 => anchor - size,
            _ => anchor - size / 2.0,
        }
    };
    let from = (
        start(at.0, direction.0, size.0),
        start(at.1, direction.1, size.1),
    );
    Area {
        from,
        to: (from.0 + size.0, from.1 + size.1),
    }
}

fn overlap(one: &Area, other: &Area) -> bool {
    one.from.0 < other.to.0
        && other.from.0 < one.to.0
        && one.from.1 < other.to.1
        && other.from.1 < one.to.1
}

/// Returns true if the segment from `a` to `b` has a point in the area (clipping of Liang and Barsky, 1984).
fn crosses(a: Point, b: Point, area: &Area) -> bool {
    let (mut enter, mut leave) = (0.0f64, 1.0f64);
    let sides = [
        (a.0 - b.0, a.0 - area.from.0),
        (b.0 - a.0, area.to.0 - a.0),
        (a.1 - b.1, a.1 - area.from.1),
        (b.1 - a.1, area.to.1 - a.1),
    ];
    for (direction, room) in sides {
        match direction {
            0.0 if room < 0.0 => return false,
            0.0 => {}
            d if d < 0.0 => enter = enter.max(room / d),
            d => leave = leave.min(room / d),
        }
    }
    enter <= leave
}

#[cfg(test)]
mod tests {
    use super::super::axis::Axis;
    use super::*;

    const FRAME: Frame = Frame {
        x: Axis {
            values: (0.0, 1.0),
            pixels: (0.0, 400.0),
        },
        y: Axis {
            values: (0.0, 1.0),
            pixels: (300.0, 0.0),
        },
    };

    /// A zigzag through the whole area, with a label at each corner.
    #[test]
    fn labels_keep_their_distance_from_the_path_and_from_each_other() {
        let corners: Vec<Point> = (0..8)
            .map(|k| {
                (
                    30.0 + 48.0 * f64::from(k),
                    if k % 2 == 0 { 40.0 } else { 260.0 },
                )
            })
            .collect();
        let path = [corners.clone()];
        let mut labels = Labels::new(&FRAME, &path, &corners, 5.0);
        let mut areas: Vec<Area> = Vec::new();
        for corner in &corners {
            if let Some((area, _)) = labels.place(*corner, "takeover 1.234 s") {
                let wide = Area {
                    from: (area.from.0 - 3.9, area.from.1 - 3.9),
                    to: (area.to.0 + 3.9, area.to.1 + 3.9),
                };
                let mut segments = path[0].windows(2);
                assert!(
                    !segments.any(|pair| crosses(pair[0], pair[1], &wide)),
                    "{area:?}"
                );
                assert!(areas.iter().all(|other| !overlap(&wide, other)), "{area:?}");
                areas.push(area);
                labels.taken.push(area);
            }
        }
        assert!(areas.len() >= 4, "{areas:?}");
    }

    #[test]
    fn a_segment_crosses_an_area_also_without_an_end_in_it() {
        let area = Area {
            from: (10.0, 10.0),
            to: (20.0, 20.0),
        };
        assert!(crosses((0.0, 15.0), (30.0, 15.0), &area));
        assert!(crosses((12.0, 12.0), (13.0, 13.0), &area));
        assert!(crosses((5.0, 16.0), (16.0, 5.0), &area));
        assert!(!crosses((0.0, 9.0), (30.0, 9.0), &area));
        assert!(!crosses((0.0, 15.0), (9.0, 15.0), &area));
        assert!(!crosses((15.0, 0.0), (15.0, 9.0), &area));
    }
}
