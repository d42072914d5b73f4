//! Connection to the controller of a `udp-arm`: a thread with the clock of the controller, and queues to the cycle.

use super::protocol::{MAX_BYTES, MAX_SET_POINTS, Positions, SetPointPacket, StatePacket};
use crate::driver_io::{QUEUE, newest};
use rtrb::{Consumer, Producer, RingBuffer};
use std::collections::VecDeque;
use std::io;
use std::net::{Ipv4Addr, Ipv6Addr, SocketAddr, UdpSocket};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

/// Time for which the thread waits for a state of the controller before it sends a datagram again, to contact it.
const GREETING_PERIOD: Duration = Duration::from_millis(20);
/// Time in which a controller must answer when the connection is opened.
const ANSWER_TIME: Duration = Duration::from_secs(3);

/// Set-point on its way to the controller.
#[derive(Clone, Copy, Debug)]
pub(super) struct SetPoint {
    pub(super) epoch: u32,
    /// Number of the set-point within its epoch (sequence of set-points), from 1, without gaps.
    pub(super) number: u64,
    pub(super) positions: Positions,
}

/// End of the connection in the control cycle. Its methods neither wait nor allocate, except for [`Link::open`].
pub(super) struct Link {
    set_points: Producer<SetPoint>,
    states: Consumer<StatePacket>,
    closed: Arc<AtomicBool>,
}

impl Link {
    /// Connects to a controller with this number of axes, waits for its first state and returns it.
    ///
    /// # Errors
    /// Returns the error of the system, or `TimedOut` if no controller with this number of axes answers.
    pub(super) fn open(address: SocketAddr, axes: usize) -> io::Result<(Self, StatePacket)> {
        let own: SocketAddr = match address {
            SocketAddr::V4(_) => (Ipv4Addr::UNSPECIFIED, 0).into(),
            SocketAddr::V6(_) => (Ipv6Addr::UNSPECIFIED, 0).into(),
        };
        let socket = UdpSocket::bind(own)?;
        socket.connect(address)?;
        socket.set_read_timeout(Some(GREETING_PERIOD))?;
        let (set_points, outgoing) = RingBuffer::new(QUEUE);
        let (incoming, mut states) = RingBuffer::new(QUEUE);
        let closed = Arc::new(AtomicBool::new(false));
        let exchange = Exchange {
            socket,
            axes: axes as u8,
            outgoing,
            incoming,
            recent: VecDeque::with_capacity(MAX_SET_POINTS),
        };
        let is_closed = Arc::clone(&closed);
        let thread = thread::Builder::new().name("rpi-udp".into());
        thread.spawn(move || exchange.run(&is_closed))?;
        let first = wait_for_state(&mut states);
        let link = Self {
            set_points,
            states,
            closed,
        };
        first.map(|state| (link, state)).ok_or_else(|| {
            let seconds = ANSWER_TIME.as_secs();
            let message =
                format!("no controller with {axes} axes answers at {address} within {seconds} s");
            io::Error::new(io::ErrorKind::TimedOut, message)
        })
    }

    /// Passes a set-point to the thread. If the thread does not keep pace, the set-point is lost, and the controller
    /// stops because of the gap.
    pub(super) fn send(&mut self, set_point: SetPoint) {
        let _ = self.set_points.push(set_point);
    }

    /// Returns the newest state of the controller since the last call; `None` if there is no new one.
    pub(super) fn newest(&mut self) -> Option<StatePacket> {
        newest(&mut self.states)
    }
}

impl Drop for Link {
    fn drop(&mut self) {
        self.closed.store(true, Ordering::Relaxed);
    }
}

fn wait_for_state(states: &mut Consumer<StatePacket>) -> Option<StatePacket> {
    let begin = Instant::now();
    while begin.elapsed() < ANSWER_TIME {
        if let Ok(state) = states.pop() {
            return Some(state);
        }
        thread::sleep(Duration::from_millis(1));
    }
    None
}

/// End of the connection in the thread that sends and receives datagrams.
struct Exchange {
    socket: UdpSocket,
    axes: u8,
    outgoing: Consumer<SetPoint>,
    incoming: Producer<StatePacket>,
    /// The last set-points of one epoch, the newest first.
    recent: VecDeque<SetPoint>,
}

impl Exchange {
    fn run(mut self, closed: &AtomicBool) {
        let mut buffer = [0; MAX_BYTES];
        self.answer();
        while !closed.load(Ordering::Relaxed) {
            match self.socket.recv(&mut buffer) {
                Ok(size) => self.receive(&buffer[..size]),
                // No state for the greeting period.
                Err(error) if is_timeout(&error) => self.answer(),
                // The controller does not listen yet, or is gone.
                Err(_) => {
                    thread::sleep(GREETING_PERIOD);
                    self.answer();
                }
            }
        }
    }

    fn receive(&mut self, bytes: &[u8]) {
        let state = StatePacket::decode(bytes);
        if let Some(state) = state.filter(|state| state.axes == self.axes) {
            // A full queue means that the cycle does not run; it needs only newer states then.
            let _ = self.incoming.push(state);
            self.answer();
        }
    }

    /// Sends the newest set-points to the controller.
    fn answer(&mut self) {
        while let Ok(new) = self.outgoing.pop() {
            self.recent.retain(|old| old.epoch == new.epoch);
            self.recent.truncate(MAX_SET_POINTS - 1);
            self.recent.push_front(new);
        }
        let newest = self.recent.front();
        let packet = SetPointPacket {
            axes: self.axes,
            epoch: newest.map_or(0, |newest| newest.epoch),
            newest: newest.map_or(0, |newest| newest.number),
            set_points: self.recent.iter().map(|old| old.positions).collect(),
        };
        // A datagram that cannot be sent is a lost one.
        let _ = self.socket.send(&packet.encode());
    }
}

fn is_timeout(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut | io::ErrorKind::Interrupted
    )
}
