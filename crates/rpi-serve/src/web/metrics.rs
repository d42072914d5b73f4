//! The page `/metrics`: counters and histograms in the OpenMetrics text format.

use prometheus_client::encoding::text::encode;
use prometheus_client::registry::Registry;

use super::openmetrics::{Counter, Family, Gauge, Histogram, Register};
use crate::state::{Phase, ServerState, SharedState, TaskPhase};
use crate::transport::ConnectionCounts;

/// Media type of the page.
///
/// Source: OpenMetrics 1.0.0, section "Text Format".
pub(super) const MEDIA_TYPE: &str = "application/openmetrics-text; version=1.0.0; charset=utf-8";

/// Returns the page. The state is locked only while numbers are copied.
pub(super) fn page(shared: &SharedState, connections: &ConnectionCounts) -> String {
    let mut registry = Registry::with_prefix("rpi");
    {
        let state = shared.lock();
        cycle(&mut registry, &state);
        objects(&mut registry, &state);
        requests(&mut registry, &state);
        losses(&mut registry, &state);
    }
    connected(&mut registry, connections);
    let mut text = String::new();
    // Writing to a string does not fail.
    let _ = encode(&mut text, &registry);
    text
}

fn cycle(registry: &mut Registry, state: &ServerState) {
    let cycle = &state.cycle;
    Counter(cycle.ticks()).register(registry, "ticks", "Ticks that have ended");
    Counter(cycle.overruns()).register(
        registry,
        "overruns",
        "Ticks that ended after the next one was due",
    );
    Counter(cycle.skipped_periods()).register(
        registry,
        "skipped_periods",
        "Periods by which ticks were postponed",
    );
    Histogram::from(&cycle.duration).register(
        registry,
        "tick_duration_seconds",
        "Time that a tick takes",
    );
    Histogram::from(&cycle.lateness).register(
        registry,
        "tick_lateness_seconds",
        "Time by which a tick begins too late",
    );
}

fn objects(registry: &mut Registry, state: &ServerState) {
    let commands = state.objects.commands.all();
    let commands = commands.map(|(_, record)| record.status.phase.name());
    let by_state = count_by_name(Phase::ALL.map(Phase::name), commands);
    Family::new("state", by_state).register(registry, "commands", "Commands by state");
    let tasks = state.objects.tasks.all();
    let by_phase = count_by_name(
        TaskPhase::ALL.map(TaskPhase::name),
        tasks.map(|(_, _, task)| task.phase.name()),
    );
    Family::new("state", by_phase).register(registry, "tasks", "Tasks by state");
    let sessions = state.objects.sessions.all().count() as u64;
    Gauge(sessions).register(registry, "sessions", "Open sessions");
    Gauge(state.devices.all().count() as u64).register(registry, "devices", "Devices");
    let faulty = state.devices.all().filter(|device| device.code != 0);
    Gauge(faulty.count() as u64).register(
        registry,
        "devices_with_error",
        "Devices that report an error",
    );
    let stopped = u64::from(state.emergency.by().is_some());
    Gauge(stopped).register(
        registry,
        "emergency_stop",
        "Whether an emergency stop is in force (1) or not (0)",
    );
}

/// Counts how often each of the names is found. A name that is not found is shown with 0, so that it can be plotted.
fn count_by_name<const N: usize>(
    names: [&'static str; N],
    found: impl Iterator<Item = &'static str>,
) -> [(&'static str, Gauge); N] {
    let mut counts = names.map(|name| (name, Gauge(0)));
    for name in found {
        let count = counts.iter_mut().find(|(known, _)| *known == name);
        count.into_iter().for_each(|(_, Gauge(count))| *count += 1);
    }
    counts
}

fn requests(registry: &mut Registry, state: &ServerState) {
    let counts = state.statistics;
    let loads = [
        ("accepted", Counter(counts.loads_accepted)),
        ("rejected", Counter(counts.loads_rejected)),
    ];
    Family::new("outcome", loads).register(registry, "loads", "Loads of commands and tasks");
    let answers = [
        ("done", Counter(counts.requests_done)),
        ("refused", Counter(counts.requests_refused)),
    ];
    Family::new("outcome", answers).register(registry, "requests", "Requests to the cycle");
    let ended = counts.ended().map(|(cause, count)| (cause, Counter(count)));
    Family::new("cause", ended).register(registry, "commands_ended", "Ended commands by cause");
    Counter(counts.discontinuities).register(
        registry,
        "discontinuities",
        "Takeovers with a discontinuity of a set-point",
    );
    Counter(counts.emergency_stops).register(
        registry,
        "emergency_stop_requests",
        "Requests for an emergency stop",
    );
    let depths = state.core.queue_depths().into_iter();
    let depths = depths.chain([("loads", state.jobs.len())]);
    let depths = depths.map(|(name, depth)| (name, Gauge(depth as u64)));
    Family::new("queue", depths).register(registry, "queue_depth", "Entries that wait in a queue");
}

fn losses(registry: &mut Registry, state: &ServerState) {
    Gauge(u64::from(state.recording.is_recording())).register(
        registry,
        "recording",
        "Whether the run is being recorded (1) or not (0)",
    );
    Counter(state.cycle.unrecorded_ticks()).register(
        registry,
        "recording_lost_ticks",
        "Ticks that are missing from the recording",
    );
    Counter(state.log.lost_lines()).register(
        registry,
        "log_lost_lines",
        "Lines that are missing from the log file",
    );
}

fn connected(registry: &mut Registry, connections: &ConnectionCounts) {
    let open = connections
        .open
        .map(|(kind, count)| (kind, Gauge(count as u64)));
    Family::new("kind", open).register(registry, "connections", "Open connections by kind");
    let rejected = connections
        .rejected
        .map(|(reason, count)| (reason, Counter(count)));
    Family::new("reason", rejected).register(
        registry,
        "rejections",
        "Rejected connections and requests by reason",
    );
}
