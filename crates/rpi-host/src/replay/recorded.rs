//! The trace of one cycle, read with the types of the net.

use rpi_image::Type;
use rpi_net::literal;

use crate::trace::{PortId, Trace};

/// What the trace says of a port in a cycle.
#[derive(Clone, PartialEq, Debug)]
pub(super) enum Recorded {
    /// Nothing: the port was not recorded in this cycle.
    Unknown,
    /// It was absent.
    Absent,
    /// It was present with a value that the recorder could not write.
    Opaque,
    /// It was present with a value of another type than the port has.
    Foreign(String),
    /// It carried this value.
    Value(Vec<u64>),
}

/// One cycle of a trace.
pub(super) struct CycleView<'t> {
    trace: &'t Trace,
    /// Its number, from 1.
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

    /// Turns to the cycle of this number.
    pub(super) fn turn_to(&mut self, number: u64) {
        self.number = number;
        self.texts.fill(None);
        let cycle = self.trace.at(number);
        self.complete = cycle.is_some_and(|c| c.complete);
        for row in cycle.map_or(&[][..], |c| &c.rows) {
            self.texts[row.port.0 as usize] = Some(self.trace.value(*row));
        }
    }

    /// The text that the trace has for a port in the cycle before.
    pub(super) fn before(&self, port: PortId) -> Option<&'t str> {
        let cycle = self.trace.at(self.number.checked_sub(1)?)?;
        let row = cycle.rows.iter().find(|row| row.port == port)?;
        Some(self.trace.value(*row))
    }

    /// What the trace says of an out-port of the net; `port` is `None` if it never has a row.
    pub(super) fn out_port(&self, port: Option<PortId>, ty: Type) -> Recorded {
        let row = port.and_then(|p| self.texts[p.0 as usize]);
        let covered = self.complete || port.is_some_and(|p| self.trace.covers(p, self.number));
        read(row, covered, ty)
    }

    /// What the trace says of an in-port; only recordings of chosen ports have them.
    pub(super) fn in_port(&self, port: PortId, ty: Type) -> Recorded {
        let covered = self.trace.covers(port, self.number);
        read(self.texts[port.0 as usize], covered, ty)
    }
}

fn read(row: Option<&str>, covered: bool, ty: Type) -> Recorded {
    match row {
        None if covered => Recorded::Absent,
        None => Recorded::Unknown,
        Some(text) if is_opaque(text) => Recorded::Opaque,
        Some("null") => Recorded::Absent,
        // An array with an absent element is no value either.
        Some(text) => match literal::read(text, ty) {
            Ok(Some(value)) => Recorded::Value(value.cells().to_vec()),
            Ok(None) | Err(_) => Recorded::Foreign(text.to_owned()),
        },
    }
}

/// The reference's recorder writes some objects (matrices) as class name and identity.
fn is_opaque(text: &str) -> bool {
    text.contains('@')
}

/// For each port of the trace whether it carried more than one value.
pub(super) fn varying(trace: &Trace) -> Vec<bool> {
    let mut first: Vec<Option<&str>> = vec![None; trace.ports().count()];
    let mut varies = vec![false; first.len()];
    for row in trace.cycles().flat_map(|(_, cycle)| &cycle.rows) {
        let (at, text) = (row.port.0 as usize, trace.value(*row));
        varies[at] |= *first[at].get_or_insert(text) != text;
    }
    varies
}
