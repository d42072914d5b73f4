//! Queue of load jobs with round-robin scheduling by client, so that no client waits for all jobs of another one.

use std::collections::{BTreeMap, VecDeque};
use std::ops::Bound::{Excluded, Unbounded};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

use super::loader::LoadJob;
use crate::fair_share::Client;

/// Queue of load jobs between the server state and the loader thread, in which clients take turns.
pub(super) struct LoadQueue {
    waiting: Mutex<QueueState>,
    changed: Condvar,
    /// Maximum number of queued jobs of one client.
    max_per_client: usize,
}

#[derive(Default)]
struct QueueState {
    /// Queued jobs by client; no queue in the map is empty.
    clients: BTreeMap<Option<Client>, VecDeque<LoadJob>>,
    /// Client of the latest job taken.
    last: Option<Client>,
    closed: bool,
}

impl LoadQueue {
    /// Creates an empty queue with this maximum number of jobs per client.
    pub(super) fn new(most: usize) -> LoadQueue {
        LoadQueue {
            waiting: Mutex::default(),
            changed: Condvar::new(),
            max_per_client: most,
        }
    }

    fn waiting(&self) -> MutexGuard<'_, QueueState> {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Adds a job. Returns false if its client has too many queued jobs.
    pub(super) fn push(&self, job: LoadJob) -> bool {
        let mut waiting = self.waiting();
        let own = waiting.clients.entry(job.client).or_default();
        let room = own.len() < self.max_per_client;
        if room {
            own.push_back(job);
            self.changed.notify_one();
        }
        room
    }

    /// Waits for the next job, of the client after the latest one. Returns `None` once the queue is closed.
    pub(super) fn pop(&self) -> Option<LoadJob> {
        let mut waiting = self.waiting();
        loop {
            if waiting.closed {
                return None;
            }
            if let Some(job) = waiting.next() {
                return Some(job);
            }
            let woken = self.changed.wait(waiting);
            waiting = woken.unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Removes the jobs of a session and returns their command or task numbers.
    pub(super) fn remove_session(&self, session: u64) -> Vec<u64> {
        let is_own = |job: &LoadJob| job.session == session;
        let mut waiting = self.waiting();
        let own = waiting.clients.values().flatten();
        let numbers = own.filter(|job| is_own(job)).map(|job| job.number);
        let numbers = numbers.collect();
        waiting.clients.retain(|_, jobs| {
            jobs.retain(|job| !is_own(job));
            !jobs.is_empty()
        });
        numbers
    }

    /// Closes the queue: the loader thread ends.
    pub(super) fn close(&self) {
        self.waiting().closed = true;
        self.changed.notify_all();
    }
}

impl QueueState {
    fn next(&mut self) -> Option<LoadJob> {
        // Round robin: a client that loads many commands delays each other client by one command only.
        let mut later = self.clients.range((Excluded(self.last), Unbounded));
        let next = later.next().or_else(|| self.clients.iter().next());
        let client = *next?.0;
        self.last = client;
        let own = self.clients.get_mut(&client)?;
        let job = own.pop_front();
        if own.is_empty() {
            self.clients.remove(&client);
        }
        job
    }
}

#[cfg(test)]
mod tests {
    use super::super::loader::{JobKind, Language, Source};
    use super::*;
    use crate::peer::Peer;

    /// Creates a job; each session has its own client.
    fn job(session: u64, number: u64) -> LoadJob {
        LoadJob {
            kind: JobKind::Command,
            number,
            session,
            client: Some(Client::new(session, Peer::Local)),
            origin: Source {
                language: Language::Rpi,
                text: "".into(),
                command: None,
            },
            period_ns: 1,
            tick_ns: 1,
            on_overrun: rpi_core::CommandOverrunPolicy::Count,
        }
    }

    #[test]
    fn clients_take_turns_however_much_one_of_them_wants() {
        let queue = LoadQueue::new(3);
        let put = [
            (1, 10),
            (1, 11),
            (1, 12),
            (1, 13),
            (2, 20),
            (3, 30),
            (2, 21),
        ];
        let taken = put.map(|(session, number)| queue.push(job(session, number)));
        assert_eq!(taken, [true, true, true, false, true, true, true]);
        let order: Vec<u64> = (0..6).map(|_| queue.pop().unwrap().number).collect();
        assert_eq!(order, [10, 20, 30, 11, 21, 12]);
    }

    #[test]
    fn what_is_forgotten_is_not_loaded() {
        let queue = LoadQueue::new(3);
        for (session, number) in [(1, 10), (2, 20), (1, 11)] {
            assert!(queue.push(job(session, number)));
        }
        assert_eq!(queue.remove_session(1), [10, 11]);
        assert_eq!(queue.pop().unwrap().number, 20);
        queue.close();
        assert!(queue.pop().is_none());
    }
}
