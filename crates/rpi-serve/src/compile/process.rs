//! A worker process as the server sees it: start, exchange of request and answer, end.

use std::io::{self, Read, Write};
use std::os::fd::AsFd;
use std::os::unix::process::ExitStatusExt;
use std::process::{Child, ChildStdin, ChildStdout, Command, ExitStatus, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::{OFlags, fcntl_getfl, fcntl_setfl};
use rustix::process::Signal;

use super::answer::{Answer, AnswerError};
use super::frame::{self, FrameLimits, HEADER_BYTES};
use super::request::CompileRequest;
use super::settings::WorkerSettings;
use super::worker_error::WorkerError;

/// Largest answer of a worker in bytes. All answers together must fit into the memory of the server.
const MAX_ANSWER: u64 = 32 << 20;
/// Interval at which the end of the client is checked while a worker runs.
const CHECK_INTERVAL: Duration = Duration::from_millis(10);
/// Time until a worker that has closed its output ends.
const EXIT_TIMEOUT: Duration = Duration::from_secs(1);
/// Signal of a process that cannot allocate memory: it aborts.
const SIGABRT: i32 = Signal::ABORT.as_raw();
/// Signal at the limit of the processor time.
const SIGXCPU: i32 = Signal::XCPU.as_raw();

/// Time limit of an exchange, and its cancellation.
#[derive(Clone, Copy)]
pub(super) struct Deadline<'a> {
    /// Time from the start of the worker until it is killed.
    pub(super) timeout: Duration,
    /// Set when nobody waits for the answer any more.
    pub(super) cancelled: &'a AtomicBool,
}

/// A running worker. Dropping it kills it.
struct Worker(Child);

/// Compiles a text in a worker process.
///
/// # Errors
/// If the worker fails, exceeds a limit, or gives an invalid answer.
pub(super) fn compile(
    settings: &WorkerSettings,
    request: &CompileRequest,
    deadline: Deadline<'_>,
) -> Result<Answer, WorkerError> {
    let limits = FrameLimits {
        memory_bytes: settings.memory_bytes,
        cpu_seconds: deadline.timeout.as_secs().saturating_add(2),
        server: std::process::id(),
    };
    let begin = Instant::now();
    let mut worker = Worker::start(settings).map_err(WorkerError::Io)?;
    let exchange = Exchange::new(&mut worker.0, frame::frame(limits, request))?;
    match exchange.run(begin, deadline)? {
        Some(bytes) => frame::content(&bytes[HEADER_BYTES..])
            .map_err(|why| WorkerError::Answer(AnswerError::Read(why))),
        None => Err(worker.end_error(settings, deadline.timeout)),
    }
}

impl Worker {
    fn start(settings: &WorkerSettings) -> io::Result<Worker> {
        let child = Command::new(&settings.program)
            .args(&settings.arguments)
            // The compiler reads no variables, and those of the server may contain secrets.
            .env_clear()
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()?;
        Ok(Worker(child))
    }

    /// Returns the error for a worker that has closed its output without an answer.
    fn end_error(&mut self, settings: &WorkerSettings, timeout: Duration) -> WorkerError {
        match self.exit_status() {
            None => WorkerError::Ended("it still runs".to_owned()),
            Some(status) => match status.signal() {
                // An allocation that fails aborts the process, as an overflow of the stack does.
                Some(SIGABRT) => WorkerError::Memory(settings.memory_bytes),
                Some(SIGXCPU) => WorkerError::Timeout(timeout),
                _ => WorkerError::Ended(status.to_string()),
            },
        }
    }

    fn exit_status(&mut self) -> Option<ExitStatus> {
        let begin = Instant::now();
        while begin.elapsed() < EXIT_TIMEOUT {
            if let Ok(Some(status)) = self.0.try_wait() {
                return Some(status);
            }
            std::thread::sleep(CHECK_INTERVAL);
        }
        None
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        // Both fail only if the process has ended and was waited for.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Exchange of a request and an answer over pipes that never block.
struct Exchange {
    /// Pipe to the worker, until the request is written.
    input: Option<ChildStdin>,
    output: ChildStdout,
    request: Vec<u8>,
    /// Number of bytes of the request that are written.
    written: usize,
    received: Vec<u8>,
}

impl Exchange {
    fn new(child: &mut Child, request: Vec<u8>) -> Result<Exchange, WorkerError> {
        let pipes = child.stdin.take().zip(child.stdout.take());
        let (input, output) = pipes.ok_or_else(|| WorkerError::Io(io::ErrorKind::Other.into()))?;
        set_nonblocking(&input)
            .and_then(|()| set_nonblocking(&output))
            .map_err(|why| WorkerError::Io(why.into()))?;
        Ok(Exchange {
            input: Some(input),
            output,
            request,
            written: 0,
            received: Vec::new(),
        })
    }

    /// Writes the request and reads the answer. Returns its frame; `None` if the worker closes its output before.
    fn run(
        mut self,
        begin: Instant,
        deadline: Deadline<'_>,
    ) -> Result<Option<Vec<u8>>, WorkerError> {
        loop {
            if deadline.cancelled.load(Ordering::Relaxed) {
                return Err(WorkerError::Cancelled);
            }
            if begin.elapsed() >= deadline.timeout {
                return Err(WorkerError::Timeout(deadline.timeout));
            }
            self.wait().map_err(WorkerError::Io)?;
            self.write();
            let ended = self.read().map_err(WorkerError::Io)?;
            if self.is_complete()? {
                return Ok(Some(self.received));
            }
            if ended {
                return Ok(None);
            }
        }
    }

    /// Waits until a pipe is ready, for a short time.
    fn wait(&self) -> io::Result<()> {
        let mut pipes = vec![PollFd::new(&self.output, PollFlags::IN)];
        let input = self.input.as_ref();
        pipes.extend(input.map(|input| PollFd::new(input, PollFlags::OUT)));
        let interval = Timespec::try_from(CHECK_INTERVAL).map_err(io::Error::other)?;
        match poll(&mut pipes, Some(&interval)) {
            Ok(_) | Err(rustix::io::Errno::INTR) => Ok(()),
            Err(why) => Err(why.into()),
        }
    }

    /// Writes as much of the request as the pipe takes. A worker that does not read it ends for another reason, which
    /// is reported.
    fn write(&mut self) {
        let Some(input) = &mut self.input else {
            return;
        };
        let left = &self.request[self.written..];
        match input.write(left) {
            Ok(count) => self.written += count,
            Err(why) if would_block(&why) => {}
            Err(_) => self.written = self.request.len(),
        }
        if self.written == self.request.len() {
            (self.input, self.request) = (None, Vec::new());
            self.written = 0;
        }
    }

    /// Reads what the pipe has. Returns whether the worker has closed it.
    fn read(&mut self) -> io::Result<bool> {
        let mut chunk = [0; 1 << 16];
        match self.output.read(&mut chunk) {
            Ok(0) => Ok(true),
            Ok(count) => {
                self.received.extend_from_slice(&chunk[..count]);
                Ok(false)
            }
            Err(why) if would_block(&why) => Ok(false),
            Err(why) => Err(why),
        }
    }

    /// Returns whether the whole frame was received.
    fn is_complete(&self) -> Result<bool, WorkerError> {
        let Some(head) = self.received.get(..HEADER_BYTES) else {
            return Ok(false);
        };
        let (_, length) =
            frame::head(head).map_err(|_| WorkerError::Answer(AnswerError::NotAnAnswer))?;
        if length > MAX_ANSWER {
            return Err(WorkerError::Answer(AnswerError::TooLong(MAX_ANSWER)));
        }
        let whole = (HEADER_BYTES as u64).saturating_add(length);
        Ok(self.received.len() as u64 >= whole)
    }
}

fn set_nonblocking(pipe: impl AsFd) -> rustix::io::Result<()> {
    fcntl_setfl(&pipe, fcntl_getfl(&pipe)? | OFlags::NONBLOCK)
}

fn would_block(why: &io::Error) -> bool {
    matches!(
        why.kind(),
        io::ErrorKind::WouldBlock | io::ErrorKind::Interrupted
    )
}
