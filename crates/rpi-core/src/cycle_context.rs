//! What the core tells a command in a cycle: times, requests, and the override and pause of all motions.

/// Context of a command in one cycle, supplied by the core: times, cancellation, takeover and predecessor.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct CycleContext {
    /// Logical time of this cycle, nanoseconds since the Unix epoch.
    pub net_ns: i64,
    /// Wall-clock time at the start of the cycle, nanoseconds since the Unix epoch.
    pub wall_ns: i64,
    /// True once a cancel was requested.
    pub cancel: bool,
    /// True if a successor is scheduled that takes over every moving actuator.
    pub takeover: bool,
    /// Identity of the predecessor's result; see `rpi_image::hash::result_id`.
    pub predecessor: Option<i64>,
    /// Override and pause of all motions.
    pub controls: MotionControls,
}

/// Override and pause that the operator of a cell sets for the motions of all commands, as with the keys of a teach
/// pendant. The control core hands them to each command; the motions of the library obey them.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct MotionControls {
    /// Share of the speed, from 0 to 1.
    pub speed_override: f64,
    /// True while all motions pause: they come to rest on their paths.
    pub paused: bool,
}

impl MotionControls {
    /// Returns controls with the override limited to 0 to 1; what is not a number counts as 0.
    #[must_use]
    pub fn limited(self) -> MotionControls {
        let share = self.speed_override;
        let speed_override = if share > 0.0 { share.min(1.0) } else { 0.0 };
        MotionControls {
            speed_override,
            ..self
        }
    }
}

impl Default for MotionControls {
    /// Full speed, without a pause.
    fn default() -> Self {
        MotionControls {
            speed_override: 1.0,
            paused: false,
        }
    }
}
