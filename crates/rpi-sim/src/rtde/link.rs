//! Connection to the controller of a `ur-arm`: a thread with the clock of the controller, and queues to the cycle.

use super::UrSpec;
use super::exchange::Exchange;
use super::program;
use super::recipe::Joints;
use super::session::Session;
use crate::driver_io::{QUEUE, newest};
use crate::error_code::ErrorCode;
use rpi_kin::AxisLimits;
use rtrb::{Consumer, Producer, RingBuffer};
use std::io;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant, SystemTime};

/// Time in which the controller must follow when the connection is opened.
const START_TIME: Duration = Duration::from_secs(5);
/// Maximum time for which the end of the connection waits until the last set-points are played.
const END_TIME: Duration = Duration::from_millis(500);

/// Set-point on its way to the controller.
#[derive(Clone, Copy, Debug)]
pub(super) struct SetPoint {
    pub(super) epoch: i32,
    /// Time of the cell, in s.
    pub(super) time: f64,
    pub(super) positions: Joints,
}

/// State of the controller for the cycle.
#[derive(Clone, Copy, Debug)]
pub(super) struct ControllerState {
    /// Time of the controller's clock, in s.
    pub(super) clock: f64,
    /// Measured positions, in rad.
    pub(super) positions: Joints,
    /// Error code of the robot and its safety controller; 0 for none.
    pub(super) failure: ErrorCode,
    /// Epoch (sequence of set-points) that the controller follows; 0 for none.
    pub(super) epoch: i32,
    /// Positions at which this epoch has begun, in rad.
    pub(super) start: Joints,
}

/// What both ends of the connection share besides the queues. The cycle uses the flags only.
#[derive(Default)]
pub(super) struct Shared {
    is_closed: AtomicBool,
    is_connected: AtomicBool,
    /// Reason for which the controller does not follow set-points, with the way out.
    advice: Mutex<String>,
}

impl Shared {
    pub(super) fn is_closed(&self) -> bool {
        self.is_closed.load(Ordering::Relaxed)
    }

    pub(super) fn set_connected(&self, is_connected: bool) {
        self.is_connected.store(is_connected, Ordering::Relaxed);
    }

    pub(super) fn set_advice(&self, advice: &str) {
        let mut text = self.advice.lock().unwrap_or_else(PoisonError::into_inner);
        advice.clone_into(&mut text);
    }

    fn advice(&self) -> String {
        let text = self.advice.lock();
        text.unwrap_or_else(PoisonError::into_inner).clone()
    }
}

/// End of the connection in the control cycle. Its methods neither wait nor allocate, except for [`Link::open`].
pub(super) struct Link {
    set_points: Producer<SetPoint>,
    states: Consumer<ControllerState>,
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

impl Link {
    /// Connects to a controller, starts the driver's program there, waits until it follows, and returns its state. `limits`
    /// are those of the arm, `tick` is the duration of a tick of the cell in s.
    ///
    /// # Errors
    /// Returns the error of the connection, or `TimedOut` with a way out if the controller does not follow.
    pub(super) fn open(
        spec: &UrSpec,
        limits: &[AxisLimits],
        tick: f64,
    ) -> io::Result<(Self, ControllerState)> {
        let session = Session::open(spec)?;
        let (set_points, outgoing) = RingBuffer::new(QUEUE);
        let (incoming, states) = RingBuffer::new(QUEUE);
        let shared = Arc::new(Shared::default());
        let since_epoch = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH);
        // Differs from that of an earlier process, whose program may still run.
        let seed = since_epoch.map_or(0, |time| time.subsec_micros()) ^ std::process::id();
        let token = program::token(seed);
        let text = program::text(spec, limits, token);
        let exchange = Exchange::new(
            spec.clone(),
            (token, text),
            tick,
            (outgoing, incoming),
            Arc::clone(&shared),
        );
        let thread = thread::Builder::new().name("rpi-rtde".into());
        let thread = thread.spawn(move || exchange.run(session))?;
        let mut link = Self {
            set_points,
            states,
            shared,
            thread: Some(thread),
        };
        match link.wait_until_it_follows() {
            Some(state) => Ok((link, state)),
            None => {
                let (host, advice) = (&spec.host, link.shared.advice());
                let message = format!("the controller at {host} does not follow: {advice}");
                Err(io::Error::new(io::ErrorKind::TimedOut, message))
            }
        }
    }

    fn wait_until_it_follows(&mut self) -> Option<ControllerState> {
        let begin = Instant::now();
        while begin.elapsed() < START_TIME {
            if let Some(state) = self.newest().filter(|state| state.epoch != 0) {
                return Some(state);
            }
            thread::sleep(Duration::from_millis(1));
        }
        None
    }

    /// True while the connection is open and the controller sends its states.
    pub(super) fn is_connected(&self) -> bool {
        self.shared.is_connected.load(Ordering::Relaxed)
    }

    /// Passes a set-point to the thread. If the thread does not keep pace, the set-point is lost.
    pub(super) fn send(&mut self, set_point: SetPoint) {
        let _ = self.set_points.push(set_point);
    }

    /// Returns the newest state of the controller since the last call; `None` if there is no new one.
    pub(super) fn newest(&mut self) -> Option<ControllerState> {
        newest(&mut self.states)
    }
}

impl Drop for Link {
    /// Waits until the thread has played the last set-points, so that an arm at the end of its motion reaches the end.
    fn drop(&mut self) {
        self.shared.is_closed.store(true, Ordering::Relaxed);
        let begin = Instant::now();
        while let Some(thread) = &self.thread
            && !thread.is_finished()
            && begin.elapsed() < END_TIME
        {
            thread::sleep(Duration::from_millis(1));
        }
    }
}
