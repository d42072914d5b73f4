//! Executes both sides of a run: alternating on one thread, or in parallel on two.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use rpi_core::AbortReason;
use rtrb::{Producer, RingBuffer};

use super::cycle::CycleLoop;
use super::devices;
use super::end_text::abort_text;
use super::host::Host;
use super::job::{Progress, RunError};
use super::outcome::Outcome;
use super::samples::Sink;
use crate::realtime::{self, RealTime, ResourceGrant};

/// Period with which the part of a run outside the cycle processes events and samples in real time.
pub(crate) const SERVE_PERIOD: Duration = Duration::from_millis(2);
/// Minimum time between two calls of the progress callback.
const PROGRESS_PERIOD: Duration = Duration::from_millis(100);

/// Loop of a run outside the cycle: it passes samples and progress to the caller of the run.
pub(super) struct HostLoop<'a> {
    sink: &'a mut dyn Sink,
    progress: Option<&'a mut Progress<'a>>,
    tick_ns: u64,
    /// Time of the last progress callback.
    last: Instant,
}

impl<'a> HostLoop<'a> {
    pub(super) fn new(
        sink: &'a mut dyn Sink,
        progress: Option<&'a mut Progress<'a>>,
        tick_ns: u64,
    ) -> HostLoop<'a> {
        HostLoop {
            sink,
            progress,
            tick_ns,
            last: Instant::now(),
        }
    }

    fn serve(&mut self, host: &mut Host<'_>) {
        host.serve(self.sink);
        let due = self.last.elapsed() >= PROGRESS_PERIOD;
        if let (Some(show_progress), Some(command)) = (&mut self.progress, host.latest_command())
            && due
        {
            self.last = Instant::now();
            show_progress(
                command,
                Duration::from_nanos(self.tick_ns.saturating_mul(host.last_tick)),
            );
        }
    }
}

/// Runs the parts of a run inside and outside the cycle alternately on one thread, so that the same run always gives
/// the same bits.
pub(super) fn run_alternating(
    mut cycle: CycleLoop,
    mut host: Host<'_>,
    mut listener: HostLoop<'_>,
) -> Result<Outcome, RunError> {
    listener.serve(&mut host);
    while cycle.should_continue(host.is_over()) {
        cycle.tick();
        listener.serve(&mut host);
        // On simulated time the run waits for the recorder, so that no tick is lost.
        while !cycle.has_room() && host.is_recorded() {
            std::thread::sleep(SERVE_PERIOD);
        }
    }
    outcome((cycle, Vec::new()), host, listener)
}

/// Runs the cycle on a thread of its own, and the other parts of the run on this thread.
pub(super) fn run_threaded(
    cycle: CycleLoop,
    mut host: Host<'_>,
    mut listener: HostLoop<'_>,
    real_time: RealTime,
) -> Result<Outcome, RunError> {
    let over = Arc::new(AtomicBool::new(false));
    listener.serve(&mut host);
    let (done, mut back) = RingBuffer::new(1);
    let stop = Arc::clone(&over);
    let thread = std::thread::Builder::new().name("rpi-cycle".into());
    let running = thread.spawn(move || tick_until((cycle, done), &stop, real_time));
    let running = running.map_err(RunError::Thread)?;
    // A panic ends the thread without a result in the queue, and with the system call filter the thread never ends.
    while back.is_empty() && !running.is_finished() {
        listener.serve(&mut host);
        over.fetch_or(host.is_over(), Ordering::Relaxed);
        std::thread::sleep(SERVE_PERIOD);
    }
    match back.pop() {
        Ok(cycle) => outcome(cycle, host, listener),
        Err(_) => match running.join() {
            Err(panic) => std::panic::resume_unwind(panic),
            Ok(()) => Err(RunError::Thread(std::io::ErrorKind::BrokenPipe.into())),
        },
    }
}

/// A finished cycle loop, with the operating system's answers to the requests for real-time resources.
type FinishedCycle = (CycleLoop, Vec<ResourceGrant>);

/// Executes ticks until no command runs and `over` is set or a limit is reached. Then returns the cycle loop through
/// the queue `done`, because with the system call filter the thread cannot exit and must not be joined.
fn tick_until(
    (mut cycle, mut done): (CycleLoop, Producer<FinishedCycle>),
    over: &AtomicBool,
    real_time: RealTime,
) {
    let grants = realtime::acquire_resources(real_time);
    let fenced = grants.iter().any(realtime::is_syscall_filter_installed);
    cycle.timer.restart();
    while cycle.should_continue(over.load(Ordering::Relaxed)) {
        cycle.tick();
    }
    // The queue has capacity one and is pushed to once.
    let _ = done.push((cycle, grants));
    if fenced {
        realtime::sleep_forever();
    }
}

fn outcome(
    (mut cycle, grants): FinishedCycle,
    mut host: Host<'_>,
    listener: HostLoop<'_>,
) -> Result<Outcome, RunError> {
    host.process_events(listener.sink);
    let lost = cycle.finish_tick_log();
    let written = host.recorder.take().map(|recorder| recorder.finish(lost));
    let (recorded, unrecorded) = match written.transpose() {
        Ok(recorded) => (recorded.flatten(), None),
        Err(why) => (None, Some(why.to_string())),
    };
    if let Some((command, faults)) = host.command_log.load_failure {
        return Err(RunError::Load {
            command,
            faults,
            // All devices were found before the run began.
            devices: Vec::new(),
        });
    }
    for (id, overruns) in &cycle.overruns {
        host.command_log.set_overruns(*id, overruns);
    }
    let stopped = cycle.halted.filter(|why| *why != AbortReason::Request);
    Ok(Outcome {
        commands: host
            .command_log
            .commands
            .into_iter()
            .map(|(_, command)| command)
            .collect(),
        unlisted: host.command_log.unlisted,
        late: host.context.late_successors,
        missed: host.context.missed_takeovers,
        blended: host.command_log.blended,
        devices: devices::device_ends(cycle.bank()),
        figures: cycle.timer.figures(),
        tick_ns: listener.tick_ns,
        cut_off: cycle.halted == Some(AbortReason::Request),
        stopped: stopped.map(|why| abort_text(why).to_owned()),
        digest: None,
        recorded,
        unrecorded,
        grants: grants.iter().map(ToString::to_string).collect(),
        samples_lost: cycle.watcher.tap.lost,
    })
}
