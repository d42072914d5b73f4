//! Options of `rpi view`.

use std::path::PathBuf;

use clap::Args;

/// Options of `rpi view`.
#[derive(Args, Debug)]
pub(crate) struct ViewArgs {
    /// Recording (.mcap) to show: the file of its first part.
    pub(crate) recording: PathBuf,
    /// Write the page with the recording to this file, to share or keep it, and start no server.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["port", "no_open"])]
    pub(crate) report: Option<PathBuf>,
    /// Port of the page on this machine; 0 for any free port.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(crate) port: u16,
    /// Do not open the page in a browser; its address is printed.
    #[arg(long)]
    pub(crate) no_open: bool,
    /// Show the recording from this time on, such as 10s.
    #[arg(long, value_name = "TIME", value_parser = rpi_driver::parse_duration)]
    pub(crate) from: Option<u64>,
    /// Show the recording up to this time, such as 20s.
    #[arg(long, value_name = "TIME", value_parser = rpi_driver::parse_duration)]
    pub(crate) to: Option<u64>,
}
