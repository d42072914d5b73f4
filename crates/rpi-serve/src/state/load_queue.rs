//! Queue of load jobs with round-robin scheduling by client, so that no client waits for all jobs of another one. One job
//! of a client runs at a time.

use std::collections::{BTreeMap, VecDeque};
use std::ops::Bound::{Excluded, Unbounded};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

use super::loader::LoadJob;
use crate::fair_share::Client;

/// Queue of load jobs between the server state and the loader threads. Clients with jobs take turns.
pub(crate) struct LoadQueue {
    waiting: Mutex<QueueState>,
    changed: Condvar,
    /// Maximum number of queued jobs of one client.
    max_per_client: usize,
}

#[derive(Default)]
struct QueueState {
    /// Queued jobs by client (`None` for jobs of no client); no queue in the map is empty.
    clients: BTreeMap<Option<Client>, VecDeque<LoadJob>>,
    /// Client of the job that was taken last; the next client in the map has its turn.
    last: Option<Client>,
    /// Running jobs by client.
    running: BTreeMap<Option<Client>, RunningJob>,
    closed: bool,
}

/// Job that a loader thread has taken.
struct RunningJob {
    session: u64,
    /// Set when nobody waits for the job any more.
    cancelled: Arc<AtomicBool>,
}

impl LoadQueue {
    /// Creates an empty queue with at most `most` jobs per client.
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

    /// Adds a job to the queue. Returns false, and does not add it, if its client has the maximum number of queued
    /// jobs.
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

    /// Waits for the next job, of the next client after the latest one without a running job. Returns it with the flag
    /// that cancels it; `None` once the queue is closed. The job runs until [`LoadQueue::finish`].
    pub(super) fn pop(&self) -> Option<(LoadJob, Arc<AtomicBool>)> {
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

    /// Returns the number of queued jobs.
    pub(crate) fn len(&self) -> usize {
        self.waiting().clients.values().map(VecDeque::len).sum()
    }

    /// Marks the running job of a client as done, so that its next one can run.
    pub(super) fn finish(&self, client: Option<Client>) {
        self.waiting().running.remove(&client);
        self.changed.notify_all();
    }

    /// Cancels the running jobs of a session.
    pub(super) fn cancel_session(&self, session: u64) {
        let waiting = self.waiting();
        let running = waiting.running.values();
        running
            .filter(|job| job.session == session)
            .for_each(RunningJob::cancel);
    }

    /// Removes the waiting jobs of a session and returns the numbers of the commands and tasks that they would load.
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

    /// Closes the queue: running jobs are cancelled, and the loader threads end.
    pub(super) fn close(&self) {
        let mut waiting = self.waiting();
        waiting.closed = true;
        waiting.running.values().for_each(RunningJob::cancel);
        drop(waiting);
        self.changed.notify_all();
    }
}

impl RunningJob {
    fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }
}

impl QueueState {
    fn next(&mut self) -> Option<(LoadJob, Arc<AtomicBool>)> {
        // Round robin: a client that loads many commands delays each other client by one command only.
        let later = self.clients.range((Excluded(self.last), Unbounded));
        let mut turns = later.chain(&self.clients).map(|(client, _)| *client);
        let client = turns.find(|client| !self.running.contains_key(client))?;
        self.last = client;
        let own = self.clients.get_mut(&client)?;
        let job = own.pop_front()?;
        if own.is_empty() {
            self.clients.remove(&client);
        }
        let cancelled = Arc::<AtomicBool>::default();
        let running = RunningJob {
            session: job.session,
            cancelled: Arc::clone(&cancelled),
        };
        self.running.insert(client, running);
        Some((job, cancelled))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compile::{CompileKind, CompileRequest, Language, Source};
    use crate::peer::Peer;

    /// Creates a job; each session has its own client.
    fn job(session: u64, number: u64) -> LoadJob {
        LoadJob {
            number,
            session,
            client: Some(Client::new(session, Peer::Local)),
            request: CompileRequest {
                kind: CompileKind::Command,
                source: Source {
                    language: Language::Rpi,
                    text: "".into(),
                    command: None,
                    arm_axes: None,
                    watch: Vec::new(),
                },
                period_ns: 1,
                tick_ns: 1,
            },
            timeout: None,
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
        let order: Vec<u64> = (0..6).map(|_| take(&queue)).collect();
        assert_eq!(order, [10, 20, 30, 11, 21, 12]);
    }

    /// Takes the next job and finishes it at once. Returns its number.
    fn take(queue: &LoadQueue) -> u64 {
        let (job, _) = queue.pop().unwrap();
        queue.finish(job.client);
        job.number
    }

    #[test]
    fn one_job_of_a_client_runs_at_a_time_and_ends_with_its_session() {
        let queue = LoadQueue::new(3);
        for (session, number) in [(1, 10), (1, 11), (2, 20)] {
            assert!(queue.push(job(session, number)));
        }
        let (first, cancelled) = queue.pop().unwrap();
        let (second, other) = queue.pop().unwrap();
        assert_eq!([first.number, second.number], [10, 20]);
        queue.cancel_session(1);
        let flags = [&cancelled, &other].map(|flag| flag.load(Ordering::Relaxed));
        assert_eq!(flags, [true, false]);
        queue.finish(first.client);
        assert_eq!(queue.pop().unwrap().0.number, 11);
        queue.close();
        assert!(other.load(Ordering::Relaxed));
    }

    #[test]
    fn what_is_forgotten_is_not_loaded() {
        let queue = LoadQueue::new(3);
        for (session, number) in [(1, 10), (2, 20), (1, 11)] {
            assert!(queue.push(job(session, number)));
        }
        assert_eq!(queue.remove_session(1), [10, 11]);
        assert_eq!(take(&queue), 20);
        queue.close();
        assert!(queue.pop().is_none());
    }
}
