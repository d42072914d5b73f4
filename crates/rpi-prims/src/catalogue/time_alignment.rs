//! Alignment of values by their time stamps.

use super::times::seconds_between;
use crate::aggregates::StateRange;
use crate::context::Context;
use crate::macros::primitive;
use crate::registry::Prim;
use crate::ring_buffer::RingBuffer;
use crate::value_types::Time;
use rpi_image::SizeArgs;

pub(super) const ALL: &[Prim] = &[HISTORY, CONSISTENT_RANGE];

primitive! {
    /// Time since the cycle in which the time stamp `inValue` was last not later than `inTime`, in s and a multiple of
    /// the period. 0 if that is the current cycle. If there is no such cycle in the history of `MaxAge` seconds, the
    /// length of the history so far.
    HISTORY = "Core::TimeHistory";
    in { inValue: Time; inTime: Time }
    param { MaxAge: f64 = Real(1.0) }
    out { outAge: f64 }
    ring { stamps }
    presence strict work 100;
    c Code(r"
size_t back = 0U;
uint64_t *next = rpi_ring_push(ring, ring_len, 1U, true);
*next = (uint64_t)inValue;
while (back < rpi_index(ring[1])) {
  const uint64_t *stamp = rpi_ring_entry(ring, ring_len, 1U, back);
  if (stamp != NULL && rpi_integer(*stamp) <= inTime) {
    break;
  }
  back += 1U;
}
*outAge = (double)back * rpi_dt;
");
    full |cx, _, history, _, (value, time)| {
        let ring = RingBuffer::<Time>::from_region(*history);
        ring.push(cx.slots, Some(value));
        let seen = ring.len(cx.slots);
        let back = (0..seen).find(|&k| ring.nth_back(cx.slots, k).is_some_and(|t| t <= time));
        (back.unwrap_or(seen) as f64 * cx.time.dt,)
    }
}

primitive! {
    /// Newest range of time that covers a range of the first input and a range of the second input and is shorter than
    /// `MaxSize` seconds. At least one of both is of this cycle; the other may be up to `MaxAge` seconds old. Without
    /// such a pair, the result is the newest earlier one of the last `MaxAge` seconds; absent if there is none.
    CONSISTENT_RANGE = "Core::TimeConsistentRange";
    in { inFirstStart: Time; inFirstEnd: Time; inSecondStart: Time; inSecondEnd: Time }
    param { MaxSize: f64 = Real(1.0); MaxAge: f64 = Real(1.0) }
    out { outStart: Time; outEnd: Time }
    ring { ranges }
    presence maybe work 400;
    c Code(r"
const int64_t first[2] = {inFirstStart, inFirstEnd};
const int64_t second[2] = {inSecondStart, inSecondEnd};
int64_t found[2] = {0, 0};
const bool is_found = rpi_consistent_range(ring, ring_len, first, inFirstStart_present && inFirstEnd_present, second,
                                           inSecondStart_present && inSecondEnd_present, MaxSize, found);
if (is_found) {
  *outStart = found[0];
  *outEnd = found[1];
}
*outStart_present = is_found;
*outEnd_present = is_found;
");
    full |cx, _, history, (max_size, _), (first_start, first_end, second_start, second_end)| {
        let first = TimeRange::from_options(first_start, first_end);
        let second = TimeRange::from_options(second_start, second_end);
        let found = histories(*history).hull(cx, first, second, max_size);
        (found.map(|r| r.start), found.map(|r| r.end))
    }
}

fn stamps(args: &SizeArgs<'_>) -> u32 {
    RingBuffer::<Time>::cells(args.cycles_of_param(0))
}

fn ranges(args: &SizeArgs<'_>) -> u32 {
    RingBuffer::<Time>::cells(args.cycles_of_param(1).saturating_add(1)).saturating_mul(6)
}

/// Range of time from `start` to `end`.
#[derive(Clone, Copy)]
struct TimeRange {
    start: Time,
    end: Time,
}

impl TimeRange {
    fn from_options(start: Option<Time>, end: Option<Time>) -> Option<TimeRange> {
        start.zip(end).map(|(start, end)| TimeRange { start, end })
    }

    fn hull(self, other: TimeRange) -> TimeRange {
        TimeRange {
            start: self.start.min(other.start),
            end: self.end.max(other.end),
        }
    }

    fn shorter_than(&self, seconds: f64) -> bool {
        seconds_between(self.start, self.end) < seconds
    }
}

/// History of the time ranges of one input, or of the results.
#[derive(Clone, Copy)]
struct RangeHistory {
    starts: RingBuffer<Time>,
    ends: RingBuffer<Time>,
}

impl RangeHistory {
    fn push(self, cells: &mut [u64], range: Option<TimeRange>) {
        self.starts.push(cells, range.map(|r| r.start));
        self.ends.push(cells, range.map(|r| r.end));
    }

    fn nth_back(self, cells: &[u64], k: usize) -> Option<TimeRange> {
        TimeRange::from_options(self.starts.nth_back(cells, k), self.ends.nth_back(cells, k))
    }
}

/// Histories of the time ranges of both inputs, and of the results.
struct Histories {
    first: RangeHistory,
    second: RangeHistory,
    results: RangeHistory,
}

fn histories(region: StateRange) -> Histories {
    let len = region.len / 6;
    let ring = |k| {
        RingBuffer::from_region(StateRange {
            start: region.start + k * len,
            len,
        })
    };
    let ranges = |k| RangeHistory {
        starts: ring(k),
        ends: ring(k + 1),
    };
    Histories {
        first: ranges(0),
        second: ranges(2),
        results: ranges(4),
    }
}

impl Histories {
    fn hull(
        &self,
        cx: &mut Context<'_>,
        first: Option<TimeRange>,
        second: Option<TimeRange>,
        max_size: f64,
    ) -> Option<TimeRange> {
        self.first.push(cx.slots, first);
        self.second.push(cx.slots, second);
        let found = self.newest(cx.slots, first, second, max_size);
        self.results.push(cx.slots, found);
        let kept =
            (0..self.results.starts.capacity()).find_map(|k| self.results.nth_back(cx.slots, k));
        found.or(kept)
    }

    /// Returns the range that covers the newest pair of a range of the first and a range of the second input, if it is
    /// shorter than `max_size` seconds; one range of the pair is of this cycle. `None` if there is no such pair.
    fn newest(
        &self,
        cells: &[u64],
        first: Option<TimeRange>,
        second: Option<TimeRange>,
        max_size: f64,
    ) -> Option<TimeRange> {
        let short = |a: Option<TimeRange>, b: Option<TimeRange>| {
            a.zip(b)
                .map(|(a, b)| a.hull(b))
                .filter(|r| r.shorter_than(max_size))
        };
        (0..self.first.starts.capacity()).find_map(|k| {
            let with_older_second = short(first, self.second.nth_back(cells, k));
            with_older_second.or_else(|| short(self.first.nth_back(cells, k), second))
        })
    }
}
