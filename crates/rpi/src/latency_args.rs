//! Options of `rpi latency`.

use std::path::PathBuf;

use clap::{Args, value_parser};
use rpi_runtime::realtime::SchedulingOptions;

/// Options of `rpi latency`.
#[derive(Args, Debug)]
pub(crate) struct LatencyArgs {
    /// Period at which the measured thread is woken, such as 1ms.
    #[arg(long, value_parser = rpi_driver::parse_duration, value_name = "TIME", default_value = "1ms")]
    pub(crate) period: u64,
    /// Duration of the measurement, such as 10s.
    #[arg(long, value_parser = rpi_driver::parse_duration, value_name = "TIME", default_value = "10s")]
    pub(crate) time: u64,
    /// SCHED_FIFO priority of the measured thread, 1 to 99.
    #[arg(long, value_name = "N", default_value_t = SchedulingOptions::default().priority, value_parser = value_parser!(u8).range(1..100))]
    pub(crate) priority: u8,
    /// Processor core of the measured thread, counted from 0; default: the last one.
    #[arg(long, value_name = "N")]
    pub(crate) core: Option<usize>,
    /// Number of threads that keep the processor and the memory busy during the measurement.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(crate) load: usize,
    /// Run this program in real time for the same duration first, and include its cycle times.
    #[arg(long, value_name = "FILE")]
    pub(crate) program: Option<PathBuf>,
    /// Cell description with the devices of the program; default: `cell.toml` beside the program.
    #[arg(long, value_name = "FILE", requires = "program")]
    pub(crate) cell: Option<PathBuf>,
    /// Command or task of the program, if it has several.
    #[arg(long, value_name = "NAME", requires = "program")]
    pub(crate) command: Option<String>,
    /// Print the measured figures as JSON.
    #[arg(long)]
    pub(crate) json: bool,
}
