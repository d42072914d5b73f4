//! A session: a policy whose chunks arrive late by random delays, and the arm that follows them.

use crate::policy::Policy;
use crate::watch::{PERIOD, Watch};
use crate::xorshift::Random;
use rpi_kin::state_to_rest::Bounds;
use rpi_kin::{ArmModel, Pose};
use rpi_motion::chunk::{ChunkMotion, ChunkOptions, ChunkRows, ChunkSetPoint, Seam};
use rpi_motion::{Arm, Controls, JointState, Joints};
use rpi_testkit::no_alloc;

/// Bounds that are higher than the limits of every arm.
pub(crate) const UNBOUNDED: Bounds = Bounds {
    speed: 1e6,
    acceleration: 1e9,
    jerk: 1e12,
};

/// Parameters of a session.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Kind {
    /// Number of chunks.
    pub(crate) chunks: usize,
    /// Share of the limits that the policy asks for.
    pub(crate) ask: f64,
    /// Time between two rows, s, and their number.
    pub(crate) period: f64,
    pub(crate) rows: usize,
    /// Shortest and longest delay between observation and arrival, s.
    pub(crate) delay: (f64, f64),
    /// Amplitude of the noise of each number and of the offset of each chunk, rad.
    pub(crate) noise: f64,
    pub(crate) offset: f64,
    pub(crate) with_velocities: bool,
    /// True if pauses, overrides, wild and invalid chunks, other seams and options occur.
    pub(crate) is_wild: bool,
}

impl Kind {
    pub(crate) fn horizon(&self) -> f64 {
        self.period * (self.rows - 1) as f64
    }
}

/// Result of a session.
#[derive(Clone, Debug, Default)]
pub(crate) struct Outcome {
    /// Distance of each set-point from the curve of the policy after the first chunk has come, rad.
    pub(crate) errors: Vec<f64>,
    /// Number of cycles at rest after the first chunk, of cycles in which a limit bound, and of chunks that came too late.
    pub(crate) at_rest: usize,
    pub(crate) limited: usize,
    pub(crate) late: usize,
    pub(crate) rejected: usize,
    /// Bits of all set-points, combined.
    pub(crate) digest: u64,
    pub(crate) worst: [f64; 3],
    pub(crate) is_within: bool,
    pub(crate) smoothing: f64,
}

/// A chunk on its way: time of the observation and of the arrival, s, and its numbers.
struct Sent {
    observed: f64,
    arrives: f64,
    positions: Vec<f64>,
    velocities: Vec<f64>,
}

pub(crate) struct Session {
    pub(crate) arm: Arm,
    kind: Kind,
    policy: Policy,
    random: Random,
    pub(crate) motion: ChunkMotion,
    pub(crate) watch: Watch,
    controls: Controls,
    sent: Option<Sent>,
    time: f64,
    outcome: Outcome,
}

impl Session {
    pub(crate) fn new(model: &'static ArmModel, kind: Kind, seed: u64) -> Self {
        let arm = Arm::new(model, Pose::identity(), &[]);
        let mut random = Random::new(seed);
        let policy = Policy::new(&arm, kind.ask, kind.delay.1, &mut random);
        let start = policy.at(0.0).0;
        let mut motion = ChunkMotion::new(arm, PERIOD);
        let state = JointState::at_rest(start);
        no_alloc(|| motion.begin(&state, UNBOUNDED, PERIOD)).expect("finite");
        Self {
            arm,
            kind,
            policy,
            random,
            motion,
            watch: Watch::standing(&start),
            controls: Controls::default(),
            sent: None,
            time: 0.0,
            outcome: Outcome::default(),
        }
    }

    /// Runs the whole session.
    pub(crate) fn run(mut self) -> Outcome {
        self.exchange_chunks(self.kind.chunks);
        self.outcome.worst = self.watch.worst;
        self.outcome.is_within = self.watch.is_within();
        self.outcome
    }

    fn number(&mut self, amplitude: f64) -> f64 {
        amplitude * self.random.between(-1.0, 1.0)
    }

    /// The policy observes and computes the next chunk.
    fn send(&mut self) {
        let kind = self.kind;
        let (low, high) = kind.delay;
        let delay = low + (high - low) * self.random.unit();
        let jump = match kind.is_wild && self.random.unit() < 0.1 {
            true => 1.0,
            false => kind.offset,
        };
        let offset: Joints = core::array::from_fn(|_| self.number(jump));
        let mut sent = Sent {
            observed: self.time,
            arrives: self.time + delay,
            positions: Vec::new(),
            velocities: Vec::new(),
        };
        for row in 0..kind.rows {
            let (position, velocity) = self.policy.at(self.time + kind.period * row as f64);
            for axis in 0..self.arm.axes() {
                let noise = self.number(kind.noise);
                sent.positions.push(position[axis] + offset[axis] + noise);
                sent.velocities.push(velocity[axis]);
            }
        }
        if kind.is_wild {
            self.spoil(&mut sent);
        }
        self.sent = Some(sent);
    }

    /// Makes some chunks wild: steps between rows, numbers that are none, places far outside of the ranges.
    fn spoil(&mut self, sent: &mut Sent) {
        let at = (self.random.unit() * sent.positions.len() as f64) as usize;
        let at = at.min(sent.positions.len() - 1);
        match self.random.unit() {
            u if u < 0.03 => sent.positions[at] = f64::NAN,
            u if u < 0.06 => sent.positions[at..].iter_mut().for_each(|x| *x += 1.0),
            u if u < 0.09 => sent.positions.iter_mut().for_each(|x| *x *= 3.0),
            u if u < 0.12 => sent
                .positions
                .iter_mut()
                .for_each(|x| *x += self.random.between(-0.3, 0.3)),
            u if u < 0.14 => sent.velocities[at] = 1e5,
            u if u < 0.16 => sent.positions.truncate(at),
            _ => {}
        }
    }

    fn options(&mut self) -> ChunkOptions {
        let mut options = ChunkOptions::default();
        if self.kind.is_wild {
            options.seam = match self.random.unit() < 0.2 {
                true => Seam::Append,
                false => Seam::Overlap,
            };
            options.previous_weight = if self.random.unit() < 0.3 { 0.6 } else { 0.0 };
            options.frozen_rows = (self.random.unit() * 5.0) as usize;
        }
        options
    }

    /// The chunk arrives.
    fn receive(&mut self) {
        let Some(sent) = self.sent.take() else { return };
        let options = self.options();
        let with = self.kind.with_velocities || self.kind.is_wild && self.random.unit() < 0.3;
        let chunk = ChunkRows {
            period: self.kind.period,
            positions: &sent.positions,
            velocities: with.then_some(&sent.velocities[..]),
            age: self.time - sent.observed,
        };
        let taken = no_alloc(|| self.motion.take(&chunk, &options));
        self.outcome.rejected += usize::from(taken.is_err());
        if self.kind.is_wild {
            self.controls = Controls {
                speed_share: if self.random.unit() < 0.1 {
                    self.random.unit()
                } else {
                    1.0
                },
                paused: self.random.unit() < 0.05,
            };
        }
    }

    /// One cycle. `is_counted` is true once a chunk has come.
    pub(crate) fn cycle(&mut self, is_counted: bool) -> ChunkSetPoint {
        let controls = self.controls;
        let at = no_alloc(|| self.motion.next_set_point(controls));
        self.time += PERIOD;
        self.watch.push(&self.arm, &at.state.position);
        for value in at.state.position {
            let mixed = self.outcome.digest.rotate_left(5) ^ value.to_bits();
            self.outcome.digest = mixed.wrapping_mul(0x9E37_79B9_7F4A_7C15);
        }
        if is_counted {
            let wanted = self.policy.at(self.time).0;
            let error = (0..self.arm.axes())
                .map(|axis| (at.state.position[axis] - wanted[axis]).abs())
                .fold(0.0, f64::max);
            self.outcome.errors.push(error);
            self.outcome.at_rest += usize::from(at.at_rest);
            self.outcome.late += usize::from(at.is_late);
            self.outcome.limited += usize::from(at.limit.is_some());
            self.outcome.smoothing = self.outcome.smoothing.max(at.smoothing);
        }
        at
    }

    /// Sends `chunks` chunks and runs until the last one has been received.
    fn exchange_chunks(&mut self, chunks: usize) {
        for number in 0..chunks {
            self.send();
            while self
                .sent
                .as_ref()
                .is_some_and(|sent| self.time < sent.arrives)
            {
                self.cycle(number > 0);
            }
            self.receive();
        }
    }

    /// Runs for `chunks` chunks, and returns once the last one has come into force.
    pub(crate) fn run_chunks(&mut self, chunks: usize) {
        self.exchange_chunks(chunks);
        while self.motion.is_preparing() {
            self.cycle(true);
        }
    }

    /// Pauses the motion, or lets it go on. The policy goes on in both cases.
    pub(crate) fn set_paused(&mut self, paused: bool) {
        self.controls.paused = paused;
    }

    /// Sends chunks until `duration` seconds have passed. Returns the largest velocity of an axis in this time, rad/s.
    pub(crate) fn fastest_within(&mut self, duration: f64) -> f64 {
        let end = self.time + duration;
        let mut fastest = 0.0f64;
        while self.time < end {
            self.send();
            while self
                .sent
                .as_ref()
                .is_some_and(|sent| self.time < sent.arrives)
            {
                let velocities = self.cycle(true).state.velocity;
                fastest = velocities.iter().fold(fastest, |most, v| most.max(v.abs()));
            }
            self.receive();
        }
        fastest
    }

    /// Distance of the last set-point from the curve of the policy, rad.
    pub(crate) fn error(&self) -> f64 {
        self.outcome.errors.last().copied().unwrap_or(f64::NAN)
    }
}
