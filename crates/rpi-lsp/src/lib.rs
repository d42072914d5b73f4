//! The language server: findings while one writes, names, fixes and the one style, in any editor that speaks the
//! Language Server Protocol (Microsoft, version 3.17).
//!
//! [`serve`] answers one client over two streams of bytes, standard input and output in the tool. One thread does all the
//! work, in the order of the messages, and looks at a program again when its writer pauses for as long as that takes;
//! what is asked meanwhile is answered for the text as it is. This crate knows the protocol and how to say things in it;
//! what a program means it asks of `rpi-driver`.
//!
//! | file | idea |
//! |---|---|
//! | `wire.rs` | bytes and messages |
//! | `server.rs` | the life of the server, and its clock |
//! | `dispatch.rs` | the table of what can be asked, and of what can be told |
//! | `client.rs` | what the client can do, and what we tell it that we can |
//! | `world.rs` | open texts, what is known of them, what has been shown |
//! | `lines.rs`, `uri.rs`, `places.rs` | places in texts, as the protocol counts and names them |
//! | `shelf.rs` | built-in texts as files: the standard library, the pages of findings |
//! | `diagnostics.rs`, `actions.rs` | findings and their fixes |
//! | `hover.rs`, `describe.rs`, `primitive.rs` | what a name means, in words |
//! | `navigate.rs`, `symbols.rs` | where things are |
//! | `completion/` | what could be written here |
//! | `formatting.rs` | the one style |

mod actions;
mod client;
mod completion;
mod describe;
mod diagnostics;
mod dispatch;
mod formatting;
mod hover;
mod lines;
mod navigate;
mod places;
mod primitive;
mod server;
mod shelf;
mod symbols;
mod uri;
mod wire;
mod world;

use std::io::{self, BufRead, Write};
use std::sync::mpsc;
use std::thread;

/// The stack of the thread that works: deep nesting in a program costs stack.
const STACK: usize = 64 << 20;

/// Serves one client until it says `exit` or closes the stream.
///
/// # Errors
/// If the client leaves without having asked to shut down, or the output breaks.
pub fn serve(
    input: impl BufRead + Send + 'static,
    output: impl Write + Send + 'static,
) -> io::Result<()> {
    let (arrive, inbox) = mpsc::channel();
    let (outbox, leave) = mpsc::channel();
    // The reader may wait for a client that says nothing more: nobody waits for the reader.
    thread::Builder::new().spawn(move || wire::read_all(input, &arrive))?;
    let writer = thread::Builder::new().spawn(move || wire::write_all(output, &leave))?;
    let worker = thread::Builder::new().stack_size(STACK);
    let worker = worker.spawn(move || server::run(&inbox, outbox))?;
    let ended = worker.join().unwrap_or(Err("the server broke"));
    let written = writer.join().unwrap_or(Ok(()));
    ended.map_err(io::Error::other).and(written)
}
