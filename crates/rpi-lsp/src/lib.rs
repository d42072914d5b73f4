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
//! | `server.rs`, `cancellation.rs`, `progress.rs` | lifecycle of the server, scheduling of analyses, cancelled requests, progress |
//! | `dispatch.rs`, `notifications.rs` | tables of the supported requests and notifications |
//! | `capabilities.rs`, `settings.rs` | capabilities of client and server, settings of the user |
//! | `workspace.rs` | open documents, their analyses and published diagnostics |
//! | `programs.rs` | programs of the project, also closed ones |
//! | `line_index.rs`, `uri.rs`, `locations.rs` | conversion of spans and paths to positions and URIs |
//! | `builtin_documents.rs` | built-in texts as files: the standard library, the pages of diagnostic codes |
//! | `diagnostics.rs`, `pull_diagnostics.rs` | diagnostics, published or requested |
//! | `code_actions.rs`, `workspace_edit.rs` | fixes of diagnostics, edits of several files |
//! | `refactor/` | refactorings |
//! | `hover.rs`, `description.rs`, `primitive.rs` | descriptions of names and expressions |
//! | `signature_help.rs`, `inlay_hints.rs` | parameters of a call, inferred types |
//! | `navigation.rs`, `references.rs`, `highlights.rs`, `call_hierarchy.rs` | definitions and uses of names |
//! | `symbols.rs`, `workspace_symbols.rs`, `code_lenses.rs`, `document_links.rs` | outlines, lenses, links |
//! | `rename/`, `linked_editing.rs` | renaming |
//! | `semantic_tokens.rs` | colours by meaning |
//! | `syntax_ranges.rs`, `folding.rs`, `selection_ranges.rs` | ranges of the syntax tree |
//! | `cursor_tokens.rs`, `completion/` | the text before the cursor, completion |
//! | `formatting.rs`, `on_type_formatting.rs` | formatting, indentation while typing |

mod builtin_documents;
mod call_hierarchy;
mod cancellation;
mod capabilities;
mod code_actions;
mod code_lenses;
mod completion;
mod cursor_tokens;
mod description;
mod diagnostics;
mod dispatch;
mod document_links;
mod folding;
mod formatting;
mod framing;
mod highlights;
mod hover;
mod inlay_hints;
mod line_index;
mod linked_editing;
mod locations;
mod navigation;
mod notifications;
mod on_type_formatting;
mod primitive;
mod programs;
mod progress;
mod pull_diagnostics;
mod refactor;
mod references;
mod rename;
mod selection_ranges;
mod semantic_tokens;
mod server;
mod settings;
mod signature_help;
mod symbols;
mod syntax_ranges;
mod uri;
mod workspace;
mod workspace_edit;
mod workspace_symbols;

use std::io::{self, BufRead, Write};
use std::sync::mpsc;
use std::thread;

use cancellation::Cancellations;

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
    let cancellations = Cancellations::default();
    let recorded = cancellations.clone();
    thread::Builder::new().spawn(move || framing::read_all(input, &arrive, &recorded))?;
    let writer = thread::Builder::new().spawn(move || framing::write_all(output, &leave))?;
    let worker = thread::Builder::new().stack_size(STACK);
    let worker = worker.spawn(move || server::run(&inbox, outbox, cancellations))?;
    let ended = worker.join().unwrap_or(Err("the server thread panicked"));
    let written = writer.join().unwrap_or(Ok(()));
    ended.map_err(io::Error::other).and(written)
}
