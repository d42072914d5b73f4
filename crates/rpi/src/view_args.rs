//! Options of `rpi view`, and those of a recording whose values are read.

use std::path::PathBuf;

use clap::Args;

/// Recording, and the values of it that are read.
#[derive(Args, Debug)]
pub(crate) struct RecordedRun {
    /// Recording (.mcap): the file of its first part.
    pub(crate) recording: PathBuf,
    /// Read the recording from this time on, such as 10s.
    #[arg(long, value_name = "TIME", value_parser = rpi_driver::parse_duration)]
    pub(crate) from: Option<u64>,
    /// Read the recording up to this time, such as 20s.
    #[arg(long, value_name = "TIME", value_parser = rpi_driver::parse_duration)]
    pub(crate) to: Option<u64>,
    /// Add a flow that was not recorded, named by its command and the path to it, such as `Move.Approach.way.travelled`; a
    /// command, call or fragment stands for all flows inside. The recording is replayed. May be repeated.
    #[arg(long, value_name = "FLOW")]
    pub(crate) watch: Vec<String>,
    /// Program that was recorded, if it consists of several files (for --watch, and for the net in `rpi view`).
    #[arg(long, value_name = "FILE")]
    pub(crate) program: Option<PathBuf>,
}

/// Options of `rpi view`.
#[derive(Args, Debug)]
pub(crate) struct ViewArgs {
    #[command(flatten)]
    pub(crate) run: RecordedRun,
    /// Write the page with the recording to this file, to share or keep it, and start no server.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["port", "no_open"])]
    pub(crate) report: Option<PathBuf>,
    /// Port of the page on this machine; 0 for any free port.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(crate) port: u16,
    /// Do not open the page in a browser; its address is printed.
    #[arg(long)]
    pub(crate) no_open: bool,
}
