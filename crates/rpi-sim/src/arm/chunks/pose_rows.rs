//! Chunks of poses: their rows are converted to joint positions, a few in each cycle.

use crate::arm::path_fault::PathFault;
use crate::device::pose_from;
use crate::error_code::ErrorCode;
use rpi_kin::Pose;
use rpi_motion::chunk::{ChunkOptions, MAX_ROWS, Seam};
use rpi_motion::{Arm, Joints};

/// Number of rows that are converted in a cycle: they take less time than planning a motion along a path does.
const ROWS_PER_CYCLE: usize = 8;

/// Number of slots of a pose.
pub(super) const POSE_SLOTS: usize = 7;

/// What a chunk states beside its rows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Heading {
    /// Number that the program gave to the chunk.
    pub(super) number: i64,
    /// Time between two rows, s.
    pub(super) period: f64,
    /// Time since that of the first row, s.
    pub(super) age: f64,
    pub(super) options: ChunkOptions,
}

/// Chunk of poses of the tool in the base frame, in conversion.
#[derive(Clone, Debug)]
pub(super) struct PoseRows {
    heading: Option<Heading>,
    poses: Vec<Pose>,
    /// Number of converted rows.
    converted: usize,
    /// Joint positions (rad) of the last converted row, and the arm angle there (rad).
    near: Joints,
    arm_angle: f64,
    /// Chunk that is appended to the one in conversion, and waits for it.
    next: Option<Heading>,
    next_poses: Vec<Pose>,
}

impl PoseRows {
    pub(super) fn new() -> Self {
        Self {
            heading: None,
            poses: Vec::with_capacity(MAX_ROWS),
            converted: 0,
            near: Joints::default(),
            arm_angle: 0.0,
            next: None,
            next_poses: Vec::with_capacity(MAX_ROWS),
        }
    }

    /// Drops the chunks in conversion.
    pub(super) fn clear(&mut self) {
        (self.heading, self.next) = (None, None);
    }

    /// Returns true while a chunk is in conversion.
    pub(super) fn is_busy(&self) -> bool {
        self.heading.is_some()
    }

    /// Returns true if the next rows to be converted are the first ones of a chunk.
    pub(super) fn begins(&self) -> bool {
        self.is_busy() && self.converted == 0
    }

    /// Begins to convert a chunk with the poses in `slots`, from the joint positions `near` (rad) on; it replaces one in
    /// conversion. A chunk that is appended waits for it instead.
    ///
    /// # Errors
    /// [`ErrorCode::CHUNK_FULL`] if a chunk waits already.
    pub(super) fn accept(
        &mut self,
        heading: Heading,
        slots: &[u64],
        arm: &Arm,
        near: &Joints,
    ) -> Result<(), ErrorCode> {
        let is_appended = self.is_busy() && heading.options.seam == Seam::Append;
        if is_appended && self.next.is_some() {
            return Err(ErrorCode::CHUNK_FULL);
        }
        let poses = match is_appended {
            true => &mut self.next_poses,
            false => &mut self.poses,
        };
        let (slots, _) = slots.as_chunks::<POSE_SLOTS>();
        poses.clear();
        poses.extend(slots.iter().take(MAX_ROWS).map(|pose| pose_from(pose)));
        if is_appended {
            self.next = Some(heading);
            return Ok(());
        }
        (self.heading, self.next) = (Some(heading), None);
        self.converted = 0;
        self.near = *near;
        self.arm_angle = arm.arm_angle(near).unwrap_or(0.0);
        Ok(())
    }

    /// Ends the conversion of a chunk and begins that of the one that waits for it. Returns the heading of the former.
    fn finish(&mut self) -> Option<Heading> {
        let done = core::mem::replace(&mut self.heading, self.next.take());
        if self.heading.is_some() {
            core::mem::swap(&mut self.poses, &mut self.next_poses);
            self.converted = 0;
        }
        done
    }

    /// Converts the next rows and appends their joint positions (rad), row by row, to `positions`. `elapsed` (s) is the time
    /// since the last call, by which the chunk gets older. Returns the heading when all rows are converted.
    ///
    /// # Errors
    /// The error code of a pose that the arm cannot reach; the chunk is then dropped.
    pub(super) fn advance(
        &mut self,
        arm: &Arm,
        elapsed: f64,
        positions: &mut Vec<f64>,
    ) -> Result<Option<Heading>, ErrorCode> {
        let Some(heading) = &mut self.heading else {
            return Ok(None);
        };
        match self.converted {
            0 => positions.clear(),
            _ => heading.age += elapsed,
        }
        let end = (self.converted + ROWS_PER_CYCLE).min(self.poses.len());
        for pose in &self.poses[self.converted..end] {
            let found = arm.inverse(pose, &self.near, self.arm_angle);
            let (joints, turned) = match found {
                Ok(found) => found,
                Err(error) => {
                    self.finish();
                    return Err(PathFault::from(error).violation.code);
                }
            };
            self.near = joints;
            self.arm_angle += turned;
            positions.extend(&joints[..arm.axes()]);
        }
        self.converted = end;
        match end == self.poses.len() {
            true => Ok(self.finish()),
            false => Ok(None),
        }
    }
}
