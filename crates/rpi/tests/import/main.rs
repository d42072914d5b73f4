//! Recorded nets, written as programs, formatted and compiled again, do what they did.

mod constant;
mod nets;
mod replay;
mod trip;

use nets::{below, in_parallel, none_wrong};

/// Every recorded value that the program computes, compared as `rpi replay` does.
#[test]
fn programs_of_the_corpus_agree_with_the_traces_of_their_nets() {
    let nets = below("corpus/nets");
    none_wrong(&nets, in_parallel(&nets, |net| replay::agrees(net)));
}
