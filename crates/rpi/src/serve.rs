//! `rpi serve`: the control core as a server.

use std::error::Error;
use std::fs::File;
use std::io;
use std::path::Path;
use std::sync::atomic::Ordering;
use std::time::Duration;

use rpi_diag::with_noun;
use rpi_record::mcap::{RecordingOptions, RunOutputs, RunSources};
use rpi_serve::{
    CompilerSettings, FoxglovePort, FoxgloveSettings, OpenError, Server, Settings, TlsFiles,
    WorkerSettings, read_tokens,
};

use crate::args::ServeArgs;
use crate::cell_file;
use crate::exit::{self, Exit};
use crate::guard::{Heartbeat, HeartbeatSource};
use crate::interrupt::Interrupt;
use crate::own_program::own_program;
use crate::run::is_mcap;

/// Carries out `rpi serve`: runs the server until a signal interrupts it, then stops all commands and closes the server
/// as soon as the devices are at rest.
pub(crate) fn serve(args: &ServeArgs) -> exit::CommandResult {
    let cell = args.cell.as_deref().map(cell_file::read).transpose()?;
    let (cell, text) = cell.unwrap_or_default();
    let settings = settings(args)?;
    let recording = args
        .record
        .as_deref()
        .map(|path| recording(path, args, text));
    if args.recording.needs_mcap() && args.record.is_none() {
        return Err("--profile, --part-size and --part-time need --record FILE.mcap".into());
    }
    let interrupt = Interrupt::listen()?;
    interrupt.listen_for_reset()?;
    let interrupted = interrupt.flag();
    let foxglove = args.foxglove.open(FoxgloveSettings {
        listen: settings.listen,
        tokens: settings.tokens.clone(),
        tls: settings.tls.clone(),
        insecure: settings.insecure,
        origins: Vec::new(),
    });
    let foxglove = foxglove.map_err(with_hint)?;
    let outputs = RunOutputs {
        recording: recording.transpose()?,
        live: foxglove.as_ref().map(FoxglovePort::viewers),
        ..RunOutputs::default()
    };
    let outputs = outputs.is_needed().then_some(outputs);
    let server = Server::open_with_outputs(&cell, &settings, (), outputs);
    let server = server.map_err(with_hint)?;
    server
        .grants()
        .iter()
        .for_each(|grant| rpi_diag::println_stderr!("{grant}"));
    let scheme = args.tls_cert.as_ref().map_or("ws", |_| "wss");
    rpi_diag::println_stderr!("serving at {scheme}://{}", server.address());
    if args.guard.emergency_stopped {
        rpi_diag::println_stderr!("EMERGENCY STOP: still in force after the crash");
    }
    let heartbeat = heartbeat(&server, args, &interrupt)?;
    while server.runs() && !interrupted.load(Ordering::Relaxed) {
        handle_operator(&server, &interrupt);
        heartbeat.set_stopped(server.is_emergency_stopped());
        for warning in server.warnings() {
            rpi_diag::println_stderr!("{warning}");
        }
        std::thread::sleep(POLL_INTERVAL);
    }
    let crashed = !server.runs();
    drop(heartbeat);
    let file = args.record.as_deref().unwrap_or(Path::new("")).display();
    if let Some(written) = server.close().map_err(|e| format!("{file}: {e}"))? {
        let ticks = with_noun(written.ticks, "tick");
        rpi_diag::println_stderr!("recorded {ticks}, {} lost", written.lost);
    }
    match crashed {
        true => Ok(Exit::Crashed),
        false => Ok(Exit::Success),
    }
}

/// Returns the settings of the server that the options give.
fn settings(args: &ServeArgs) -> Result<Settings, Box<dyn Error>> {
    let tokens = args.token_file.as_deref().map(read_tokens).transpose();
    let tokens = tokens.map_err(|why| why.to_string())?.unwrap_or_default();
    Ok(Settings {
        cycle_share: args.share.parse_share(),
        ns_per_operation: args.share.ns_per_operation(None)?,
        listen: args.listen,
        sockets: args.sockets.clone(),
        tokens,
        tls: tls(args),
        insecure: args.insecure,
        tick_ns: args.period,
        real_time: args.clock.real_time.then(|| args.clock.real_time()),
        continuity: args.on_jump.map(Into::into),
        on_loss: args.on_loss,
        grace: Duration::from_nanos(args.grace),
        stopped_by: args
            .guard
            .emergency_stopped
            .then(|| STOP_BEFORE_CRASH.to_owned()),
        log_file: args.log.clone(),
        compiler: compiler(args)?,
        ..Settings::default()
    })
}

/// Starts the heartbeat of the server, which reports the cycles to the guard or to the service manager.
fn heartbeat(server: &Server, args: &ServeArgs, interrupt: &Interrupt) -> io::Result<Heartbeat> {
    let metrics = server.cycle_metrics();
    let source = HeartbeatSource {
        ticks: Box::new(move || metrics.ticks()),
        period_ns: args.period,
        is_stopped: server.is_emergency_stopped(),
        interrupted: interrupt.flag(),
    };
    Heartbeat::start(source, args.guard.guarded)
}

/// Returns where the texts of clients are compiled: in workers that run this program.
fn compiler(args: &ServeArgs) -> Result<CompilerSettings, String> {
    if args.in_process || !cfg!(unix) {
        return Ok(CompilerSettings::InProcess);
    }
    let program = own_program().map_err(|why| format!("the path of this program: {why}"))?;
    Ok(CompilerSettings::Workers(WorkerSettings {
        timeout: Duration::from_nanos(args.load_timeout),
        ..WorkerSettings::new(program, vec!["compile-worker".into()])
    }))
}

/// Carries out `rpi compile-worker`.
pub(crate) fn compile_worker() -> exit::CommandResult {
    #[cfg(unix)]
    rpi_serve::run_compile_worker().map_err(|why| why.to_string())?;
    Ok(Exit::Success)
}

/// Carries out a pending request of the operator: an emergency stop (SIGQUIT), or its reset (SIGUSR1).
fn handle_operator(server: &Server, interrupt: &Interrupt) {
    if interrupt.take_emergency() {
        server.emergency_stop("SIGQUIT");
        let process = std::process::id();
        rpi_diag::println_stderr!(
            "EMERGENCY STOP; reset it with `kill -USR1 {process}`, or as a client with the role operator or admin"
        );
    } else if interrupt.take_reset() {
        match server.reset_emergency() {
            Ok(()) => rpi_diag::println_stderr!("the emergency stop was reset"),
            Err(why) => rpi_diag::println_stderr!("the emergency stop is still in force: {why}"),
        }
    }
}

/// Requester of an emergency stop that was in force when the previous control core crashed.
const STOP_BEFORE_CRASH: &str = "the emergency stop before the crash of the control core";

/// Interval at which the server process checks for signals and prints warnings.
const POLL_INTERVAL: Duration = Duration::from_millis(20);

/// Creates the file of a recording of the server, in the format MCAP. `cell` is the text of the cell description.
fn recording(path: &Path, args: &ServeArgs, cell: String) -> Result<RecordingOptions, String> {
    let name = path.display();
    if !is_mcap(path) {
        return Err(format!(
            "{name}: the recording of a server must be a file .mcap"
        ));
    }
    let file = File::create(path).map_err(|e| format!("{name}: {e}"))?;
    let origin = RunSources {
        program: "server".to_owned(),
        program_bytes: Vec::new(),
        cell,
    };
    Ok(args.recording.options((path, file), origin))
}

fn tls(args: &ServeArgs) -> Option<TlsFiles> {
    let (certificates, key) = args.tls_cert.clone().zip(args.tls_key.clone())?;
    Some(TlsFiles { certificates, key })
}

/// Returns the text of an error that prevents the start of the server. For an unprotected address, it also names the
/// missing options.
fn with_hint(why: OpenError) -> String {
    let OpenError::Unprotected {
        no_token, no_tls, ..
    } = why
    else {
        return why.to_string();
    };
    let options = [
        (no_token, " --token-file FILE"),
        (no_tls, " --tls-cert FILE --tls-key FILE"),
    ];
    let missing = options.iter().filter(|(lacks, _)| *lacks);
    let missing: String = missing.map(|(_, option)| *option).collect();
    format!(
        "{why}\n  add{missing}, or --insecure in an isolated network; see `rpic explain RPI9201`"
    )
}
