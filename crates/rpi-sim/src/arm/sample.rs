//! Samples of the arm's sensors with a configurable latency.

use super::limits::AxisState;
use rpi_kin::MAX_AXES;

/// Measured states of all axes in one tick.
pub(super) type Sample = [AxisState; MAX_AXES];

/// Ring buffer of the latest samples of an arm, from which sensors read delayed samples.
#[derive(Clone, Debug)]
pub(super) struct History {
    ring: Vec<Sample>,
    newest: usize,
    /// Age of the sample that sensors read, in ticks.
    age: usize,
}

/// Maximum latency of a sample, in ticks; it bounds the memory.
const OLDEST: usize = 100_000;

impl History {
    /// Creates a history filled with copies of `sample`, for latencies of up to `oldest` ticks.
    pub(super) fn new(sample: Sample, oldest: usize) -> Self {
        Self {
            ring: vec![sample; oldest.min(OLDEST) + 1],
            newest: 0,
            age: 0,
        }
    }

    /// Adds a new sample. Sensors then read the sample that is `age` ticks older, or the oldest available one.
    pub(super) fn add(&mut self, sample: Sample, age: usize) {
        self.newest = (self.newest + 1) % self.ring.len();
        self.ring[self.newest] = sample;
        self.age = age.min(self.ring.len() - 1);
    }

    /// Returns the sample that sensors read now.
    pub(super) fn read(&self) -> &Sample {
        &self.ring[(self.newest + self.ring.len() - self.age) % self.ring.len()]
    }

    /// Extends the buffer for latencies of up to `oldest` ticks. The new entries are copies of the oldest sample.
    pub(super) fn reserve(&mut self, oldest: usize) {
        let wanted = oldest.min(OLDEST) + 1;
        if wanted > self.ring.len() {
            self.ring.rotate_left(self.newest + 1);
            let missing = wanted - self.ring.len();
            let first = self.ring[0];
            self.ring.splice(0..0, core::iter::repeat_n(first, missing));
            self.newest = self.ring.len() - 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(position: f64) -> Sample {
        [AxisState::at_rest(position); MAX_AXES]
    }

    #[test]
    fn samples_are_read_at_their_age() {
        let mut history = History::new(at(0.0), 2);
        for tick in 1..=10 {
            history.add(at(f64::from(tick)), 2);
            assert_eq!(history.read()[0].position, f64::from(tick - 2).max(0.0));
        }
        history.add(at(11.0), 0);
        assert_eq!(history.read()[0].position, 11.0);
        history.add(at(12.0), 99);
        assert_eq!(
            history.read()[0].position,
            10.0,
            "no older than there is room for"
        );
    }

    #[test]
    fn room_can_be_added_while_running() {
        let mut history = History::new(at(0.0), 1);
        (1..=5).for_each(|tick| history.add(at(f64::from(tick)), 1));
        history.reserve(4);
        history.add(at(6.0), 2);
        assert_eq!(history.read()[0].position, 4.0);
        history.add(at(7.0), 4);
        assert_eq!(
            history.read()[0].position,
            4.0,
            "the oldest stands in for what was not kept"
        );
    }
}
