//! The DirectIO protocol 2.0 of the reference system: `tag=name(arguments)` over a websocket.
//!
//! Requests are answered by `ok` or `err` under their tag; subscriptions push `ns`, `nc`, `rs`, `st`, `da`, `dr`, `ds` under
//! theirs. Keys of exports are told with `out` before them, keys of inputs with `in`.

mod front;
mod message;
mod parse;
mod sink;

pub(crate) use front::DioFront;
