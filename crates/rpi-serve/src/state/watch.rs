//! Subscriptions to commands: states are reported at once, exported values periodically.

use std::time::{Duration, Instant};

use rpi_image::Image;
use rpi_image::image::Export;
use rpi_runtime::control::{Board, State};

use super::types::{Failure, Phase, Sink, Status, Update};

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

/// The latest exports of a command, if it has run.
pub(super) struct Exported<'a> {
    board: Option<&'a Board>,
    image: Option<&'a Image>,
}

impl<'a> Exported<'a> {
    /// Creates the view of a command's exports.
    pub(super) fn new(board: Option<&'a Board>, image: Option<&'a Image>) -> Exported<'a> {
        Exported { board, image }
    }

    /// Returns the declarations of the exports and their memory slots.
    fn read(&self) -> Option<(&'a [Export], Vec<u64>)> {
        let cells = self.board.and_then(Board::read);
        Some((&self.image?.exports, cells?))
    }

    /// Returns all exports with a present value: key and text.
    pub(super) fn values(&self) -> Vec<(String, String)> {
        let read = self.read();
        read.map_or_else(Vec::new, |(exports, cells)| texts(exports, &cells))
    }
}

/// The subscriptions to one command. Values can be withheld from subscribers with a settling time, so that they get
/// updates in the order in which they understand them.
#[derive(Default)]
pub(super) struct Subscriptions {
    list: Vec<Subscription>,
    /// Until when values are withheld from subscribers that depend on the order of updates.
    held: Option<Instant>,
}

impl Subscriptions {
    /// Adds a subscription: reports the values and the state now.
    pub(super) fn add(&mut self, watching: Watching, status: &Status, exported: &Exported<'_>) {
        self.list.push(Subscription {
            period: watching.period.max(LEAST),
            settle: watching.settle,
            due: Instant::now(),
            late: None,
            last: Vec::new(),
            sink: watching.sink,
        });
        let now = Instant::now();
        self.publish(now, exported);
        if let Some(last) = self.list.last_mut() {
            last.tell(status, now);
        }
    }

    /// Removes the subscriptions of disconnected clients.
    pub(super) fn forget_deaf(&mut self) {
        self.list.retain(|s| s.sink.is_heard());
    }

    /// Reports the state to all subscribers; before an end, the values that led to it.
    pub(super) fn tell_state(&mut self, status: &Status, exported: &Exported<'_>) {
        let now = Instant::now();
        match status.phase {
            Phase::Is(State::Running) => self.held = Some(now + HELD),
            Phase::Is(State::Terminated) => self.publish_now(exported),
            Phase::Unloaded => {
                self.held = None;
                self.publish(now, exported);
            }
            _ => {}
        }
        self.list.retain_mut(|s| s.tell(status, now));
    }

    /// Reports a discontinuity to all subscribers.
    pub(super) fn tell_jump(&mut self, jump: &str) {
        let told = |s: &mut Subscription| s.sink.tell(&Update::Jumped(jump));
        self.list.retain_mut(told);
    }

    /// Called when the firing of the rule that started the command was reported: ends withholding its values.
    pub(super) fn release(&mut self) {
        self.held = None;
    }

    /// Reports changed values to all subscribers, whatever their periods.
    pub(super) fn publish_now(&mut self, exported: &Exported<'_>) {
        let now = Instant::now();
        self.list.iter_mut().for_each(|s| s.due = now);
        self.publish(now, exported);
    }

    /// Reports a value of a Boolean export to subscribers with a settling time, regardless of its actual value.
    pub(super) fn tell_flag(&mut self, key: &str, value: bool) {
        let told = [(key.to_owned(), value.to_string())];
        let slow = |s: &&mut Subscription| !s.settle.is_zero();
        self.list.iter_mut().filter(slow).for_each(|s| {
            s.sink.tell(&Update::Values(&told));
        });
    }

    fn is_held(&self, now: Instant) -> bool {
        self.held.is_some_and(|until| now < until)
    }

    /// Returns whether values are withheld from some subscriber.
    pub(super) fn is_held_back(&self, now: Instant) -> bool {
        self.is_held(now) && self.list.iter().any(|s| !s.settle.is_zero())
    }

    /// Reports changed values to the subscribers that are due.
    pub(super) fn publish(&mut self, now: Instant, exported: &Exported<'_>) {
        let held = self.is_held(now);
        let free = |s: &&mut Subscription| !held || s.settle.is_zero();
        let is_due = self.list.iter_mut().filter(free).any(|s| s.due <= now);
        if is_due && let Some((exports, cells)) = exported.read() {
            let due = self.list.iter_mut().filter(free);
            due.filter(|s| s.due <= now)
                .for_each(|s| s.tell_values(exports, &cells, now));
        }
        self.list
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
