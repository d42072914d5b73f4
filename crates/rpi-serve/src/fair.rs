//! How places that are there once for all clients are shared: nobody can take them all, however many others there are.
//!
//! A client has no more of something than is free for others, and those from one place together no more than three times that. So
//! whoever is alone gets half of it, two get a third each, and something is left for whoever comes next (Choudhury and Hahne 1998, on
//! buffers that ports of a switch share; see ADR 0011).

use crate::peer::Peer;

/// How much more than what is free all clients from one place may have together.
const OF_PEER: usize = 3;

/// A connection.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) struct Client {
    number: u64,
    peer: Peer,
}

impl Client {
    pub(crate) fn new(number: u64, peer: Peer) -> Client {
        Client { number, peer }
    }

    /// Where it comes from.
    pub(crate) fn peer(&self) -> Peer {
        self.peer
    }
}

/// Whose something is.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Holder {
    /// A client that is there.
    Is(Client),
    /// One that is gone: it counts for where it came from.
    Was(Client),
    /// Nobody's in particular.
    Nobody,
}

/// How much of something is taken, as somebody sees it who wants more.
#[derive(Clone, Copy, Default, Debug)]
pub(crate) struct Taken {
    all: usize,
    of_peer: usize,
    of_client: usize,
}

/// Why somebody gets no more.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Full {
    /// There is not so much left.
    All,
    /// It would be more than its share.
    Share,
    /// It would be more than the share of all that come from where it does.
    Place,
}

impl Taken {
    /// What these have, as this one sees it.
    pub(crate) fn by(
        client: Option<Client>,
        held: impl IntoIterator<Item = (Holder, usize)>,
    ) -> Taken {
        let mut taken = Taken::default();
        for (holder, amount) in held {
            let (is, was) = match holder {
                Holder::Is(owner) => (Some(owner), Some(owner)),
                Holder::Was(owner) => (None, Some(owner)),
                Holder::Nobody => (None, None),
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

    /// Of places that only where one comes from counts for.
    pub(crate) fn by_peer(all: usize, of_peer: usize) -> Taken {
        Taken {
            all,
            of_peer,
            of_client: 0,
        }
    }

    /// Fails if so much more is too much.
    pub(crate) fn admit(&self, more: usize, limit: usize) -> Result<(), Full> {
        let free = limit.saturating_sub(self.all);
        let share = |own: usize, times: usize| own + more <= free.saturating_mul(times);
        if more > free {
            return Err(Full::All);
        }
        match (share(self.of_client, 1), share(self.of_peer, OF_PEER)) {
            (true, true) => Ok(()),
            (false, _) => Err(Full::Share),
            (true, false) => Err(Full::Place),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn client(number: u64, peer: u8) -> Client {
        Client::new(number, Peer::of([10, 0, 0, peer].into()))
    }

    /// Lets these clients take places of 256, in turns, until none gets another one.
    fn scramble(clients: &[Client]) -> Vec<usize> {
        let mut has = vec![0; clients.len()];
        loop {
            let before = has.clone();
            for (k, client) in clients.iter().enumerate() {
                let held = clients.iter().zip(&has).map(|(c, n)| (Holder::Is(*c), *n));
                let taken = Taken::by(Some(*client), held);
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
        let held = [(Holder::Was(client(1, 1)), 190), (Holder::Nobody, 2)];
        let same = Taken::by(Some(client(2, 1)), held);
        assert_eq!(same.admit(3, 256), Err(Full::Place));
        let other = Taken::by(Some(client(3, 2)), held);
        assert_eq!(other.admit(64, 256), Ok(()));
        assert_eq!(other.admit(65, 256), Err(Full::All));
    }
}
