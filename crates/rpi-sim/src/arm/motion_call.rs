//! Arguments and results of the motion functions of an arm, as slots.

use crate::device::SlotWriter;
use crate::error_code::ErrorCode;
use rpi_kin::state_to_rest::Bounds;
use rpi_motion::Controls;

/// Number of slots in the result of a motion function besides the joints and the pose: travelled way, progress, speed,
/// whether the tool is on the path, whether the motion is done, error.
pub(super) const STATUS_SLOTS: u32 = 6;

/// Number of slots in the result of a motion function besides the joints: number of the motion, pose, status.
pub(super) const RESULT_SLOTS: u32 = 1 + 7 + STATUS_SLOTS;

/// Arguments of a call of a motion function.
pub(super) struct Request<'a> {
    pub(super) motion: i64,
    pub(super) target: &'a [u64],
    pub(super) requested: Bounds,
    pub(super) controls: Controls,
}

impl<'a> Request<'a> {
    /// Splits arguments: number of the motion, target, speed, acceleration, jerk, override, pause.
    pub(super) fn from_slots(slots: &'a [u64]) -> Option<Self> {
        let (motion, rest) = slots.split_first()?;
        let (target, rest) = rest.split_last_chunk::<5>()?;
        let [speed, acceleration, jerk, share] = [0, 1, 2, 3].map(|k| f64::from_bits(rest[k]));
        Some(Self {
            motion: motion.cast_signed(),
            target,
            requested: Bounds {
                speed,
                acceleration,
                jerk,
            },
            controls: Controls {
                speed_share: if share >= 0.0 { share.min(1.0) } else { 0.0 },
                paused: rest[4] != 0,
            },
        })
    }
}

/// Writes the result of a call of a motion function that gives no set-point.
pub(super) fn put_error(number: i64, axes: usize, error: ErrorCode, out: &mut SlotWriter<'_>) {
    out.put_bits(number.cast_unsigned());
    out.put_reals(core::iter::repeat_n(f64::NAN, axes + 7));
    out.put_reals([0.0; 3]);
    out.put_bits(0);
    out.put_bits(0);
    out.put_bits(error.0.cast_unsigned());
}
