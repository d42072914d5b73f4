//! A controller for the driver under test, with jitter, loss and a watchdog that brakes. It runs in a process of its own.

use std::collections::BTreeMap;
use std::io::{self, Read};
use std::net::{SocketAddr, UdpSocket};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use rpi_sim::udp::protocol::{ControllerMode, MAX_BYTES, Positions, SetPointPacket, StatePacket};

/// Number of cycles in which the watchdog brings the arm to rest.
const BRAKE_CYCLES: u32 = 40;

/// Settings of a controller, as passed to its process.
#[derive(Clone, Debug)]
pub(crate) struct Settings {
    /// Period of its clock.
    pub(crate) period: Duration,
    /// Share of datagrams that are lost in each direction.
    pub(crate) loss: f64,
    /// Largest delay of a state.
    pub(crate) jitter: Duration,
    /// Number of set-points that must have come before the first is played.
    pub(crate) depth: usize,
    /// Number of periods without a set-point after which a moving arm brakes.
    pub(crate) watchdog: u32,
    /// Number of set-points after which no datagram passes for a time; 0 for never.
    pub(crate) outage_at: u64,
    /// Initial positions, in rad.
    pub(crate) joints: Vec<f64>,
}

impl Settings {
    pub(crate) fn to_text(&self) -> String {
        let joints: Vec<String> = self.joints.iter().map(f64::to_string).collect();
        format!(
            "{} {} {} {} {} {} {}",
            self.period.as_micros(),
            self.loss,
            self.jitter.as_micros(),
            self.depth,
            self.watchdog,
            self.outage_at,
            joints.join(" ")
        )
    }

    pub(crate) fn from_text(text: &str) -> Settings {
        let numbers: Vec<f64> = text.split(' ').map(|word| word.parse().unwrap()).collect();
        let [
            period,
            loss,
            jitter,
            depth,
            watchdog,
            outage_at,
            joints @ ..,
        ] = &numbers[..]
        else {
            panic!("{text}");
        };
        Settings {
            period: Duration::from_micros(*period as u64),
            loss: *loss,
            jitter: Duration::from_micros(*jitter as u64),
            depth: *depth as usize,
            watchdog: *watchdog as u32,
            outage_at: *outage_at as u64,
            joints: joints.to_vec(),
        }
    }
}

/// A controller with its clock, its buffer of set-points and its log.
struct Controller {
    settings: Settings,
    socket: UdpSocket,
    peer: Option<SocketAddr>,
    random: u64,
    cycles: u64,
    mode: ControllerMode,
    epoch: u32,
    is_playing: bool,
    /// Number of the next set-point to play.
    next: u64,
    buffer: BTreeMap<u64, Positions>,
    missed: u32,
    position: Positions,
    /// Way per cycle.
    velocity: Positions,
    /// Cycles until rest while it brakes.
    braking: u32,
    /// Cycles until datagrams pass again.
    outage: u64,
    /// All set-points in the order in which they were played.
    log: Vec<Positions>,
    brakes: u32,
}

impl Controller {
    fn new(settings: Settings, socket: UdpSocket) -> Controller {
        let mut position = Positions::default();
        position[..settings.joints.len()].copy_from_slice(&settings.joints);
        Controller {
            settings,
            socket,
            peer: None,
            random: 1,
            cycles: 0,
            mode: ControllerMode::Ready,
            epoch: 0,
            is_playing: false,
            next: 1,
            buffer: BTreeMap::new(),
            missed: 0,
            position,
            velocity: Positions::default(),
            braking: 0,
            outage: 0,
            log: Vec::new(),
            brakes: 0,
        }
    }

    /// A random number from 0 to 1 (xorshift).
    fn random(&mut self) -> f64 {
        self.random ^= self.random << 13;
        self.random ^= self.random >> 7;
        self.random ^= self.random << 17;
        (self.random >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn is_lost(&mut self) -> bool {
        self.random() < self.settings.loss || self.outage > 0
    }

    fn receive(&mut self) {
        let mut bytes = [0; MAX_BYTES];
        while let Ok((size, from)) = self.socket.recv_from(&mut bytes) {
            let packet = SetPointPacket::decode(&bytes[..size]);
            let Some(packet) = packet.filter(|_| !self.is_lost()) else {
                continue;
            };
            self.peer = Some(from);
            if packet.set_points.is_empty() {
                continue;
            }
            if packet.epoch != self.epoch && self.velocity == Positions::default() {
                self.begin_epoch(packet.epoch);
            }
            if packet.epoch == self.epoch {
                let numbered = (0..).map(|age| packet.newest - age).zip(packet.set_points);
                let new = numbered.filter(|(number, _)| *number >= self.next);
                self.buffer.extend(new);
            }
        }
    }

    fn begin_epoch(&mut self, epoch: u32) {
        self.epoch = epoch;
        self.mode = ControllerMode::Ready;
        self.is_playing = false;
        self.next = 1;
        self.missed = 0;
        self.buffer.clear();
    }

    fn play(&mut self) {
        self.is_playing |= self.buffer.len() >= self.settings.depth;
        match self.mode {
            ControllerMode::Ready if self.is_playing => self.play_next(),
            ControllerMode::Braking => self.brake(),
            _ => {}
        }
    }

    fn play_next(&mut self) {
        if let Some(positions) = self.buffer.remove(&self.next) {
            let way = positions.iter().zip(self.position);
            way.zip(&mut self.velocity)
                .for_each(|((to, from), velocity)| *velocity = to - from);
            self.position = positions;
            self.log.push(positions);
            self.next += 1;
            self.missed = 0;
            return;
        }
        let rests = self.velocity == Positions::default();
        self.missed += u32::from(!rests || !self.buffer.is_empty());
        if self.missed >= self.settings.watchdog {
            self.brakes += 1;
            self.braking = BRAKE_CYCLES;
            self.mode = ControllerMode::Braking;
            return self.brake();
        }
        self.coast();
    }

    fn coast(&mut self) {
        let axes = self.position.iter_mut().zip(self.velocity);
        axes.for_each(|(position, velocity)| *position += velocity);
    }

    fn brake(&mut self) {
        let share = f64::from(self.braking.saturating_sub(1)) / f64::from(self.braking.max(1));
        self.velocity = self.velocity.map(|velocity| velocity * share);
        self.braking = self.braking.saturating_sub(1);
        self.coast();
        if self.braking == 0 {
            self.velocity = Positions::default();
            self.mode = ControllerMode::Stopped;
        }
    }

    fn send(&mut self) {
        let delay = self.settings.jitter.mul_f64(self.random());
        std::thread::sleep(delay);
        let state = StatePacket {
            axes: self.settings.joints.len() as u8,
            mode: self.mode,
            epoch: self.epoch,
            clock: self.cycles as f64 * self.settings.period.as_secs_f64(),
            positions: self.position,
        };
        if let Some(peer) = self.peer
            && !self.is_lost()
        {
            let _ = self.socket.send_to(&state.encode(), peer);
        }
    }

    fn cycle(&mut self) {
        self.cycles += 1;
        self.outage = self.outage.saturating_sub(1);
        if self.settings.outage_at > 0 && self.log.len() as u64 >= self.settings.outage_at {
            // Once, for long enough that both sides notice it.
            self.settings.outage_at = 0;
            self.outage = 250;
        }
        self.receive();
        self.play();
        self.send();
    }
}

/// Runs a controller until standard input ends. Prints its port at the start, and its log at the end.
pub(crate) fn run(settings: Settings) {
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    socket.set_nonblocking(true).unwrap();
    println!("\nPORT {}", socket.local_addr().unwrap().port());
    let (is_over, period) = (Arc::new(AtomicBool::new(false)), settings.period);
    let stop = Arc::clone(&is_over);
    std::thread::spawn(move || {
        let _ = io::stdin().read_to_end(&mut Vec::new());
        stop.store(true, Ordering::Relaxed);
    });
    let mut controller = Controller::new(settings, socket);
    let mut due = Instant::now();
    while !is_over.load(Ordering::Relaxed) {
        controller.cycle();
        // A late cycle delays the clock: it is the controller's own.
        due = (due + period).max(Instant::now());
        std::thread::sleep(due.saturating_duration_since(Instant::now()));
    }
    println!(
        "BRAKES {} REST {}",
        controller.brakes,
        controller.velocity == Positions::default()
    );
    for positions in &controller.log {
        let axes = positions.iter().take(controller.settings.joints.len());
        let bits: Vec<String> = axes
            .map(|position| position.to_bits().to_string())
            .collect();
        println!("SET {}", bits.join(" "));
    }
}
