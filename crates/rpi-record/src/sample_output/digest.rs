//! Digest of the device values of a run. Runs with equal digests had the same bits in every tick.

use rpi_image::hash::Fnv1a;

use rpi_runtime::run::{Channel, Sink, Source};

/// Sink that computes a hash of every sample of the devices in a run: channel, tick, presence, value. Flows of commands
/// are left out because they may depend on the time of day.
#[derive(Default)]
pub struct DigestSink {
    devices: Vec<bool>,
    hash: Fnv1a,
}

impl DigestSink {
    /// Returns the digest as 16 hexadecimal digits.
    #[must_use]
    pub fn to_hex(&self) -> String {
        format!("{:016x}", self.hash.finish())
    }
}

impl Sink for DigestSink {
    fn channels(&mut self, channels: &[Channel]) {
        let device = |c: &Channel| matches!(c.source, Source::Device { .. });
        self.devices = channels.iter().map(device).collect();
    }

    fn sample(&mut self, channel: usize, tick: u64, value: Option<&[u64]>) {
        if self.devices.get(channel) != Some(&true) {
            return;
        }
        let head = [channel as u64, tick, u64::from(value.is_some())];
        let words = head.iter().chain(value.into_iter().flatten());
        // A fixed byte order gives the same digest on every machine.
        self.hash = words.fold(self.hash, |hash, word| hash.with_bytes(&word.to_le_bytes()));
    }
}
