//! `rpi serve`: the control core as a server.

use std::path::Path;

use rpi_serve::{CannotOpen, Server, Settings, TlsFiles};
use rpi_sim::Cell;

use crate::args::ServeArgs;
use crate::exit::{self, Exit};

/// Serves until it is interrupted.
pub(crate) fn serve(args: &ServeArgs) -> exit::Outcome {
    let cell = cell(args.cell.as_deref())?;
    let token = args.token_file.as_deref().map(token).transpose()?;
    let settings = Settings {
        listen: args.listen,
        socket: args.socket.clone(),
        token,
        tls: tls(args),
        insecure: args.insecure,
        tick_ns: args.period,
        real_time: args.clock.real_time.then(|| args.clock.real_time()),
        continuity: args.on_jump.map(Into::into),
        on_loss: args.on_loss,
        ..Settings::default()
    };
    let mut server = Server::open(&cell, &settings, ()).map_err(with_a_way_out)?;
    server
        .grants()
        .iter()
        .for_each(|grant| eprintln!("{grant}"));
    eprintln!("serving at {}", server.address());
    server.wait();
    Ok(Exit::Good)
}

fn cell(path: Option<&Path>) -> Result<Cell, String> {
    let Some(path) = path else {
        return Ok(Cell::default());
    };
    let name = path.display().to_string();
    let bytes = std::fs::read(path).map_err(|e| format!("{name}: {e}"))?;
    let text = rpi_driver::utf8(path, &bytes).map_err(|e| e.to_string())?;
    Cell::parse(&name, text).map_err(|errors| format!("the cell is wrong\n{errors}"))
}

fn tls(args: &ServeArgs) -> Option<TlsFiles> {
    let (certificates, key) = args.tls_cert.clone().zip(args.tls_key.clone())?;
    Some(TlsFiles { certificates, key })
}

/// Says with which options it would open.
fn with_a_way_out(why: CannotOpen) -> String {
    let CannotOpen::Unguarded {
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
        "{why}\n  add{missing}, or --insecure where nobody else can reach it; `rpic explain RPI9201` says more"
    )
}

fn token(path: &Path) -> Result<String, String> {
    let name = path.display();
    let text = std::fs::read_to_string(path).map_err(|e| format!("{name}: {e}"))?;
    match text.trim() {
        "" => Err(format!("{name} holds no token")),
        token => Ok(token.to_owned()),
    }
}
