//! Every recorded net of the corpus is replayed against its trace: nothing may differ.

use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use rpi_diag::FileId;
use rpi_host::replay::{Options, replay};
use rpi_host::trace::Trace;

/// Nets that may still differ: primitives and the table of differences that are on their way.
const NOT_YET: usize = 44;

#[test]
fn every_net_of_the_corpus_agrees_with_its_trace() {
    let Some(corpus) = rpi_testkit::shared_path("nets/corpus") else {
        return;
    };
    let names = names(&corpus);
    assert!(names.len() >= 400, "the corpus has {} nets", names.len());
    let outcomes = in_parallel(&names, |name| outcome(&corpus, name));
    let wrong: Vec<String> = names
        .iter()
        .zip(&outcomes)
        .filter_map(|(name, outcome)| Some(format!("{name}: {}", outcome.as_ref().err()?)))
        .collect();
    assert!(
        wrong.len() <= NOT_YET,
        "{} of {} nets differ\n{}",
        wrong.len(),
        names.len(),
        wrong.join("\n")
    );
}

fn names(corpus: &Path) -> Vec<String> {
    let files = std::fs::read_dir(corpus.join("nets")).unwrap();
    let names = files.map(|f| f.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = names
        .filter_map(|n| Some(n.strip_suffix(".rpinet.gz")?.to_owned()))
        .collect();
    names.sort();
    names
}

/// Replays one net; what differs or why it could not be replayed.
fn outcome(corpus: &Path, name: &str) -> Result<(), String> {
    let text = rpi_testkit::read_maybe_gz(corpus.join(format!("nets/{name}.rpinet.gz"))).unwrap();
    let (net, findings) = rpi_net::rpinet::read(name, FileId(0), &text);
    let messages = || {
        findings
            .iter()
            .map(|f| f.message.as_str())
            .collect::<Vec<_>>()
            .join("; ")
    };
    let net = net.ok_or_else(messages)?;
    let trace = Trace::read(&corpus.join(format!("traces/{name}.trace.gz")));
    let trace = trace.map_err(|e| e.to_string())?;
    let report = replay(&net, &trace, &Options::default()).map_err(|e| e.to_string())?;
    report
        .agrees()
        .then_some(())
        .ok_or_else(|| report.to_string())
}

/// Maps in the order of the input on as many threads as the machine has.
fn in_parallel<T: Sync, R: Send>(items: &[T], f: impl Fn(&T) -> R + Sync) -> Vec<R> {
    let next = AtomicUsize::new(0);
    let done = Mutex::new(Vec::new());
    let threads = std::thread::available_parallelism().map_or(2, |n| n.get());
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                while let Some(k) =
                    Some(next.fetch_add(1, Ordering::Relaxed)).filter(|k| *k < items.len())
                {
                    let result = f(&items[k]);
                    done.lock().unwrap().push((k, result));
                }
            });
        }
    });
    let mut done = done.into_inner().unwrap();
    done.sort_by_key(|(k, _)| *k);
    done.into_iter().map(|(_, r)| r).collect()
}
