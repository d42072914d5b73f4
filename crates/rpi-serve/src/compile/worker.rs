//! The worker process: compiles one text.

use std::io::{self, Write};

use super::answer::Answer;
use super::confinement;
use super::frame::{self, FrameLimits};
use super::text;

/// Serves as the worker process of a server: reads a request from standard input, applies its limits to this process,
/// compiles the text and writes the answer to standard output. The process must not have other threads.
///
/// # Errors
/// If standard input has no request, the system refuses a limit, or the answer cannot be written.
pub fn run_compile_worker() -> io::Result<()> {
    let mut input = io::stdin().lock();
    let (limits, length) = frame::read_head(&mut input)?;
    confinement::apply(limits)?;
    let request = frame::read_content(&mut input, length)?;
    let answer = Answer::from_result(text::compile_guarded(&request));
    let mut output = io::stdout().lock();
    output.write_all(&frame::frame(FrameLimits::default(), &answer))?;
    output.flush()
}
