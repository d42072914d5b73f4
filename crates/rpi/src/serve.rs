//! `rpi serve`: the control core as a server.

use std::fs::File;
use std::io::BufWriter;
use std::path::Path;
use std::sync::atomic::Ordering;
use std::time::Duration;

use rpi_diag::with_noun;
use rpi_record::mcap::{RecordingOptions, RunSources};
use rpi_serve::{OpenError, Server, Settings, TlsFiles};

use crate::args::ServeArgs;
use crate::cell_file;
use crate::exit::{self, Exit};
use crate::interrupt::Interrupt;
use crate::run::is_mcap;

/// Carries out `rpi serve`: runs the server until it is interrupted; then stops everything and closes once the devices
/// are at rest.
pub(crate) fn serve(args: &ServeArgs) -> exit::CommandResult {
    let cell = args.cell.as_deref().map(cell_file::read).transpose()?;
    let (cell, text) = cell.unwrap_or_default();
    let token = args.token_file.as_deref().map(read_token).transpose()?;
    let settings = Settings {
        cycle_share: args.share.parse_share(),
        ns_per_operation: args.share.ns_per_operation(None)?,
        listen: args.listen,
        socket: args.socket.clone(),
        token,
        tls: tls(args),
        insecure: args.insecure,
        tick_ns: args.period,
        real_time: args.clock.real_time.then(|| args.clock.real_time()),
        continuity: args.on_jump.map(Into::into),
        on_loss: args.on_loss,
        grace: Duration::from_nanos(args.grace),
        ..Settings::default()
    };
    let recording = args.record.as_deref().map(|path| recording(path, text));
    let interrupt = Interrupt::listen()?;
    let (interrupted, emergency) = (interrupt.flag(), interrupt.emergency());
    let server = Server::open_recorded(&cell, &settings, (), recording.transpose()?);
    let server = server.map_err(with_hint)?;
    server
        .grants()
        .iter()
        .for_each(|grant| rpi_diag::println_stderr!("{grant}"));
    let scheme = args.tls_cert.as_ref().map_or("ws", |_| "wss");
    rpi_diag::println_stderr!("serving at {scheme}://{}", server.address());
    while server.runs() && !interrupted.load(Ordering::Relaxed) {
        if emergency.swap(false, Ordering::Relaxed) {
            server.emergency_stop("SIGQUIT");
            rpi_diag::println_stderr!("EMERGENCY STOP; reset it by `emergency.reset` of JSON-RPC");
        }
        for warning in server.warnings() {
            rpi_diag::println_stderr!("{warning}");
        }
        std::thread::sleep(POLL_INTERVAL);
    }
    let file = args.record.as_deref().unwrap_or(Path::new("")).display();
    if let Some(written) = server.close().map_err(|e| format!("{file}: {e}"))? {
        let ticks = with_noun(written.ticks, "tick");
        rpi_diag::println_stderr!("recorded {ticks}, {} lost", written.lost);
    }
    Ok(Exit::Success)
}

/// Interval at which interrupts and warnings are checked.
const POLL_INTERVAL: Duration = Duration::from_millis(20);

/// Creates the recording file.
fn recording(path: &Path, cell: String) -> Result<RecordingOptions, String> {
    let name = path.display();
    if !is_mcap(path) {
        return Err(format!(
            "{name}: the recording of a server must be a file .mcap"
        ));
    }
    let file = File::create(path).map_err(|e| format!("{name}: {e}"))?;
    Ok(RecordingOptions {
        out: Box::new(BufWriter::new(file)),
        origin: RunSources {
            program: "server".to_owned(),
            program_bytes: Vec::new(),
            cell,
        },
    })
}

fn tls(args: &ServeArgs) -> Option<TlsFiles> {
    let (certificates, key) = args.tls_cert.clone().zip(args.tls_key.clone())?;
    Some(TlsFiles { certificates, key })
}

/// Returns the text of an error of opening the server, with the options that would avoid it.
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

/// Minimum length of a token in bytes.
const MIN_TOKEN_BYTES: usize = 16;

fn read_token(path: &Path) -> Result<String, String> {
    let name = path.display();
    let text = std::fs::read_to_string(path).map_err(|e| format!("{name}: {e}"))?;
    match text.trim() {
        "" => Err(format!("{name}: the file has no token")),
        token if token.len() < MIN_TOKEN_BYTES => Err(format!(
            "{name}: a token of {} is too short; use at least {MIN_TOKEN_BYTES}, for example of `head -c 32 /dev/urandom | base64`",
            with_noun(token.len(), "byte")
        )),
        token if token.contains(char::is_whitespace) => {
            Err(format!("{name}: a token must be a single word"))
        }
        token => Ok(token.to_owned()),
    }
}
