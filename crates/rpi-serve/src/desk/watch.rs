//! Who is told what: states at once, exported values now and then.

use std::time::{Duration, Instant};

use rpi_core::Overrun;
use rpi_host::control::{Board, State};
use rpi_image::image::Export;
use rpi_net::literal;

use super::{Desk, Failure, Phase, Record, Sink, Status, Update};

/// What somebody wants to be told about a command.
pub(crate) struct Watching {
    /// Least time between two updates of values.
    pub(crate) period: Duration,
    /// How long after its last values a command's end is told, for clients that take both apart again. Zero for those
    /// that take things as they come, and that need not be told either that what was taken over is complete.
    pub(crate) settle: Duration,
    pub(crate) sink: Box<dyn Sink>,
}

/// Somebody who is told about a command.
pub(super) struct Subscription {
    period: Duration,
    settle: Duration,
    due: Instant,
    /// An end that is yet to be told, and when.
    late: Option<(Instant, Status)>,
    /// What it knows already.
    last: Vec<u64>,
    sink: Box<dyn Sink>,
}

impl Subscription {
    /// Tells a state, after what is yet to be told; an end only once the values before it have settled.
    fn tell(&mut self, status: &Status, now: Instant) -> bool {
        let listens = self.tell_late(None);
        if status.phase == Phase::Is(State::Terminated) && !self.settle.is_zero() {
            self.late = Some((now + self.settle, status.clone()));
            return listens;
        }
        listens && self.sink.tell(&Update::Command(status))
    }

    /// Tells an end for which it is time; without a time, in any case.
    fn tell_late(&mut self, now: Option<Instant>) -> bool {
        let due = |(at, _): &mut (Instant, Status)| now.is_none_or(|now| *at <= now);
        match self.late.take_if(due) {
            Some((_, status)) => self.sink.tell(&Update::Command(&status)),
            None => true,
        }
    }

    /// Tells the values that have changed.
    fn tell_values(&mut self, exports: &[Export], cells: &[u64], now: Instant) {
        self.due = now + self.period;
        let changed = changed(exports, &self.last, cells);
        if changed.is_empty() {
            return;
        }
        self.sink.tell(&Update::Values(&changed));
        self.last = cells.to_vec();
        if let Some((at, _)) = &mut self.late {
            *at = now + self.settle;
        }
    }
}

/// Too many things are watched by one client.
pub(crate) const TOO_CURIOUS: Failure = Failure::Limit("things that one client watches");

/// How long values of a command that a rule has started are held back at most, until somebody has been told that the rule
/// fired: clients that need time to settle understand them only in this order.
const HELD: Duration = Duration::from_millis(200);
/// Values are not looked at more often than this.
const LEAST: Duration = Duration::from_millis(1);

impl Desk {
    /// Tells somebody about a command: its state now and whenever it changes, and its exports.
    pub(crate) fn watch(&mut self, name: &str, watching: Watching) -> Result<(), Failure> {
        let (number, _) = self.find(name)?;
        let Some(record) = self.commands.get_mut(&number) else {
            return Ok(());
        };
        record.subscriptions.push(Subscription {
            period: watching.period.max(LEAST),
            settle: watching.settle,
            due: Instant::now(),
            late: None,
            last: Vec::new(),
            sink: watching.sink,
        });
        let now = Instant::now();
        record.publish(now);
        if let Some(last) = record.subscriptions.last_mut() {
            last.tell(&record.status, now);
        }
        Ok(())
    }

    /// Forgets everybody who does not listen any more.
    pub(super) fn forget_deaf(&mut self) {
        let records = self.commands.values_mut();
        records.for_each(|r| r.subscriptions.retain(|s| s.sink.is_heard()));
        self.watchers()
            .for_each(|list| list.retain(|s| s.is_heard()));
    }

    /// How many watch something else than a command.
    #[cfg(test)]
    pub(crate) fn watching(&mut self) -> usize {
        self.watchers().map(|list| list.len()).sum()
    }

    /// Everybody who watches something else than a command.
    fn watchers(&mut self) -> impl Iterator<Item = &mut Vec<Box<dyn Sink>>> {
        let sessions = self.sessions.values_mut().map(|s| &mut s.watchers);
        let rules = self.rules.values_mut().map(|r| &mut r.watchers);
        let tasks = self.tasks.values_mut().map(|t| &mut t.watchers);
        let others = [&mut self.devices.watchers, &mut self.emergency.watchers];
        sessions.chain(rules).chain(tasks).chain(others)
    }

    /// Tells the exports that have changed to those for whom it is time.
    pub(super) fn publish(&mut self) {
        let now = Instant::now();
        self.commands.values_mut().for_each(|r| r.publish(now));
    }
}

impl Record {
    /// Tells everybody the state; before an end the values that led to it.
    pub(super) fn tell_state(&mut self) {
        let now = Instant::now();
        match self.status.phase {
            Phase::Is(State::Running) => self.held = Some(now + HELD),
            Phase::Is(State::Terminated) => self.publish_now(),
            Phase::Unloaded => {
                self.held = None;
                self.publish(now);
            }
            _ => {}
        }
        self.subscriptions.retain_mut(|s| s.tell(&self.status, now));
    }

    /// Tells everybody that it has jumped.
    pub(super) fn tell_jump(&mut self, jump: &str) {
        let told = |s: &mut Subscription| s.sink.tell(&Update::Jumped(jump));
        self.subscriptions.retain_mut(told);
    }

    pub(super) fn set_phase(&mut self, phase: Phase) {
        if self.status.phase != phase {
            self.status.phase = phase;
            self.tell_state();
        }
    }

    /// The rule that started it has been told: so may be what it brings.
    pub(super) fn release(&mut self) {
        self.held = None;
    }

    /// Tells what is new to everybody who may know, however short ago they were told something.
    pub(super) fn publish_now(&mut self) {
        let now = Instant::now();
        self.subscriptions.iter_mut().for_each(|s| s.due = now);
        self.publish(now);
    }

    /// Tells those who need time to settle that a Boolean which it exports is this, whatever it is.
    pub(super) fn tell_flag(&mut self, key: &str, value: bool) {
        let told = [(key.to_owned(), value.to_string())];
        let slow = |s: &&mut Subscription| !s.settle.is_zero();
        self.subscriptions.iter_mut().filter(slow).for_each(|s| {
            s.sink.tell(&Update::Values(&told));
        });
    }

    fn is_held(&self, now: Instant) -> bool {
        self.held.is_some_and(|until| now < until)
    }

    /// Whether somebody is not told its values yet.
    pub(super) fn is_held_back(&self, now: Instant) -> bool {
        self.is_held(now) && self.subscriptions.iter().any(|s| !s.settle.is_zero())
    }

    fn publish(&mut self, now: Instant) {
        let held = self.is_held(now);
        let free = |s: &&mut Subscription| !held || s.settle.is_zero();
        if self
            .subscriptions
            .iter_mut()
            .filter(free)
            .any(|s| s.due <= now)
        {
            let cells = self.board.as_ref().and_then(|board| board.read());
            if let (Some(cells), Some(image)) = (cells, &self.image) {
                let due = self.subscriptions.iter_mut().filter(free);
                due.filter(|s| s.due <= now)
                    .for_each(|s| s.tell_values(&image.exports, &cells, now));
            }
        }
        self.subscriptions
            .retain_mut(|s| held && !s.settle.is_zero() || s.tell_late(Some(now)));
    }
}

/// The present values that differ from what was told last.
fn changed(exports: &[Export], last: &[u64], now: &[u64]) -> Vec<(String, String)> {
    let mut before = Board::values(exports, last);
    let now = Board::values(exports, now);
    let news = now.filter_map(|(export, value)| {
        let known = before.next().and_then(|(_, value)| value);
        let value = value.filter(|v| known != Some(v))?;
        Some((export.key.clone(), literal::write(value, export.value.ty)))
    });
    news.collect()
}

/// All present values as texts.
pub(crate) fn texts(exports: &[Export], cells: &[u64]) -> Vec<(String, String)> {
    changed(exports, &[], cells)
}

impl Record {
    /// What it exports now: key and value.
    pub(crate) fn values(&self) -> Vec<(String, String)> {
        let cells = self.board.as_ref().and_then(|board| board.read());
        match (cells, &self.image) {
            (Some(cells), Some(image)) => texts(&image.exports, &cells),
            _ => Vec::new(),
        }
    }
}

impl Record {
    /// How many cycles it has run.
    pub(crate) fn cycles(&self) -> u64 {
        self.board.as_ref().map_or(0, |board| board.cycles())
    }

    /// Its period, nanoseconds.
    pub(crate) fn period_ns(&self) -> u64 {
        self.image.as_ref().map_or(0, |image| image.period_ns)
    }

    /// How many of its cycles took too long, and the worst of them; nothing if none did.
    pub(crate) fn overruns(&self) -> Option<(u64, Overrun)> {
        self.board.as_ref().and_then(|board| board.overruns())
    }

    /// The path of one of its fragments: empty for the command itself.
    pub(crate) fn fragment(&self, index: u32) -> Option<&str> {
        let image = self.image.as_ref()?;
        let fragment = image.fragments.get(index as usize)?;
        Some(&fragment.path)
    }

    /// Bytes that it takes.
    pub(crate) fn bytes(&self) -> usize {
        self.bytes
    }
}
