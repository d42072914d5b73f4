//! What a sample of the controller means for the driver: faults, and the state of the driver's program.

use super::program;
use super::recipe::{COUNTER_MASK, Sample};
use crate::error_code::ErrorCode;

/// Mode of a robot whose brakes are released, `robot_mode`.
const ROBOT_RUNNING: i32 = 7;
/// Modes of the safety controller in which the arm may move, `safety_mode`: normal and reduced.
const SAFETY_NORMAL: [i32; 2] = [1, 2];
/// Modes of the safety controller with an emergency stop, `safety_mode`: of the system and of the robot.
const SAFETY_EMERGENCY: [i32; 2] = [6, 7];

/// States of the program that the controller executes, `runtime_state`.
const STOPPED: u32 = 1;
const PLAYING: u32 = 2;

/// Share of the full speed below which the controller counts as slow.
const FULL_SPEED: f64 = 0.99;

/// Velocity below which an axis counts as at rest, in rad/s. Measured velocities have noise.
const REST: f64 = 0.02;
/// Number of successive samples with the same heartbeat after which the program counts as not running.
const MISSED_BEATS: u32 = 25;
/// Number of times that the heartbeat must advance before the program counts as running.
const PROOF_BEATS: u32 = 3;
/// Greatest advance of the heartbeat between two samples: the cycles of the longest gap that a connection survives.
const MAX_ADVANCE: i32 = 1024;

/// State of the driver's program in the controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ProgramState {
    /// The program waits for an epoch (sequence of set-points), or has stopped at the end of one.
    Waiting,
    /// The program follows the set-points of the epoch with this number.
    Following(i32),
    /// The program brakes the arm.
    Braking,
    /// No program runs, so the driver may send its own.
    Absent,
    /// A program of another process of this driver runs. Its driver is gone, because the inputs are free.
    Orphaned,
    /// A program that is not this driver's runs, is paused, or starts or ends.
    Foreign,
}

/// Interpretation of successive samples of one connection.
pub(super) struct Status {
    token: i32,
    /// Heartbeat of the last sample; `None` before the first one, which proves nothing.
    heartbeat: Option<i32>,
    /// Number of advances of the heartbeat without a longer pause.
    beats: u32,
    missed_beats: u32,
}

impl Status {
    /// Creates the interpretation for programs with this token.
    pub(super) fn new(token: i32) -> Self {
        Self {
            token,
            heartbeat: None,
            beats: 0,
            missed_beats: 0,
        }
    }

    /// True if the heartbeat of the driver's program has advanced under this connection, and still does.
    ///
    /// Registers keep their values when a program ends, so no value of theirs shows that the program runs. While the
    /// program brakes, it has no heartbeat; it must prove itself again afterwards.
    fn is_alive(&mut self, heartbeat: i32) -> bool {
        let last = self.heartbeat.replace(heartbeat).unwrap_or(heartbeat);
        match heartbeat.wrapping_sub(last) & COUNTER_MASK {
            1..=MAX_ADVANCE => {
                self.beats = self.beats.saturating_add(1);
                self.missed_beats = 0;
            }
            0 if self.missed_beats < MISSED_BEATS => self.missed_beats += 1,
            _ => self.beats = 0,
        }
        self.beats >= PROOF_BEATS
    }

    /// Returns the state of the program at the next sample.
    pub(super) fn program(&mut self, sample: &Sample) -> ProgramState {
        let is_alive = self.is_alive(sample.heartbeat);
        match sample.runtime_state {
            STOPPED => ProgramState::Absent,
            PLAYING if is_alive && sample.token == self.token => match sample.phase {
                2 => ProgramState::Following(sample.epoch),
                3 => ProgramState::Braking,
                1 | 4 | 5 => ProgramState::Waiting,
                _ => ProgramState::Foreign,
            },
            PLAYING if is_alive && program::is_token(sample.token) => ProgramState::Orphaned,
            _ => ProgramState::Foreign,
        }
    }
}

/// Returns the error code for the modes of the robot and its safety controller; 0 if the arm can move.
pub(super) fn failure(sample: &Sample) -> ErrorCode {
    if SAFETY_EMERGENCY.contains(&sample.safety_mode) {
        ErrorCode::EMERGENCY_STOP
    } else if !SAFETY_NORMAL.contains(&sample.safety_mode) {
        ErrorCode::PROTECTIVE_STOP
    } else if sample.robot_mode != ROBOT_RUNNING || is_slow(sample) {
        ErrorCode::CONTROLLER_STOPPED
    } else {
        ErrorCode::OK
    }
}

/// True if the controller does not run at its full speed. Its cycles are longer then for the program, which would neither see
/// every set-point nor brake in time. Without a running program, the scaling of the trajectory has no meaning.
fn is_slow(sample: &Sample) -> bool {
    let is_scaled = sample.runtime_state == PLAYING && sample.speed_scaling < FULL_SPEED;
    is_scaled || sample.speed_fraction < FULL_SPEED
}

/// True if no axis moves.
pub(super) fn is_at_rest(sample: &Sample) -> bool {
    sample.velocities.iter().all(|speed| speed.abs() < REST)
}

/// Returns what the user must do before the arm can follow set-points, for a controller in this state.
pub(super) fn advice(sample: &Sample, program: ProgramState) -> &'static str {
    match (failure(sample), program) {
        (ErrorCode::EMERGENCY_STOP, _) => {
            "the emergency stop is active; release it and switch the robot on"
        }
        (ErrorCode::PROTECTIVE_STOP, _) => {
            "a safety function has stopped the robot; clear the cause and unlock it at the pendant"
        }
        (ErrorCode::CONTROLLER_STOPPED, _) if sample.robot_mode == ROBOT_RUNNING => {
            "the speed is reduced; set the speed slider at the pendant to 100 %"
        }
        (ErrorCode::CONTROLLER_STOPPED, _) => {
            "the robot is not running; switch it on and release its brakes"
        }
        (_, ProgramState::Foreign) => {
            "another program runs or is paused on the controller; stop it at the pendant"
        }
        (_, ProgramState::Absent | ProgramState::Orphaned) => {
            "the controller does not start the program of the driver; set it to remote control"
        }
        (_, _) if !is_at_rest(sample) => "the arm moves; wait until it rests",
        (_, _) => {
            "the program of the driver does not follow set-points; see the log of the pendant"
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rtde::AXES;

    fn sample(safety_mode: i32, robot_mode: i32) -> Sample {
        Sample {
            clock: 0.0,
            positions: [0.0; AXES],
            velocities: [0.0; AXES],
            targets: [0.0; AXES],
            robot_mode,
            safety_mode,
            runtime_state: PLAYING,
            speed_scaling: 1.0,
            speed_fraction: 1.0,
            phase: 2,
            epoch: 4,
            heartbeat: 1,
            token: program::token(9),
        }
    }

    #[test]
    fn each_mode_has_its_code() {
        let code = |safety, robot| failure(&sample(safety, robot));
        assert_eq!(code(1, 7), ErrorCode::OK);
        assert_eq!(code(2, 7), ErrorCode::OK);
        assert_eq!(code(1, 5), ErrorCode::CONTROLLER_STOPPED);
        assert_eq!(code(3, 7), ErrorCode::PROTECTIVE_STOP);
        assert_eq!(code(5, 7), ErrorCode::PROTECTIVE_STOP);
        assert_eq!(code(6, 7), ErrorCode::EMERGENCY_STOP);
        assert_eq!(code(7, 3), ErrorCode::EMERGENCY_STOP);
        // Modes that the description does not have yet never let the arm move.
        assert_eq!(code(99, 7), ErrorCode::PROTECTIVE_STOP);
    }

    #[test]
    fn a_reduced_speed_is_reported_with_its_cause() {
        let mut now = sample(1, 7);
        now.speed_fraction = 0.5;
        assert_eq!(failure(&now), ErrorCode::CONTROLLER_STOPPED);
        assert!(advice(&now, ProgramState::Waiting).contains("speed slider"));
        (now.speed_fraction, now.speed_scaling) = (1.0, 0.0);
        assert_eq!(failure(&now), ErrorCode::CONTROLLER_STOPPED);
        now.runtime_state = STOPPED;
        assert_eq!(failure(&now), ErrorCode::OK);
    }

    #[test]
    fn registers_of_an_ended_program_are_not_trusted() {
        let mut status = Status::new(program::token(9));
        let mut now = sample(1, 7);
        let states: Vec<ProgramState> = (COUNTER_MASK - 20..COUNTER_MASK + 80)
            .map(|heartbeat| {
                now.heartbeat = heartbeat & COUNTER_MASK;
                status.program(&now)
            })
            .collect();
        assert_eq!(states[..3], [ProgramState::Foreign; 3]);
        assert_eq!(states[3..], [ProgramState::Following(4); 97]);
        let later: Vec<ProgramState> = (0..40).map(|_| status.program(&now)).collect();
        assert_eq!(later.first(), Some(&ProgramState::Following(4)));
        assert_eq!(later.last(), Some(&ProgramState::Foreign));
        now.runtime_state = STOPPED;
        assert_eq!(status.program(&now), ProgramState::Absent);
    }

    /// The registers still have the values of a program of this driver, but another program runs.
    #[test]
    fn values_that_do_not_change_prove_no_program() {
        for token in [program::token(1), program::token(9)] {
            for phase in 0..7 {
                let mut status = Status::new(program::token(9));
                let mut now = sample(1, 7);
                (now.token, now.phase, now.heartbeat) = (token, phase, 812);
                let states: Vec<ProgramState> = (0..100).map(|_| status.program(&now)).collect();
                assert_eq!(states, [ProgramState::Foreign; 100]);
                // A single change may be the last act of the program.
                now.heartbeat = 813;
                assert_eq!(status.program(&now), ProgramState::Foreign);
                now.heartbeat = -5;
                assert_eq!(status.program(&now), ProgramState::Foreign);
            }
        }
    }

    #[test]
    fn a_program_of_another_process_is_recognised() {
        let mut status = Status::new(program::token(1));
        let mut now = sample(1, 7);
        let mut state = |token, heartbeat| {
            (now.token, now.heartbeat) = (token, heartbeat);
            status.program(&now)
        };
        let states = [1, 2, 4, 5].map(|heartbeat| state(program::token(9), heartbeat));
        assert_eq!(states[..3], [ProgramState::Foreign; 3]);
        assert_eq!(states[3], ProgramState::Orphaned);
        assert_eq!(state(0, 6), ProgramState::Foreign);
    }
}
