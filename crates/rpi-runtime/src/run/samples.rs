//! Samples on their way from the cycle to the sinks, as words in a bounded ring.

use rpi_image::{Scalar, Type};
use rtrb::{Consumer, Producer, RingBuffer};

/// Flow or device port whose value is sampled in each cycle.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Channel {
    /// Name of the channel: `device.port[index]`, `Command.key`, or the path of a port in a net.
    pub name: String,
    /// Type of the sampled values.
    pub ty: Type,
    /// Kind of source from which the values come: a device port or a command.
    pub source: Source,
}

/// Source of the values of a channel.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Source {
    /// The values are those of a port of a device.
    Device {
        /// Name of the device in the cell description, such as `arm`.
        device: String,
        /// Name of the device's port, such as `position`.
        port: &'static str,
        /// Index of the port among the device's ports of the same name (such as joints), from 0.
        index: usize,
    },
    /// The values are those of a flow of a command.
    Command,
    /// The values are those of a claim (assertion, check or contract) of a command, or of a flow that a claim reads.
    /// The program does not export this flow.
    Claim,
}

/// Receiver of the samples of a run, such as a recording or a plot.
pub trait Sink {
    /// Receives the list of channels, which later samples refer to by index. Called once, before the first sample.
    fn channels(&mut self, channels: &[Channel]);
    /// Receives the value of a channel (by index, from 0) in a tick (by number, from 0), as memory words; `None` if the
    /// flow is absent.
    fn sample(&mut self, channel: usize, tick: u64, value: Option<&[u64]>);
}

/// Sink that discards all samples.
impl Sink for () {
    fn channels(&mut self, _: &[Channel]) {}

    fn sample(&mut self, _: usize, _: u64, _: Option<&[u64]>) {}
}

/// Sink that forwards samples to several sinks.
#[derive(Default)]
pub struct SinkList<'a>(pub Vec<&'a mut dyn Sink>);

impl Sink for SinkList<'_> {
    fn channels(&mut self, channels: &[Channel]) {
        self.0.iter_mut().for_each(|sink| sink.channels(channels));
    }

    fn sample(&mut self, channel: usize, tick: u64, value: Option<&[u64]>) {
        let sinks = self.0.iter_mut();
        sinks.for_each(|sink| sink.sample(channel, tick, value));
    }
}

/// Capacity of the ring buffer of samples in 64-bit words. It must hold the samples between two visits of the host.
const CAPACITY: usize = 1 << 20;
/// Number of 64-bit words before the value of a sample: channel index with presence; tick number.
const HEADER: usize = 2;
/// Bit of the first header word of a sample that is set if a value follows; otherwise the flow was absent.
const PRESENT: u64 = 1 << 32;

/// Creates the ring buffer through which samples leave the cycle. `types` are the types of the channels. Returns the
/// end of the cycle and that of the host.
pub(super) fn ring(types: &[Type]) -> (SampleSender, SampleReceiver) {
    let (producer, consumer) = RingBuffer::new(CAPACITY);
    let widths: Box<[usize]> = types.iter().map(|ty| ty.slots() as usize).collect();
    let widest = widths.iter().copied().max().unwrap_or(0);
    let tap = SampleSender {
        ring: producer,
        lost: 0,
    };
    let drain = SampleReceiver {
        ring: consumer,
        widths,
        buffer: vec![0; widest.max(Scalar::Pose.slots() as usize)].into(),
    };
    (tap, drain)
}

/// End of the ring buffer at which the cycle writes samples. It neither blocks nor allocates; samples that do not fit
/// are counted.
pub(super) struct SampleSender {
    ring: Producer<u64>,
    /// Number of samples dropped because the ring buffer was full.
    pub(super) lost: u64,
}

impl SampleSender {
    pub(super) fn put(&mut self, channel: usize, tick: u64, value: Option<&[u64]>) {
        let cells = value.unwrap_or(&[]);
        if self.ring.slots() < HEADER + cells.len() {
            self.lost += 1;
            return;
        }
        let present = if value.is_some() { PRESENT } else { 0 };
        let words = [channel as u64 | present, tick];
        for word in words.iter().chain(cells) {
            // The free slots were checked above, and this is the only producer.
            let _ = self.ring.push(*word);
        }
    }
}

/// End of the ring buffer at which the host reads samples.
pub(super) struct SampleReceiver {
    ring: Consumer<u64>,
    widths: Box<[usize]>,
    buffer: Box<[u64]>,
}

impl SampleReceiver {
    /// Passes all complete samples in the ring buffer to `take`, in order: channel index, tick number, and memory words
    /// (`None` if the flow was absent).
    pub(super) fn drain(&mut self, mut take: impl FnMut(usize, u64, Option<&[u64]>)) {
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

    /// Returns the channel index of the next sample and whether a value follows; `None` if the sample is incomplete.
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
        drain.drain(|channel, tick, value| got.push((channel, tick, value.map(<[u64]>::to_vec))));
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
        drain.drain(|_, _, value| {
            assert_eq!(value, Some(&[1, 2, 3][..]));
            count += 1;
        });
        assert_eq!(count, most);
    }
}
