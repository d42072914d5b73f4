//! Axes: scaling of values to pixels, and tick marks.

/// Axis of a chart: a linear map from values to pixels on the page.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Axis {
    /// Smallest and largest value on the axis.
    pub(super) values: (f64, f64),
    /// Positions on the page, in pixels, that belong to the smallest and the largest value.
    pub(super) pixels: (f64, f64),
}

impl Axis {
    /// Returns the pixel position of a value on the page.
    pub(super) fn to_pixel(self, value: f64) -> f64 {
        let (low, high) = self.values;
        self.pixels.0 + (value - low) / (high - low) * (self.pixels.1 - self.pixels.0)
    }

    /// Returns the values at which the axis has tick marks: round values, about one per `spacing` pixels.
    pub(super) fn ticks(&self, spacing: f64) -> Vec<f64> {
        let (low, high) = self.values;
        let count = ((self.pixels.1 - self.pixels.0).abs() / spacing).max(1.0);
        let step = round_step((high - low) / count);
        let first = (low / step).ceil();
        let last = ((high / step).floor() - first).clamp(0.0, 1000.0) as usize;
        (0..=last).map(|k| (first + k as f64) * step).collect()
    }

    /// Returns the label of the tick mark at the value `tick`, with as many decimals as needed to distinguish the tick
    /// marks. `spacing` is their approximate distance in pixels.
    pub(super) fn label(&self, tick: f64, spacing: f64) -> String {
        let ticks = self.ticks(spacing);
        let step = ticks.windows(2).map(|w| w[1] - w[0]).next().unwrap_or(1.0);
        let decimals = (0..6).find(|&d| {
            let scaled = step * POWERS[d];
            (scaled - scaled.round()).abs() < 1e-6 * scaled
        });
        let text = format!("{tick:.*}", decimals.unwrap_or(6));
        if text
            .trim_start_matches('-')
            .bytes()
            .all(|b| b == b'0' || b == b'.')
        {
            text.trim_start_matches('-').to_owned()
        } else {
            text.replace('-', "\u{2212}")
        }
    }
}

const POWERS: [f64; 6] = [1.0, 10.0, 100.0, 1e3, 1e4, 1e5];

/// Returns the smallest number of the form 1, 2 or 5 times a power of ten that is at least `step`.
fn round_step(step: f64) -> f64 {
    let mut power = 1e-9;
    while power * 10.0 < step && power < 1e12 {
        power *= 10.0;
    }
    let rounds = [1.0, 2.0, 5.0, 10.0].map(|r| r * power);
    rounds
        .into_iter()
        .find(|r| *r >= step * (1.0 - 1e-9))
        .unwrap_or(step)
}

/// Returns the smallest and the largest of the finite values, widened to a width of at least `least`. Without a finite
/// value the range has the centre 0.
pub(super) fn value_range(values: impl Iterator<Item = f64>, least: f64) -> (f64, f64) {
    let finite = values.filter(|v| v.is_finite());
    let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| {
        (l.min(v), h.max(v))
    });
    if low > high {
        return (-least / 2.0, least / 2.0);
    }
    let missing = ((least - (high - low)) / 2.0).max(0.0);
    (low - missing, high + missing)
}

/// Returns a range of values extended at both ends by `part` of its width.
pub(super) fn padded((low, high): (f64, f64), part: f64) -> (f64, f64) {
    let margin = (high - low) * part;
    (low - margin, high + margin)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_inside() {
        let axis = Axis {
            values: (-1.3, 2.7),
            pixels: (0.0, 400.0),
        };
        assert_eq!(axis.ticks(100.0), [-1.0, 0.0, 1.0, 2.0]);
        let labels: Vec<_> = axis
            .ticks(50.0)
            .iter()
            .map(|t| axis.label(*t, 50.0))
            .collect();
        assert_eq!(labels[0], "\u{2212}1.0");
        assert!(labels.contains(&"0.0".to_owned()));
    }

    #[test]
    fn steps_are_one_two_or_five() {
        assert_eq!(
            [0.03, 1.0, 1.2, 4.9, 70.0].map(round_step),
            [0.05, 1.0, 2.0, 5.0, 100.0]
        );
    }

    #[test]
    fn a_constant_gets_a_range() {
        assert_eq!(value_range([3.0, 3.0].into_iter(), 2.0), (2.0, 4.0));
        assert_eq!(value_range([f64::NAN].into_iter(), 2.0), (-1.0, 1.0));
    }

    #[test]
    fn values_map_to_pixels_also_upside_down() {
        let axis = Axis {
            values: (0.0, 2.0),
            pixels: (100.0, 0.0),
        };
        assert_eq!(
            [axis.to_pixel(0.0), axis.to_pixel(0.5), axis.to_pixel(2.0)],
            [100.0, 75.0, 0.0]
        );
    }
}
