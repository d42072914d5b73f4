//! Log and delay of rejected connections and requests.
//!
//! Only the first, tenth, hundredth (and so on) rejection of a peer is logged, so that rejections cannot flood the log.
//! A request with a wrong token is answered after a delay; a correct token is never delayed, whatever else its peer
//! sends.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use crate::peer::Peer;

/// Maximum number of entries.
const PEERS: usize = 256;
/// An entry is removed after this time without a further rejection.
const CALM: Duration = Duration::from_secs(60);
/// Maximum number of delayed answers per peer. Each occupies a connection.
const WAITING: usize = 8;

/// Recent rejections by peer and reason.
#[derive(Clone, Default)]
pub(crate) struct Strangers(Arc<Mutex<BTreeMap<(Peer, Why), Stranger>>>);

/// Reason for a rejection.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) enum Why {
    /// The request has no token.
    NoToken,
    /// The request has a wrong token.
    WrongToken,
    /// Too many connections.
    Crowd,
}

struct Stranger {
    times: u64,
    latest: Instant,
    waiting: usize,
}

/// A delayed answer. Dropping it decrements the count of its peer.
pub(super) struct Wait(Strangers, Peer);

impl Why {
    /// Describes the reason for the log.
    fn told(self) -> &'static str {
        match self {
            Why::NoToken => "rejected a request without a token",
            Why::WrongToken => "rejected a request with a wrong token",
            Why::Crowd => "rejected a connection beyond the limit",
        }
    }
}

impl Strangers {
    fn all(&self) -> MutexGuard<'_, BTreeMap<(Peer, Why), Stranger>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Counts a rejection. Returns the text for the log, if it is to be logged.
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

    /// Reserves a delayed answer to a wrong token; `None` if the peer has too many.
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

/// Returns whether the number is a power of ten.
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
                "rejected a request with a wrong token, from 10.0.0.1",
                "rejected a request with a wrong token, 10 times by now, from 10.0.0.1",
                "rejected a request with a wrong token, 100 times by now, from 10.0.0.1",
                "rejected a request with a wrong token, 1000 times by now, from 10.0.0.1",
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
