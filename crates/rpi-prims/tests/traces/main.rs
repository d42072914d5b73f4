//! Tests of every primitive against the recorded traces of the reference system. Each node of each recorded net gets
//! the recorded values of its sources and must output the recorded values of its out-ports.

mod bench;
mod compare;
mod compare_outputs;
mod graph;
mod net;
mod params;
mod report;
mod run;
mod text;
mod trace;

use std::path::Path;

rpi_testkit::trap_allocations!();

#[test]
fn every_node_of_every_recorded_net_gives_the_recorded_values() {
    let Some(nets) = rpi_testkit::external_data_path("nets/corpus/nets") else {
        return;
    };
    let mut report = report::Report::default();
    let mut files: Vec<_> = std::fs::read_dir(nets)
        .expect("a folder")
        .map(|e| e.expect("a file").path())
        .collect();
    files.sort();
    for file in &files {
        replay(file, &mut report);
    }
    println!("{report}");
    assert!(report.nets > 400, "the recorded nets are there");
    assert!(report.clean(), "{report}");
}

fn replay(file: &Path, report: &mut report::Report) {
    let id = file
        .file_name()
        .and_then(|n| n.to_str())
        .expect("a name")
        .trim_end_matches(".rpinet.gz");
    let traces = file.with_file_name("../traces");
    let trace = traces.join(format!("{id}.trace.gz"));
    let Ok(trace) = rpi_testkit::read_maybe_gz(&trace) else {
        return;
    };
    let net = rpi_testkit::read_maybe_gz(file).expect("a net");
    let trace = trace::read(&trace);
    report.nets += 1;
    match bench::build(&net::read(&net), &trace) {
        Ok(bench) => run::run(id, bench, &trace, report),
        Err(error) => report.error(format!("{id}: {error}")),
    }
}
