//! Subscriptions to commands: states are reported at once, exported values periodically.

use std::time::{Duration, Instant};

use rpi_core::Overrun;
use rpi_image::image::Export;
use rpi_runtime::control::{Board, State};

use super::{Desk, Failure, Phase, Record, Sink, Status, Update};

/// A request to subscribe to a command.
pub(crate) struct Watching {
    /// Minimum time between two updates of values.
    pub(crate) period: Duration,
    /// Delay between the last values and the end of a command, for clients that handle values and states separately.
    /// Zero for clients that handle updates in order; those are also not sent completion results.
    pub(crate) settle: Duration,
    pub(crate) sink: Box<dyn Sink>,
}

/// A subscription to a command.
pub(super) struct Subscription {
    period: Duration,
    settle: Duration,
    due: Instant,
    /// An end of the command that is not reported yet, with the time to report it.
    late: Option<(Instant, Status)>,
    /// Memory slots of the exports at the latest report.
    last: Vec<u64>,
    sink: Box<dyn Sink>,
}

impl Subscription {
    /// Reports a state, after a delayed end. If there is a settling time, an end is delayed by it.
    fn tell(&mut self, status: &Status, now: Instant) -> bool {
        let listens = self.tell_late(None);
        if status.phase == Phase::Is(State::Terminated) && !self.settle.is_zero() {
            self.late = Some((now + self.settle, status.clone()));
            return listens;
        }
        listens && self.sink.tell(&Update::Command(status))
    }

    /// Reports the delayed end if its time has come; with `None`, in any case.
    fn tell_late(&mut self, now: Option<Instant>) -> bool {
        let due = |(at, _): &mut (Instant, Status)| now.is_none_or(|now| *at <= now);
        match self.late.take_if(due) {
            Some((_, status)) => self.sink.tell(&Update::Command(&status)),
            None => true,
        }
    }

    /// Reports the changed values.
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

/// Error of a client with too many subscriptions.
pub(crate) const TOO_CURIOUS: Failure = Failure::Limit("subscriptions of one client");

/// Maximum time for which values of a command started by a rule are withheld until the firing of the rule was reported.
/// Clients with a settling time need the updates in this order.
const HELD: Duration = Duration::from_millis(200);
/// Minimum period of a subscription.
const LEAST: Duration = Duration::from_millis(1);

impl Desk {
    /// Subscribes to a command: reports its state now and at each change, and its exports.
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

    /// Removes the subscriptions of disconnected clients.
    pub(super) fn forget_deaf(&mut self) {
        let records = self.commands.values_mut();
        records.for_each(|r| r.subscriptions.retain(|s| s.sink.is_heard()));
        self.watchers()
            .for_each(|list| list.retain(|s| s.is_heard()));
    }

    /// Returns the number of subscriptions to anything but commands.
    #[cfg(test)]
    pub(crate) fn watching(&mut self) -> usize {
        self.watchers().map(|list| list.len()).sum()
    }

    /// Returns all lists of subscribers to anything but commands.
    fn watchers(&mut self) -> impl Iterator<Item = &mut Vec<Box<dyn Sink>>> {
        let sessions = self.sessions.values_mut().map(|s| &mut s.watchers);
        let rules = self.rules.values_mut().map(|r| &mut r.watchers);
        let tasks = self.tasks.values_mut().map(|t| &mut t.watchers);
        let others = [&mut self.devices.watchers, &mut self.emergency.watchers];
        sessions.chain(rules).chain(tasks).chain(others)
    }

    /// Reports changed exports to all subscriptions that are due.
    pub(super) fn publish(&mut self) {
        let now = Instant::now();
        self.commands.values_mut().for_each(|r| r.publish(now));
    }
}

impl Record {
    /// Reports the state to all subscribers; before an end, the values that led to it.
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

    /// Reports a discontinuity to all subscribers.
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

    /// Called when the firing of the rule that started the command was reported: ends withholding its values.
    pub(super) fn release(&mut self) {
        self.held = None;
    }

    /// Reports changed values to all subscribers, whatever their periods.
    pub(super) fn publish_now(&mut self) {
        let now = Instant::now();
        self.subscriptions.iter_mut().for_each(|s| s.due = now);
        self.publish(now);
    }

    /// Reports a value of a Boolean export to subscribers with a settling time, regardless of its actual value.
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

    /// Returns whether values are withheld from some subscriber.
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

/// Returns the exports with a present value that differs from the latest report: key and text.
fn changed(exports: &[Export], last: &[u64], now: &[u64]) -> Vec<(String, String)> {
    let mut before = Board::values(exports, last);
    let now = Board::values(exports, now);
    let news = now.filter_map(|(export, value)| {
        let known = before.next().and_then(|(_, value)| value);
        let value = value.filter(|v| known != Some(v))?;
        Some((
            export.key.clone(),
            rpi_literal::write(value, export.value.ty),
        ))
    });
    news.collect()
}

/// Returns all exports with a present value: key and text.
pub(crate) fn texts(exports: &[Export], cells: &[u64]) -> Vec<(String, String)> {
    changed(exports, &[], cells)
}

impl Record {
    /// Returns the current exports: key and text.
    pub(crate) fn values(&self) -> Vec<(String, String)> {
        let cells = self.board.as_ref().and_then(|board| board.read());
        match (cells, &self.image) {
            (Some(cells), Some(image)) => texts(&image.exports, &cells),
            _ => Vec::new(),
        }
    }
}

impl Record {
    /// Returns the number of cycles that the command has run.
    pub(crate) fn cycles(&self) -> u64 {
        self.board.as_ref().map_or(0, |board| board.cycles())
    }

    /// Returns the period in nanoseconds.
    pub(crate) fn period_ns(&self) -> u64 {
        self.image.as_ref().map_or(0, |image| image.period_ns)
    }

    /// Returns the number of overruns and the worst one; `None` if there was none.
    pub(crate) fn overruns(&self) -> Option<(u64, Overrun)> {
        self.board.as_ref().and_then(|board| board.overruns())
    }

    /// Returns the path of a fragment; empty for the command itself.
    pub(crate) fn fragment(&self, index: u32) -> Option<&str> {
        let image = self.image.as_ref()?;
        let fragment = image.fragments.get(index as usize)?;
        Some(&fragment.path)
    }

    /// Returns the memory of the command in bytes.
    pub(crate) fn bytes(&self) -> usize {
        self.bytes
    }
}
