//! Every recorded net of the corpus is replayed against its trace: nothing may differ.

use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use rpi_diag::FileId;
use rpi_host::replay::{Options, Report, replay};
use rpi_host::trace::Trace;

/// What came out for one net.
enum Outcome {
    Agrees(Report),
    Differs(Report),
    /// The net or its trace could not be read, with the reason.
    Failed(String),
}

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
        .filter_map(|(name, outcome)| match outcome {
            Outcome::Agrees(_) => None,
            Outcome::Differs(report) => Some(format!("{name}: {report}")),
            Outcome::Failed(reason) => Some(format!("{name}: {reason}")),
        })
        .collect();
    assert!(
        wrong.is_empty(),
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

fn outcome(corpus: &Path, name: &str) -> Outcome {
    let text = rpi_testkit::read_maybe_gz(corpus.join(format!("nets/{name}.rpinet.gz"))).unwrap();
    let (net, findings) = rpi_net::rpinet::read(name, FileId(0), &text);
    let Some(net) = net else {
        let messages: Vec<&str> = findings.iter().map(|f| f.message.as_str()).collect();
        return Outcome::Failed(messages.join("; "));
    };
    let path: PathBuf = corpus.join(format!("traces/{name}.trace.gz"));
    let trace = match Trace::read(&path) {
        Ok(trace) => trace,
        Err(error) => return Outcome::Failed(error.to_string()),
    };
    match replay(&net, &trace, &Options::default()) {
        Ok(report) if report.agrees() => Outcome::Agrees(report),
        Ok(report) => Outcome::Differs(report),
        Err(error) => Outcome::Failed(error.to_string()),
    }
}

/// Maps in the order of the input on as many threads as the machine has.
fn in_parallel<T: Sync, R: Send>(items: &[T], f: impl Fn(&T) -> R + Sync) -> Vec<R> {
    let next = AtomicUsize::new(0);
    let done = Mutex::new(Vec::new());
    let threads = std::thread::available_parallelism().map_or(2, |n| n.get());
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                while let Some(k) = Some(next.fetch_add(1, Ordering::Relaxed)).filter(|k| *k < items.len()) {
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
