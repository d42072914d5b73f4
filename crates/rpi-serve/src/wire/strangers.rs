//! Those who are turned away: told about, and held up.
//!
//! A line for each would let them fill the log, so that of each peer the first is told, the tenth, the hundredth. Who shows a wrong
//! token waits for the answer; who shows the right one never does, whoever else comes from the same place.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use crate::peer::Peer;

/// Peers that are remembered.
const PEERS: usize = 256;
/// A peer that keeps away for so long is forgotten.
const CALM: Duration = Duration::from_secs(60);
/// Of one peer so many wait at a time: each takes the place of a connection.
const WAITING: usize = 8;

/// Those who were turned away lately.
#[derive(Clone, Default)]
pub(crate) struct Strangers(Arc<Mutex<BTreeMap<(Peer, Why), Stranger>>>);

/// Why somebody is turned away.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) enum Why {
    /// No token was shown.
    NoToken,
    /// Another token was shown.
    WrongToken,
    /// There are too many connections.
    Crowd,
}

struct Stranger {
    times: u64,
    latest: Instant,
    waiting: usize,
}

/// Somebody who waits for an answer.
pub(super) struct Wait(Strangers, Peer);

impl Why {
    /// In words.
    fn told(self) -> &'static str {
        match self {
            Why::NoToken => "no token was shown",
            Why::WrongToken => "a wrong token was shown",
            Why::Crowd => "a connection too many was turned away",
        }
    }
}

impl Strangers {
    fn all(&self) -> MutexGuard<'_, BTreeMap<(Peer, Why), Stranger>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Notes that somebody is turned away; what is to be told about it, if something is.
    pub(super) fn note(&self, peer: Peer, why: Why) -> Option<String> {
        let mut all = self.all();
        all.retain(|_, s| s.waiting > 0 || s.latest.elapsed() < CALM);
        if all.len() >= PEERS && !all.contains_key(&(peer, why)) {
            return None;
        }
        let stranger = all.entry((peer, why)).or_insert(Stranger {
            times: 0,
            latest: Instant::now(),
            waiting: 0,
        });
        (stranger.times, stranger.latest) = (stranger.times + 1, Instant::now());
        let (times, what) = (stranger.times, why.told());
        match times {
            1 => Some(format!("{what}, from {peer}")),
            _ if is_round(times) => Some(format!("{what}, {times} times by now, from {peer}")),
            _ => None,
        }
    }

    /// Lets one who has shown a wrong token wait; none if so many from there wait already.
    pub(super) fn wait(&self, peer: Peer) -> Option<Wait> {
        let mut all = self.all();
        let stranger = all.get_mut(&(peer, Why::WrongToken))?;
        if stranger.waiting >= WAITING {
            return None;
        }
        stranger.waiting += 1;
        Some(Wait(self.clone(), peer))
    }
}

impl Drop for Wait {
    fn drop(&mut self) {
        if let Some(stranger) = self.0.all().get_mut(&(self.1, Why::WrongToken)) {
            stranger.waiting -= 1;
        }
    }
}

/// 10, 100, 1000 and so on.
fn is_round(times: u64) -> bool {
    times == 10_u64.pow(times.ilog10())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn peer(last: u8) -> Peer {
        Peer::of([10, 0, 0, last].into())
    }

    #[test]
    fn the_first_is_told_and_then_ever_fewer() {
        let strangers = Strangers::default();
        let told = (0..1000).filter_map(|_| strangers.note(peer(1), Why::WrongToken));
        assert_eq!(
            told.collect::<Vec<_>>(),
            [
                "a wrong token was shown, from 10.0.0.1",
                "a wrong token was shown, 10 times by now, from 10.0.0.1",
                "a wrong token was shown, 100 times by now, from 10.0.0.1",
                "a wrong token was shown, 1000 times by now, from 10.0.0.1",
            ]
        );
        assert!(strangers.note(peer(2), Why::WrongToken).is_some());
    }

    #[test]
    fn only_so_many_wait_and_are_remembered() {
        let strangers = Strangers::default();
        strangers.note(peer(1), Why::WrongToken);
        let mut waiting: Vec<Wait> = (0..WAITING)
            .map(|_| strangers.wait(peer(1)).unwrap())
            .collect();
        assert!(strangers.wait(peer(1)).is_none());
        waiting.pop();
        assert!(strangers.wait(peer(1)).is_some());
        for k in 0..2000_u32 {
            strangers.note(Peer::of(k.to_be_bytes().into()), Why::NoToken);
        }
        assert_eq!(strangers.all().len(), PEERS);
    }
}
