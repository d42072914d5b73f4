//! Recordings that are made from other recordings: a part of one (`cut`), or several together (`merge`).
//!
//! Both read the files record by record, so that recordings of any length need the memory of a chunk.

mod channels;
mod cut;
mod cut_selection;
mod cut_window;
mod merge;
mod message_reader;

pub use cut::{CutRecording, cut};
pub use merge::{MergedRecording, TimeAxis, merge};
