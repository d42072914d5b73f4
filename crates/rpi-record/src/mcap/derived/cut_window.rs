//! The ticks that a cut keeps, with their times.

use std::ops::Range;

use rpi_runtime::tick_log::LoggedTick;

use crate::mcap::error::RecordingError;
use crate::mcap::reader::Recording;

/// Ticks of a recording that are kept.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) struct CutWindow {
    /// Number of the first kept tick, and number of the tick after the last one.
    pub(super) ticks: Range<u64>,
    /// Times of the first kept tick and of the first one after them, in nanoseconds since the Unix epoch.
    pub(super) times: Range<u64>,
    /// Whether ticks are left out before and after the kept ones.
    pub(super) is_late: bool,
    pub(super) is_early: bool,
    /// Number of kept ticks in which the core ran.
    pub(super) count: u64,
    /// Number of ticks among them that are missing in the recording.
    pub(super) lost: u64,
}

/// Place of a tick or message in relation to the kept ticks.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Place {
    Before,
    Within,
    After,
}

impl CutWindow {
    /// Finds the ticks of a recording whose numbers are in the range `wanted`.
    ///
    /// # Errors
    /// Returns an error if there are none, or if the recording cannot be read.
    pub(super) fn find(
        recording: &Recording,
        wanted: &Range<u64>,
    ) -> Result<CutWindow, RecordingError> {
        let mut window: Option<CutWindow> = None;
        let (mut is_late, mut is_early, mut all_lost) =
            (recording.excerpt.from.is_some(), false, 0);
        recording.for_each_tick(|words| {
            let tick = logged(words)?;
            if tick.number >= wanted.end {
                is_early = true;
                if let Some(window) = &mut window {
                    window.times.end = time(&tick);
                }
                return Ok(false);
            }
            all_lost += tick.lost;
            if tick.number < wanted.start {
                is_late = true;
                return Ok(true);
            }
            // Ticks that were lost before the first one are not part of a cut that begins with it.
            let is_first = window.is_none() && is_late;
            let window = window.get_or_insert_with(|| CutWindow::at(&tick, is_late));
            window.ticks.end = tick.number.saturating_add(1);
            window.count += u64::from(tick.ticked);
            window.lost += if is_first { 0 } else { tick.lost };
            Ok(true)
        })?;
        let mut window =
            window.ok_or_else(|| RecordingError::Missing("cycles in this time".to_owned()))?;
        window.is_early = is_early || recording.excerpt.to.is_some();
        if !is_early {
            // The number at the end of a recording includes ticks that were lost after the last one.
            window.lost += recording.lost.saturating_sub(all_lost);
        }
        Ok(window)
    }

    /// Returns a window that begins at a tick.
    fn at(tick: &LoggedTick<'_>, is_late: bool) -> CutWindow {
        CutWindow {
            ticks: tick.number..tick.number,
            times: time(tick)..u64::MAX,
            is_late,
            is_early: false,
            count: 0,
            lost: 0,
        }
    }

    /// Returns the place of the tick with this number.
    pub(super) fn place_of_tick(&self, tick: u64) -> Place {
        place(&self.ticks, tick)
    }

    /// Returns the place of a time in nanoseconds since the Unix epoch.
    pub(super) fn place_of_time(&self, time: u64) -> Place {
        place(&self.times, time)
    }
}

fn place(range: &Range<u64>, at: u64) -> Place {
    match at {
        at if at < range.start => Place::Before,
        at if at < range.end => Place::Within,
        _ => Place::After,
    }
}

/// Decodes a tick of the tick log.
pub(super) fn logged(words: &[u64]) -> Result<LoggedTick<'_>, RecordingError> {
    let tick = LoggedTick::from_words(words);
    tick.ok_or_else(|| RecordingError::Damaged("invalid tick in the tick log".to_owned()))
}

fn time(tick: &LoggedTick<'_>) -> u64 {
    tick.wall_ns.max(0).cast_unsigned()
}
