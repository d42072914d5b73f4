//! Subscriptions to exported flows. Samples are sent to the host through a bounded ring when a value changes.

use rpi_core::{Command, CommandId};
use rpi_image::image::Signal;
use rtrb::{Consumer, Producer};

/// Subscription of the host to exported flows of one command: changed values are sent to the host. A new subscription
/// of the command replaces the old one.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Subscription {
    pub(super) command: CommandId,
    pub(super) every: u64,
    flows: Box<[SubscribedFlow]>,
    /// Number of samples that were not sent because the ring buffer to the host was full.
    pub(super) lost: u64,
}

#[derive(Clone, PartialEq, Eq, Debug)]
struct SubscribedFlow {
    export: u32,
    signal: Signal,
    /// State of the flow in the last sample that was sent: `None` if none was sent, `Some(false)` if the flow was
    /// absent, `Some(true)` if it had the value in `cells`.
    sent: Option<bool>,
    cells: Box<[u64]>,
}

/// Number of 64-bit words before the value of a sample: command number; export index with width and presence; tick
/// number.
const HEADER: usize = 3;
/// Bit of the second header word of a sample that is set if a value follows; otherwise the flow was absent.
const PRESENT: u64 = 1 << 63;

impl Subscription {
    /// Creates a subscription to exports of a command, given by index and signal (place and type in memory). The flows
    /// are sampled in every `every`th cycle.
    #[must_use]
    pub fn new(command: CommandId, flows: &[(u32, Signal)], every: u64) -> Subscription {
        let flow = |&(export, signal): &(u32, Signal)| SubscribedFlow {
            export,
            signal,
            sent: None,
            cells: vec![0; signal.ty.slots() as usize].into(),
        };
        Subscription {
            command,
            every: every.max(1),
            flows: flows.iter().map(flow).collect(),
            lost: 0,
        }
    }

    /// Returns the indices of the subscribed exports in the image.
    pub(super) fn exports(&self) -> impl Iterator<Item = u32> + '_ {
        self.flows.iter().map(|flow| flow.export)
    }

    /// Sends the subscribed flows that have changed since they were last sent, if the sampling period has elapsed.
    pub(super) fn send_changes(&mut self, command: &Command, tick: u64, ring: &mut Producer<u64>) {
        if !command.instance().cycle().is_multiple_of(self.every) && command.ending().is_none() {
            return;
        }
        let id = self.command;
        for flow in &mut self.flows {
            let value = command.instance().value(flow.signal);
            let same =
                flow.sent == Some(value.is_some()) && value.is_none_or(|v| *v == *flow.cells);
            if same {
                continue;
            }
            // Before `sent` is updated: a value without space counts as not sent, so the next cycle tries again.
            if ring.slots() < HEADER + flow.cells.len() {
                self.lost += 1;
                continue;
            }
            flow.sent = Some(value.is_some());
            value
                .into_iter()
                .for_each(|v| flow.cells.copy_from_slice(v));
            flow.send(id, tick, ring);
        }
    }
}

impl SubscribedFlow {
    fn send(&self, id: CommandId, tick: u64, ring: &mut Producer<u64>) {
        let present = if self.sent == Some(true) { PRESENT } else { 0 };
        let cells = if present == 0 { &[][..] } else { &self.cells };
        let width = (cells.len() as u64) << 32;
        let header = [
            id.to_number(),
            present | width | u64::from(self.export),
            tick,
        ];
        for word in header.iter().chain(cells) {
            // The free slots were checked by the caller, and this is the only producer.
            let _ = ring.push(*word);
        }
    }
}

/// Passes all complete samples in the ring buffer to `take`: command number, export index, tick number, and memory
/// words of the value (`None` if the flow was absent).
pub(super) fn drain_samples(
    ring: &mut Consumer<u64>,
    buffer: &mut Vec<u64>,
    mut take: impl FnMut(u64, u32, u64, Option<&[u64]>),
) {
    while let Ok(header) = ring.read_chunk(HEADER) {
        let (first, second) = header.as_slices();
        let word = first.iter().chain(second).nth(1).copied().unwrap_or(0);
        let width = (word >> 32 & 0x7fff_ffff) as usize;
        // The producer pushes word by word, so the value may still be incomplete.
        if ring.slots() < HEADER + width {
            return;
        }
        let mut next = || ring.pop().unwrap_or(0);
        let (id, _, tick) = (next(), next(), next());
        buffer.clear();
        buffer.extend((0..width).map(|_| next()));
        let present = word & PRESENT != 0;
        take(id, word as u32, tick, present.then_some(&buffer[..]));
    }
}
