//! The DirectIO protocol 2.0 of the reference system: `tag=name(arguments)` over a websocket.
//!
//! A request is answered by `ok` or `err` with its tag. A subscription pushes `ns`, `nc`, `rs`, `st`, `da`, `dr` and
//! `ds` with its tag. Keys of exports are sent with the prefix `out`, keys of inputs with `in`.

mod connection;
mod message;
mod parse;
mod subscriber;

pub(crate) use connection::DioConnection;
