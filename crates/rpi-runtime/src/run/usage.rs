//! Use of the limits of the axes in the outcome of a run: time at limits, and smallest margins.

use std::fmt;

use rpi_sim::arm::limit_usage::{AxisUsage, LimitKind};
use serde::Serialize;

/// Use of the limits of one axis in a run.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct AxisEnd {
    /// Index of the axis, from 0.
    pub axis: usize,
    /// Whether the axis is linear: its positions are in m, not in rad.
    pub linear: bool,
    /// Time in seconds during which the axis was at one of its limits of velocity, acceleration and jerk.
    pub time_at_limit: f64,
    /// Use of the limits of velocity, acceleration and jerk, in this order.
    pub limits: [AxisLimitUse; 3],
    /// Smallest distance to an end of the range, in rad or m, negative outside of it; `None` for an axis without ends.
    pub distance_to_end: Option<f64>,
    /// Time of this distance, in seconds since the start of the run.
    pub distance_to_end_at: f64,
}

/// Use of one limit of an axis in a run.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct AxisLimitUse {
    /// Name of the limited quantity: velocity, acceleration or jerk.
    pub quantity: &'static str,
    /// Time in seconds during which the axis was at the limit.
    pub time_at_limit: f64,
    /// Largest share of the limit that the axis used; 1 is all of it.
    pub largest_share: f64,
    /// Time of the largest share, in seconds since the start of the run.
    pub at: f64,
}

impl AxisEnd {
    /// Returns the use of the limits of an axis; `None` if the axis has not followed any set-point.
    pub(super) fn of(axis: AxisUsage<'_>) -> Option<AxisEnd> {
        let usage = axis.usage;
        let moved = usage.largest_share.iter().any(|share| share.value > 0.0);
        let limits = LimitKind::ALL.map(|kind| {
            let largest = usage.largest_share[kind as usize];
            AxisLimitUse {
                quantity: kind.name(),
                time_at_limit: usage.time_at_limit[kind as usize],
                largest_share: largest.value,
                at: largest.time,
            }
        });
        let distance = usage.distance_to_end;
        moved.then(|| AxisEnd {
            axis: axis.axis,
            linear: axis.is_linear,
            time_at_limit: usage.time_at_any_limit,
            limits,
            distance_to_end: Some(distance.value).filter(|value| value.is_finite()),
            distance_to_end_at: distance.time,
        })
    }

    /// Returns the limit at which the axis was for the longest time.
    fn binding(&self) -> &AxisLimitUse {
        self.largest(|limit| limit.time_at_limit)
    }

    /// Returns the limit of which the axis used the largest share.
    fn fullest(&self) -> &AxisLimitUse {
        self.largest(|limit| limit.largest_share)
    }

    /// Returns the first limit with the largest value of `key`.
    fn largest(&self, key: fn(&AxisLimitUse) -> f64) -> &AxisLimitUse {
        let [first, rest @ ..] = &self.limits;
        rest.iter().fold(
            first,
            |most, next| {
                if key(next) > key(most) { next } else { most }
            },
        )
    }
}

/// Prints the time at limits of all axes of a device, such as `axis 1 0.250 s (jerk)`. `total` is the time that the shares
/// refer to, in s.
pub(super) fn time_at_limits(axes: &[AxisEnd], total: f64) -> String {
    let at_limit = axes.iter().filter(|axis| axis.time_at_limit > 0.0);
    let texts = at_limit.map(|axis| {
        let share = 100.0 * axis.time_at_limit / total.max(f64::MIN_POSITIVE);
        let (time, binding) = (axis.time_at_limit, axis.binding().quantity);
        format!("axis {} {time:.3} s ({share:.0} %, {binding})", axis.axis)
    });
    match texts.collect::<Vec<_>>() {
        texts if texts.is_empty() => "no axis".to_owned(),
        texts => texts.join(", "),
    }
}

/// Nearest margins of a device: the smallest distance to an end of a range, and the largest share of a limit.
pub(super) struct Margins<'a>(pub(super) &'a [AxisEnd]);

impl fmt::Display for Margins<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ends = self
            .0
            .iter()
            .filter_map(|axis| Some((axis, axis.distance_to_end?)));
        let nearest = ends.min_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((axis, distance)) = nearest {
            let (distance, unit) = match axis.linear {
                true => (distance * 1e3, "mm"),
                false => (distance.to_degrees(), "deg"),
            };
            let (number, at) = (axis.axis, axis.distance_to_end_at);
            write!(
                f,
                "axis {number} {distance:.1} {unit} from the end of its range at {at:.3} s, "
            )?;
        }
        let share = |axis: &&AxisEnd| axis.fullest().largest_share;
        let fullest = self.0.iter().max_by(|a, b| share(a).total_cmp(&share(b)));
        fullest.map_or(Ok(()), |axis| {
            let most = axis.fullest();
            let (number, percent) = (axis.axis, 100.0 * most.largest_share);
            let (quantity, at) = (most.quantity, most.at);
            write!(
                f,
                "axis {number} {percent:.0} % of its {quantity} limit at {at:.3} s"
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An axis that was at each limit for these times (s), and used these shares of the limits.
    fn axis(number: usize, times: [f64; 3], shares: [f64; 3], distance: f64) -> AxisEnd {
        let limits = [0, 1, 2].map(|k| AxisLimitUse {
            quantity: LimitKind::ALL[k].name(),
            time_at_limit: times[k],
            largest_share: shares[k],
            at: 1.0,
        });
        AxisEnd {
            axis: number,
            linear: number == 9,
            time_at_limit: times.iter().copied().fold(0.0, f64::max),
            limits,
            distance_to_end: Some(distance).filter(|distance| distance.is_finite()),
            distance_to_end_at: 2.0,
        }
    }

    #[test]
    fn times_at_limits_name_the_axes_and_the_limits() {
        let axes = [
            axis(0, [0.0; 3], [0.5; 3], 1.0),
            axis(1, [0.25, 0.0, 0.5], [1.0; 3], 1.0),
        ];
        assert_eq!(time_at_limits(&axes, 2.0), "axis 1 0.500 s (25 %, jerk)");
        assert_eq!(time_at_limits(&axes[..1], 2.0), "no axis");
    }

    #[test]
    fn margins_name_the_nearest_end_and_the_fullest_limit() {
        let axes = [
            axis(0, [0.0; 3], [0.5, 0.75, 0.1], f64::INFINITY),
            axis(9, [0.0; 3], [0.25; 3], 0.0125),
        ];
        assert_eq!(
            Margins(&axes).to_string(),
            "axis 9 12.5 mm from the end of its range at 2.000 s, axis 0 75 % of its acceleration limit at 1.000 s"
        );
        let without_ends = Margins(&axes[..1]).to_string();
        assert_eq!(
            without_ends,
            "axis 0 75 % of its acceleration limit at 1.000 s"
        );
    }
}
