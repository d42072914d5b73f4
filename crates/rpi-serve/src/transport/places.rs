//! Places of connections: how many may be open at the same time, apart by what they have shown.
//!
//! A connection that has not shown who it is has one of a few places for a short time. If all are taken, the oldest one
//! of the peer with most of them is closed: a client that sends its request at once gets in, however many connections
//! stay silent. Clients over the network and at the Unix sockets have places of their own. A few places are kept for
//! the emergency stop: a client that finds no other place may request it, and the oldest of these is closed as well.

use std::collections::BTreeMap;
use std::fmt;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use crate::fair_share::Usage;
use crate::limits::Limits;
use crate::peer::Peer;

/// Connection as the table of connections sees it, from another thread than that of the connection.
pub(super) trait OpenConnection: Send {
    /// Closes the connection.
    fn close(&self);

    /// Returns whether the client has sent data that the server has not read yet.
    fn has_unread_data(&self) -> bool;
}

/// Kind of a connection. The number of connections is limited for each kind separately.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum PlaceKind {
    /// The client at this connection is not authenticated yet.
    Unauthenticated,
    /// Authenticated client over the network.
    Network,
    /// Client at a Unix socket.
    Socket,
    /// Client beyond the limits of the other kinds, which may only request the emergency stop.
    Emergency,
}

struct Entry {
    peer: Peer,
    kind: PlaceKind,
    /// Time at which the connection is closed; `None` if it may stay open.
    deadline: Option<Instant>,
    connection: Box<dyn OpenConnection>,
}

#[derive(Default)]
struct Table {
    /// Number of entries made so far, which is the key of the newest entry. Lower keys are older.
    given: u64,
    entries: BTreeMap<u64, Entry>,
}

/// Table of all open connections of a server, which limits their number by kind.
#[derive(Clone)]
pub(crate) struct Places {
    table: Arc<Mutex<Table>>,
    limits: Limits,
}

/// Decision about a client with a valid token or at a Unix socket: whether and how the server serves the client.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Admission {
    /// The client is served in full.
    Admitted,
    /// The client may only request the emergency stop, because the maximum number of clients is connected.
    EmergencyOnly,
    /// The connection was closed meanwhile, to make room for another one or because its time had elapsed.
    Closed,
}

/// Entry of a connection in the table of connections. Dropping it removes the entry.
pub(super) struct Place {
    places: Places,
    key: u64,
}

impl fmt::Debug for Places {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Places")
    }
}

impl Places {
    /// Creates the empty table of connections with these limits.
    pub(crate) fn new(limits: Limits) -> Places {
        Places {
            table: Arc::default(),
            limits,
        }
    }

    fn lock(&self) -> MutexGuard<'_, Table> {
        self.table.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Adds a new, unauthenticated connection over the network to the table. Returns also the peer of a connection that was
    /// closed to make room; `None` if none was closed.
    pub(super) fn enter(
        &self,
        peer: Peer,
        connection: Box<dyn OpenConnection>,
    ) -> (Place, Option<Peer>) {
        let mut table = self.lock();
        let kind = PlaceKind::Unauthenticated;
        let evicted = table.make_room(kind, self.limits.places.unauthenticated);
        let deadline = Instant::now() + self.limits.request_timeout;
        let key = table.insert(peer, kind, (Some(deadline), connection));
        (self.place(key), evicted)
    }

    /// Adds a connection at a Unix socket to the table. If too many clients are at the sockets, the client may only
    /// request the emergency stop.
    pub(super) fn enter_socket(&self, connection: Box<dyn OpenConnection>) -> (Place, Admission) {
        let mut table = self.lock();
        let is_full = table.count(PlaceKind::Socket) >= self.limits.places.socket;
        let key = table.insert(Peer::Local, PlaceKind::Socket, (None, connection));
        let admission = match is_full {
            false => Admission::Admitted,
            true => table.keep_for_stop(key, &self.limits),
        };
        (self.place(key), admission)
    }

    /// Closes the connections whose deadlines have passed.
    pub(super) fn expire(&self) {
        let mut table = self.lock();
        let now = Instant::now();
        table.entries.retain(|_, entry| {
            let is_over = entry.deadline.is_some_and(|deadline| deadline < now);
            if is_over {
                entry.connection.close();
            }
            !is_over
        });
    }

    /// Returns the number of open connections with the name of each kind.
    pub(super) fn counts(&self) -> [(&'static str, usize); 4] {
        let table = self.lock();
        [
            ("unauthenticated", PlaceKind::Unauthenticated),
            ("network", PlaceKind::Network),
            ("socket", PlaceKind::Socket),
            ("emergency", PlaceKind::Emergency),
        ]
        .map(|(name, kind)| (name, table.count(kind)))
    }

    fn place(&self, key: u64) -> Place {
        Place {
            places: self.clone(),
            key,
        }
    }
}

impl Place {
    /// Moves the connection, whose client is now authenticated, from the unauthenticated connections to those of
    /// clients, if the limit and the share of its peer allow it, else to those for an emergency stop.
    pub(super) fn admit(&self) -> Admission {
        let limits = &self.places.limits;
        let mut table = self.places.lock();
        let Some(peer) = table.entries.get(&self.key).map(|entry| entry.peer) else {
            return Admission::Closed;
        };
        let all = table.count(PlaceKind::Network);
        let usage = Usage::for_peer(all, table.count_of(PlaceKind::Network, peer));
        if usage.admit(1, limits.connections).is_err() {
            return table.keep_for_stop(self.key, limits);
        }
        if let Some(entry) = table.entries.get_mut(&self.key) {
            (entry.kind, entry.deadline) = (PlaceKind::Network, None);
        }
        Admission::Admitted
    }

    /// Closes the connection after `time`.
    pub(super) fn limit(&self, time: Duration) {
        if let Some(entry) = self.places.lock().entries.get_mut(&self.key) {
            entry.deadline = Some(Instant::now() + time);
        }
    }

    /// Postpones the deadline of the connection by `time`.
    pub(super) fn extend(&self, time: Duration) {
        if let Some(entry) = self.places.lock().entries.get_mut(&self.key) {
            entry.deadline = entry.deadline.map(|deadline| deadline + time);
        }
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        self.places.lock().entries.remove(&self.key);
    }
}

impl Table {
    fn insert(
        &mut self,
        peer: Peer,
        kind: PlaceKind,
        (deadline, connection): (Option<Instant>, Box<dyn OpenConnection>),
    ) -> u64 {
        self.given += 1;
        let entry = Entry {
            peer,
            kind,
            deadline,
            connection,
        };
        self.entries.insert(self.given, entry);
        self.given
    }

    fn count(&self, kind: PlaceKind) -> usize {
        let all = self.entries.values();
        all.filter(|entry| entry.kind == kind).count()
    }

    fn count_of(&self, kind: PlaceKind, peer: Peer) -> usize {
        let all = self.entries.values();
        all.filter(|entry| entry.kind == kind && entry.peer == peer)
            .count()
    }

    /// Moves a connection to those that may only request the emergency stop; the oldest of them is closed if necessary.
    fn keep_for_stop(&mut self, key: u64, limits: &Limits) -> Admission {
        self.make_room(PlaceKind::Emergency, limits.places.emergency);
        let Some(entry) = self.entries.get_mut(&key) else {
            return Admission::Closed;
        };
        entry.kind = PlaceKind::Emergency;
        entry.deadline = Some(Instant::now() + limits.request_timeout);
        Admission::EmergencyOnly
    }

    /// If `limit` connections of this kind are open, closes one of the peer with most of them and returns the peer: the
    /// oldest one that is silent. A connection with unread data waits for the server, and is closed only if all do.
    /// Returns `None` if no connection had to be closed.
    fn make_room(&mut self, kind: PlaceKind, limit: usize) -> Option<Peer> {
        if self.count(kind) < limit {
            return None;
        }
        let of_kind = self.entries.iter().filter(|(_, entry)| entry.kind == kind);
        // The oldest among equals: `max_by_key` returns the last one, so the order is reversed.
        let oldest = of_kind.rev();
        let (key, peer, _) = oldest
            .map(|(key, entry)| (*key, entry.peer, !entry.connection.has_unread_data()))
            .max_by_key(|(_, peer, is_silent)| (self.count_of(kind, *peer), *peer, *is_silent))?;
        if let Some(entry) = self.entries.remove(&key) {
            entry.connection.close();
        }
        Some(peer)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::*;

    fn peer(last: u8) -> Peer {
        Peer::from_ip([10, 0, 0, last].into())
    }

    fn places() -> Places {
        let mut limits = Limits::default();
        (limits.connections, limits.places.unauthenticated) = (8, 4);
        (limits.places.socket, limits.places.emergency) = (2, 2);
        Places::new(limits)
    }

    /// Connection that stores its number when it is closed.
    struct Numbered {
        closed: Arc<AtomicUsize>,
        number: usize,
        has_unread_data: bool,
    }

    impl OpenConnection for Numbered {
        fn close(&self) {
            self.closed.store(self.number, Ordering::Relaxed);
        }

        fn has_unread_data(&self) -> bool {
            self.has_unread_data
        }
    }

    fn silent(closed: &Arc<AtomicUsize>, number: usize) -> Box<dyn OpenConnection> {
        Box::new(Numbered {
            closed: Arc::clone(closed),
            number,
            has_unread_data: false,
        })
    }

    /// On a busy machine, many connections can come before the server reads the request of one.
    #[test]
    fn a_connection_with_a_waiting_request_outlives_silent_ones() {
        let (places, closed) = (places(), Arc::new(AtomicUsize::new(0)));
        let waiting = Numbered {
            closed: Arc::clone(&closed),
            number: 9,
            has_unread_data: true,
        };
        let (honest, _) = places.enter(peer(1), Box::new(waiting));
        let crowd: Vec<Place> = (1..=20)
            .map(|number| places.enter(peer(1), silent(&closed, number)).0)
            .collect();
        assert_eq!(closed.load(Ordering::Relaxed), 17);
        assert_eq!(honest.admit(), Admission::Admitted);
        drop(crowd);
    }

    #[test]
    fn the_oldest_silent_connection_of_the_busiest_peer_makes_room() {
        let (places, closed) = (places(), Arc::new(AtomicUsize::new(0)));
        let (honest, _) = places.enter(peer(9), silent(&closed, 9));
        let mut others = Vec::new();
        for number in 1..=3 {
            others.push(places.enter(peer(1), silent(&closed, number)).0);
        }
        assert_eq!(closed.load(Ordering::Relaxed), 0);
        let (_last, evicted) = places.enter(peer(1), silent(&closed, 4));
        assert_eq!(evicted, Some(peer(1)));
        assert_eq!(closed.load(Ordering::Relaxed), 1);
        assert_eq!(others[0].admit(), Admission::Closed);
        assert_eq!(honest.admit(), Admission::Admitted);
    }

    #[test]
    fn whoever_finds_no_place_may_still_stop_everything() {
        let (places, closed) = (places(), Arc::new(AtomicUsize::new(0)));
        let admitted: Vec<_> = (0..10)
            .map(|number| {
                let (place, _) = places.enter(peer(1), silent(&closed, number));
                (place.admit(), place)
            })
            .collect();
        let full = |(admission, _): &&(Admission, Place)| *admission == Admission::EmergencyOnly;
        // Six of eight: a peer leaves a quarter.
        assert_eq!(admitted.iter().filter(full).count(), 4);
        assert_eq!(
            closed.load(Ordering::Relaxed),
            7,
            "the oldest kept ones end"
        );
        let (other, _) = places.enter(peer(2), silent(&closed, 99));
        assert_eq!(other.admit(), Admission::Admitted);
    }

    #[test]
    fn the_network_takes_no_place_of_a_socket() {
        let (places, closed) = (places(), Arc::new(AtomicUsize::new(0)));
        let network: Vec<_> = (0..20)
            .map(|number| places.enter(Peer::Local, silent(&closed, number)).0)
            .collect();
        for place in &network {
            let _ = place.admit();
        }
        let sockets = [(); 3].map(|()| places.enter_socket(silent(&closed, 0)));
        let admissions = sockets.each_ref().map(|(_, admission)| *admission);
        use Admission::{Admitted, EmergencyOnly};
        assert_eq!(admissions, [Admitted, Admitted, EmergencyOnly]);
    }

    #[test]
    fn what_stays_silent_is_closed_in_time() {
        let limits = Limits {
            request_timeout: Duration::ZERO,
            ..Limits::default()
        };
        let (places, closed) = (Places::new(limits), Arc::new(AtomicUsize::new(0)));
        let (place, _) = places.enter(peer(1), silent(&closed, 5));
        std::thread::sleep(Duration::from_millis(2));
        places.expire();
        assert_eq!(closed.load(Ordering::Relaxed), 5);
        assert_eq!(place.admit(), Admission::Closed);
    }
}
