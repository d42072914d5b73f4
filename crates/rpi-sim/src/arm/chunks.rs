//! Motion along chunks of joint positions or poses: the device functions `follow_chunks` and `follow_pose_chunks`.

mod pose_rows;

use crate::device::SlotWriter;
use crate::error_code::ErrorCode;
use pose_rows::{Heading, POSE_SLOTS, PoseRows};
use rpi_kin::state_to_rest::Bounds;
use rpi_motion::chunk::{
    ChunkError, ChunkMotion, ChunkOptions, ChunkRows, ChunkSetPoint, LimitKind, MAX_ROWS, Seam,
};
use rpi_motion::{Arm, Controls, JointState, Joints, MotionError};

/// Number of slots before the rows: number of the chunk, number of rows, period, age, whether it is appended, weight of the
/// previous chunk, frozen rows, permitted smoothing.
const HEAD: usize = 8;

/// What the rows of chunks are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum RowKind {
    /// Joint positions and, in the second half, velocities. A slot before them states whether the velocities are used.
    Joints,
    /// Poses of the tool in the base frame of the arm.
    Poses,
}

/// Number of slots in the result beside those of every motion: number of the newest accepted chunk, its present row, deviation,
/// lag, smoothing, remaining time, whether the next chunk is late, axis and kind of the limit that binds, error code of the
/// newest rejected chunk.
pub(in crate::arm) const CHUNK_SLOTS: u32 = 10;

/// Motion of an arm along chunks, and the newest chunk.
#[derive(Clone, Debug)]
pub(super) struct Chunks {
    motion: ChunkMotion,
    /// Time between set-points, s.
    period: f64,
    /// Number of the newest chunk that was read, and of the newest one that was accepted.
    read: i64,
    accepted: i64,
    rejected: ErrorCode,
    /// Chunk of poses that is being converted to positions.
    poses: PoseRows,
    /// Numbers of the newest chunk, row by row: rad, rad/s.
    positions: Vec<f64>,
    velocities: Vec<f64>,
    /// Joint positions of the last set-point, rad.
    at: Joints,
    last: Option<ChunkSetPoint>,
}

impl Chunks {
    pub(super) fn new(arm: Arm, tick: f64) -> Self {
        let most = MAX_ROWS * arm.axes();
        Self {
            motion: ChunkMotion::new(arm, tick),
            period: tick,
            read: 0,
            accepted: 0,
            rejected: ErrorCode::OK,
            poses: PoseRows::new(),
            positions: Vec::with_capacity(most),
            velocities: Vec::with_capacity(most),
            at: Joints::default(),
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
        (self.period, self.at, self.last) = (period, state.position, None);
        self.poses.clear();
        Ok(())
    }

    /// Returns the state at the next set-point, and true while the arm rests at the end of its chunks. Reads the chunk of
    /// `target` if its number is a new one.
    pub(super) fn next(
        &mut self,
        arm: &Arm,
        rows: RowKind,
        target: &[u64],
        controls: Controls,
    ) -> (JointState, bool) {
        let number = target.first().map_or(0, |slot| slot.cast_signed());
        let is_new = number != self.read && number != 0;
        self.read = number;
        let taken = match is_new {
            true => self.read_chunk(arm, rows, target),
            false => Ok(()),
        };
        let share = if controls.paused {
            0.0
        } else {
            controls.speed_share
        };
        let converted = taken.and_then(|()| self.convert(arm, share * self.period));
        if let Err(code) = converted {
            self.rejected = code;
        }
        let next = self.motion.next_set_point(controls);
        self.at = next.state.position;
        self.last = Some(next);
        let is_preparing = self.motion.is_preparing() || self.poses.is_busy();
        let done = next.at_rest && next.is_late && self.accepted != 0 && !is_preparing;
        (next.state, done)
    }

    /// Reads a new chunk: takes over its joint positions, or begins to convert its poses.
    fn read_chunk(&mut self, arm: &Arm, rows: RowKind, target: &[u64]) -> Result<(), ErrorCode> {
        let (heading, count, slots) = heading_of(target).ok_or(ErrorCode::CHUNK_INVALID)?;
        match rows {
            RowKind::Joints => self.read_joints(&heading, count * arm.axes(), slots),
            RowKind::Poses => {
                let poses = slots
                    .get(..count * POSE_SLOTS)
                    .ok_or(ErrorCode::CHUNK_INVALID)?;
                self.poses.accept(heading, poses, arm, &self.at)
            }
        }
    }

    fn read_joints(
        &mut self,
        heading: &Heading,
        count: usize,
        slots: &[u64],
    ) -> Result<(), ErrorCode> {
        let (with_velocities, arrays) = slots.split_first().ok_or(ErrorCode::CHUNK_INVALID)?;
        let (positions, velocities) = arrays.split_at(arrays.len() / 2);
        let positions = positions.get(..count).ok_or(ErrorCode::CHUNK_INVALID)?;
        copy(positions, &mut self.positions);
        copy(
            &velocities[..count.min(velocities.len())],
            &mut self.velocities,
        );
        self.take(heading, *with_velocities != 0)
    }

    /// Converts the next poses of a chunk, `elapsed` seconds after the last ones.
    fn convert(&mut self, arm: &Arm, elapsed: f64) -> Result<(), ErrorCode> {
        if self.poses.begins() {
            // Whether this chunk is accepted is known some cycles later.
            self.rejected = ErrorCode::OK;
        }
        match self.poses.advance(arm, elapsed, &mut self.positions)? {
            Some(heading) => self.take(&heading, false),
            None => Ok(()),
        }
    }

    /// Gives the rows in `positions` and, if they are to be used, `velocities` to the motion.
    fn take(&mut self, heading: &Heading, with_velocities: bool) -> Result<(), ErrorCode> {
        let chunk = ChunkRows {
            period: heading.period,
            positions: &self.positions,
            velocities: with_velocities.then_some(&self.velocities[..]),
            age: heading.age,
        };
        self.motion
            .take(&chunk, &heading.options)
            .map_err(code_of)?;
        (self.accepted, self.rejected) = (heading.number, ErrorCode::OK);
        Ok(())
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

/// Splits the slots of a chunk into what it states, its number of rows (at most [`MAX_ROWS`]), and its rows. `None` if there
/// are too few slots or too many rows.
fn heading_of(target: &[u64]) -> Option<(Heading, usize, &[u64])> {
    let (head, slots) = target.split_first_chunk::<HEAD>()?;
    let [
        number,
        rows,
        period,
        age,
        appended,
        weight,
        frozen,
        smoothing,
    ] = *head;
    let options = ChunkOptions {
        seam: match appended != 0 {
            true => Seam::Append,
            false => Seam::Overlap,
        },
        previous_weight: f64::from_bits(weight),
        frozen_rows: usize::try_from(frozen).unwrap_or(usize::MAX),
        smoothing: f64::from_bits(smoothing),
    };
    let heading = Heading {
        number: number.cast_signed(),
        period: f64::from_bits(period),
        age: f64::from_bits(age),
        options,
    };
    // A negative number of rows is more than any chunk has.
    let rows = usize::try_from(rows)
        .ok()
        .filter(|rows| *rows <= MAX_ROWS)?;
    Some((heading, rows, slots))
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
