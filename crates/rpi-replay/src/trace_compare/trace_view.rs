//! One cycle of a trace, parsed with the types of the net.

use rpi_image::Type;

use rpi_record::trace::{Trace, TracePortId};

/// Value of a port in a cycle as the trace has it.
#[derive(Clone, PartialEq, Debug)]
pub(super) enum RecordedValue {
    /// The trace does not say whether the port had a value in the cycle.
    Unknown,
    /// The port was absent in the cycle.
    Absent,
    /// The port was present, but the recorder of the reference system (the control core of the Robotics API) does not
    /// write values of its type.
    Unprintable,
    /// The port was present with a value that does not have the type of the port; the text is the recorded value.
    WrongType(String),
    /// The port had this value, as memory words.
    Value(Vec<u64>),
}

/// Recorded values of one cycle of a trace, and of the cycle before.
pub(super) struct CycleView<'t> {
    trace: &'t Trace,
    /// Number of the cycle, from 1.
    pub(super) number: u64,
    complete: bool,
    texts: Vec<Option<&'t str>>,
}

impl<'t> CycleView<'t> {
    pub(super) fn new(trace: &'t Trace) -> CycleView<'t> {
        CycleView {
            trace,
            number: 0,
            complete: false,
            texts: vec![None; trace.ports().count()],
        }
    }

    /// Moves the view to the cycle of the trace with this number, from 1.
    pub(super) fn set_cycle(&mut self, number: u64) {
        self.number = number;
        self.texts.fill(None);
        let cycle = self.trace.cycle_at(number);
        self.complete = cycle.is_some_and(|c| c.complete);
        for row in cycle.map_or(&[][..], |c| &c.rows) {
            self.texts[row.port.0 as usize] = Some(self.trace.value(*row));
        }
    }

    /// Returns the recorded text of the value of a port in the previous cycle; `None` if there is none.
    pub(super) fn previous_text(&self, port: TracePortId) -> Option<&'t str> {
        let cycle = self.trace.cycle_at(self.number.checked_sub(1)?)?;
        let row = cycle.rows.iter().find(|row| row.port == port)?;
        Some(self.trace.value(*row))
    }

    /// Returns the recorded value of an out-port of the net. `port` is `None` if the port has no row in the trace.
    pub(super) fn out_port(&self, port: Option<TracePortId>, ty: Type) -> RecordedValue {
        let row = port.and_then(|p| self.texts[p.0 as usize]);
        let covered = self.complete || port.is_some_and(|p| self.trace.is_recorded(p, self.number));
        parse_recorded(row, covered, ty)
    }

    /// Returns the recorded value of an in-port of the net. Only traces of selected ports contain in-ports.
    pub(super) fn in_port(&self, port: TracePortId, ty: Type) -> RecordedValue {
        let covered = self.trace.is_recorded(port, self.number);
        parse_recorded(self.texts[port.0 as usize], covered, ty)
    }
}

fn parse_recorded(row: Option<&str>, covered: bool, ty: Type) -> RecordedValue {
    match row {
        None if covered => RecordedValue::Absent,
        None => RecordedValue::Unknown,
        Some(text) if is_opaque(text) => RecordedValue::Unprintable,
        Some("null") => RecordedValue::Absent,
        // An array with an absent element is also not a value.
        Some(text) => match rpi_literal::parse(text, ty) {
            Ok(Some(value)) => RecordedValue::Value(value.slots().to_vec()),
            Ok(None) | Err(_) => RecordedValue::WrongType(text.to_owned()),
        },
    }
}

/// Returns true for a text by which the recorder of the reference system (the control core of the Robotics API)
/// represents an object such as a matrix: its class name and identity.
fn is_opaque(text: &str) -> bool {
    text.contains('@')
}

/// Returns for each port of the trace, by its index, whether its value changed.
pub(super) fn varying_ports(trace: &Trace) -> Vec<bool> {
    let mut first: Vec<Option<&str>> = vec![None; trace.ports().count()];
    let mut varies = vec![false; first.len()];
    for row in trace.cycles().flat_map(|(_, cycle)| &cycle.rows) {
        let (at, text) = (row.port.0 as usize, trace.value(*row));
        varies[at] |= *first[at].get_or_insert(text) != text;
    }
    varies
}
