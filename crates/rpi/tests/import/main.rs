//! Recorded nets, imported as programs, formatted and compiled again, behave as before; and programs exported as nets.

mod bank;
mod constant;
mod export;
mod nets;
mod replay;
mod round_trip;
mod run;

use std::path::PathBuf;

use nets::{below, in_parallel, none_wrong};

/// Every recorded value that the program computes is compared, as `rpi replay` does.
#[test]
fn programs_of_the_corpus_agree_with_the_traces_of_their_nets() {
    let nets = below("corpus/nets");
    none_wrong(&nets, in_parallel(&nets, |net| replay::agrees(net)));
}

/// Nets without traces are run beside their programs.
#[test]
fn programs_of_the_first_generation_move_the_arms_as_their_nets_do() {
    move_the_arms_alike(&below("v1"));
}

#[test]
fn programs_of_the_second_generation_move_the_arms_as_their_nets_do() {
    move_the_arms_alike(&below("v2"));
}

fn move_the_arms_alike(nets: &[PathBuf]) {
    let outcomes = in_parallel(nets, |net| run::behaves_alike(net));
    let moving = outcomes.iter().filter(|o| **o == Ok(true)).count();
    none_wrong(nets, outcomes.into_iter().map(|o| o.map(|_| ())).collect());
    // Some nets wait for an external input before they move anything.
    assert!(2 * moving >= nets.len(), "only {moving} nets moved an arm");
}

/// Rule M10.6.
#[test]
fn programs_of_the_examples_come_back_from_their_nets() {
    let mut programs = rpi_testkit::files_below("examples", &[".rpi"]);
    // A net is made of a command; other examples have only nodes and tests.
    programs.retain(|path| {
        let text = std::fs::read_to_string(path).expect("it is text");
        text.contains("\ncommand ")
    });
    none_wrong(
        &programs,
        in_parallel(&programs, |path| export::come_back(path)),
    );
}
