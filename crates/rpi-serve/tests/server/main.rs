//! Tests of the server through its protocols: recorded exchanges, the native interface, authentication, limits and
//! isolation of clients.

mod auth;
mod cancel;
mod client;
mod cycle_share;
mod evals;
mod exchange;
mod foxglove;
mod hostile_http;
mod json_rpc;
mod limits;
mod methods;
mod metrics;
mod multiplied;
mod native;
mod nets;
mod operator;
mod order;
mod overruns;
mod owners;
#[cfg(unix)]
mod places;
mod recording;
mod request_limits;
mod roles;
mod rules;
mod safe_outputs;
mod slow_reader;
mod updates;
mod watched_flows;
