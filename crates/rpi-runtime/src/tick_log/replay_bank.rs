//! Replays a tick log in place of the devices: returns the recorded answers and compares the accesses and set-points with
//! the tick log.

use std::cell::RefCell;
use std::collections::BTreeSet;
use std::ops::Range;

use rpi_core::AbortReason;
use rpi_device::{DeviceBank, Discontinuity, PortId, PortQuery, Quantity, Rejection, ResolveError};

use super::entry::{EntryKind, LogEntry, decode_first};
use super::reason::reason_from_number;
use crate::control::{AttributedOverrun, CommandId, Plant};

/// Difference between the exchange with the devices in the tick log and that of the replay, in one tick.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Mismatch {
    /// The core wrote another set-point in the replay than in the recording.
    SetPoint {
        /// Number of the set-point's port in the device bank.
        port: u32,
        /// Memory words of the recorded set-point.
        recorded: Vec<u64>,
        /// Memory words of the set-point in the replay.
        now: Vec<u64>,
    },
    /// The core made another access to a device in the replay than the next one in the tick log.
    UnexpectedAccess {
        /// Kind and key of the next access in the tick log; `None` at the end of the tick.
        recorded: Option<(EntryKind, u32)>,
        /// Kind and key of the access in the replay.
        now: (EntryKind, u32),
    },
    /// The core did not make an access in the replay that is in the tick log, with this kind and key.
    MissingAccess(EntryKind, u32),
}

/// Device bank of a replay: it answers the accesses of the core with the values in the tick log, and compares the
/// set-points of the core with those in the log.
pub struct ReplayBank {
    devices: usize,
    // Queries take `&self` but advance the tick log. A single thread owns the player, so the cell is never borrowed twice.
    state: RefCell<ReplayState>,
}

/// Logged exchange with the devices in one tick, and the read position in it.
#[derive(Default)]
struct ReplayState {
    words: Vec<u64>,
    at: usize,
    /// Whether accesses may come in another order than in the log, and be more or fewer.
    any_order: bool,
    /// Positions of the entries from `at` on that were replayed before their turn.
    replayed: BTreeSet<usize>,
    loaded: bool,
    mismatch: Option<Mismatch>,
    /// Ports that were read and are not in the log.
    unrecorded: BTreeSet<u32>,
}

impl ReplayState {
    /// Returns the first entry of this kind and key that was not replayed; `None` if there is none, which is no mismatch.
    fn next_of(&mut self, kind: EntryKind, key: u32) -> Option<LogEntry<'_>> {
        let mut at = self.at;
        loop {
            let (entry, after) = decode_first(self.words.get(at..)?)?;
            let end = self.words.len() - after.len();
            if (entry.kind, entry.key) == (kind, key) && !self.replayed.contains(&at) {
                break;
            }
            at = end;
        }
        self.replayed.insert(at);
        self.skip(|_| false);
        decode_first(&self.words[at..]).map(|(entry, _)| entry)
    }

    /// Advances over the entries that were replayed, and over those of a kind for which `is_over` holds.
    fn skip(&mut self, is_over: impl Fn(EntryKind) -> bool) {
        while let Some((entry, end)) = self.peek() {
            let is_over = is_over(entry.kind);
            if !(self.replayed.remove(&self.at) || is_over) {
                return;
            }
            self.at = end;
        }
    }

    fn peek(&self) -> Option<(LogEntry<'_>, usize)> {
        let rest = self.words.get(self.at..)?;
        let (entry, after) = decode_first(rest)?;
        Some((entry, self.words.len() - after.len()))
    }

    /// Returns the next entry of the log if it has this kind and key, and advances. Otherwise the mismatch is stored,
    /// `None` is returned, and nothing more is replayed.
    fn next(&mut self, kind: EntryKind, key: u32) -> Option<LogEntry<'_>> {
        if self.any_order {
            return self.next_of(kind, key);
        }
        if self.mismatch.is_some() {
            return None;
        }
        let found = self.peek().map(|(entry, end)| (entry.kind, entry.key, end));
        match found {
            Some((k, y, end)) if (k, y) == (kind, key) => {
                let (entry, _) = decode_first(&self.words[self.at..])?;
                self.at = end;
                Some(entry)
            }
            other => {
                let recorded = other.map(|(kind, key, _)| (kind, key));
                let now = (kind, key);
                self.mismatch = Some(Mismatch::UnexpectedAccess { recorded, now });
                None
            }
        }
    }
}

impl ReplayBank {
    /// Creates a replay bank for a recording with this number of devices.
    #[must_use]
    pub fn new(devices: usize) -> ReplayBank {
        ReplayBank {
            devices,
            state: RefCell::default(),
        }
    }

    /// Creates a replay bank for commands that were compiled otherwise than the recorded ones: they may access the devices in
    /// another order, and read ports that were not recorded, which have the value 0. Set-points are compared.
    #[must_use]
    pub fn in_any_order(devices: usize) -> ReplayBank {
        let bank = ReplayBank::new(devices);
        bank.state.borrow_mut().any_order = true;
        bank
    }

    /// Returns the ports that were read so far although the log has no value for them.
    pub fn unrecorded(&mut self) -> &BTreeSet<u32> {
        &self.state.get_mut().unrecorded
    }

    /// Ends the accesses of the commands in a tick: those of the log that are left are skipped if any order is permitted.
    pub fn end_accesses(&mut self) {
        let state = self.state.get_mut();
        if state.any_order {
            state.skip(|kind| !matches!(kind, EntryKind::Halt | EntryKind::OverrunCause));
        }
    }

    /// Loads the logged exchange with the devices in the next tick, as words of entries.
    pub fn load_tick(&mut self, exchange: &[u64]) {
        let state = self.state.get_mut();
        state.words.clear();
        state.words.extend_from_slice(exchange);
        state.replayed.clear();
        (state.at, state.loaded) = (0, true);
    }

    /// Returns the abort reason if the next entry of the log is an abort of all commands, and skips the entry. Returns
    /// `None` otherwise, or if the reason is unknown.
    pub fn take_halt(&mut self) -> Option<AbortReason> {
        let state = self.state.get_mut();
        let (entry, end) = state.peek().filter(|(e, _)| e.kind == EntryKind::Halt)?;
        let why = reason_from_number(entry.key);
        state.at = end;
        why
    }

    /// Returns the overrun and the command to which it is attributed if the next entry of the log is such an
    /// attribution, and skips the entry. Returns `None` otherwise.
    pub fn take_overrun(&mut self) -> Option<AttributedOverrun> {
        let state = self.state.get_mut();
        let (entry, end) = state.peek()?;
        let late = decode_overrun(&entry)?;
        state.at = end;
        Some(late)
    }

    /// Returns the first difference between the replay and the log in this tick; `None` if there is none. Called after
    /// the tick.
    pub fn mismatch(&mut self) -> Option<Mismatch> {
        let state = self.state.get_mut();
        let left = state
            .peek()
            .filter(|_| !state.any_order)
            .map(|(e, _)| Mismatch::MissingAccess(e.kind, e.key));
        state.mismatch.take().or(left)
    }

    fn replay_entry<T>(
        &self,
        kind: EntryKind,
        key: u32,
        take: impl FnOnce(LogEntry<'_>) -> T,
    ) -> Option<T> {
        let mut state = self.state.try_borrow_mut().ok()?;
        state.next(kind, key).map(take)
    }

    /// Copies the words of the next entry of the log, if it has this kind and key, to a buffer and returns its flag.
    /// Returns false if the entry does not fit.
    fn copy_words(&self, kind: EntryKind, key: u32, into: &mut [u64]) -> bool {
        let copied = self.replay_entry(kind, key, |entry| {
            if entry.words.len() == into.len() {
                into.copy_from_slice(entry.words);
            }
            entry.flag
        });
        copied.unwrap_or(false)
    }

    fn word(&self, kind: EntryKind, key: u32) -> u64 {
        let word = self.replay_entry(kind, key, |entry| entry.words.first().copied());
        word.flatten().unwrap_or(0)
    }
}

/// Decodes a tick log entry that attributes an overrun to a command; `None` if the entry is of another kind.
#[must_use]
pub fn decode_overrun(entry: &LogEntry<'_>) -> Option<AttributedOverrun> {
    let (EntryKind::OverrunCause, &[command, took_ns, late_ns]) = (entry.kind, entry.words) else {
        return None;
    };
    Some(AttributedOverrun {
        command: CommandId::from_number(command),
        took_ns,
        late_ns,
        fragment: entry.key,
    })
}

fn decode_discontinuity(words: &[u64]) -> Option<Discontinuity> {
    let &[resource, quantity, value, limit] = words else {
        return None;
    };
    let all = [
        Quantity::Position,
        Quantity::Velocity,
        Quantity::Acceleration,
    ];
    Some(Discontinuity {
        resource: u32::try_from(resource).ok()?,
        quantity: all.into_iter().find(|q| *q as u64 == quantity)?,
        value: f64::from_bits(value),
        limit: f64::from_bits(limit),
    })
}

impl DeviceBank for ReplayBank {
    fn resolve(&mut self, _: &PortQuery<'_>) -> Result<PortId, ResolveError> {
        Err(ResolveError::UnknownDevice)
    }

    fn resource(&self, port: PortId) -> u32 {
        port.0
    }

    fn resources(&self, port: PortId) -> Range<u32> {
        port.0..port.0
    }

    fn begin_command(&mut self, resource: u32, _: u32) {
        self.word(EntryKind::Period, resource);
    }

    fn read(&mut self, port: PortId, value: &mut [u64]) -> bool {
        let any_order = self.state.get_mut().any_order;
        let recorded = self.replay_entry(EntryKind::Read, port.0, |entry| {
            if entry.words.len() == value.len() {
                value.copy_from_slice(entry.words);
            }
            entry.flag
        });
        // Without a value, the command would end with a fault.
        recorded.unwrap_or_else(|| {
            self.state.get_mut().unrecorded.insert(port.0);
            value.fill(0);
            any_order
        })
    }

    fn check_set_point(&mut self, port: PortId, _: &[u64]) -> Rejection {
        Rejection(self.word(EntryKind::Check, port.0) as u32)
    }

    fn discontinuity(&self, port: PortId, _: &[u64]) -> Option<Discontinuity> {
        let jump = self.replay_entry(EntryKind::Discontinuity, port.0, |entry| {
            decode_discontinuity(entry.words).filter(|_| entry.flag)
        });
        jump.flatten()
    }

    fn error_code(&self, port: PortId) -> i64 {
        self.word(EntryKind::Error, port.0).cast_signed()
    }

    fn write(&mut self, port: PortId, value: &[u64]) {
        let recorded = self.replay_entry(EntryKind::Write, port.0, |e| e.words.to_vec());
        if let Some(recorded) = recorded.filter(|recorded| recorded != value) {
            self.state.get_mut().mismatch = Some(Mismatch::SetPoint {
                port: port.0,
                recorded,
                now: value.to_vec(),
            });
        }
    }

    fn call(&mut self, port: PortId, _: &[u64], result: &mut [u64]) -> bool {
        self.copy_words(EntryKind::Call, port.0, result)
    }

    fn is_moving(&self, resource: u32) -> bool {
        let moving = self.replay_entry(EntryKind::Moving, resource, |entry| entry.flag);
        moving.unwrap_or(false)
    }

    fn stop(&mut self, resource: u32) {
        self.replay_entry(EntryKind::Stop, resource, |_| ());
    }
}

impl Plant for ReplayBank {
    type Device = ();

    fn swap(&mut self, _: usize, _: Option<()>) -> Option<()> {
        None
    }

    fn step(&mut self) {}

    fn device_states(&self, each: &mut dyn FnMut(usize, i64, bool)) {
        let loaded = self.state.try_borrow().is_ok_and(|state| state.loaded);
        for device in 0..self.devices {
            let condition = |entry: LogEntry<'_>| {
                let code = entry.words.first().copied().unwrap_or(0);
                (code.cast_signed(), entry.flag)
            };
            // There are fewer than 2^32 devices.
            let state =
                loaded.then(|| self.replay_entry(EntryKind::DeviceState, device as u32, condition));
            let (code, moving) = state.flatten().unwrap_or_default();
            each(device, code, moving);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::entry_buffer::EntryBuffer;
    use super::*;

    fn player(fill: impl Fn(&mut EntryBuffer)) -> ReplayBank {
        let mut stage = EntryBuffer::with_capacity(64);
        fill(&mut stage);
        let mut player = ReplayBank::new(0);
        player.load_tick(stage.words().unwrap());
        player
    }

    #[test]
    fn devices_answer_as_they_did() {
        let mut player = player(|stage| {
            stage.push(EntryKind::Read, 3, true, &[&[7, 8]]);
            stage.push(EntryKind::Moving, 1, true, &[]);
            stage.push(EntryKind::Write, 4, false, &[&[9]]);
        });
        let mut value = [0; 2];
        assert!(player.read(PortId(3), &mut value) && value == [7, 8]);
        assert!(player.is_moving(1));
        player.write(PortId(4), &[9]);
        assert_eq!(player.mismatch(), None);
    }

    #[test]
    fn what_is_done_otherwise_is_told_once() {
        let fill = |stage: &mut EntryBuffer| stage.push(EntryKind::Write, 4, false, &[&[9]]);
        let mut other = player(fill);
        other.write(PortId(4), &[8]);
        let mismatch = Mismatch::SetPoint {
            port: 4,
            recorded: vec![9],
            now: vec![8],
        };
        assert_eq!(other.mismatch(), Some(mismatch));
        let mut missing = player(fill);
        assert_eq!(
            missing.mismatch(),
            Some(Mismatch::MissingAccess(EntryKind::Write, 4))
        );
        let mut more = player(fill);
        more.stop(2);
        let mismatch = Mismatch::UnexpectedAccess {
            recorded: Some((EntryKind::Write, 4)),
            now: (EntryKind::Stop, 2),
        };
        assert_eq!(more.mismatch(), Some(mismatch));
    }

    #[test]
    fn accesses_in_another_order_get_their_own_answers() {
        let mut stage = EntryBuffer::with_capacity(64);
        stage.push(EntryKind::Read, 3, true, &[&[7]]);
        stage.push(EntryKind::Read, 5, true, &[&[8]]);
        stage.push(EntryKind::Read, 3, true, &[&[9]]);
        stage.push(EntryKind::Write, 4, false, &[&[1]]);
        let mut player = ReplayBank::in_any_order(0);
        player.load_tick(stage.words().unwrap());
        let read = |player: &mut ReplayBank, port| {
            let mut value = [0];
            player.read(PortId(port), &mut value).then_some(value[0])
        };
        assert_eq!(read(&mut player, 5), Some(8));
        // What was not recorded has the value 0.
        assert_eq!(read(&mut player, 6), Some(0));
        assert_eq!(read(&mut player, 3), Some(7));
        player.write(PortId(4), &[2]);
        assert_eq!(read(&mut player, 3), Some(9));
        assert_eq!(read(&mut player, 3), Some(0));
        player.end_accesses();
        assert!(matches!(
            player.mismatch(),
            Some(Mismatch::SetPoint { port: 4, .. })
        ));
    }
}
