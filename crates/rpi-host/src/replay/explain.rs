//! Whether an entry of the table of differences explains that a value differs.

use super::engine::Replay;
use super::recorded::Recorded;
use rpi_image::PrimDesc;
use rpi_net::PortRef;

/// An entry of the table: a fault of the reference that is not imitated.
pub(super) struct Difference {
    pub(super) name: &'static str,
    pub(super) why: &'static str,
    primitive: &'static str,
    port: &'static str,
    holds: fn(&Case<'_, '_>) -> bool,
}

/// A differing value.
pub(super) struct Case<'r, 'a> {
    pub(super) replay: &'r Replay<'a>,
    pub(super) port: PortRef,
    pub(super) computed: Option<&'r [u64]>,
    pub(super) recorded: &'r Recorded,
}

const DIFFERENCES: &[Difference] = &[
    Difference {
        name: "sine-is-cosine",
        why: "the reference's sine computes the cosine",
        primitive: "Core::DoubleSin",
        port: "outValue",
        holds: on_the_unit_circle,
    },
    Difference {
        name: "cosine-is-sine",
        why: "the reference's cosine computes the sine",
        primitive: "Core::DoubleCos",
        port: "outValue",
        holds: on_the_unit_circle,
    },
];

/// True if an entry speaks of such a port.
pub(super) fn concerns(desc: &PrimDesc, port: usize) -> bool {
    DIFFERENCES.iter().any(|d| d.speaks_of(desc, port))
}

/// The entry that explains a differing value.
pub(super) fn explain(case: &Case<'_, '_>) -> Option<&'static Difference> {
    let desc = case.replay.net.node(case.port.node).desc();
    let port = usize::from(case.port.port);
    let mut entries = DIFFERENCES.iter();
    entries.find(|d| d.speaks_of(desc, port) && (d.holds)(case))
}

impl Difference {
    fn speaks_of(&self, desc: &PrimDesc, port: usize) -> bool {
        self.primitive == desc.name && desc.outputs[port].name == self.port
    }
}

/// Sine and cosine of one angle: their squares add up to 1.
fn on_the_unit_circle(case: &Case<'_, '_>) -> bool {
    let (Some(computed), Recorded::Value(recorded)) = (case.computed, case.recorded) else {
        return false;
    };
    let square = |cells: &[u64]| f64::from_bits(cells[0]) * f64::from_bits(cells[0]);
    (square(computed) + square(recorded) - 1.0).abs() < 1e-12
}
