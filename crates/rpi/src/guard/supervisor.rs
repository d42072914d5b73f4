//! The process of the guard: starts the control core, waits for its end, completes its recording, and starts it again.

use std::path::Path;
use std::thread::JoinHandle;
use std::time::Instant;

use super::args::GuardArgs;
use super::core_process::{CoreEnd, CoreProcess};
use super::crash_recording;
use super::restart_limit::{MAX_RESTARTS, RESTART_WINDOW, RestartLimit};
use super::service_manager::ServiceManager;
use crate::exit::{CommandResult, Exit};
use crate::interrupt::Interrupt;

/// Runs the control core in a process of its own and watches it. `recording` is the file of its recording in the
/// format MCAP, if any. `has_reset` is true if the core handles SIGUSR1, the reset of an emergency stop.
pub(crate) fn guard(args: &GuardArgs, recording: Option<&Path>, has_reset: bool) -> CommandResult {
    let interrupt = Interrupt::listen()?;
    if has_reset {
        interrupt.listen_for_reset()?;
    }
    let mut manager = ServiceManager::from_environment();
    let mut restarts = RestartLimit::default();
    let mut completions = Vec::new();
    let mut is_stopped = false;
    loop {
        let mut core = CoreProcess::start(is_stopped)?;
        let end = match core.watch(&interrupt, &mut manager, args.stall_timeout())? {
            CoreEnd::Exited(status) => {
                join(completions);
                return Ok(Exit::Core { status });
            }
            end => end,
        };
        report(&core, end);
        // The emergency stop holds until it is reset, also across a crash.
        is_stopped = match core.beat().ticks {
            0 => is_stopped,
            _ => has_reset && core.beat().is_stopped,
        };
        let may_restart = args.restarts() && !core.is_interrupted;
        let restart = may_restart.then(|| restarts.next(Instant::now()));
        let again = matches!(restart, Some(Some(_)));
        completions.extend(crash_recording::complete_recording(
            recording,
            &end.to_string(),
            again,
        )?);
        match restart {
            Some(Some(number)) => {
                manager.status(&format!("restarted, because the core {end}"));
                rpi_diag::println_stderr!(
                    "guard: restart {number} of {MAX_RESTARTS} within {} s",
                    RESTART_WINDOW.as_secs()
                );
            }
            Some(None) => {
                rpi_diag::println_stderr!(
                    "guard: no restart after {MAX_RESTARTS} restarts within {} s",
                    RESTART_WINDOW.as_secs()
                );
            }
            None => {}
        }
        if !again {
            manager.status(&format!("the core {end}"));
            join(completions);
            return Ok(Exit::Crashed);
        }
    }
}

/// Reports the end of a core that has not ended in order.
fn report(core: &CoreProcess, end: CoreEnd) {
    let (process, ticks) = (core.id(), core.beat().ticks);
    let last = match ticks {
        0 => "before its first cycle".to_owned(),
        ticks => format!("after {}", rpi_diag::with_noun(ticks, "cycle")),
    };
    rpi_diag::println_stderr!("\nguard: the control core (process {process}) {end}, {last}");
    if ticks > 0 {
        rpi_diag::println_stderr!(
            "guard: no more set-points are sent; controllers of devices brake by their own watchdogs"
        );
    }
}

/// Waits until all recordings are completed.
fn join(completions: Vec<JoinHandle<()>>) {
    for completion in completions {
        // A completion only fails by a panic, which it has printed.
        let _ = completion.join();
    }
}
