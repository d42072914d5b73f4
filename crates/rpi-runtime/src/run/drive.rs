//! Executes both sides of a run: alternating on one thread, or in parallel on two.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use rpi_core::Why;
use rtrb::{Producer, RingBuffer};

use super::cycle::Cycle;
use super::devices;
use super::end::stop_text;
use super::host::Host;
use super::job::{Failure, Progress};
use super::outcome::Outcome;
use super::samples::Sink;
use crate::realtime::{self, Grant, RealTime};

/// Period with which the host serves the cycle in real time.
const SERVE_EVERY: Duration = Duration::from_millis(2);
/// Period of the progress callback.
const TELL_EVERY: Duration = Duration::from_millis(100);

/// Receivers of the samples and the progress of a run.
pub(super) struct Listener<'a> {
    sink: &'a mut dyn Sink,
    progress: Option<&'a mut Progress<'a>>,
    tick_ns: u64,
    /// Time of the last progress callback.
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

/// Runs host and cycle alternately on one thread, so that the same run gives the same bits.
pub(super) fn taking_turns(
    mut cycle: Cycle,
    mut host: Host<'_>,
    mut listener: Listener<'_>,
) -> Result<Outcome, Failure> {
    listener.serve(&mut host);
    while cycle.goes_on(host.is_over()) {
        cycle.tick();
        listener.serve(&mut host);
        // On simulated time the run waits for the recorder, so that no tick is lost.
        while !cycle.has_room() && host.is_recorded() {
            std::thread::sleep(SERVE_EVERY);
        }
    }
    outcome((cycle, Vec::new()), host, listener)
}

/// Runs the cycle on a thread of its own and the host on this thread.
pub(super) fn side_by_side(
    cycle: Cycle,
    mut host: Host<'_>,
    mut listener: Listener<'_>,
    real_time: RealTime,
) -> Result<Outcome, Failure> {
    let over = Arc::new(AtomicBool::new(false));
    listener.serve(&mut host);
    let (done, mut back) = RingBuffer::new(1);
    let told = Arc::clone(&over);
    let thread = std::thread::Builder::new().name("rpi-cycle".into());
    let running = thread.spawn(move || tick_until((cycle, done), &told, real_time));
    let running = running.map_err(Failure::Thread)?;
    while back.is_empty() && !running.is_finished() {
        listener.serve(&mut host);
        over.fetch_or(host.is_over(), Ordering::Relaxed);
        std::thread::sleep(SERVE_EVERY);
    }
    match back.pop() {
        Ok(cycle) => outcome(cycle, host, listener),
        Err(_) => match running.join() {
            Err(panic) => std::panic::resume_unwind(panic),
            Ok(()) => Err(Failure::Thread(std::io::ErrorKind::BrokenPipe.into())),
        },
    }
}

/// A finished cycle with the resources that the operating system granted.
type Done = (Cycle, Vec<Grant>);

/// Executes ticks until the end, then returns the cycle through a queue. Joining the thread is not possible: with the
/// system call filter it cannot exit.
fn tick_until(
    (mut cycle, mut done): (Cycle, Producer<Done>),
    over: &AtomicBool,
    real_time: RealTime,
) {
    let grants = realtime::begin(real_time);
    let fenced = grants.iter().any(realtime::is_fence_up);
    cycle.beat.restart();
    while cycle.goes_on(over.load(Ordering::Relaxed)) {
        cycle.tick();
    }
    // The queue has capacity one and is pushed to once.
    let _ = done.push((cycle, grants));
    if fenced {
        realtime::rest();
    }
}

fn outcome(
    (mut cycle, grants): Done,
    mut host: Host<'_>,
    listener: Listener<'_>,
) -> Result<Outcome, Failure> {
    host.listen(listener.sink);
    let lost = cycle.finish_tape();
    let written = host.recorder.take().map(|recorder| recorder.finish(lost));
    let (recorded, unrecorded) = match written.transpose() {
        Ok(recorded) => (recorded, None),
        Err(why) => (None, Some(why.to_string())),
    };
    if let Some((command, faults)) = host.books.failed {
        return Err(Failure::Loading {
            command,
            faults,
            // All devices were found before the run began.
            devices: Vec::new(),
        });
    }
    for (id, overruns) in &cycle.overran {
        host.books.overran(*id, overruns);
    }
    let stopped = cycle.halted.filter(|why| *why != Why::Request);
    Ok(Outcome {
        commands: host
            .books
            .commands
            .into_iter()
            .map(|(_, command)| command)
            .collect(),
        unlisted: host.books.unlisted,
        late: host.desk.late,
        missed: host.desk.missed,
        devices: devices::ends(cycle.bank()),
        figures: cycle.beat.figures(),
        tick_ns: listener.tick_ns,
        cut_off: cycle.halted == Some(Why::Request),
        stopped: stopped.map(|why| stop_text(why).to_owned()),
        digest: None,
        recorded,
        unrecorded,
        grants: grants.iter().map(ToString::to_string).collect(),
        samples_lost: cycle.watcher.tap.lost,
    })
}
