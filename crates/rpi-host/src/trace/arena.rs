//! A trace in memory: rows that point into one text.

use std::collections::BTreeMap;
use std::io::{ErrorKind, Read};
use std::ops::Range;
use std::path::Path;

use flate2::read::MultiGzDecoder;

use super::{ReadError, TraceError, comma, tabbed};

/// Index of a port in a [`Trace`].
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct PortId(pub u32);

/// What was recorded of one port in one cycle.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Row {
    /// The port.
    pub port: PortId,
    start: u32,
    end: u32,
}

/// What was recorded in one cycle.
#[derive(Clone, Debug, Default)]
pub struct Cycle {
    /// True if every out-port of the net was recorded: one without a row was absent.
    pub complete: bool,
    /// The rows, in the file's order.
    pub rows: Vec<Row>,
}

/// A recorded trace.
#[derive(Clone, Debug, Default)]
pub struct Trace {
    /// The net's clock in its first cycle, milliseconds since the Unix epoch.
    pub start_ms: Option<i64>,
    names: Vec<String>,
    index: BTreeMap<String, PortId>,
    /// Ports recorded in every cycle of their range: one without a row there was absent.
    listed: BTreeMap<PortId, Range<u64>>,
    cycles: BTreeMap<u64, Cycle>,
    text: String,
}

impl Trace {
    /// Reads a trace file, plain or gzip, of either form.
    ///
    /// # Errors
    /// If the file cannot be opened or unpacked, or a line is in neither form.
    pub fn read(path: &Path) -> Result<Trace, ReadError> {
        let text = read_text(path)?;
        Trace::parse(&text).map_err(|e| ReadError {
            path: path.to_owned(),
            line: Some(e.line),
            message: e.message,
        })
    }

    /// Reads a trace from its text; the first line tells the form.
    ///
    /// # Errors
    /// Names the first line that cannot be read.
    pub fn parse(text: &str) -> Result<Trace, TraceError> {
        let first = text.lines().next().unwrap_or("");
        if first.starts_with(comma::HEADER) {
            comma::parse(text)
        } else {
            tabbed::parse(text)
        }
    }

    /// Takes up what another recording of the same run holds.
    #[must_use]
    pub fn merged(mut self, other: &Trace) -> Trace {
        self.start_ms = self.start_ms.or(other.start_ms);
        for (&number, cycle) in &other.cycles {
            self.cycle(number).complete |= cycle.complete;
            for &row in &cycle.rows {
                self.record(number, other.name(row.port), other.value(row));
            }
        }
        for (&port, range) in &other.listed {
            let port = self.port(other.name(port));
            self.listed.insert(port, range.clone());
        }
        self
    }

    /// The port's path, `fragment/primitive.port`.
    #[must_use]
    pub fn name(&self, port: PortId) -> &str {
        &self.names[port.0 as usize]
    }

    /// All ports that have a row somewhere, in order of appearance.
    pub fn ports(&self) -> impl Iterator<Item = (PortId, &str)> {
        let ids = (0..).map(PortId);
        ids.zip(self.names.iter().map(String::as_str))
    }

    /// The port of this path, if it has a row somewhere.
    #[must_use]
    pub fn find(&self, name: &str) -> Option<PortId> {
        self.index.get(name).copied()
    }

    /// The text of a recorded value.
    #[must_use]
    pub fn value(&self, row: Row) -> &str {
        &self.text[row.start as usize..row.end as usize]
    }

    /// The recorded cycles by number, from 1.
    pub fn cycles(&self) -> impl Iterator<Item = (u64, &Cycle)> {
        self.cycles.iter().map(|(&number, cycle)| (number, cycle))
    }

    /// What was recorded in the cycle of this number.
    #[must_use]
    pub fn at(&self, number: u64) -> Option<&Cycle> {
        self.cycles.get(&number)
    }

    /// The number of the last recorded cycle; 0 for an empty trace.
    #[must_use]
    pub fn last_cycle(&self) -> u64 {
        self.cycles.keys().next_back().copied().unwrap_or(0)
    }

    /// Whether a missing row of this port in this cycle means that it was absent.
    #[must_use]
    pub fn covers(&self, port: PortId, number: u64) -> bool {
        self.listed.get(&port).is_some_and(|r| r.contains(&number))
    }

    /// Adds a row.
    pub(super) fn record(&mut self, number: u64, name: &str, value: &str) {
        let start = self.offset();
        self.text.push_str(value);
        let end = self.offset();
        let port = self.port(name);
        self.cycle(number).rows.push(Row { port, start, end });
    }

    pub(super) fn cycle(&mut self, number: u64) -> &mut Cycle {
        self.cycles.entry(number).or_default()
    }

    /// Declares that every port with a row was recorded in all cycles up to the last.
    pub(super) fn list_all(&mut self) {
        let range = 1..self.last_cycle() + 1;
        self.listed = self.ports().map(|(id, _)| (id, range.clone())).collect();
    }

    /// Declares that every out-port was recorded in each cycle of the trace.
    pub(super) fn complete_all(&mut self) {
        for cycle in self.cycles.values_mut() {
            cycle.complete = true;
        }
    }

    fn port(&mut self, name: &str) -> PortId {
        if let Some(id) = self.find(name) {
            return id;
        }
        let id = PortId(u32::try_from(self.names.len()).unwrap_or(u32::MAX));
        self.names.push(name.to_owned());
        self.index.insert(name.to_owned(), id);
        id
    }

    fn offset(&self) -> u32 {
        u32::try_from(self.text.len()).unwrap_or(u32::MAX)
    }
}

/// The text of a file, unpacked if it begins as gzip does (RFC 1952, section 2.3.1).
///
/// # Errors
/// If the file cannot be read or unpacked, or is no text.
pub fn read_text(path: &Path) -> Result<String, ReadError> {
    let failed = |e: std::io::Error| ReadError {
        path: path.to_owned(),
        line: None,
        message: match e.kind() {
            ErrorKind::InvalidData => "this is no text (not UTF-8)".to_owned(),
            _ => e.to_string(),
        },
    };
    let bytes = std::fs::read(path).map_err(failed)?;
    let mut text = String::new();
    if bytes.starts_with(&[0x1f, 0x8b]) {
        MultiGzDecoder::new(bytes.as_slice()).read_to_string(&mut text)
    } else {
        bytes.as_slice().read_to_string(&mut text)
    }
    .map_err(failed)?;
    Ok(text)
}
