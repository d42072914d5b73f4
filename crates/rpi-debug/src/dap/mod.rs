//! Debug Adapter Protocol (specification 1.70): the debugger for editors.
//!
//! | file | idea |
//! |---|---|
//! | `messages.rs` | requests, responses and events |
//! | `session.rs` | the requests of a client, and what each does |
//! | `breakpoints.rs` | breakpoints of the client as triggers of the debugger |
//! | `stepping.rs` | forwards and backwards, by cycles and by equations |
//! | `frames.rs` | commands as threads, active fragments as stack frames |
//! | `variables.rs` | flows as variables, and expressions |
//! | `sources.rs` | texts of the program and of the library |

mod breakpoints;
mod frames;
mod messages;
mod session;
mod sources;
mod stepping;
mod variables;

use std::io::{self, BufRead, Write};
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, mpsc};
use std::thread;

use rpi_files::framing::read_message;
use serde_json::Value;

pub(crate) use session::Session;

/// Function that runs the program that the arguments of a `launch` request name, and returns the path of the recording.
pub type Launch<'a> = &'a dyn Fn(&Value) -> Result<PathBuf, String>;

/// Serves a client of the protocol until it disconnects or the input ends.
///
/// # Errors
/// Returns an error if the output cannot be written.
pub fn serve(
    input: impl BufRead + Send + 'static,
    output: impl Write,
    launch: Launch<'_>,
) -> io::Result<()> {
    let interrupt = Arc::new(AtomicUsize::new(0));
    let (arrived, requests) = mpsc::channel();
    let count = Arc::clone(&interrupt);
    thread::Builder::new().spawn(move || read_all(input, &arrived, &count))?;
    let mut session = Session::new(output, launch, interrupt);
    for request in requests {
        if !session.handle(&request)? {
            break;
        }
    }
    Ok(())
}

/// Reads requests until the end of the input. A request to pause or to end interrupts a search at once.
fn read_all(mut input: impl BufRead, to: &mpsc::Sender<Value>, interrupt: &AtomicUsize) {
    while let Ok(Some(body)) = read_message(&mut input) {
        let Ok(request) = serde_json::from_slice::<Value>(&body) else {
            continue;
        };
        if is_interruption(request["command"].as_str()) {
            interrupt.fetch_add(1, Ordering::Relaxed);
        }
        if to.send(request).is_err() {
            return;
        }
    }
    interrupt.fetch_add(1, Ordering::Relaxed);
}

/// Returns whether a request ends the searches before it. It counts from its arrival until it is handled.
fn is_interruption(command: Option<&str>) -> bool {
    matches!(command, Some("pause" | "disconnect" | "terminate"))
}
