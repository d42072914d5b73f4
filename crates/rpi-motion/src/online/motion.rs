//! Motion of several axes, synchronised.

use super::axis::{AxisPlanner, Planner};
use super::limits::{AxisLimits, OnlineError, OnlineErrorKind, check_finite};
use super::profile::{AxisProfile, PositionExtrema};
use super::straight::{straight_change, straight_line};
use super::velocity_axis::VelocityPlanner;
use rpi_kin::state_to_rest::AxisState;

/// Way in which the durations of the axes of one motion depend on each other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Synchronization {
    /// Each axis moves as fast as it can, without regard to the other axes.
    None,
    /// All axes end at the same time, as early as possible.
    #[default]
    Time,
    /// All axes move in proportion to each other, on a straight line in joint space, if their states at the start and at
    /// the target are in proportion. The motion is the fastest one on this line; it may take longer than without the line.
    /// Otherwise as [`Synchronization::Time`].
    Phase,
}

/// Options of a motion of several axes: synchronisation and minimum duration.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MotionOptions {
    /// Synchronisation of the axes with each other.
    pub synchronization: Synchronization,
    /// Minimum duration, s; not negative. The motion takes the shortest possible duration that is not below it.
    pub minimum_duration: f64,
}

/// Planned motion of `N` axes from their present states to their targets, within the limits of each axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OnlineMotion<const N: usize> {
    axes: [AxisProfile; N],
    synchronization: Synchronization,
    duration: f64,
}

impl<const N: usize> OnlineMotion<N> {
    /// Plans the time-optimal motion from `start` to `target` (position, velocity and acceleration of each axis) within
    /// `limits`. A start outside of the limits is first brought back into them, as fast as possible.
    ///
    /// # Errors
    /// A number that is not finite, limits with a wrong sign, or a target outside of the limits.
    pub fn to_position(
        start: &[AxisState; N],
        target: &[AxisState; N],
        limits: &[AxisLimits; N],
        options: MotionOptions,
    ) -> Result<Self, OnlineError> {
        for axis in 0..N {
            check(&start[axis], &target[axis], &limits[axis], &options)
                .and_then(|()| limits[axis].check_target(&target[axis]))
                .map_err(|kind| OnlineError { axis, kind })?;
        }
        let line = |minimum| straight_line(start, target, limits, minimum);
        let plan = |axis| AxisPlanner::new(start[axis], target[axis], &limits[axis]);
        Ok(Self::plan(line, plan, &options))
    }

    /// Plans the time-optimal motion from `start` to the velocity and acceleration of `target` within the limits of
    /// acceleration and jerk. The position of the target and the limits of the velocity are not used. The velocity
    /// stays between those of start and target, except as far as the accelerations there demand.
    ///
    /// # Errors
    /// A number that is not finite, limits with a wrong sign, or a target acceleration outside of the limits.
    pub fn to_velocity(
        start: &[AxisState; N],
        target: &[AxisState; N],
        limits: &[AxisLimits; N],
        options: MotionOptions,
    ) -> Result<Self, OnlineError> {
        for axis in 0..N {
            check(&start[axis], &target[axis], &limits[axis], &options)
                .and_then(|()| limits[axis].check_acceleration(&target[axis]))
                .map_err(|kind| OnlineError { axis, kind })?;
        }
        let line = |minimum| straight_change(start, target, limits, minimum);
        let plan = |axis| VelocityPlanner::new(start[axis], target[axis], &limits[axis]);
        Ok(Self::plan(line, plan, &options))
    }

    fn new(axes: [AxisProfile; N], synchronization: Synchronization) -> Self {
        Self {
            axes,
            synchronization,
            duration: axes.iter().map(AxisProfile::duration).fold(0.0, f64::max),
        }
    }

    /// Plans the motion of the axes on a straight line if this is requested and possible, else of each axis by its
    /// planner. `line` plans on a straight line and gets the minimum duration, s.
    fn plan<P: Planner>(
        line: impl FnOnce(f64) -> Option<[AxisProfile; N]>,
        planner: impl FnMut(usize) -> P,
        options: &MotionOptions,
    ) -> Self {
        if options.synchronization == Synchronization::Phase
            && let Some(line) = line(options.minimum_duration)
        {
            return Self::new(line, Synchronization::Phase);
        }
        Self::synchronised(&core::array::from_fn(planner), options)
    }

    fn synchronised(planners: &[impl Planner; N], options: &MotionOptions) -> Self {
        let minimum = options.minimum_duration;
        let together = options.synchronization != Synchronization::None;
        if together && let Some(axes) = at_one_time(planners, minimum) {
            return Self::new(axes, Synchronization::Time);
        }
        let alone = |axis: usize| {
            let planner = &planners[axis];
            at_one_time(core::array::from_ref(planner), minimum)
                .map_or_else(|| planner.profile(), |[profile]| profile)
        };
        Self::new(core::array::from_fn(alone), Synchronization::None)
    }

    /// Returns the duration of the motion (s): that of the axis that takes longest.
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.duration
    }

    /// Returns the motion of each axis, in the order of the axes of the request.
    #[must_use]
    pub fn axes(&self) -> &[AxisProfile; N] {
        &self.axes
    }

    /// Returns the synchronisation of the planned motion, which is [`Synchronization::Time`] if a straight line was
    /// requested but is impossible.
    #[must_use]
    pub fn synchronization(&self) -> Synchronization {
        self.synchronization
    }

    /// Returns the states of the axes `time` seconds after the start; see [`AxisProfile::state_at`].
    #[must_use]
    pub fn state_at(&self, time: f64) -> [AxisState; N] {
        core::array::from_fn(|axis| self.axes[axis].state_at(time))
    }

    /// Returns the jerks of the axes `time` seconds after the start, rad/s³ or m/s³.
    #[must_use]
    pub fn jerk_at(&self, time: f64) -> [f64; N] {
        core::array::from_fn(|axis| self.axes[axis].jerk_at(time))
    }

    /// Returns the smallest and largest position of each axis between start and end of the motion.
    #[must_use]
    pub fn position_extrema(&self) -> [PositionExtrema; N] {
        core::array::from_fn(|axis| self.axes[axis].position_extrema())
    }
}

fn check(
    start: &AxisState,
    target: &AxisState,
    limits: &AxisLimits,
    options: &MotionOptions,
) -> Result<(), OnlineErrorKind> {
    check_finite(start)?;
    check_finite(target)?;
    limits.check()?;
    let minimum = options.minimum_duration;
    if minimum.is_finite() && minimum >= 0.0 {
        Ok(())
    } else {
        Err(OnlineErrorKind::NotFinite)
    }
}

/// Maximum number of durations, per axis, at which motions of exactly this duration begin or cease to exist.
const CHANGES: usize = 24;

/// Plans motions with the shortest common duration that is not below `minimum` (s); `None` if there is none. An axis
/// may have no motion for some durations above its shortest one; the ends of these gaps are tried in order.
pub(super) fn at_one_time<const M: usize>(
    planners: &[impl Planner; M],
    minimum: f64,
) -> Option<[AxisProfile; M]> {
    let own = planners.iter().map(Planner::duration);
    let mut duration = own.fold(minimum, f64::max);
    for _ in 0..=CHANGES * M {
        if let Some(axes) = with_duration(planners, duration) {
            return Some(axes);
        }
        duration = next_change(planners, duration)?;
    }
    None
}

fn with_duration<const M: usize>(
    planners: &[impl Planner; M],
    duration: f64,
) -> Option<[AxisProfile; M]> {
    let nothing = AxisProfile::standing(AxisState::default(), AxisState::default());
    let mut axes = [nothing; M];
    for (axis, planner) in axes.iter_mut().zip(planners) {
        *axis = planner.profile_with_duration(duration)?;
    }
    Some(axes)
}

fn next_change<const M: usize>(planners: &[impl Planner; M], duration: f64) -> Option<f64> {
    let mut next = f64::INFINITY;
    for planner in planners {
        planner.durations(&mut |time| {
            if time > duration && time < next {
                next = time;
            }
        });
    }
    next.is_finite().then_some(next)
}
