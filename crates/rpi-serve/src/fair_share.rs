//! Fair sharing of limited resources: no client can take all of them, however many clients there are.
//!
//! A client may hold at most as much as it leaves free for others, and all clients of one peer together at most three
//! times that. So a single client gets half, two get a third each, and something is always left for the next one
//! (dynamic thresholds: Choudhury and Hahne 1998, on shared buffers of switch ports; see ADR 0011).

use crate::peer::Peer;

/// Factor of the share of a peer: all clients of one peer together may hold this many times the amount that is still
/// free.
const PEER_FACTOR: usize = 3;

/// Client connection, identified by a number, with its network origin.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) struct Client {
    number: u64,
    peer: Peer,
    /// Whether the client may act on the sessions of other clients.
    manages: bool,
}

impl Client {
    pub(crate) fn new(number: u64, peer: Peer) -> Client {
        Client {
            number,
            peer,
            manages: false,
        }
    }

    /// Sets whether the client may act on the sessions of other clients.
    pub(crate) fn with_management(self, manages: bool) -> Client {
        Client { manages, ..self }
    }

    /// Returns whether the client may act on the sessions of other clients.
    pub(crate) fn manages(&self) -> bool {
        self.manages
    }

    /// Returns the peer (network origin) of the client.
    pub(crate) fn peer(&self) -> Peer {
        self.peer
    }
}

/// Client or peer whose share of a limited resource a held amount counts for.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Holder {
    /// The resource counts for this connected client.
    Connected(Client),
    /// The client has disconnected. The resource still counts for its peer.
    Disconnected(Client),
    /// The resource counts for no client and no peer.
    Unowned,
}

/// Amounts of a limited resource in use: in total, by one peer, and by one client. A request for more is checked
/// against them.
#[derive(Clone, Copy, Default, Debug)]
pub(crate) struct Usage {
    all: usize,
    of_peer: usize,
    of_client: usize,
}

/// Reason for rejecting a request for more of a limited resource, such as memory.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum QuotaError {
    /// Less of the resource is left for all clients together than the request needs.
    Exhausted,
    /// The client would hold more than its share of the resource.
    ClientShare,
    /// All clients of the peer together would hold more than the share of a peer.
    PeerShare,
}

impl Usage {
    /// Sums up the held amounts (holder and amount of each): in total, by the peer of `client`, and by `client`.
    pub(crate) fn for_client(
        client: Option<Client>,
        held: impl IntoIterator<Item = (Holder, usize)>,
    ) -> Usage {
        let mut taken = Usage::default();
        for (holder, amount) in held {
            let (is, was) = match holder {
                Holder::Connected(owner) => (Some(owner), Some(owner)),
                Holder::Disconnected(owner) => (None, Some(owner)),
                Holder::Unowned => (None, None),
            };
            taken.all += amount;
            if client.is_some() && is == client {
                taken.of_client += amount;
            }
            if client.is_some_and(|c| was.is_some_and(|w| w.peer == c.peer)) {
                taken.of_peer += amount;
            }
        }
        taken
    }

    /// Creates the usage of a resource from the amounts held by all clients, by one peer, and by one of its clients.
    pub(crate) fn new(all: usize, of_peer: usize, of_client: usize) -> Usage {
        Usage {
            all,
            of_peer,
            of_client,
        }
    }

    /// Returns the usage of a resource that is shared by peer only and not by client: the amounts held by all peers and
    /// by one peer.
    pub(crate) fn for_peer(all: usize, of_peer: usize) -> Usage {
        Usage::new(all, of_peer, 0)
    }

    /// Returns an error if `more` of the resource would exceed the total `limit`, the share of the client or that of
    /// its peer.
    pub(crate) fn admit(&self, more: usize, limit: usize) -> Result<(), QuotaError> {
        // Shares are shares of the free amount: one client alone may use much, and later ones still find space
        // (decision 11).
        let free = limit.saturating_sub(self.all);
        let share = |own: usize, times: usize| own + more <= free.saturating_mul(times);
        if more > free {
            return Err(QuotaError::Exhausted);
        }
        match (share(self.of_client, 1), share(self.of_peer, PEER_FACTOR)) {
            (true, true) => Ok(()),
            (false, _) => Err(QuotaError::ClientShare),
            (true, false) => Err(QuotaError::PeerShare),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn client(number: u64, peer: u8) -> Client {
        Client::new(number, Peer::from_ip([10, 0, 0, peer].into()))
    }

    /// Lets the clients take units of 256 in turn until none gets another one. Returns the units of each client.
    fn scramble(clients: &[Client]) -> Vec<usize> {
        let mut has = vec![0; clients.len()];
        loop {
            let before = has.clone();
            for (k, client) in clients.iter().enumerate() {
                let held = clients
                    .iter()
                    .zip(&has)
                    .map(|(c, n)| (Holder::Connected(*c), *n));
                let taken = Usage::for_client(Some(*client), held);
                has[k] += usize::from(taken.admit(1, 256).is_ok());
            }
            if has == before {
                return has;
            }
        }
    }

    #[test]
    fn whoever_is_alone_gets_half_and_others_as_much_as_one_another() {
        assert_eq!(scramble(&[client(1, 1)]), [128]);
        assert_eq!(scramble(&[client(1, 1), client(2, 2)]), [86, 85]);
        let many: Vec<Client> = (0..63).map(|k| client(k, k as u8)).collect();
        assert!(scramble(&many).iter().all(|has| *has == 4));
    }

    #[test]
    fn those_from_one_place_leave_a_quarter() {
        let many: Vec<Client> = (0..32).map(|k| client(k, 1)).collect();
        assert!(scramble(&many).iter().sum::<usize>() <= 192);
    }

    #[test]
    fn what_was_left_behind_counts_for_where_its_owner_came_from() {
        let held = [
            (Holder::Disconnected(client(1, 1)), 190),
            (Holder::Unowned, 2),
        ];
        let same = Usage::for_client(Some(client(2, 1)), held);
        assert_eq!(same.admit(3, 256), Err(QuotaError::PeerShare));
        let other = Usage::for_client(Some(client(3, 2)), held);
        assert_eq!(other.admit(64, 256), Ok(()));
        assert_eq!(other.admit(65, 256), Err(QuotaError::Exhausted));
    }
}
