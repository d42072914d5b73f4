//! Tests of the server through its protocols: recorded exchanges, the native interface, authentication, limits and
//! isolation of clients.

mod client;
mod deaf;
mod evals;
mod excess;
mod exchange;
mod guard;
mod limits;
mod methods;
mod native;
mod nets;
mod order;
mod overruns;
mod owners;
mod recording;
mod rules;
mod share;
mod spec;
mod told;
