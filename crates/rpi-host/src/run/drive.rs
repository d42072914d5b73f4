//! Lets the two sides of a run work: by turns on one thread, or side by side on two.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use super::cycle::Cycle;
use super::devices;
use super::host::Host;
use super::job::{Failure, Progress};
use super::outcome::Outcome;
use super::samples::Sink;
use crate::realtime::{self, Grant, Wanted};

/// How often the host looks after things on real time.
const SERVE_EVERY: Duration = Duration::from_millis(2);
/// How often somebody is told how far it is.
const TELL_EVERY: Duration = Duration::from_millis(100);

/// Who is told what happens.
pub(super) struct Listener<'a> {
    sink: &'a mut dyn Sink,
    progress: Option<&'a mut Progress<'a>>,
    tick_ns: u64,
    /// When somebody was last told how far it is.
    last: Instant,
}

impl<'a> Listener<'a> {
    pub(super) fn new(
        sink: &'a mut dyn Sink,
        progress: Option<&'a mut Progress<'a>>,
        tick_ns: u64,
    ) -> Listener<'a> {
        Listener {
            sink,
            progress,
            tick_ns,
            last: Instant::now(),
        }
    }

    fn serve(&mut self, host: &mut Host<'_>) {
        host.serve(self.sink);
        let due = self.last.elapsed() >= TELL_EVERY;
        if let (Some(tell), Some(command)) = (&mut self.progress, host.running())
            && due
        {
            self.last = Instant::now();
            tell(
                command,
                Duration::from_nanos(self.tick_ns.saturating_mul(host.last_tick)),
            );
        }
    }
}

/// The host before each tick, all on one thread: the same run gives the same bits.
pub(super) fn taking_turns(
    mut cycle: Cycle,
    mut host: Host<'_>,
    mut listener: Listener<'_>,
) -> Result<Outcome, Failure> {
    listener.serve(&mut host);
    while cycle.goes_on(host.is_over()) {
        cycle.tick();
        listener.serve(&mut host);
    }
    outcome((cycle, Vec::new()), host, listener)
}

/// The cycle on a thread of its own; the host here.
pub(super) fn side_by_side(
    cycle: Cycle,
    mut host: Host<'_>,
    mut listener: Listener<'_>,
    wanted: Wanted,
) -> Result<Outcome, Failure> {
    let over = AtomicBool::new(false);
    listener.serve(&mut host);
    let cycle = std::thread::scope(|scope| {
        let running = scope.spawn(|| tick_until(cycle, &over, wanted));
        while !running.is_finished() {
            listener.serve(&mut host);
            over.fetch_or(host.is_over(), Ordering::Relaxed);
            std::thread::sleep(SERVE_EVERY);
        }
        running.join()
    });
    match cycle {
        Ok(cycle) => outcome(cycle, host, listener),
        Err(panic) => std::panic::resume_unwind(panic),
    }
}

fn tick_until(mut cycle: Cycle, over: &AtomicBool, wanted: Wanted) -> (Cycle, Vec<Grant>) {
    let grants = realtime::ask(wanted);
    cycle.beat.restart();
    while cycle.goes_on(over.load(Ordering::Relaxed)) {
        cycle.tick();
    }
    (cycle, grants)
}

fn outcome(
    (mut cycle, grants): (Cycle, Vec<Grant>),
    mut host: Host<'_>,
    listener: Listener<'_>,
) -> Result<Outcome, Failure> {
    host.listen(listener.sink);
    if let Some((command, faults)) = host.books.failed {
        return Err(Failure::Loading {
            command,
            faults,
            // None is missing, or the run would not have begun.
            devices: Vec::new(),
        });
    }
    Ok(Outcome {
        commands: host
            .books
            .commands
            .into_iter()
            .map(|(_, command)| command)
            .collect(),
        unlisted: host.books.unlisted,
        late: host.desk.late,
        devices: devices::ends(cycle.bank()),
        figures: cycle.beat.figures(),
        tick_ns: listener.tick_ns,
        cut_off: cycle.cut_off,
        digest: None,
        grants: grants.iter().map(ToString::to_string).collect(),
        samples_lost: cycle.watcher.tap.lost,
    })
}
