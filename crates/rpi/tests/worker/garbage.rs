//! Workers that are no workers: their output is untrusted input.

use std::time::Duration;

use crate::SHORT;
use crate::client::{Scene, reasons};

/// Returns the error of a load by a worker that is this shell script.
fn error_of(script: &str) -> String {
    let scene = Scene::with_workers(|workers| {
        workers.program = "/bin/sh".into();
        workers.arguments = vec!["-c".into(), script.into()];
        workers.timeout = Duration::from_secs(2);
    });
    let mut client = scene.client();
    let error = reasons(&client.load(SHORT));
    // The server goes on.
    assert_eq!(
        client.call("ping", &serde_json::json!({}))["id"],
        1,
        "{error}"
    );
    error
}

#[test]
fn a_worker_that_answers_garbage_costs_an_error() {
    for (script, expected) in [
        ("cat > /dev/null", "exit status: 0"),
        ("exit 7", "exit status: 7"),
        ("kill -SEGV $$", "SIGSEGV"),
        ("kill -ABRT $$", "more than 1024 MiB"),
        ("yes", "does not begin as an answer"),
        // An echo of the request begins as an answer does.
        ("cat", "invalid answer"),
        ("exec sleep 1000", "longer than 2 s"),
        // The pipe stays open in a process that the server does not know.
        ("sleep 3 & exit 3", "longer than 2 s"),
        ("exec 1>&-; exec sleep 1000", "still runs"),
        ("head -c 1000 /dev/zero; exec sleep 1000", "does not begin"),
    ] {
        let error = error_of(script);
        assert!(
            error.contains("RPI9202") && error.contains(expected),
            "{script}: {error}"
        );
    }
}

#[test]
fn a_worker_that_cannot_be_started_costs_an_error() {
    let scene = Scene::with_workers(|workers| workers.program = "/nowhere/rpi".into());
    let error = reasons(&scene.client().load(SHORT));
    assert!(error.contains("cannot be started"), "{error}");
}
