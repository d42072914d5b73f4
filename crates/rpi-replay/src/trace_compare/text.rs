//! Text of the values in a report.

use rpi_image::Type;

use super::trace_view::RecordedValue;

/// Returns a value of type `ty` as a literal; `null` if it is absent.
pub(super) fn value_text(value: Option<&[u64]>, ty: Type) -> String {
    value.map_or_else(|| "null".to_owned(), |cells| rpi_literal::write(cells, ty))
}

impl RecordedValue {
    /// Returns a recorded value of type `ty` as text, also if it is missing or cannot be read.
    pub(super) fn text(&self, ty: Type) -> String {
        match self {
            RecordedValue::Unknown => "(not recorded)".to_owned(),
            RecordedValue::Absent => value_text(None, ty),
            RecordedValue::Unprintable => "(a value that the recorder could not write)".to_owned(),
            RecordedValue::WrongType(text) => text.clone(),
            RecordedValue::Value(cells) => value_text(Some(cells), ty),
        }
    }
}
