//! The server as its clients see it: recorded exchanges, the native interface, who may come in, and that nobody disturbs
//! what runs.

mod client;
mod deaf;
mod evals;
mod excess;
mod exchange;
mod guard;
mod limits;
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
