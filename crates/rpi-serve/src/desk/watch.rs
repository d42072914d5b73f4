//! Who is told what: states at once, exported values now and then.

use std::time::{Duration, Instant};

use rpi_image::image::Export;
use rpi_net::literal;

use super::{Desk, Failure, Phase, Record, Sink, Update};
use crate::plant::values;

/// What somebody wants to be told about a command.
pub(crate) struct Watching {
    /// Least time between two updates of values.
    pub(crate) period: Duration,
    pub(crate) sink: Box<dyn Sink>,
}

/// Somebody who is told about a command.
pub(super) struct Subscription {
    period: Duration,
    due: Instant,
    /// What it knows already.
    last: Vec<u64>,
    sink: Box<dyn Sink>,
}

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
            due: Instant::now(),
            last: Vec::new(),
            sink: watching.sink,
        });
        record.publish(Instant::now());
        if let Some(last) = record.subscriptions.last_mut() {
            last.sink.tell(&Update::Command(&record.status));
        }
        Ok(())
    }

    /// Tells the exports that have changed to those for whom it is time.
    pub(super) fn publish(&mut self) {
        let now = Instant::now();
        self.commands.values_mut().for_each(|r| r.publish(now));
    }
}

impl Record {
    /// Tells everybody the state; the values that led to it first.
    pub(super) fn tell_state(&mut self) {
        self.subscriptions
            .iter_mut()
            .for_each(|s| s.due = Instant::now());
        self.publish(Instant::now());
        let update = Update::Command(&self.status);
        self.subscriptions.retain_mut(|s| s.sink.tell(&update));
    }

    pub(super) fn set_phase(&mut self, phase: Phase) {
        if self.status.phase != phase {
            self.status.phase = phase;
            self.tell_state();
        }
    }

    fn publish(&mut self, now: Instant) {
        if !self.subscriptions.iter().any(|s| s.due <= now) {
            return;
        }
        let cells = self.board.as_ref().and_then(|board| board.read());
        let (Some(cells), Some(image)) = (cells, &self.image) else {
            return;
        };
        for subscription in self.subscriptions.iter_mut().filter(|s| s.due <= now) {
            subscription.due = now + subscription.period;
            let changed = changed(&image.exports, &subscription.last, &cells);
            if !changed.is_empty() {
                subscription.sink.tell(&Update::Values(&changed));
            }
            subscription.last.clone_from(&cells);
        }
    }
}

/// The present values that differ from what was told last.
fn changed(exports: &[Export], last: &[u64], now: &[u64]) -> Vec<(String, String)> {
    let mut before = values(exports, last);
    let now = values(exports, now);
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

    /// Bytes that it takes.
    pub(crate) fn bytes(&self) -> usize {
        self.bytes
    }
}
