//! Writes a run as a trace that `rpi replay` can read.

use std::io::{self, Write};

use crate::trace::TraceWriter;
use rpi_runtime::run::{Channel, Sink, Source};

/// Sink of samples that writes the ports of one command as a trace (input of `rpi replay`). The first tick is cycle 1.
pub struct TraceSink<W: Write> {
    out: TraceWriter<W>,
    channels: Vec<Channel>,
    /// First error of the output; `None` without an error. Nothing is written after it.
    error: Option<io::Error>,
}

impl<W: Write> TraceSink<W> {
    /// Creates the sink for a command whose clock is `start_ms`, in milliseconds since the Unix epoch, in its first
    /// cycle.
    ///
    /// # Errors
    /// Returns the I/O errors of the writer.
    pub fn new(out: W, start_ms: i64) -> io::Result<TraceSink<W>> {
        Ok(TraceSink {
            out: TraceWriter::new(out, start_ms)?,
            channels: Vec::new(),
            error: None,
        })
    }

    /// Finishes the trace.
    ///
    /// # Errors
    /// Returns the first error of the writer.
    pub fn finish(self) -> io::Result<()> {
        match self.error {
            Some(error) => Err(error),
            None => self.out.finish().map(|_| ()),
        }
    }
}

impl<W: Write> Sink for TraceSink<W> {
    fn channels(&mut self, channels: &[Channel]) {
        self.channels = channels.to_vec();
    }

    fn sample(&mut self, channel: usize, tick: u64, value: Option<&[u64]>) {
        let channel = &self.channels[channel];
        let Some(value) = value.filter(|_| channel.source == Source::Command) else {
            return;
        };
        if self.error.is_none() {
            let text = rpi_literal::write(value, channel.ty);
            self.error = self.out.write_row(tick + 1, &channel.name, &text).err();
        }
    }
}
