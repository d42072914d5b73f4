//! Encoding of tape entries.

/// Kind of a tape entry. Each description lists the meaning of the key, the flag and the words.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum Kind {
    /// Read of a sensor. Key: port; flag: a sample was available; words: memory words of the sample.
    Read = 1,
    /// Check of a set-point by its device. Key: port; words: the reasons for a refusal, as bits.
    Check = 2,
    /// Query of a device error. Key: port; words: error code.
    Error = 3,
    /// Query of a discontinuity. Key: port; flag: the set-point is discontinuous; words: actuator, quantity, value,
    /// limit.
    Jump = 4,
    /// Call of a device function. Key: port; flag: there was a result; words: memory words of the result.
    Call = 5,
    /// Query of an actuator's motion. Key: actuator; flag: the actuator moves.
    Moving = 6,
    /// Write of a set-point. Key: port; words: memory words of the set-point.
    Write = 7,
    /// Stop of an actuator. Key: actuator.
    Stop = 8,
    /// Period of an actuator's set-points. Key: actuator; words: number of ticks.
    Pace = 9,
    /// State of a device at the end of a tick. Key: device; flag: the device moves; words: error code.
    Condition = 10,
    /// End of all commands between two ticks. Key: number of the reason.
    Halt = 11,
    /// Flow of a command at the end of its cycle. Key: index of the flow; flag: the flow is present; words: number of
    /// the command, memory words of the value.
    Flow = 12,
    /// Sample of a device port after a tick. Key: index of the sampled port; flag: there is a value; words: memory
    /// words of the value.
    Sample = 13,
    /// Overrun of a tick. Words: nanoseconds by which the tick ended after the next one was due.
    Overrun = 14,
    /// Attribution of an overrun to a command. Key: fragment with the most work; words: number of the command, its time
    /// in nanoseconds, nanoseconds by which the tick ended too late.
    Blamed = 15,
}

impl Kind {
    const ALL: [Kind; 15] = [
        Kind::Read,
        Kind::Check,
        Kind::Error,
        Kind::Jump,
        Kind::Call,
        Kind::Moving,
        Kind::Write,
        Kind::Stop,
        Kind::Pace,
        Kind::Condition,
        Kind::Halt,
        Kind::Flow,
        Kind::Sample,
        Kind::Overrun,
        Kind::Blamed,
    ];

    fn of(number: u64) -> Option<Kind> {
        Kind::ALL.into_iter().find(|kind| *kind as u64 == number)
    }
}

/// An entry of a tape.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Entry<'a> {
    /// Kind of the entry.
    pub kind: Kind,
    /// Key; its meaning depends on the kind.
    pub key: u32,
    /// Flag; its meaning depends on the kind.
    pub flag: bool,
    /// Words; their meaning depends on the kind.
    pub words: &'a [u64],
}

const FLAG: u64 = 1 << 55;
const KIND: u32 = 56;
const LEN: u32 = 32;
const MOST: u64 = (1 << 23) - 1;

/// Encodes the head word of an entry.
pub(super) fn head(kind: Kind, key: u32, flag: bool, len: usize) -> u64 {
    let flag = if flag { FLAG } else { 0 };
    (kind as u64) << KIND | flag | (len as u64 & MOST) << LEN | u64::from(key)
}

/// Decodes the first entry. Returns the entry and the remaining words; `None` at the end or if the words are invalid.
pub(super) fn split(words: &[u64]) -> Option<(Entry<'_>, &[u64])> {
    let (head, rest) = words.split_first()?;
    let len = usize::try_from(head >> LEN & MOST).ok()?;
    let (words, rest) = rest.split_at_checked(len)?;
    let entry = Entry {
        kind: Kind::of(head >> KIND)?,
        key: *head as u32,
        flag: head & FLAG != 0,
        words,
    };
    Some((entry, rest))
}

/// Decodes a list of entries. The iteration ends at the first invalid entry.
pub fn entries(mut words: &[u64]) -> impl Iterator<Item = Entry<'_>> {
    std::iter::from_fn(move || {
        let (entry, rest) = split(words)?;
        words = rest;
        Some(entry)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heads_keep_what_they_are_given() {
        for kind in Kind::ALL {
            let words = [head(kind, u32::MAX, true, 2), 7, 8, head(kind, 0, false, 0)];
            let all: Vec<_> = entries(&words).collect();
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
        assert_eq!(entries(&[head(Kind::Read, 0, false, 2), 1]).count(), 0);
        assert_eq!(entries(&[0]).count(), 0);
    }
}
