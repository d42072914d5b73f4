//! One thing that happened, as numbers.

/// What happened.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub(crate) enum Kind {
    /// A sensor was read. Key: port; flag: there was a sample; words: its cells.
    Read = 1,
    /// A set-point was shown to a device before. Key: port; words: what it has against it, as bits.
    Check = 2,
    /// The error of a device was asked for. Key: port; words: the code.
    Error = 3,
    /// It was asked whether a set-point joins. Key: port; flag: it does not; words: actuator, quantity, value, limit.
    Jump = 4,
    /// A function of a device was called. Key: port; flag: there was a result; words: its cells.
    Call = 5,
    /// It was asked whether an actuator moves. Key: actuator; flag: it does.
    Moving = 6,
    /// A set-point was handed over. Key: port; words: its cells.
    Write = 7,
    /// An actuator was told to stop. Key: actuator.
    Stop = 8,
    /// An actuator was told its period. Key: actuator; words: ticks.
    Pace = 9,
    /// How a device does at the end of a tick. Key: device; flag: it moves; words: its error code.
    Condition = 10,
    /// All commands were ended between two ticks. Key: why.
    Halt = 11,
    /// A flow of a command at the end of its cycle. Key: which of its flows; flag: it is present; words: number of the command,
    /// cells.
    Flow = 12,
    /// A port of a device after it has moved. Key: which of those that are looked at; flag: there is a value; words: its cells.
    Sample = 13,
    /// A tick ended when the next one was due already. Words: by how many nanoseconds.
    Overrun = 14,
    /// A tick that ended too late is put down to a command. Key: the fragment that was at work; words: number of the command,
    /// nanoseconds that it took, and by which the tick was late.
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

/// One thing that happened.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Entry<'a> {
    pub(crate) kind: Kind,
    pub(crate) key: u32,
    pub(crate) flag: bool,
    pub(crate) words: &'a [u64],
}

const FLAG: u64 = 1 << 55;
const KIND: u32 = 56;
const LEN: u32 = 32;
const MOST: u64 = (1 << 23) - 1;

/// The head of an entry.
pub(super) fn head(kind: Kind, key: u32, flag: bool, len: usize) -> u64 {
    let flag = if flag { FLAG } else { 0 };
    (kind as u64) << KIND | flag | (len as u64 & MOST) << LEN | u64::from(key)
}

/// The first entry, and what follows it; none at the end and where no entry begins.
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

/// All entries of a row; it ends early where no entry begins.
pub(crate) fn entries(mut words: &[u64]) -> impl Iterator<Item = Entry<'_>> {
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
