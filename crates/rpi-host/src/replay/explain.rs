//! Whether an entry of the table of differences explains that a value differs.

use rpi_image::PrimDesc;
use rpi_net::PortRef;

use super::engine::Replay;
use super::recorded::Recorded;

/// An entry of the table.
pub(super) struct Difference {
    pub(super) name: &'static str,
    pub(super) why: &'static str,
}

/// A differing value.
pub(super) struct Case<'r, 'a> {
    pub(super) replay: &'r Replay<'a>,
    pub(super) port: PortRef,
    pub(super) computed: Option<&'r [u64]>,
    pub(super) recorded: &'r Recorded,
}

/// True if an entry speaks of such a port.
pub(super) fn concerns(_desc: &PrimDesc, _port: usize) -> bool {
    false
}

/// The entry that explains a differing value.
pub(super) fn explain(_case: &Case<'_, '_>) -> Option<&'static Difference> {
    None
}
