//! Tab-separated trace format: `cycle  path.port  value`, one line per present out-port and cycle.
//!
//! The line `0  #t0  <ms>` holds the clock of the net in its first cycle. A port without a line in a cycle was absent
//! in that cycle. After a line `0  #ports  listed` this applies only to the ports that have at least one line; nothing
//! is known of other ports.

use std::io::{self, Write};

use super::{Trace, TraceError};

pub(super) fn parse(text: &str) -> Result<Trace, TraceError> {
    let mut trace = Trace::default();
    let mut listed = false;
    for (k, line) in text.lines().enumerate() {
        let mut fields = line.splitn(3, '\t');
        let (Some(cycle), Some(name), Some(value)) = (fields.next(), fields.next(), fields.next())
        else {
            return Err(TraceError::new(
                k + 1,
                "expected `cycle<TAB>path.port<TAB>value`",
            ));
        };
        match name {
            "#t0" => {
                trace.start_ms = Some(parse_start_ms(value).ok_or_else(|| invalid_start(k, value))?)
            }
            "#ports" => listed = value == "listed",
            _ => trace.push_row(
                parse_cycle_number(cycle).ok_or_else(|| invalid_cycle_number(k, cycle))?,
                name,
                value,
            ),
        }
    }
    if listed {
        trace.mark_all_listed();
    } else {
        add_empty_cycles(&mut trace);
        trace.mark_all_complete();
    }
    Ok(trace)
}

/// Adds the cycles without any line to the trace. Every port was absent in these cycles.
fn add_empty_cycles(trace: &mut Trace) {
    for number in 1..trace.last_cycle() {
        trace.cycle(number);
    }
}

fn parse_start_ms(value: &str) -> Option<i64> {
    value.split('\t').next()?.parse().ok()
}

/// Parses a cycle number from 1 to 10 000 000; `None` for any other text. Larger numbers are rejected because the
/// cycles in between are filled in.
pub(super) fn parse_cycle_number(text: &str) -> Option<u64> {
    text.parse().ok().filter(|n| (1..=10_000_000).contains(n))
}

fn invalid_start(k: usize, value: &str) -> TraceError {
    TraceError::new(k + 1, format!("`{value}` is not a time in milliseconds"))
}

pub(super) fn invalid_cycle_number(k: usize, text: &str) -> TraceError {
    TraceError::new(k + 1, format!("`{text}` is not a cycle number (1, 2, ...)"))
}

/// Writer of a trace (recorded port values of a net) in the tab-separated format.
pub struct TraceWriter<W> {
    out: W,
}

impl<W: Write> TraceWriter<W> {
    /// Creates the writer and writes the header. `start_ms` is the clock of the net in its first cycle, in milliseconds
    /// since the Unix epoch.
    ///
    /// # Errors
    /// Returns the I/O errors of the writer.
    pub fn new(mut out: W, start_ms: i64) -> io::Result<TraceWriter<W>> {
        writeln!(out, "0\t#t0\t{start_ms}\tcycle=1")?;
        Ok(TraceWriter { out })
    }

    /// Writes the header line which says that the trace contains only some ports: those with at least one line.
    ///
    /// # Errors
    /// Returns the I/O errors of the writer.
    pub fn write_listed_marker(&mut self) -> io::Result<()> {
        writeln!(self.out, "0\t#ports\tlisted")
    }

    /// Writes the text form of the value of the port `name` in a cycle. Cycles are numbered from 1.
    ///
    /// # Errors
    /// Returns the I/O errors of the writer.
    pub fn write_row(&mut self, cycle: u64, name: &str, value: &str) -> io::Result<()> {
        writeln!(self.out, "{cycle}\t{name}\t{value}")
    }

    /// Flushes and returns the underlying writer.
    ///
    /// # Errors
    /// Returns the I/O errors of the writer.
    pub fn finish(mut self) -> io::Result<W> {
        self.out.flush()?;
        Ok(self.out)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "0\t#t0\t1000\tcycle=1\n1\ta.outValue\t1.5\n3\tf/b.outIO\ttrue\n";

    #[test]
    fn rows_keep_cycle_path_and_text() {
        let trace = Trace::parse(TEXT).unwrap();
        assert_eq!(trace.start_ms, Some(1000));
        let rows: Vec<_> = trace
            .cycles()
            .flat_map(|(n, c)| c.rows.iter().map(move |&r| (n, r)))
            .map(|(n, r)| (n, trace.name(r.port), trace.value(r)))
            .collect();
        assert_eq!(rows, [(1, "a.outValue", "1.5"), (3, "f/b.outIO", "true")]);
    }

    #[test]
    fn a_cycle_without_lines_was_recorded_as_wholly_absent() {
        let trace = Trace::parse(TEXT).unwrap();
        assert_eq!(trace.last_cycle(), 3);
        assert!(
            trace
                .cycle_at(2)
                .is_some_and(|c| c.complete && c.rows.is_empty())
        );
    }

    #[test]
    fn listed_ports_are_covered_and_others_unknown() {
        let trace = Trace::parse(&format!("0\t#ports\tlisted\n{TEXT}")).unwrap();
        let a = trace.find("a.outValue").unwrap();
        assert!(trace.is_recorded(a, 2) && !trace.is_recorded(a, 4));
        assert!(trace.cycles().all(|(_, c)| !c.complete));
    }

    #[test]
    fn broken_lines_are_named() {
        let line = |text| Trace::parse(text).unwrap_err().line;
        assert_eq!(line("1\ta.b\t2\nx"), 2);
        assert_eq!(line("one\ta.b\t2"), 1);
        assert_eq!(line("0\t#t0\tnow"), 1);
        assert_eq!(line("99999999999\ta.b\t1"), 1);
    }

    #[test]
    fn what_is_written_reads_back() {
        let mut out = TraceWriter::new(Vec::new(), 7).unwrap();
        out.write_listed_marker().unwrap();
        out.write_row(2, "p.outValue", "{x:1.0,y:2.0,z:3.0}")
            .unwrap();
        let text = String::from_utf8(out.finish().unwrap()).unwrap();
        let trace = Trace::parse(&text).unwrap();
        assert_eq!(trace.start_ms, Some(7));
        let row = trace.cycle_at(2).unwrap().rows[0];
        assert_eq!(trace.value(row), "{x:1.0,y:2.0,z:3.0}");
    }
}
