//! The key `watchdog`: a number of periods.

use super::reader::TableReader;

/// Reads a number of periods, from 1 to 1000; `None` if the key is missing or invalid.
pub(super) fn read_periods(reader: &mut TableReader<'_>, key: &'static str) -> Option<u32> {
    let periods = reader.integer(key, 1..=1000, " periods")?;
    u32::try_from(periods).ok()
}
