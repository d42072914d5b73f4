//! Trace in memory. The rows are ranges of one text buffer.

use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::ops::Range;
use std::path::Path;

use super::{FileReadError, TraceError, csv, tsv};

/// Index of a port in the list of ports of a [`Trace`].
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct TracePortId(pub u32);

/// Row of a trace: the recorded value of one port in one cycle.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct TraceRow {
    /// Port of the net whose value was recorded.
    pub port: TracePortId,
    start: u32,
    end: u32,
}

/// Values recorded in one cycle of a trace.
#[derive(Clone, Debug, Default)]
pub struct TraceCycle {
    /// Whether every out-port of the net was recorded in the cycle. If true, an out-port without a row was absent.
    pub complete: bool,
    /// Recorded values, in the order of the file.
    pub rows: Vec<TraceRow>,
}

/// Recorded trace of a net: the values of its ports in each cycle.
#[derive(Clone, Debug, Default)]
pub struct Trace {
    /// Clock of the net in its first cycle, in milliseconds since the Unix epoch; `None` if the trace does not state
    /// it.
    pub start_ms: Option<i64>,
    names: Vec<String>,
    index: BTreeMap<String, TracePortId>,
    /// For some ports, the range of cycles (end exclusive) in which every present value was recorded. A port without a
    /// row in such a cycle was absent.
    listed: BTreeMap<TracePortId, Range<u64>>,
    cycles: BTreeMap<u64, TraceCycle>,
    text: String,
}

impl Trace {
    /// Reads a trace file in either format, plain or compressed with gzip.
    ///
    /// # Errors
    /// Returns an error if the file cannot be opened or decompressed, or if a line is invalid.
    pub fn read(path: &Path) -> Result<Trace, FileReadError> {
        let text = read_text(path)?;
        Trace::parse(&text).map_err(|e| FileReadError {
            path: path.to_owned(),
            line: Some(e.line),
            message: e.message,
        })
    }

    /// Parses the text of a trace in either format. The first line determines the format.
    ///
    /// # Errors
    /// Returns an error that names the first invalid line.
    pub fn parse(text: &str) -> Result<Trace, TraceError> {
        let first = text.lines().next().unwrap_or("");
        if first.starts_with(csv::HEADER) {
            csv::parse(text)
        } else {
            tsv::parse(text)
        }
    }

    /// Adds the rows of another trace of the same run and returns the merged trace.
    #[must_use]
    pub fn merged_with(mut self, other: &Trace) -> Trace {
        self.start_ms = self.start_ms.or(other.start_ms);
        for (&number, cycle) in &other.cycles {
            self.cycle(number).complete |= cycle.complete;
            for &row in &cycle.rows {
                self.push_row(number, other.name(row.port), other.value(row));
            }
        }
        for (&port, range) in &other.listed {
            let port = self.port(other.name(port));
            self.listed.insert(port, range.clone());
        }
        self
    }

    /// Returns the path of a port in the net, `fragment/primitive.port`.
    #[must_use]
    pub fn name(&self, port: TracePortId) -> &str {
        &self.names[port.0 as usize]
    }

    /// Iterates over the indices and paths of all ports with at least one row, in order of appearance.
    pub fn ports(&self) -> impl Iterator<Item = (TracePortId, &str)> {
        let ids = (0..).map(TracePortId);
        ids.zip(self.names.iter().map(String::as_str))
    }

    /// Returns the index of the port with this path; `None` if the port has no row.
    #[must_use]
    pub fn find(&self, name: &str) -> Option<TracePortId> {
        self.index.get(name).copied()
    }

    /// Returns the text form of a recorded value.
    #[must_use]
    pub fn value(&self, row: TraceRow) -> &str {
        &self.text[row.start as usize..row.end as usize]
    }

    /// Iterates over the recorded cycles with their numbers, from 1.
    pub fn cycles(&self) -> impl Iterator<Item = (u64, &TraceCycle)> {
        self.cycles.iter().map(|(&number, cycle)| (number, cycle))
    }

    /// Returns the rows recorded in the cycle with this number, from 1; `None` if the cycle was not recorded.
    #[must_use]
    pub fn cycle_at(&self, number: u64) -> Option<&TraceCycle> {
        self.cycles.get(&number)
    }

    /// Returns the number of the last recorded cycle; 0 for an empty trace.
    #[must_use]
    pub fn last_cycle(&self) -> u64 {
        self.cycles.keys().next_back().copied().unwrap_or(0)
    }

    /// Returns true if all present values of this port were recorded in the cycle with this number, so that a missing
    /// row means an absent value.
    #[must_use]
    pub fn is_recorded(&self, port: TracePortId, number: u64) -> bool {
        self.listed.get(&port).is_some_and(|r| r.contains(&number))
    }

    /// Adds a row: the text form of the value of the port `name` in the cycle `number`, from 1.
    pub(super) fn push_row(&mut self, number: u64, name: &str, value: &str) {
        let start = self.offset();
        self.text.push_str(value);
        let end = self.offset();
        let port = self.port(name);
        self.cycle(number).rows.push(TraceRow { port, start, end });
    }

    pub(super) fn cycle(&mut self, number: u64) -> &mut TraceCycle {
        self.cycles.entry(number).or_default()
    }

    /// Marks all ports with a row: in all cycles up to the last one, a missing row means an absent value.
    pub(super) fn mark_all_listed(&mut self) {
        let range = 1..self.last_cycle() + 1;
        self.listed = self.ports().map(|(id, _)| (id, range.clone())).collect();
    }

    /// Marks every cycle as complete, which means that all out-ports of the net were recorded in it.
    pub(super) fn mark_all_complete(&mut self) {
        for cycle in self.cycles.values_mut() {
            cycle.complete = true;
        }
    }

    fn port(&mut self, name: &str) -> TracePortId {
        if let Some(id) = self.find(name) {
            return id;
        }
        let id = TracePortId(u32::try_from(self.names.len()).unwrap_or(u32::MAX));
        self.names.push(name.to_owned());
        self.index.insert(name.to_owned(), id);
        id
    }

    fn offset(&self) -> u32 {
        u32::try_from(self.text.len()).unwrap_or(u32::MAX)
    }
}

/// Reads a text file. The file is decompressed if it starts with the magic number of gzip (RFC 1952, section 2.3.1).
///
/// # Errors
/// Returns an error if the file cannot be read or decompressed, or is not UTF-8 text.
pub fn read_text(path: &Path) -> Result<String, FileReadError> {
    let failed = |e: std::io::Error| FileReadError {
        path: path.to_owned(),
        line: None,
        message: match e.kind() {
            ErrorKind::InvalidData => "this is not a text file (invalid UTF-8)".to_owned(),
            _ => e.to_string(),
        },
    };
    let bytes = rpi_files::read(path, rpi_files::MAX_TRACE).map_err(failed)?;
    let text = String::from_utf8(bytes);
    text.map_err(|error| failed(std::io::Error::new(ErrorKind::InvalidData, error)))
}
