//! Message of the control core to its guard.

/// State of the control core, which the core sends to its guard at regular intervals.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub(super) struct Beat {
    /// Number of cycles since the start; 0 before the first one, and throughout on simulated time.
    pub(super) ticks: u64,
    /// Length of a cycle in nanoseconds.
    pub(super) period_ns: u64,
    /// Whether an emergency stop is in force, which must hold after a restart.
    pub(super) is_stopped: bool,
    /// Whether the core ends in order: no further cycles are expected.
    pub(super) is_ending: bool,
}

/// Number of bytes of an encoded [`Beat`].
pub(super) const BEAT_BYTES: usize = 18;

impl Beat {
    pub(super) fn encode(self) -> [u8; BEAT_BYTES] {
        let mut bytes = [0; BEAT_BYTES];
        bytes[..8].copy_from_slice(&self.ticks.to_le_bytes());
        bytes[8..16].copy_from_slice(&self.period_ns.to_le_bytes());
        bytes[16..].copy_from_slice(&[self.is_stopped, self.is_ending].map(u8::from));
        bytes
    }

    pub(super) fn decode(bytes: [u8; BEAT_BYTES]) -> Beat {
        let number = |at: usize| {
            let mut number = [0; 8];
            number.copy_from_slice(&bytes[at..at + 8]);
            u64::from_le_bytes(number)
        };
        Beat {
            ticks: number(0),
            period_ns: number(8),
            is_stopped: bytes[16] != 0,
            is_ending: bytes[17] != 0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_beat_is_decoded_as_it_was_encoded() {
        let beat = Beat {
            ticks: 70_000,
            period_ns: 1_000_000,
            is_stopped: true,
            is_ending: false,
        };
        assert_eq!(Beat::decode(beat.encode()), beat);
    }
}
