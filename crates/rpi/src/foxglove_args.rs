//! Options for live messages to the viewer Foxglove, common to `rpi run` and `rpi serve`.

use std::net::{IpAddr, SocketAddr};

use clap::Args;
use rpi_serve::{FoxglovePort, FoxgloveSettings, OpenError};

/// Options for live messages to the viewer Foxglove.
#[derive(Args, Debug)]
pub(crate) struct FoxgloveArgs {
    /// Send live messages to the viewer Foxglove at this port; 0 for any free one. In Foxglove, open the connection
    /// `ws://127.0.0.1:PORT`.
    #[arg(long, value_name = "PORT", help_heading = "Live viewers")]
    foxglove: Option<u16>,
    /// Let the pages of this origin connect, such as `https://app.foxglove.dev`. May be repeated.
    #[arg(
        long,
        value_name = "ORIGIN",
        requires = "foxglove",
        help_heading = "Live viewers"
    )]
    foxglove_origin: Vec<String>,
}

impl FoxgloveArgs {
    /// Opens the port and prints its address; `None` if there is no such option. `protection` has the tokens and the certificate, and
    /// the port listens at its address.
    pub(crate) fn open(
        &self,
        protection: FoxgloveSettings,
    ) -> Result<Option<FoxglovePort>, OpenError> {
        let Some(port) = self.foxglove else {
            return Ok(None);
        };
        let scheme = protection.tls.as_ref().map_or("ws", |_| "wss");
        let opened = FoxglovePort::open(&FoxgloveSettings {
            listen: SocketAddr::new(protection.listen.ip(), port),
            origins: self.foxglove_origin.clone(),
            ..protection
        })?;
        rpi_diag::println_stderr!(
            "live messages for Foxglove at {scheme}://{}",
            opened.address()
        );
        Ok(Some(opened))
    }

    /// Opens the port for a run, to which only this machine can connect.
    pub(crate) fn open_local(&self) -> Result<Option<FoxglovePort>, OpenError> {
        self.open(FoxgloveSettings {
            listen: SocketAddr::new(IpAddr::from([127, 0, 0, 1]), 0),
            tokens: Vec::new(),
            tls: None,
            insecure: false,
            origins: Vec::new(),
        })
    }
}
