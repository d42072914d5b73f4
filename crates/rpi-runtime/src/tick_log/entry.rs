//! Encoding of entries of a tick log.

/// Kind of an entry of the tick log, which records the exchange between core and devices in each tick. The description
/// of each kind lists the meaning of the entry's key, flag and words.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum EntryKind {
    /// Read of a sensor. Key: number of the port; flag: a sample was available; words: memory words of the sample.
    Read = 1,
    /// Check of a set-point by its device. Key: number of the port; words: the reasons for a rejection as bits, 0 for
    /// none.
    Check = 2,
    /// Query of a device error. Key: number of the port; words: error code, 0 for none.
    Error = 3,
    /// Query whether a set-point continues the motion. Key: number of the port; flag: the set-point is discontinuous;
    /// words: number of the actuator, number of the quantity (position, velocity, acceleration), value, limit.
    Discontinuity = 4,
    /// Call of a device function, such as inverse kinematics. Key: number of the port; flag: there was a result; words:
    /// memory words of the result.
    Call = 5,
    /// Query whether an actuator moves. Key: number of the actuator; flag: the actuator moves.
    Moving = 6,
    /// Write of a set-point. Key: number of the port; words: memory words of the set-point.
    Write = 7,
    /// Stop of an actuator. Key: number of the actuator.
    Stop = 8,
    /// Start of a command that drives an actuator. Key: number of the actuator; words: period of its set-points in
    /// ticks.
    Period = 9,
    /// State of a device at the end of a tick. Key: index of the device; flag: the device moves; words: error code, 0
    /// for none.
    DeviceState = 10,
    /// Abort of all commands between two ticks. Key: number of the abort reason.
    Halt = 11,
    /// Value of a flow of a command at the end of its cycle. Key: index of the flow; flag: the flow is present; words:
    /// number of the command, memory words of the value.
    Flow = 12,
    /// Sample of a device port after a tick. Key: index of the sampled port; flag: there is a value; words: memory
    /// words of the value.
    Sample = 13,
    /// Overrun of a tick. Words: nanoseconds by which the tick ended after the next one was due.
    Overrun = 14,
    /// Attribution of an overrun to a command. Key: index of the fragment with the most work; words: number of the
    /// command, its time in nanoseconds, nanoseconds by which the tick ended after the next one was due.
    OverrunCause = 15,
}

impl EntryKind {
    const ALL: [EntryKind; 15] = [
        EntryKind::Read,
        EntryKind::Check,
        EntryKind::Error,
        EntryKind::Discontinuity,
        EntryKind::Call,
        EntryKind::Moving,
        EntryKind::Write,
        EntryKind::Stop,
        EntryKind::Period,
        EntryKind::DeviceState,
        EntryKind::Halt,
        EntryKind::Flow,
        EntryKind::Sample,
        EntryKind::Overrun,
        EntryKind::OverrunCause,
    ];

    fn from_number(number: u64) -> Option<EntryKind> {
        EntryKind::ALL
            .into_iter()
            .find(|kind| *kind as u64 == number)
    }
}

/// Entry of the tick log, which records the exchange between core and devices, and values, in each tick.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct LogEntry<'a> {
    /// Kind of the entry, such as a sensor sample or a set-point.
    pub kind: EntryKind,
    /// Number of a port, actuator, device, flow or reason, depending on the kind; see [`EntryKind`].
    pub key: u32,
    /// Truth value of the entry; its meaning depends on the kind, see [`EntryKind`].
    pub flag: bool,
    /// 64-bit words of the entry; their meaning depends on the kind, see [`EntryKind`].
    pub words: &'a [u64],
}

// Layout of a head word, from the top: 8 bits kind, 1 bit flag, 23 bits length, 32 bits key.
const FLAG: u64 = 1 << 55;
const KIND_SHIFT: u32 = 56;
const LEN_SHIFT: u32 = 32;
const MAX_LEN: u64 = (1 << 23) - 1;

/// Encodes the first word of a tick log entry: kind, key, flag and number of further words.
pub(super) fn encode_head(kind: EntryKind, key: u32, flag: bool, len: usize) -> u64 {
    let flag = if flag { FLAG } else { 0 };
    (kind as u64) << KIND_SHIFT | flag | (len as u64 & MAX_LEN) << LEN_SHIFT | u64::from(key)
}

/// Decodes the first of the tick log entries in `words`. Returns the entry and the remaining words; `None` at the end
/// or if the words are invalid.
pub(super) fn decode_first(words: &[u64]) -> Option<(LogEntry<'_>, &[u64])> {
    let (head, rest) = words.split_first()?;
    let len = usize::try_from(head >> LEN_SHIFT & MAX_LEN).ok()?;
    let (words, rest) = rest.split_at_checked(len)?;
    let entry = LogEntry {
        kind: EntryKind::from_number(head >> KIND_SHIFT)?,
        key: *head as u32,
        flag: head & FLAG != 0,
        words,
    };
    Some((entry, rest))
}

/// Decodes a list of tick log entries. The iteration ends at the first invalid entry.
pub fn decode_entries(mut words: &[u64]) -> impl Iterator<Item = LogEntry<'_>> {
    std::iter::from_fn(move || {
        let (entry, rest) = decode_first(words)?;
        words = rest;
        Some(entry)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heads_keep_what_they_are_given() {
        for kind in EntryKind::ALL {
            let words = [
                encode_head(kind, u32::MAX, true, 2),
                7,
                8,
                encode_head(kind, 0, false, 0),
            ];
            let all: Vec<_> = decode_entries(&words).collect();
            assert_eq!(
                (all[0].kind, all[0].key, all[0].flag),
                (kind, u32::MAX, true)
            );
            assert_eq!((all[0].words, all[1].words), (&[7, 8][..], &[][..]));
            assert_eq!((all[1].kind, all[1].key, all[1].flag), (kind, 0, false));
        }
    }

    #[test]
    fn a_row_ends_where_no_entry_begins() {
        assert_eq!(
            decode_entries(&[encode_head(EntryKind::Read, 0, false, 2), 1]).count(),
            0
        );
        assert_eq!(decode_entries(&[0]).count(), 0);
    }
}
