//! What the core tells a command in a cycle: times, requests, and the override and pause of all motions.

/// Context of a command in one cycle, supplied by the core: times, cancellation, takeover and predecessor.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct CycleContext {
    /// Logical time of this cycle, nanoseconds since the Unix epoch: the start of the command plus the duration of its
    /// cycles so far.
    pub net_ns: i64,
    /// Wall-clock time at the start of the cycle, nanoseconds since the Unix epoch.
    pub wall_ns: i64,
    /// True in every cycle after a cancel of the command was requested.
    pub cancel: bool,
    /// True if a successor is scheduled that takes over every moving actuator of the command.
    pub takeover: bool,
    /// Hash of the predecessor's name and of the result with which the predecessor ended
    /// (`rpi_image::hash::result_id`); `None` without a predecessor.
    pub predecessor: Option<i64>,
    /// Speed override and pause of the motions of all commands.
    pub controls: MotionControls,
}

/// Override and pause that the operator of a cell sets for the motions of all commands, as with the keys of a teach
/// pendant. The control core hands them to each command; the motions of the library obey them.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct MotionControls {
    /// Share of the programmed speed at which motions run, from 0 (standstill) to 1 (full speed).
    pub speed_override: f64,
    /// True while all motions pause: they come to rest on their paths.
    pub paused: bool,
}

impl MotionControls {
    /// Returns the controls with the speed override limited to 0 to 1; NaN counts as 0.
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
    /// Returns controls with full speed and without a pause.
    fn default() -> Self {
        MotionControls {
            speed_override: 1.0,
            paused: false,
        }
    }
}
