//! Motion along chunks of joint positions: the device function `follow_chunks`.

use crate::device::SlotWriter;
use crate::error_code::ErrorCode;
use rpi_kin::state_to_rest::Bounds;
use rpi_motion::chunk::{
    ChunkError, ChunkMotion, ChunkOptions, ChunkRows, ChunkSetPoint, LimitKind, MAX_ROWS, Seam,
};
use rpi_motion::{Arm, Controls, JointState, MotionError};

/// Number of slots before the positions: number of the chunk, number of rows, period, age, whether it is appended, weight of
/// the previous chunk, frozen rows, permitted smoothing, whether there are velocities.
const HEAD: usize = 9;

/// Number of slots in the result beside those of every motion: number of the newest accepted chunk, its present row, deviation,
/// lag, smoothing, remaining time, whether the next chunk is late, axis and kind of the limit that binds, error code of the
/// newest rejected chunk.
pub(in crate::arm) const CHUNK_SLOTS: u32 = 10;

/// Motion of an arm along chunks, and the newest chunk.
#[derive(Clone, Debug)]
pub(super) struct Chunks {
    motion: ChunkMotion,
    /// Number of the newest chunk that was read, and of the newest one that was accepted.
    read: i64,
    accepted: i64,
    rejected: ErrorCode,
    /// Numbers of the newest chunk, row by row: rad, rad/s.
    positions: Vec<f64>,
    velocities: Vec<f64>,
    last: Option<ChunkSetPoint>,
}

impl Chunks {
    pub(super) fn new(arm: Arm, tick: f64) -> Self {
        let most = MAX_ROWS * arm.axes();
        Self {
            motion: ChunkMotion::new(arm, tick),
            read: 0,
            accepted: 0,
            rejected: ErrorCode::OK,
            positions: Vec::with_capacity(most),
            velocities: Vec::with_capacity(most),
            last: None,
        }
    }

    /// Begins a motion without a chunk.
    pub(super) fn begin(
        &mut self,
        state: &JointState,
        requested: Bounds,
        period: f64,
    ) -> Result<(), MotionError> {
        self.motion.begin(state, requested, period)?;
        (self.read, self.accepted, self.rejected) = (0, 0, ErrorCode::OK);
        self.last = None;
        Ok(())
    }

    /// Returns the state at the next set-point, and true while the arm rests at the end of its chunks. Reads the chunk of
    /// `target` if its number is a new one.
    pub(super) fn next(
        &mut self,
        arm: &Arm,
        target: &[u64],
        controls: Controls,
    ) -> (JointState, bool) {
        let number = target.first().map_or(0, |slot| slot.cast_signed());
        let is_new = number != self.read && number != 0;
        self.read = number;
        if is_new {
            match self.take(arm, target) {
                Ok(()) => (self.accepted, self.rejected) = (number, ErrorCode::OK),
                Err(error) => self.rejected = code_of(error),
            }
        }
        let next = self.motion.next_set_point(controls);
        self.last = Some(next);
        let done =
            next.at_rest && next.is_late && self.accepted != 0 && !self.motion.is_preparing();
        (next.state, done)
    }

    fn take(&mut self, arm: &Arm, target: &[u64]) -> Result<(), ChunkError> {
        let Some((head, arrays)) = target.split_first_chunk::<HEAD>() else {
            return Err(ChunkError::Length);
        };
        let [
            _,
            rows,
            period,
            age,
            appended,
            weight,
            frozen,
            smoothing,
            with,
        ] = *head;
        let (positions, velocities) = arrays.split_at(arrays.len() / 2);
        // A number of rows that is too large or negative is more than any chunk has.
        let rows = usize::try_from(rows)
            .unwrap_or(usize::MAX)
            .min(MAX_ROWS + 1);
        let count = rows * arm.axes();
        if rows > MAX_ROWS || count > positions.len() {
            return Err(ChunkError::Length);
        }
        copy(&positions[..count], &mut self.positions);
        copy(
            &velocities[..count.min(velocities.len())],
            &mut self.velocities,
        );
        let chunk = ChunkRows {
            period: f64::from_bits(period),
            positions: &self.positions,
            velocities: (with != 0).then_some(&self.velocities[..]),
            age: f64::from_bits(age),
        };
        let options = ChunkOptions {
            seam: if appended != 0 {
                Seam::Append
            } else {
                Seam::Overlap
            },
            previous_weight: f64::from_bits(weight),
            frozen_rows: usize::try_from(frozen).unwrap_or(usize::MAX),
            smoothing: f64::from_bits(smoothing),
        };
        self.motion.take(&chunk, &options)
    }

    /// Returns the state of the axes `elapsed` seconds after the last set-point if the arm stops on its own.
    pub(super) fn stopping(&self, elapsed: f64) -> JointState {
        self.motion.stopping(elapsed)
    }

    /// Writes the slots of the result beside those of every motion.
    pub(super) fn put_report(&self, out: &mut SlotWriter<'_>) {
        let axis_and_limit = self.last.and_then(|last| last.limit);
        let (axis, limit) =
            axis_and_limit.map_or((0, 0), |(axis, kind)| (axis as u64 + 1, number_of(kind)));
        let reals = self.last.map_or([0.0; 4], |last| {
            [last.deviation, last.lag, last.smoothing, last.remaining]
        });
        out.put_bits(self.accepted.cast_unsigned());
        out.put_bits(self.motion.row() as u64);
        out.put_reals(reals);
        out.put_bits(u64::from(self.last.is_none_or(|last| last.is_late)));
        out.put_bits(axis);
        out.put_bits(limit);
        out.put_bits(self.rejected.0.cast_unsigned());
    }
}

fn copy(slots: &[u64], to: &mut Vec<f64>) {
    to.clear();
    to.extend(slots.iter().map(|bits| f64::from_bits(*bits)));
}

fn code_of(error: ChunkError) -> ErrorCode {
    match error {
        ChunkError::NotFinite => ErrorCode::NOT_A_NUMBER,
        ChunkError::Period | ChunkError::Length | ChunkError::Option => ErrorCode::CHUNK_INVALID,
        ChunkError::Stale => ErrorCode::CHUNK_STALE,
        ChunkError::Full => ErrorCode::CHUNK_FULL,
    }
}

/// Number of a kind of limit in the result of the function.
fn number_of(kind: LimitKind) -> u64 {
    match kind {
        LimitKind::Velocity => 1,
        LimitKind::Acceleration => 2,
        LimitKind::Jerk => 3,
        LimitKind::Range => 4,
    }
}
