//! Replays the recorded nets of the corpus, which is stored outside the repository. No value may differ, and changed
//! values must be detected.

mod nets;
mod parallel;

use nets::RecordedNet;
use parallel::in_parallel;
use rpi_record::trace::Trace;
use rpi_replay::trace_compare::{Options, replay};

#[test]
fn every_net_of_the_corpus_agrees_with_its_trace() {
    let Some(corpus) = rpi_testkit::external_data_path("nets/corpus") else {
        return;
    };
    let nets = nets::corpus_nets(&corpus);
    assert!(nets.len() >= 400, "the corpus has {} nets", nets.len());
    none_wrong(&nets, in_parallel(&nets, agrees));
}

/// Replays traces that join set-points of every cycle with all ports of a few cycles.
#[test]
fn recorded_set_points_agree() {
    let Some(folder) = rpi_testkit::external_data_path("nets/traces") else {
        return;
    };
    let nets = nets::set_point_nets(&folder);
    assert!(nets.len() >= 10, "there are {} nets", nets.len());
    none_wrong(&nets, in_parallel(&nets, agrees));
}

/// Checks that a replay detects differences: one value is changed in each trace.
#[test]
fn a_changed_value_is_found_in_every_net() {
    let Some(corpus) = rpi_testkit::external_data_path("nets/corpus") else {
        return;
    };
    let nets = nets::corpus_nets(&corpus);
    let outcomes = in_parallel(&nets, |net| {
        let computed = net.last_computed_real();
        computed.map_or(Ok(false), |row| finds(net, &row).map(|()| true))
    });
    let changed = outcomes.iter().filter(|o| **o == Ok(true)).count();
    assert!(changed > 300, "only {changed} nets compute a real");
    none_wrong(&nets, outcomes.into_iter().map(|o| o.map(|_| ())).collect());
}

fn agrees(recorded: &RecordedNet) -> Result<(), String> {
    let net = recorded.net()?;
    let report = replay(&net, &recorded.trace()?, &Options::default());
    let report = report.map_err(|e| e.to_string())?;
    if report.agrees() {
        Ok(())
    } else {
        Err(report.to_string())
    }
}

fn finds(recorded: &RecordedNet, row: &str) -> Result<(), String> {
    let changed = recorded.text.replace(row, &nets::changed(row));
    let trace = Trace::parse(&changed).map_err(|e| e.to_string())?;
    let report = replay(&recorded.net()?, &trace, &Options::default());
    match report.map_err(|e| e.to_string())?.differing {
        0 => Err(format!("the change of `{}` was not found", row.trim())),
        _ => Ok(()),
    }
}

fn none_wrong(nets: &[RecordedNet], outcomes: Vec<Result<(), String>>) {
    let all = nets.iter().zip(&outcomes);
    let wrong: Vec<String> = all
        .filter_map(|(net, o)| Some(format!("{}: {}", net.name, o.as_ref().err()?)))
        .collect();
    let (few, many) = (wrong.len(), nets.len());
    assert!(
        wrong.is_empty(),
        "{few} of {many} nets\n{}",
        wrong.join("\n")
    );
}
