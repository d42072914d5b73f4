//! Replays a tape in place of the devices: returns the recorded answers and compares the accesses and set-points with
//! the tape.

use std::cell::RefCell;
use std::ops::Range;

use rpi_core::Why;
use rpi_device::{DeviceBank, Jump, PortId, PortName, Quantity, Refusal, ResolveError};

use super::entry::{Entry, Kind, split};
use super::reason::why_of;
use crate::control::{CommandId, Late, Plant};

/// A difference between the tape and the replay in the device exchange of a tick.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Mismatch {
    /// The set-point differs.
    SetPoint {
        /// Number of the port.
        port: u32,
        /// Memory words of the recorded set-point.
        recorded: Vec<u64>,
        /// Memory words of the set-point of the replay.
        now: Vec<u64>,
    },
    /// The access is not the next one on the tape.
    Asked {
        /// Kind and key of the next access on the tape; `None` at the end of the tick.
        recorded: Option<(Kind, u32)>,
        /// Kind and key of the access of the replay.
        now: (Kind, u32),
    },
    /// The replay did not make an access that is on the tape, with this kind and key.
    Unasked(Kind, u32),
}

/// Device bank of a replay.
pub struct Player {
    devices: usize,
    // Queries take `&self` but advance the tape. A single thread owns the player, so the cell is never borrowed twice.
    state: RefCell<State>,
}

/// Device exchange of a tick and the read position in it.
#[derive(Default)]
struct State {
    words: Vec<u64>,
    at: usize,
    loaded: bool,
    mismatch: Option<Mismatch>,
}

impl State {
    fn peek(&self) -> Option<(Entry<'_>, usize)> {
        let rest = self.words.get(self.at..)?;
        let (entry, after) = split(rest)?;
        Some((entry, self.words.len() - after.len()))
    }

    /// Returns the next entry if it has this kind and key, and advances. Otherwise the mismatch is stored, and nothing
    /// more is replayed.
    fn next(&mut self, kind: Kind, key: u32) -> Option<Entry<'_>> {
        if self.mismatch.is_some() {
            return None;
        }
        let found = self.peek().map(|(entry, end)| (entry.kind, entry.key, end));
        match found {
            Some((k, y, end)) if (k, y) == (kind, key) => {
                let (entry, _) = split(&self.words[self.at..])?;
                self.at = end;
                Some(entry)
            }
            other => {
                let recorded = other.map(|(kind, key, _)| (kind, key));
                let now = (kind, key);
                self.mismatch = Some(Mismatch::Asked { recorded, now });
                None
            }
        }
    }
}

impl Player {
    /// Creates a player for this number of devices.
    #[must_use]
    pub fn new(devices: usize) -> Player {
        Player {
            devices,
            state: RefCell::default(),
        }
    }

    /// Loads the device exchange of the next tick.
    pub fn load(&mut self, exchange: &[u64]) {
        let state = self.state.get_mut();
        state.words.clear();
        state.words.extend_from_slice(exchange);
        (state.at, state.loaded) = (0, true);
    }

    /// Returns the reason if the next entry is the end of all commands for a known reason.
    pub fn halted(&mut self) -> Option<Why> {
        let state = self.state.get_mut();
        let (entry, end) = state.peek().filter(|(e, _)| e.kind == Kind::Halt)?;
        let why = why_of(entry.key);
        state.at = end;
        why
    }

    /// Returns the attribution of an overrun if it is the next entry.
    pub fn too_late(&mut self) -> Option<Late> {
        let state = self.state.get_mut();
        let (entry, end) = state.peek()?;
        let late = late_of(&entry)?;
        state.at = end;
        Some(late)
    }

    /// Returns the difference of this tick, if any. Called after the tick.
    pub fn mismatch(&mut self) -> Option<Mismatch> {
        let state = self.state.get_mut();
        let left = state.peek().map(|(e, _)| Mismatch::Unasked(e.kind, e.key));
        state.mismatch.take().or(left)
    }

    fn answer<T>(&self, kind: Kind, key: u32, take: impl FnOnce(Entry<'_>) -> T) -> Option<T> {
        let mut state = self.state.try_borrow_mut().ok()?;
        state.next(kind, key).map(take)
    }

    /// Copies the answer of an entry into a buffer and returns its flag.
    fn cells(&self, kind: Kind, key: u32, into: &mut [u64]) -> bool {
        let copied = self.answer(kind, key, |entry| {
            if entry.words.len() == into.len() {
                into.copy_from_slice(entry.words);
            }
            entry.flag
        });
        copied.unwrap_or(false)
    }

    fn word(&self, kind: Kind, key: u32) -> u64 {
        let word = self.answer(kind, key, |entry| entry.words.first().copied());
        word.flatten().unwrap_or(0)
    }
}

/// Decodes the attribution of an overrun; `None` if the entry is of another kind.
#[must_use]
pub fn late_of(entry: &Entry<'_>) -> Option<Late> {
    let (Kind::Blamed, &[command, took_ns, late_ns]) = (entry.kind, entry.words) else {
        return None;
    };
    Some(Late {
        command: CommandId::from_number(command),
        took_ns,
        late_ns,
        fragment: entry.key,
    })
}

fn jump_of(words: &[u64]) -> Option<Jump> {
    let &[resource, quantity, value, limit] = words else {
        return None;
    };
    let all = [
        Quantity::Position,
        Quantity::Velocity,
        Quantity::Acceleration,
    ];
    Some(Jump {
        resource: u32::try_from(resource).ok()?,
        quantity: all.into_iter().find(|q| *q as u64 == quantity)?,
        value: f64::from_bits(value),
        limit: f64::from_bits(limit),
    })
}

impl DeviceBank for Player {
    fn resolve(&mut self, _: &PortName<'_>) -> Result<PortId, ResolveError> {
        Err(ResolveError::NoDevice)
    }

    fn resource(&self, port: PortId) -> u32 {
        port.0
    }

    fn resources(&self, port: PortId) -> Range<u32> {
        port.0..port.0
    }

    fn begin(&mut self, resource: u32, _: u32) {
        self.word(Kind::Pace, resource);
    }

    fn read(&mut self, port: PortId, value: &mut [u64]) -> bool {
        self.cells(Kind::Read, port.0, value)
    }

    fn check(&mut self, port: PortId, _: &[u64]) -> Refusal {
        Refusal(self.word(Kind::Check, port.0) as u32)
    }

    fn jump(&self, port: PortId, _: &[u64]) -> Option<Jump> {
        let jump = self.answer(Kind::Jump, port.0, |entry| {
            jump_of(entry.words).filter(|_| entry.flag)
        });
        jump.flatten()
    }

    fn error(&self, port: PortId) -> i64 {
        self.word(Kind::Error, port.0).cast_signed()
    }

    fn write(&mut self, port: PortId, value: &[u64]) {
        let recorded = self.answer(Kind::Write, port.0, |e| e.words.to_vec());
        if let Some(recorded) = recorded.filter(|recorded| recorded != value) {
            self.state.get_mut().mismatch = Some(Mismatch::SetPoint {
                port: port.0,
                recorded,
                now: value.to_vec(),
            });
        }
    }

    fn call(&mut self, port: PortId, _: &[u64], result: &mut [u64]) -> bool {
        self.cells(Kind::Call, port.0, result)
    }

    fn moving(&self, resource: u32) -> bool {
        let moving = self.answer(Kind::Moving, resource, |entry| entry.flag);
        moving.unwrap_or(false)
    }

    fn stop(&mut self, resource: u32) {
        self.answer(Kind::Stop, resource, |_| ());
    }
}

impl Plant for Player {
    type Part = ();

    fn swap(&mut self, _: usize, _: Option<()>) -> Option<()> {
        None
    }

    fn step(&mut self) {}

    fn conditions(&self, each: &mut dyn FnMut(usize, i64, bool)) {
        let loaded = self.state.try_borrow().is_ok_and(|state| state.loaded);
        for device in 0..self.devices {
            let condition = |entry: Entry<'_>| {
                let code = entry.words.first().copied().unwrap_or(0);
                (code.cast_signed(), entry.flag)
            };
            // There are fewer than 2^32 devices.
            let told = loaded.then(|| self.answer(Kind::Condition, device as u32, condition));
            let (code, moving) = told.flatten().unwrap_or_default();
            each(device, code, moving);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::stage::Stage;
    use super::*;

    fn player(fill: impl Fn(&mut Stage)) -> Player {
        let mut stage = Stage::with_capacity(64);
        fill(&mut stage);
        let mut player = Player::new(0);
        player.load(stage.words().unwrap());
        player
    }

    #[test]
    fn devices_answer_as_they_did() {
        let mut player = player(|stage| {
            stage.put(Kind::Read, 3, true, &[&[7, 8]]);
            stage.put(Kind::Moving, 1, true, &[]);
            stage.put(Kind::Write, 4, false, &[&[9]]);
        });
        let mut value = [0; 2];
        assert!(player.read(PortId(3), &mut value) && value == [7, 8]);
        assert!(player.moving(1));
        player.write(PortId(4), &[9]);
        assert_eq!(player.mismatch(), None);
    }

    #[test]
    fn what_is_done_otherwise_is_told_once() {
        let fill = |stage: &mut Stage| stage.put(Kind::Write, 4, false, &[&[9]]);
        let mut other = player(fill);
        other.write(PortId(4), &[8]);
        let told = Mismatch::SetPoint {
            port: 4,
            recorded: vec![9],
            now: vec![8],
        };
        assert_eq!(other.mismatch(), Some(told));
        let mut missing = player(fill);
        assert_eq!(missing.mismatch(), Some(Mismatch::Unasked(Kind::Write, 4)));
        let mut more = player(fill);
        more.stop(2);
        let told = Mismatch::Asked {
            recorded: Some((Kind::Write, 4)),
            now: (Kind::Stop, 2),
        };
        assert_eq!(more.mismatch(), Some(told));
    }
}
