//! Text of the values in a report.

use rpi_image::Type;

use super::recorded::Recorded;

/// Returns the text of a value; `null` if it is absent.
pub(super) fn text(value: Option<&[u64]>, ty: Type) -> String {
    value.map_or_else(|| "null".to_owned(), |cells| rpi_literal::write(cells, ty))
}

impl Recorded {
    /// Returns the text of a recorded value.
    pub(super) fn text(&self, ty: Type) -> String {
        match self {
            Recorded::Unknown => "(not recorded)".to_owned(),
            Recorded::Absent => text(None, ty),
            Recorded::Opaque => "(a value that the recorder could not write)".to_owned(),
            Recorded::Foreign(text) => text.clone(),
            Recorded::Value(cells) => text(Some(cells), ty),
        }
    }
}
