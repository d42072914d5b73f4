//! Memory of the messages of all clients together.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::fair_share::Usage;
use crate::peer::Peer;

/// Number of bytes that each connection may use without a share of the pool (128 KiB), so that a small message is always
/// received and answered.
const UNSHARED_BYTES: usize = 1 << 17;

/// Memory that the messages of all clients share: a client may use at most as much as it leaves free.
#[derive(Clone)]
pub(crate) struct MemoryPool(Arc<Pool>);

struct Pool {
    limit: usize,
    ledger: Mutex<Ledger>,
}

/// Amounts of the pool that are in use.
#[derive(Default)]
struct Ledger {
    all: usize,
    by_peer: BTreeMap<Peer, usize>,
}

/// Memory that one connection uses. Dropping it returns the memory to the pool.
pub(crate) struct ConnectionMemory {
    pool: MemoryPool,
    peer: Peer,
    /// Maximum number of bytes of this connection.
    limit: usize,
    used: Mutex<usize>,
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Returns how many of the used bytes of a connection count for the pool.
fn shared(used: usize) -> usize {
    used.saturating_sub(UNSHARED_BYTES)
}

impl MemoryPool {
    /// Creates a pool of `limit` bytes.
    pub(crate) fn new(limit: usize) -> MemoryPool {
        MemoryPool(Arc::new(Pool {
            limit,
            ledger: Mutex::default(),
        }))
    }

    /// Creates the memory of a connection from this peer, which may use at most `limit` bytes.
    pub(crate) fn connection(&self, peer: Peer, limit: usize) -> ConnectionMemory {
        ConnectionMemory {
            pool: self.clone(),
            peer,
            limit,
            used: Mutex::new(0),
        }
    }

    /// Takes `more` bytes for a client that has `own` bytes. Returns false, and takes nothing, if that exceeds its share.
    fn take(&self, peer: Peer, own: usize, more: usize) -> bool {
        let mut ledger = lock(&self.0.ledger);
        let of_peer = ledger.by_peer.get(&peer).copied().unwrap_or(0);
        let usage = Usage::new(ledger.all, of_peer, own);
        let is_granted = more == 0 || usage.admit(more, self.0.limit).is_ok();
        if is_granted {
            ledger.all += more;
            *ledger.by_peer.entry(peer).or_default() += more;
        }
        is_granted
    }

    fn give_back(&self, peer: Peer, bytes: usize) {
        let mut ledger = lock(&self.0.ledger);
        ledger.all = ledger.all.saturating_sub(bytes);
        if let Some(of_peer) = ledger.by_peer.get_mut(&peer) {
            *of_peer = of_peer.saturating_sub(bytes);
        }
        // The number of peers that ever connected has no bound.
        ledger.by_peer.retain(|_, bytes| *bytes > 0);
    }
}

impl ConnectionMemory {
    /// Reserves `more` bytes. Returns false, and reserves nothing, if that exceeds the limit of the connection or the
    /// share of its client.
    pub(crate) fn reserve(&self, more: usize) -> bool {
        let mut used = lock(&self.used);
        let total = used.saturating_add(more);
        if total > self.limit {
            return false;
        }
        let own = shared(*used);
        let is_granted = match shared(total) - own {
            0 => true,
            more => self.pool.take(self.peer, own, more),
        };
        if is_granted {
            *used = total;
        }
        is_granted
    }

    /// Releases `less` of the reserved bytes.
    pub(crate) fn release(&self, less: usize) {
        let mut used = lock(&self.used);
        let total = used.saturating_sub(less);
        let freed = shared(*used) - shared(total);
        *used = total;
        if freed > 0 {
            self.pool.give_back(self.peer, freed);
        }
    }

    /// Returns whether the connection uses memory of the pool.
    pub(crate) fn uses_pool(&self) -> bool {
        shared(*lock(&self.used)) > 0
    }
}

impl Drop for ConnectionMemory {
    fn drop(&mut self) {
        self.release(usize::MAX);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MIB: usize = 1 << 20;

    fn peer(last: u8) -> Peer {
        Peer::from_ip([10, 0, 0, last].into())
    }

    #[test]
    fn a_client_leaves_as_much_as_it_uses() {
        let pool = MemoryPool::new(8 * MIB);
        let fill =
            |memory: &ConnectionMemory| (0..).take_while(|_| memory.reserve(MIB / 8)).count();
        let one = pool.connection(peer(1), usize::MAX);
        // Half of the pool, and the bytes that are not shared.
        assert_eq!(fill(&one), 32 + 1);
        let other = pool.connection(peer(2), usize::MAX);
        assert_eq!(fill(&other), 16 + 1);
        drop(one);
        assert_eq!(fill(&other), 16);
    }

    #[test]
    fn little_memory_is_always_granted() {
        let pool = MemoryPool::new(0);
        let memory = pool.connection(peer(1), usize::MAX);
        assert!(memory.reserve(UNSHARED_BYTES) && !memory.uses_pool());
        assert!(!memory.reserve(1));
        memory.release(1);
        assert!(memory.reserve(1));
    }

    #[test]
    fn a_connection_has_its_own_limit() {
        let memory = MemoryPool::new(8 * MIB).connection(peer(1), 100);
        assert!(memory.reserve(100) && !memory.reserve(1));
    }

    #[test]
    fn nothing_remains_of_a_closed_connection() {
        let pool = MemoryPool::new(8 * MIB);
        let memory = pool.connection(peer(1), usize::MAX);
        assert!(memory.reserve(3 * MIB));
        memory.release(MIB);
        drop(memory);
        let ledger = lock(&pool.0.ledger);
        assert_eq!((ledger.all, ledger.by_peer.len()), (0, 0));
    }
}
