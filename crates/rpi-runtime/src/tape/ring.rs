//! Tape between the cycle and the writer thread: a bounded ring on which neither side blocks.

use rtrb::{Consumer, Producer, RingBuffer};

use super::stage::Stage;

/// Capacity in words: about 15 s of an arm at 1 kHz.
const CAPACITY: usize = 1 << 20;
const HEADER: usize = 6;

/// Creates a tape and returns its two ends: the first for the cycle, the second for the writer.
#[must_use]
pub fn tape() -> (TapeIn, TapeOut) {
    with_capacity(CAPACITY)
}

fn with_capacity(words: usize) -> (TapeIn, TapeOut) {
    let (producer, consumer) = RingBuffer::new(words);
    let tape_in = TapeIn {
        ring: producer,
        capacity: words,
        untold: 0,
        lost: 0,
    };
    (tape_in, TapeOut { ring: consumer })
}

/// Cycle side of a tape.
pub struct TapeIn {
    ring: Producer<u64>,
    capacity: usize,
    /// Number of ticks lost since the last recorded one.
    untold: u64,
    lost: u64,
}

impl TapeIn {
    /// Writes a complete tick, or counts it as lost. `ticked` is false for entries between two ticks without a tick
    /// after them.
    pub fn put(
        &mut self,
        (number, wall_ns): (u64, i64),
        ticked: bool,
        exchange: &Stage,
        sights: &Stage,
    ) {
        let rows = exchange.words().zip(sights.words());
        let fits = rows.filter(|(a, b)| self.ring.slots() >= HEADER + a.len() + b.len());
        let Some((exchange, sights)) = fits else {
            self.untold += 1;
            self.lost += 1;
            return;
        };
        let (n, m) = (exchange.len() as u64, sights.len() as u64);
        let kind = u64::from(!ticked);
        let header = [self.untold, number, wall_ns.cast_unsigned(), kind, n, m];
        for word in header.iter().chain(exchange).chain(sights) {
            // The free slots were checked above, and this is the only producer.
            let _ = self.ring.push(*word);
        }
        self.untold = 0;
    }

    /// Returns the total number of lost ticks.
    #[must_use]
    pub fn lost(&self) -> u64 {
        self.lost
    }

    /// Returns true while more than half of the ring is free.
    #[must_use]
    pub fn has_room(&self) -> bool {
        self.ring.slots() > self.capacity / 2
    }
}

/// Writer side of a tape.
pub struct TapeOut {
    ring: Consumer<u64>,
}

impl TapeOut {
    /// Reads the words of the next tick. Returns false if no complete tick is available.
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

/// A decoded tick of a tape.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Tick<'a> {
    /// Number of ticks lost before this one.
    pub lost: u64,
    /// Number of the tick.
    pub number: u64,
    /// Wall clock of the commands, nanoseconds since the Unix epoch.
    pub wall_ns: i64,
    /// False for entries between two ticks without a tick after them.
    pub ticked: bool,
    /// Entries of the exchange between core and devices.
    pub exchange: &'a [u64],
    /// Entries of the observations: flows of commands and device ports.
    pub sights: &'a [u64],
}

impl Tick<'_> {
    /// Decodes a tick; `None` if the words are invalid.
    pub fn of(words: &[u64]) -> Option<Tick<'_>> {
        let (header, rest) = words.split_first_chunk::<HEADER>()?;
        let [lost, number, wall, kind, n, m] = *header;
        let (exchange, sights) = rest.split_at_checked(usize::try_from(n).ok()?)?;
        (sights.len() as u64 == m).then_some(Tick {
            lost,
            number,
            wall_ns: wall.cast_signed(),
            ticked: kind == 0,
            exchange,
            sights,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::entry::Kind;
    use super::*;

    #[test]
    fn ticks_arrive_whole_and_losses_are_told_with_the_next() {
        let (mut tape, mut out) = with_capacity(20);
        let (mut exchange, mut sights) = (Stage::with_capacity(8), Stage::with_capacity(8));
        exchange.put(Kind::Write, 1, false, &[&[5]]);
        sights.put(Kind::Flow, 2, true, &[&[9], &[6]]);
        (0..3).for_each(|tick| tape.put((tick, 7), true, &exchange, &sights));
        assert_eq!(tape.lost(), 2);
        let mut words = Vec::new();
        assert!(out.next(&mut words));
        let tick = Tick::of(&words).unwrap();
        assert_eq!((tick.lost, tick.number, tick.wall_ns), (0, 0, 7));
        assert_eq!((tick.exchange.len(), tick.sights.len()), (2, 3));
        assert!(!out.next(&mut words));
        tape.put((3, 8), true, &exchange, &sights);
        assert!(out.next(&mut words));
        assert_eq!(Tick::of(&words).unwrap().lost, 2);
    }
}
