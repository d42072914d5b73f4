//! The server as an editor meets it: messages in, messages out, over pipes.

mod completion;
mod findings;
mod life;
mod names;
mod prefixes;
mod support;
