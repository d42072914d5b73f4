//! Tick log between the cycle and the writer thread: a bounded ring on which neither side blocks.

use rtrb::{Consumer, Producer, RingBuffer};

use super::entry_buffer::EntryBuffer;

/// Capacity of the tick log in 64-bit words: about 15 s of the exchange with one arm at 1 kHz.
const CAPACITY: usize = 1 << 20;
// Words before the entries of a tick: lost ticks, number, wall clock, kind, and the lengths of both lists.
const HEADER: usize = 6;

/// Creates a tick log and returns its two ends: the first for the cycle, the second for the thread that writes the
/// recording.
#[must_use]
pub fn tick_log() -> (TickLogWriter, TickLogReader) {
    with_capacity(CAPACITY)
}

fn with_capacity(words: usize) -> (TickLogWriter, TickLogReader) {
    let (producer, consumer) = RingBuffer::new(words);
    let writer = TickLogWriter {
        ring: producer,
        capacity: words,
        lost_since_last: 0,
        lost: 0,
    };
    (writer, TickLogReader { ring: consumer })
}

/// End of the tick log to which the cycle writes ticks.
pub struct TickLogWriter {
    ring: Producer<u64>,
    capacity: usize,
    /// Number of ticks that had no room in the log since the last recorded one.
    lost_since_last: u64,
    lost: u64,
}

impl TickLogWriter {
    /// Writes a complete tick, or counts it as lost if it does not fit. `exchange` has the entries about the devices,
    /// `observations` those about sampled values. `ticked` is false for entries after the last tick.
    pub fn put(
        &mut self,
        (number, wall_ns): (u64, i64),
        ticked: bool,
        exchange: &EntryBuffer,
        observations: &EntryBuffer,
    ) {
        let rows = exchange.words().zip(observations.words());
        let fitting = rows.filter(|(a, b)| self.ring.slots() >= HEADER + a.len() + b.len());
        let Some((exchange, observations)) = fitting else {
            self.lost_since_last += 1;
            self.lost += 1;
            return;
        };
        let (n, m) = (exchange.len() as u64, observations.len() as u64);
        let kind = u64::from(!ticked);
        let header = [
            self.lost_since_last,
            number,
            wall_ns.cast_unsigned(),
            kind,
            n,
            m,
        ];
        for word in header.iter().chain(exchange).chain(observations) {
            // The free slots were checked above, and this is the only producer.
            let _ = self.ring.push(*word);
        }
        self.lost_since_last = 0;
    }

    /// Returns the total number of ticks that had no room in the log.
    #[must_use]
    pub fn lost(&self) -> u64 {
        self.lost
    }

    /// Returns true while more than half of the tick log is free.
    #[must_use]
    pub fn has_room(&self) -> bool {
        self.ring.slots() > self.capacity / 2
    }
}

/// End of the tick log from which the writer thread of the recording reads ticks.
pub struct TickLogReader {
    ring: Consumer<u64>,
}

impl TickLogReader {
    /// Reads the next tick from the log into `words`. Returns false if no complete tick is available.
    pub fn next(&mut self, words: &mut Vec<u64>) -> bool {
        words.clear();
        let Ok(header) = self.ring.read_chunk(HEADER) else {
            return false;
        };
        let (first, second) = header.as_slices();
        let lens = first.iter().chain(second).skip(HEADER - 2);
        let len = HEADER + lens.map(|len| *len as usize).sum::<usize>();
        let Ok(tick) = self.ring.read_chunk(len) else {
            return false;
        };
        words.extend(tick);
        true
    }
}

/// A tick that was read from the tick log, split into its parts.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct LoggedTick<'a> {
    /// Number of ticks that had no room in the log immediately before this one.
    pub lost: u64,
    /// Number of the tick, counted from the start of the run.
    pub number: u64,
    /// Wall clock for the commands in the tick, in nanoseconds since the Unix epoch.
    pub wall_ns: i64,
    /// Whether a tick was executed; false for entries after the last tick, such as an abort of all commands.
    pub ticked: bool,
    /// Words of the entries about the exchange between the core and the devices.
    pub exchange: &'a [u64],
    /// Words of the entries about sampled values: flows of commands and device ports.
    pub observations: &'a [u64],
}

impl LoggedTick<'_> {
    /// Decodes a tick from the words that [`TickLogReader::next`] has read; `None` if the words are invalid.
    pub fn from_words(words: &[u64]) -> Option<LoggedTick<'_>> {
        let (header, rest) = words.split_first_chunk::<HEADER>()?;
        let [lost, number, wall, kind, n, m] = *header;
        let (exchange, observations) = rest.split_at_checked(usize::try_from(n).ok()?)?;
        (observations.len() as u64 == m).then_some(LoggedTick {
            lost,
            number,
            wall_ns: wall.cast_signed(),
            ticked: kind == 0,
            exchange,
            observations,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::entry::EntryKind;
    use super::*;

    #[test]
    fn ticks_arrive_whole_and_losses_are_told_with_the_next() {
        let (mut log, mut out) = with_capacity(20);
        let (mut exchange, mut observations) =
            (EntryBuffer::with_capacity(8), EntryBuffer::with_capacity(8));
        exchange.push(EntryKind::Write, 1, false, &[&[5]]);
        observations.push(EntryKind::Flow, 2, true, &[&[9], &[6]]);
        (0..3).for_each(|tick| log.put((tick, 7), true, &exchange, &observations));
        assert_eq!(log.lost(), 2);
        let mut words = Vec::new();
        assert!(out.next(&mut words));
        let tick = LoggedTick::from_words(&words).unwrap();
        assert_eq!((tick.lost, tick.number, tick.wall_ns), (0, 0, 7));
        assert_eq!((tick.exchange.len(), tick.observations.len()), (2, 3));
        assert!(!out.next(&mut words));
        log.put((3, 8), true, &exchange, &observations);
        assert!(out.next(&mut words));
        assert_eq!(LoggedTick::from_words(&words).unwrap().lost, 2);
    }
}
