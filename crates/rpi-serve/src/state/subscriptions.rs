//! Subscriptions to commands: states are reported at once, exported values periodically.

use std::time::{Duration, Instant};

use rpi_image::Image;
use rpi_image::image::Export;
use rpi_runtime::control::{CommandState, ExportSnapshot};

use super::types::{ApiError, Phase, Status, Subscriber, Update};

/// Request of a client to subscribe to a command.
pub(crate) struct WatchRequest {
    /// Minimum time between two updates of exported values.
    pub(crate) period: Duration,
    /// Delay between the last values and the report of the command's end, for DirectIO clients, which handle values and
    /// states separately. Zero for clients that handle updates in order; completion results are not sent to them.
    pub(crate) end_delay: Duration,
    pub(crate) sink: Box<dyn Subscriber>,
}

/// Subscription of one client to a command.
pub(super) struct Subscription {
    period: Duration,
    end_delay: Duration,
    due: Instant,
    /// Time at which the end of the command is to be reported, and the status to report; `None` if no report is
    /// delayed.
    delayed_end: Option<(Instant, Status)>,
    /// Memory slots of the exports at the latest report; empty before the first one.
    last_slots: Vec<u64>,
    subscriber: Box<dyn Subscriber>,
}

impl Subscription {
    /// Reports a state of the command, after an end whose report was delayed. The report of an end is delayed if the
    /// subscription has an end delay. Returns false if the client is disconnected.
    fn report_state(&mut self, status: &Status, now: Instant) -> bool {
        let listens = self.report_delayed_end(None);
        if status.phase == Phase::Core(CommandState::Terminated) && !self.end_delay.is_zero() {
            self.delayed_end = Some((now + self.end_delay, status.clone()));
            return listens;
        }
        listens && self.subscriber.notify(&Update::Command(status))
    }

    /// Reports the end of the command whose report was delayed, if its time has come; with `None`, in any case. Returns
    /// false if the client is disconnected.
    fn report_delayed_end(&mut self, now: Option<Instant>) -> bool {
        let due = |(at, _): &mut (Instant, Status)| now.is_none_or(|now| *at <= now);
        match self.delayed_end.take_if(due) {
            Some((_, status)) => self.subscriber.notify(&Update::Command(&status)),
            None => true,
        }
    }

    /// Reports the exports whose values differ from the latest report. `cells` are the memory slots of the exports.
    fn report_values(&mut self, exports: &[Export], cells: &[u64], now: Instant) {
        self.due = now + self.period;
        let changed = changed_exports(exports, &self.last_slots, cells);
        if changed.is_empty() {
            return;
        }
        self.subscriber.notify(&Update::Values(&changed));
        self.last_slots = cells.to_vec();
        if let Some((at, _)) = &mut self.delayed_end {
            *at = now + self.end_delay;
        }
    }
}

/// Error that a client receives when it has as many subscriptions as the quota allows and requests one more.
pub(crate) const TOO_MANY_SUBSCRIPTIONS: ApiError = ApiError::Limit("subscriptions of one client");

/// Maximum time for which values of a command started by a rule are withheld until the firing of the rule was reported.
/// Clients that handle values and states separately need the updates in this order.
const MAX_WITHHOLD: Duration = Duration::from_millis(200);
/// Minimum update period of a subscription to a command; a shorter requested period is raised to it.
const MIN_PERIOD: Duration = Duration::from_millis(1);

/// View of the latest exported values of a command; without values if the command has not run.
pub(super) struct Exported<'a> {
    snapshot: Option<&'a ExportSnapshot>,
    image: Option<&'a Image>,
}

impl<'a> Exported<'a> {
    /// Creates the view from the command's latest snapshot of exports and its image, which declares the exports.
    pub(super) fn new(
        snapshot: Option<&'a ExportSnapshot>,
        image: Option<&'a Image>,
    ) -> Exported<'a> {
        Exported { snapshot, image }
    }

    /// Returns the declarations of the exports and their memory slots; `None` if the command has not run.
    fn read(&self) -> Option<(&'a [Export], Vec<u64>)> {
        let cells = self.snapshot.and_then(ExportSnapshot::read_consistent);
        Some((&self.image?.exports, cells?))
    }

    /// Returns all exports with a present value: key and literal of each.
    pub(super) fn values(&self) -> Vec<(String, String)> {
        let read = self.read();
        read.map_or_else(Vec::new, |(exports, cells)| export_texts(exports, &cells))
    }
}

/// All subscriptions to one command. To clients that handle values and states separately, values are withheld and the
/// end is delayed so that they get both in the right order.
#[derive(Default)]
pub(super) struct Subscriptions {
    list: Vec<Subscription>,
    /// Time until which values are withheld from subscribers that handle values and states separately; `None` if values
    /// are not withheld.
    held: Option<Instant>,
}

impl Subscriptions {
    /// Adds a subscription, and reports to it the values and the state of the command now.
    pub(super) fn add(&mut self, watching: WatchRequest, status: &Status, exported: &Exported<'_>) {
        self.list.push(Subscription {
            period: watching.period.max(MIN_PERIOD),
            end_delay: watching.end_delay,
            due: Instant::now(),
            delayed_end: None,
            last_slots: Vec::new(),
            subscriber: watching.sink,
        });
        let now = Instant::now();
        self.publish(now, exported);
        if let Some(last) = self.list.last_mut() {
            last.report_state(status, now);
        }
    }

    /// Removes the subscriptions of disconnected clients.
    pub(super) fn drop_disconnected(&mut self) {
        self.list.retain(|s| s.subscriber.is_connected());
    }

    /// Reports the life-cycle state to all subscribers. Before an end, the values that led to it are reported.
    pub(super) fn report_state(&mut self, status: &Status, exported: &Exported<'_>) {
        let now = Instant::now();
        match status.phase {
            Phase::Core(CommandState::Running) => self.held = Some(now + MAX_WITHHOLD),
            Phase::Core(CommandState::Terminated) => self.publish_now(exported),
            Phase::Unloaded => {
                self.held = None;
                self.publish(now, exported);
            }
            _ => {}
        }
        self.list.retain_mut(|s| s.report_state(status, now));
    }

    /// Reports the description of a discontinuity at the command's takeover to all subscribers.
    pub(super) fn report_discontinuity(&mut self, jump: &str) {
        let notify = |s: &mut Subscription| s.subscriber.notify(&Update::Discontinuity(jump));
        self.list.retain_mut(notify);
    }

    /// Ends the withholding of values. Called once the firing of the rule that started the command was reported.
    pub(super) fn stop_withholding(&mut self) {
        self.held = None;
    }

    /// Reports changed values to all subscribers, even if their update periods have not elapsed.
    pub(super) fn publish_now(&mut self, exported: &Exported<'_>) {
        let now = Instant::now();
        self.list.iter_mut().for_each(|s| s.due = now);
        self.publish(now, exported);
    }

    /// Reports a value of the Boolean export `key` to the subscribers that handle values and states separately,
    /// regardless of the actual value of the export.
    pub(super) fn report_flag(&mut self, key: &str, value: bool) {
        let values = [(key.to_owned(), value.to_string())];
        let slow = |s: &&mut Subscription| !s.end_delay.is_zero();
        self.list.iter_mut().filter(slow).for_each(|s| {
            s.subscriber.notify(&Update::Values(&values));
        });
    }

    fn is_withheld(&self, now: Instant) -> bool {
        self.held.is_some_and(|until| now < until)
    }

    /// Returns whether values are withheld at the time `now` from at least one subscriber.
    pub(super) fn is_withheld_from_any(&self, now: Instant) -> bool {
        self.is_withheld(now) && self.list.iter().any(|s| !s.end_delay.is_zero())
    }

    /// Reports changed values to the subscribers whose update periods have elapsed at `now`, and ends whose delay has
    /// elapsed.
    pub(super) fn publish(&mut self, now: Instant, exported: &Exported<'_>) {
        let held = self.is_withheld(now);
        let free = |s: &&mut Subscription| !held || s.end_delay.is_zero();
        let is_due = self.list.iter_mut().filter(free).any(|s| s.due <= now);
        if is_due && let Some((exports, cells)) = exported.read() {
            let due = self.list.iter_mut().filter(free);
            due.filter(|s| s.due <= now)
                .for_each(|s| s.report_values(exports, &cells, now));
        }
        self.list
            .retain_mut(|s| held && !s.end_delay.is_zero() || s.report_delayed_end(Some(now)));
    }
}

/// Returns the exports with a present value in `now` that differs from that in `last`: key and literal of each. Both
/// are the memory slots of the exports; `last` is empty before the first report.
fn changed_exports(exports: &[Export], last: &[u64], now: &[u64]) -> Vec<(String, String)> {
    let mut before = ExportSnapshot::values(exports, last);
    let now = ExportSnapshot::values(exports, now);
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

/// Returns all exports with a present value in the memory slots `cells`: key and literal of each.
pub(crate) fn export_texts(exports: &[Export], cells: &[u64]) -> Vec<(String, String)> {
    changed_exports(exports, &[], cells)
}
