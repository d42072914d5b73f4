//! Override and pause of all motions of a core, set from outside of the commands.

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
