//! The server as its clients see it: recorded exchanges, the native interface, who may come in, and that nobody disturbs
//! what runs.

mod chaos;
mod client;
mod exchange;
mod guard;
mod native;
mod nets;
mod order;
