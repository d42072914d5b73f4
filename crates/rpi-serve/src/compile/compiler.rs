//! The compiler of the server: in this process or in workers, of which a limited number runs at a time.

use std::sync::atomic::AtomicBool;
use std::sync::{Condvar, Mutex, PoisonError, TryLockError};
use std::time::{Duration, Instant};

use super::request::{CompileKind, CompileRequest, Source};
use super::settings::{CompilerSettings, WorkerSettings};
use super::text::CompileOutput;
use super::worker_error::WorkerError;

/// Compiler of the texts of clients.
pub(crate) struct Compiler {
    /// Settings of the workers; `None` to compile in this process.
    workers: Option<WorkerSettings>,
    /// Number of running workers.
    running: Mutex<usize>,
    freed: Condvar,
    /// Held while a page is compiled, so that pages leave workers for loads.
    page: Mutex<()>,
}

/// Place of a running worker, free again when it is dropped.
struct Place<'a>(&'a Compiler);

impl Compiler {
    /// Creates the compiler.
    pub(crate) fn new(settings: &CompilerSettings) -> Compiler {
        Compiler {
            workers: match settings {
                CompilerSettings::InProcess => None,
                CompilerSettings::Workers(workers) => Some(workers.clone()),
            },
            running: Mutex::new(0),
            freed: Condvar::new(),
            page: Mutex::new(()),
        }
    }

    /// Returns the number of texts that can be compiled at a time.
    pub(crate) fn places(&self) -> usize {
        let workers = self.workers.as_ref();
        workers.map_or(1, |workers| workers.processes.max(1))
    }

    /// Compiles a text. A worker is killed when `cancelled` is set or after `timeout`, if that is shorter than the
    /// timeout of all workers.
    ///
    /// # Errors
    /// All errors of the text, or the one of the worker.
    pub(crate) fn compile(
        &self,
        request: &CompileRequest,
        timeout: Option<Duration>,
        cancelled: &AtomicBool,
    ) -> Result<CompileOutput, Vec<String>> {
        let Some(workers) = &self.workers else {
            return super::text::compile_guarded(request);
        };
        let timeout = timeout.map_or(workers.timeout, |own| own.min(workers.timeout));
        let result = self.compile_in_worker(workers, request, timeout, cancelled);
        result.unwrap_or_else(|why| Err(vec![why.to_string()]))
    }

    /// Returns the structure of the net of a command as XML. One page is compiled at a time.
    ///
    /// # Errors
    /// All errors of the text, or the one of the worker.
    pub(crate) fn structure(
        &self,
        source: Source,
        timeout: Duration,
    ) -> Result<String, Vec<String>> {
        let request = CompileRequest {
            kind: CompileKind::Structure,
            source,
            period_ns: 0,
            tick_ns: 0,
        };
        let busy = || vec![WorkerError::Busy.to_string()];
        let page = self.workers.as_ref().map(|_| self.page.try_lock());
        if matches!(page, Some(Err(TryLockError::WouldBlock))) {
            return Err(busy());
        }
        match self.compile(&request, Some(timeout), &AtomicBool::new(false))? {
            CompileOutput::Structure(page) => Ok(page),
            CompileOutput::Command(_) | CompileOutput::Task(_) => Err(busy()),
        }
    }

    #[cfg(unix)]
    fn compile_in_worker(
        &self,
        workers: &WorkerSettings,
        request: &CompileRequest,
        timeout: Duration,
        cancelled: &AtomicBool,
    ) -> Result<Result<CompileOutput, Vec<String>>, WorkerError> {
        let _place = self.place(timeout)?;
        let deadline = super::process::Deadline { timeout, cancelled };
        let answer = super::process::compile(workers, request, deadline)?;
        answer.verified(request).map_err(WorkerError::Answer)
    }

    #[cfg(not(unix))]
    fn compile_in_worker(
        &self,
        _: &WorkerSettings,
        _: &CompileRequest,
        _: Duration,
        _: &AtomicBool,
    ) -> Result<Result<CompileOutput, Vec<String>>, WorkerError> {
        Err(WorkerError::Io(std::io::ErrorKind::Unsupported.into()))
    }

    /// Waits for the place of a worker.
    fn place(&self, timeout: Duration) -> Result<Place<'_>, WorkerError> {
        let begin = Instant::now();
        let mut running = self.running.lock().unwrap_or_else(PoisonError::into_inner);
        while *running >= self.places() {
            let left = timeout.checked_sub(begin.elapsed());
            let left = left.ok_or(WorkerError::Busy)?;
            let waited = self.freed.wait_timeout(running, left);
            running = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
        *running += 1;
        Ok(Place(self))
    }
}

impl Drop for Place<'_> {
    fn drop(&mut self) {
        let mut running = self
            .0
            .running
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        *running -= 1;
        self.0.freed.notify_one();
    }
}
