//! Log and delay of rejected connections and requests.
//!
//! Only the first, tenth, hundredth (and so on) rejection of a peer is logged, so that rejections cannot flood the log.
//! A request with a wrong token is answered after a delay; a correct token is never delayed, whatever else its peer
//! sends.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use crate::peer::Peer;

/// Maximum number of pairs of peer and reason for which rejections are counted.
const MAX_ENTRIES: usize = 256;
/// Time without a further rejection after which the count of a peer and reason is removed.
const ENTRY_LIFETIME: Duration = Duration::from_secs(60);
/// Maximum number of answers per peer that are delayed at the same time. Each of them occupies a connection.
const MAX_DELAYED: usize = 8;

/// Counts of recent rejections by peer and reason. They limit the number of log lines and slow down the guessing of
/// tokens.
#[derive(Clone, Default)]
pub(crate) struct AuthThrottle {
    recent: Arc<Mutex<BTreeMap<(Peer, RejectReason), ThrottleEntry>>>,
    /// Number of all rejections since the start of the server by reason, in the order of the enum.
    totals: Arc<[AtomicU64; 3]>,
}

/// Reason for rejecting a request or a connection before the client is authenticated.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) enum RejectReason {
    /// The request has no token.
    NoToken,
    /// The request has a wrong token.
    WrongToken,
    /// The maximum number of connections, or the share of the peer, is reached.
    TooManyConnections,
}

struct ThrottleEntry {
    times: u64,
    latest: Instant,
    waiting: usize,
}

/// Reservation of an answer to a wrong token that is sent after a delay. Dropping it decrements the count of delayed
/// answers of its peer.
pub(super) struct DelayedAnswer(AuthThrottle, Peer);

impl RejectReason {
    /// Returns the name of the reason in metrics.
    fn name(self) -> &'static str {
        match self {
            RejectReason::NoToken => "no_token",
            RejectReason::WrongToken => "wrong_token",
            RejectReason::TooManyConnections => "no_place",
        }
    }

    /// Describes the reason for the log.
    fn description(self) -> &'static str {
        match self {
            RejectReason::NoToken => "rejected a request without a token",
            RejectReason::WrongToken => "rejected a request with a wrong token",
            RejectReason::TooManyConnections => "rejected a connection beyond the limit",
        }
    }
}

impl AuthThrottle {
    fn lock(&self) -> MutexGuard<'_, BTreeMap<(Peer, RejectReason), ThrottleEntry>> {
        self.recent.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns the number of all rejections since the start of the server with the name of each reason.
    pub(super) fn totals(&self) -> [(&'static str, u64); 3] {
        [
            RejectReason::NoToken,
            RejectReason::WrongToken,
            RejectReason::TooManyConnections,
        ]
        .map(|why| {
            (
                why.name(),
                self.totals[why as usize].load(Ordering::Relaxed),
            )
        })
    }

    /// Counts a rejection. Returns the text for the log if this rejection is to be logged, else `None`.
    pub(crate) fn record(&self, peer: Peer, why: RejectReason) -> Option<String> {
        self.totals[why as usize].fetch_add(1, Ordering::Relaxed);
        let mut all = self.lock();
        all.retain(|_, s| s.waiting > 0 || s.latest.elapsed() < ENTRY_LIFETIME);
        // Requests from many addresses must not use up the memory.
        if all.len() >= MAX_ENTRIES && !all.contains_key(&(peer, why)) {
            return None;
        }
        let client = all.entry((peer, why)).or_insert(ThrottleEntry {
            times: 0,
            latest: Instant::now(),
            waiting: 0,
        });
        (client.times, client.latest) = (client.times + 1, Instant::now());
        let (times, what) = (client.times, why.description());
        // Powers of ten: repeated requests cannot flood the log, and their number stays visible.
        match times {
            1 => Some(format!("{what}, from {peer}")),
            _ if is_power_of_ten(times) => {
                Some(format!("{what}, {times} times by now, from {peer}"))
            }
            _ => None,
        }
    }

    /// Reserves an answer to a wrong token that is sent after a delay; `None` if the peer has [`MAX_DELAYED`] of them.
    pub(super) fn reserve_delay(&self, peer: Peer) -> Option<DelayedAnswer> {
        let mut all = self.lock();
        let client = all.get_mut(&(peer, RejectReason::WrongToken))?;
        if client.waiting >= MAX_DELAYED {
            return None;
        }
        client.waiting += 1;
        Some(DelayedAnswer(self.clone(), peer))
    }
}

impl Drop for DelayedAnswer {
    fn drop(&mut self) {
        if let Some(client) = self.0.lock().get_mut(&(self.1, RejectReason::WrongToken)) {
            client.waiting -= 1;
        }
    }
}

/// Returns whether the number, which must not be 0, is a power of ten.
fn is_power_of_ten(times: u64) -> bool {
    times == 10_u64.pow(times.ilog10())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn peer(last: u8) -> Peer {
        Peer::from_ip([10, 0, 0, last].into())
    }

    #[test]
    fn the_first_is_told_and_then_ever_fewer() {
        let throttle = AuthThrottle::default();
        let warnings = (0..1000).filter_map(|_| throttle.record(peer(1), RejectReason::WrongToken));
        assert_eq!(
            warnings.collect::<Vec<_>>(),
            [
                "rejected a request with a wrong token, from 10.0.0.1",
                "rejected a request with a wrong token, 10 times by now, from 10.0.0.1",
                "rejected a request with a wrong token, 100 times by now, from 10.0.0.1",
                "rejected a request with a wrong token, 1000 times by now, from 10.0.0.1",
            ]
        );
        assert!(throttle.record(peer(2), RejectReason::WrongToken).is_some());
    }

    #[test]
    fn only_so_many_wait_and_are_remembered() {
        let throttle = AuthThrottle::default();
        throttle.record(peer(1), RejectReason::WrongToken);
        let mut waiting: Vec<DelayedAnswer> = (0..MAX_DELAYED)
            .map(|_| throttle.reserve_delay(peer(1)).unwrap())
            .collect();
        assert!(throttle.reserve_delay(peer(1)).is_none());
        waiting.pop();
        assert!(throttle.reserve_delay(peer(1)).is_some());
        for k in 0..2000_u32 {
            throttle.record(Peer::from_ip(k.to_be_bytes().into()), RejectReason::NoToken);
        }
        assert_eq!(throttle.lock().len(), MAX_ENTRIES);
    }
}
