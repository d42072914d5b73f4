//! The thread of the driver: connects again after a loss, sends the program, begins epochs, and plays set-points.

use super::AXES;
use super::UrSpec;
use super::error::RtdeError;
use super::link::{ControllerState, SetPoint, Shared};
use super::pace::Pace;
use super::player::Player;
use super::recipe::{COUNTER_MASK, Command, Joints, Sample};
use super::session::Session;
use super::status::{self, ProgramState, Status};
use super::upload::{Upload, UploadState};
use crate::error_code::ErrorCode;
use rtrb::{Consumer, Producer};
use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant};

/// Shortest and longest time between two attempts to connect, to send the program or to begin an epoch.
const BACK_OFF: [Duration; 2] = [Duration::from_millis(200), Duration::from_secs(5)];
/// Time after the end of an epoch before the next attempt, so that an operator who has stopped the program sees that it has
/// stopped.
const AFTER_STOP: Duration = Duration::from_millis(500);
/// Time without a state of the controller after which the connection is closed and opened again.
const SILENCE: Duration = Duration::from_secs(1);
/// Time in which the program must answer: start, or follow a new epoch.
const PROGRAM_TIME: Duration = Duration::from_secs(2);
/// Maximum distance of the commanded from the measured position at which an epoch begins at the commanded one, in rad.
const TARGET_TOLERANCE: f64 = 0.005;
/// Number of times that the last set-point is repeated at the end, so that the program recognises rest.
const REPETITIONS: u32 = 5;

/// Maximum time that one command plays, in s. The number of the command tells the program how many cycles it stands for, and
/// the program bridges them at constant velocity meanwhile. After a longer gap, the player catches up by its speed.
const MAX_PLAYED: f64 = 0.1;

/// Progress towards a program that follows set-points.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Stage {
    /// No epoch (sequence of set-points) has begun.
    Idle,
    /// The program must begin to follow this epoch before the time limit.
    Joining(i32, Instant),
    /// The program follows this epoch.
    Following(i32),
}

/// Attempts of one kind, with pauses between them that grow.
#[derive(Clone, Copy, Debug)]
struct Attempts {
    next: Instant,
    /// Time between the next attempt and the one after it.
    pause: Duration,
}

impl Attempts {
    /// Creates attempts from this time on.
    fn new(next: Instant) -> Self {
        let pause = BACK_OFF[0];
        Self { next, pause }
    }

    /// True if an attempt may be made, which then counts as made.
    fn is_due(&mut self, now: Instant) -> bool {
        let is_due = now >= self.next;
        if is_due {
            (self.next, self.pause) = (now + self.pause, (2 * self.pause).min(BACK_OFF[1]));
        }
        is_due
    }
}

/// Both queues to the cycle.
pub(super) type Queues = (Consumer<SetPoint>, Producer<ControllerState>);

/// State of the thread.
pub(super) struct Exchange {
    spec: UrSpec,
    /// Token and text of the program.
    program: (i32, String),
    queues: Queues,
    shared: Arc<Shared>,
    player: Player,
    stage: Stage,
    /// Number of the last epoch.
    epoch: i32,
    /// Number of the last command.
    number: i32,
    /// Positions at which the present epoch has begun, in rad; held until the cycle sends set-points.
    start: Joints,
    /// Transmission of the program, kept until the program runs.
    upload: Option<Upload>,
    /// Error of the last attempt to send the program; `None` if it was sent.
    upload_error: Option<String>,
    /// Attempts to send the program.
    sending: Attempts,
    /// Attempts to begin an epoch.
    joining: Attempts,
    pace: Pace,
}

impl Exchange {
    /// Creates the state of a thread for a cell with ticks of `tick` s.
    pub(super) fn new(
        spec: UrSpec,
        program: (i32, String),
        tick: f64,
        queues: Queues,
        shared: Arc<Shared>,
    ) -> Self {
        // Covers the jitter of the cell's clock and the one of the controller's.
        let delay = 2.0 * tick + 0.006;
        Self {
            spec,
            epoch: program.0 & 0xffff,
            program,
            queues,
            shared,
            player: Player::new(delay),
            stage: Stage::Idle,
            number: 0,
            start: [0.0; AXES],
            upload: None,
            upload_error: None,
            sending: Attempts::new(Instant::now()),
            joining: Attempts::new(Instant::now()),
            pace: Pace::new(0.002, Instant::now()),
        }
    }

    /// Exchanges samples and set-points, and connects again after each loss, until the connection is closed.
    pub(super) fn run(mut self, first: Session) {
        let mut session = Ok(first);
        let mut pause = BACK_OFF[0];
        loop {
            let ended = session.and_then(|session| {
                pause = BACK_OFF[0];
                self.exchange(session)
            });
            self.shared.set_connected(false);
            let Err(error) = ended else {
                return;
            };
            self.shared.set_advice(&error.to_string());
            let until = Instant::now() + pause;
            while Instant::now() < until {
                if self.shared.is_closed() {
                    return;
                }
                thread::sleep(Duration::from_millis(10));
            }
            pause = (2 * pause).min(BACK_OFF[1]);
            session = Session::open(&self.spec);
        }
    }

    /// Exchanges samples and set-points until the connection is closed by this end.
    ///
    /// # Errors
    /// Returns the cause of a loss of the connection.
    fn exchange(&mut self, mut session: Session) -> Result<(), RtdeError> {
        let mut status = Status::new(self.program.0);
        let timeout = Duration::from_secs_f64(self.spec.timeout);
        let mut repetitions = 0;
        self.stage = Stage::Idle;
        self.pace = Pace::new(session.cycle, Instant::now());
        loop {
            let sample = session.receive(self.pace.deadline())?;
            let now = Instant::now();
            let silence = self.pace.silence(now);
            let due = match &sample {
                Some(sample) => {
                    self.take_sample(sample, &mut status);
                    self.pace.take_sample(sample.clock, now)
                }
                None if silence > SILENCE.max(2 * timeout) => {
                    return Err(RtdeError::NoAnswer("its state"));
                }
                None => self.pace.take_time(now),
            };
            // After the time limit, the cycle reports the loss. Without set-points, the controller brakes.
            if due == 0 || sample.is_none() && silence > timeout {
                continue;
            }
            let cycles = due.min((MAX_PLAYED / session.cycle) as u32);
            self.take_set_points();
            let is_closed = self.shared.is_closed();
            let command = self.next_command(cycles, session.cycle).or_else(|| {
                let last = self.player.newest().filter(|_| is_closed)?;
                repetitions += 1;
                let repeats = self.player.is_at_rest() && repetitions <= REPETITIONS;
                repeats.then(|| self.command(last, cycles))
            });
            match command {
                Some(command) => session.send(&command)?,
                None if is_closed => return Ok(()),
                None => {}
            }
            if is_closed && (self.player.is_empty() || self.stage == Stage::Idle) {
                return Ok(());
            }
        }
    }

    /// Passes a sample to the cycle, and proceeds towards a program that follows.
    fn take_sample(&mut self, sample: &Sample, status: &mut Status) {
        let program = status.program(sample);
        let failure = status::failure(sample);
        self.proceed(sample, program, failure);
        let following = match self.stage {
            Stage::Following(epoch) => epoch,
            _ => {
                let is_absent = matches!(program, ProgramState::Absent | ProgramState::Orphaned);
                match &self.upload_error {
                    Some(error) if is_absent => self.shared.set_advice(error),
                    _ => self.shared.set_advice(status::advice(sample, program)),
                }
                0
            }
        };
        // A full queue means that the cycle does not run; it needs only newer states then.
        let _ = self.queues.1.push(ControllerState {
            clock: sample.clock,
            positions: sample.positions,
            failure,
            epoch: following,
            start: self.start,
        });
        self.shared.set_connected(true);
    }

    fn proceed(&mut self, sample: &Sample, program: ProgramState, failure: ErrorCode) {
        self.follow_upload(program);
        let now = Instant::now();
        match self.stage {
            Stage::Following(epoch) | Stage::Joining(epoch, _)
                if program == ProgramState::Following(epoch) && failure == ErrorCode::OK =>
            {
                if self.stage != Stage::Following(epoch) {
                    self.player.clear();
                    (self.sending, self.joining) = (Attempts::new(now), Attempts::new(now));
                }
                self.stage = Stage::Following(epoch);
            }
            Stage::Following(_) => {
                self.stage = Stage::Idle;
                let next = now + AFTER_STOP;
                (self.sending, self.joining) = (Attempts::new(next), Attempts::new(next));
            }
            Stage::Joining(_, limit) if now < limit && failure == ErrorCode::OK => {}
            Stage::Joining(..) => self.stage = Stage::Idle,
            Stage::Idle if failure != ErrorCode::OK || !status::is_at_rest(sample) => {}
            Stage::Idle => self.attempt_start(sample, program, now),
        }
    }

    /// The arm rests and has no fault: sends the program if it does not run, or begins an epoch if it waits.
    fn attempt_start(&mut self, sample: &Sample, program: ProgramState, now: Instant) {
        match program {
            ProgramState::Absent | ProgramState::Orphaned
                if self.upload.is_none() && self.sending.is_due(now) =>
            {
                match Upload::start(&self.spec, self.program.1.clone()) {
                    Ok(upload) => self.upload = Some(upload),
                    Err(error) => self.upload_error = Some(error.to_string()),
                }
            }
            ProgramState::Waiting if self.joining.is_due(now) => {
                let gaps = sample.targets.iter().zip(&sample.positions);
                let is_near = gaps
                    .map(|(q, p)| (q - p).abs())
                    .all(|gap| gap < TARGET_TOLERANCE);
                // The commanded position, so that the controller does not move at the start. After some stops it is
                // far away; then the measured one.
                self.start = if is_near {
                    sample.targets
                } else {
                    sample.positions
                };
                self.epoch = (self.epoch.max(sample.epoch & COUNTER_MASK) + 1) & COUNTER_MASK;
                self.epoch = self.epoch.max(1);
                self.stage = Stage::Joining(self.epoch, now + PROGRAM_TIME);
            }
            _ => {}
        }
    }

    /// Ends the transmission of the program when the program runs, after an error, or when another program runs before it is
    /// sent.
    fn follow_upload(&mut self, program: ProgramState) {
        let Some(upload) = &mut self.upload else {
            return;
        };
        let is_over = match upload.state() {
            UploadState::Connecting => program == ProgramState::Foreign,
            UploadState::Sent => {
                self.upload_error = None;
                program == ProgramState::Waiting
            }
            UploadState::Over => true,
            UploadState::Failed(error) => {
                self.upload_error = Some(error.to_string());
                true
            }
        };
        if is_over {
            self.upload = None;
        }
    }

    fn take_set_points(&mut self) {
        while let Ok(new) = self.queues.0.pop() {
            if self.stage == Stage::Following(new.epoch) {
                self.player.push(new.time, new.positions);
            }
        }
    }

    /// Returns the command for the end of the next `cycles` cycles of the controller, each of `cycle` s; `None` if a
    /// set-point is missing.
    fn next_command(&mut self, cycles: u32, cycle: f64) -> Option<Command> {
        let positions = match self.stage {
            Stage::Following(_) if !self.player.is_empty() => {
                self.player.advance(f64::from(cycles) * cycle)?
            }
            _ => self.start,
        };
        Some(self.command(positions, cycles))
    }

    fn command(&mut self, positions: Joints, cycles: u32) -> Command {
        self.number = (self.number + cycles as i32) & COUNTER_MASK;
        Command {
            epoch: match self.stage {
                Stage::Idle => 0,
                Stage::Joining(epoch, _) | Stage::Following(epoch) => epoch,
            },
            number: self.number,
            positions,
        }
    }
}
