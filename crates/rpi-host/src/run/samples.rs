//! Samples on their way from the cycle to whoever records them: words in a bounded ring.

use rpi_image::{Scalar, Type};
use rtrb::{Consumer, Producer, RingBuffer};

/// A flow that is sampled.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Channel {
    /// Its name: `device.port[index]`, `Command.key`, or a port's path.
    pub name: String,
    /// Its type.
    pub ty: Type,
    /// Where it comes from.
    pub source: Source,
}

/// Where a flow comes from.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Source {
    /// A port of a device.
    Device {
        /// The device.
        device: String,
        /// Its port.
        port: &'static str,
        /// Which of several equal ones, from 0.
        index: usize,
    },
    /// A command.
    Command,
    /// A claim of a command, or what it reads: no flow that the program publishes.
    Claim,
}

/// Somebody who takes samples: a recording, a picture.
pub trait Sink {
    /// Learns what there is, once, before the first sample.
    fn channels(&mut self, channels: &[Channel]);
    /// Takes the value of a channel (by index) in a tick, from 0; `None` for absent.
    fn sample(&mut self, channel: usize, tick: u64, value: Option<&[u64]>);
}

/// Nobody takes samples.
impl Sink for () {
    fn channels(&mut self, _: &[Channel]) {}

    fn sample(&mut self, _: usize, _: u64, _: Option<&[u64]>) {}
}

/// Several who take samples.
#[derive(Default)]
pub struct Several<'a>(pub Vec<&'a mut dyn Sink>);

impl Sink for Several<'_> {
    fn channels(&mut self, channels: &[Channel]) {
        self.0.iter_mut().for_each(|sink| sink.channels(channels));
    }

    fn sample(&mut self, channel: usize, tick: u64, value: Option<&[u64]>) {
        let sinks = self.0.iter_mut();
        sinks.for_each(|sink| sink.sample(channel, tick, value));
    }
}

/// Room for samples between two visits of the host, words.
const CAPACITY: usize = 1 << 20;
/// Channel with presence, and tick.
const HEADER: usize = 2;
const PRESENT: u64 = 1 << 32;

/// The two ends of a ring for samples of these types.
pub(super) fn ring(types: &[Type]) -> (Tap, Drain) {
    let (producer, consumer) = RingBuffer::new(CAPACITY);
    let widths: Box<[usize]> = types.iter().map(|ty| ty.cells() as usize).collect();
    let widest = widths.iter().copied().max().unwrap_or(0);
    let tap = Tap {
        ring: producer,
        lost: 0,
    };
    let drain = Drain {
        ring: consumer,
        widths,
        buffer: vec![0; widest.max(Scalar::Pose.cells() as usize)].into(),
    };
    (tap, drain)
}

/// The cycle's end: neither waits nor allocates; what does not fit is counted.
pub(super) struct Tap {
    ring: Producer<u64>,
    /// Samples for which there was no room.
    pub(super) lost: u64,
}

impl Tap {
    pub(super) fn put(&mut self, channel: usize, tick: u64, value: Option<&[u64]>) {
        let cells = value.unwrap_or(&[]);
        if self.ring.slots() < HEADER + cells.len() {
            self.lost += 1;
            return;
        }
        let present = if value.is_some() { PRESENT } else { 0 };
        let words = [channel as u64 | present, tick];
        for word in words.iter().chain(cells) {
            // There is room, as was just seen; nobody else writes.
            let _ = self.ring.push(*word);
        }
    }
}

/// The host's end.
pub(super) struct Drain {
    ring: Consumer<u64>,
    widths: Box<[usize]>,
    buffer: Box<[u64]>,
}

impl Drain {
    /// Hands all complete samples that have arrived on, in order.
    pub(super) fn each(&mut self, mut take: impl FnMut(usize, u64, Option<&[u64]>)) {
        while let Some((channel, present)) = self.next() {
            let _ = self.ring.pop();
            let tick = self.ring.pop().unwrap_or(0);
            let width = if present { self.widths[channel] } else { 0 };
            for cell in &mut self.buffer[..width] {
                *cell = self.ring.pop().unwrap_or(0);
            }
            take(channel, tick, present.then(|| &self.buffer[..width]));
        }
    }

    /// The next sample, if it is there as a whole.
    fn next(&self) -> Option<(usize, bool)> {
        let word = *self.ring.peek().ok()?;
        let (channel, present) = ((word & (PRESENT - 1)) as usize, word & PRESENT != 0);
        let width = if present { self.widths[channel] } else { 0 };
        (self.ring.slots() >= HEADER + width).then_some((channel, present))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_arrive_whole_and_in_order() {
        let (mut tap, mut drain) = ring(&[Scalar::Bool.into(), Scalar::Vector.into()]);
        tap.put(1, 0, Some(&[7, 8, 9]));
        tap.put(0, 0, None);
        tap.put(0, 1, Some(&[1]));
        let mut got = Vec::new();
        drain.each(|channel, tick, value| got.push((channel, tick, value.map(<[u64]>::to_vec))));
        assert_eq!(
            got,
            [
                (1, 0, Some(vec![7, 8, 9])),
                (0, 0, None),
                (0, 1, Some(vec![1]))
            ]
        );
    }

    #[test]
    fn what_does_not_fit_is_counted_and_nothing_is_torn() {
        let (mut tap, mut drain) = ring(&[Scalar::Vector.into()]);
        let most = CAPACITY / 5;
        (0..most as u64 + 3).for_each(|tick| tap.put(0, tick, Some(&[1, 2, 3])));
        assert_eq!(tap.lost, 3);
        let mut count = 0;
        drain.each(|_, _, value| {
            assert_eq!(value, Some(&[1, 2, 3][..]));
            count += 1;
        });
        assert_eq!(count, most);
    }
}
