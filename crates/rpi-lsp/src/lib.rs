//! Language server: diagnostics, hover, navigation, completion, fixes and formatting for any editor that supports the
//! Language Server Protocol (Microsoft, version 3.17).
//!
//! [`serve`] serves one client over two byte streams (standard input and output in the tool). A single worker thread
//! handles the messages in order. It analyses a program again when the user pauses for as long as the last analysis
//! took. A request in the meantime triggers the analysis of the current text. This crate implements the protocol; the
//! analysis of programs is done by `rpi-driver`.
//!
//! | file | content |
//! |---|---|
//! | `framing.rs` | message framing and JSON-RPC |
//! | `server.rs` | lifecycle of the server, and scheduling of analyses |
//! | `dispatch.rs` | tables of the supported requests and notifications |
//! | `capabilities.rs` | capabilities of client and server |
//! | `workspace.rs` | open documents, their analyses and published diagnostics |
//! | `line_index.rs`, `uri.rs`, `locations.rs` | conversion of spans and paths to positions and URIs |
//! | `builtin_documents.rs` | built-in texts as files: the standard library, the pages of diagnostic codes |
//! | `diagnostics.rs`, `code_actions.rs` | diagnostics and their fixes |
//! | `hover.rs`, `description.rs`, `primitive.rs` | descriptions of names and expressions |
//! | `navigation.rs`, `symbols.rs` | definitions, references, outline |
//! | `completion/` | completion |
//! | `formatting.rs` | formatting |

mod builtin_documents;
mod capabilities;
mod code_actions;
mod completion;
mod description;
mod diagnostics;
mod dispatch;
mod formatting;
mod framing;
mod hover;
mod line_index;
mod locations;
mod navigation;
mod primitive;
mod server;
mod symbols;
mod uri;
mod workspace;

use std::io::{self, BufRead, Write};
use std::sync::mpsc;
use std::thread;

/// Stack size in bytes of the thread that handles messages: 64 MiB. Deeply nested programs need much stack.
const STACK: usize = 64 << 20;

/// Serves one client over two byte streams until the client sends `exit` or closes the input.
///
/// # Errors
/// Returns an error if the client disconnects without a `shutdown` request, or if writing fails.
pub fn serve(
    input: impl BufRead + Send + 'static,
    output: impl Write + Send + 'static,
) -> io::Result<()> {
    let (arrive, inbox) = mpsc::channel();
    let (outbox, leave) = mpsc::channel();
    // The reader thread is not joined: it may block for ever on a client that keeps its stream open after `exit`.
    thread::Builder::new().spawn(move || framing::read_all(input, &arrive))?;
    let writer = thread::Builder::new().spawn(move || framing::write_all(output, &leave))?;
    let worker = thread::Builder::new().stack_size(STACK);
    let worker = worker.spawn(move || server::run(&inbox, outbox))?;
    let ended = worker.join().unwrap_or(Err("the server thread panicked"));
    let written = writer.join().unwrap_or(Ok(()));
    ended.map_err(io::Error::other).and(written)
}
