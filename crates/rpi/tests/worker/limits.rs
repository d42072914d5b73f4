//! Limits of a worker: memory, time, and what it leaves in the server.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

use rpi_testkit::resident_memory_kb;
use serde_json::json;

use crate::client::{Scene, assert_loaded, reasons};
use crate::{SHORT, long};

#[test]
fn a_text_that_needs_too_much_memory_costs_an_error() {
    let scene = Scene::with_workers(|workers| workers.memory_bytes = 96 << 20);
    let mut client = scene.client();
    let reasons = reasons(&client.load(&long(150_000)));
    assert!(
        reasons.contains("RPI9202") && reasons.contains("more than 96 MiB"),
        "{reasons}"
    );
    assert_loaded(&client.load(SHORT));
}

#[test]
fn a_text_that_takes_too_long_costs_an_error() {
    let scene = Scene::with_workers(|workers| workers.timeout = Duration::from_millis(300));
    let mut client = scene.client();
    let begin = Instant::now();
    let reasons = reasons(&client.load(&long(150_000)));
    assert!(
        reasons.contains("RPI9202") && reasons.contains("longer than 0.3 s"),
        "{reasons}"
    );
    assert!(begin.elapsed() < Duration::from_secs(20));
    scene.wait_for_workers(0);
}

/// Compiling takes tens of megabytes, which the server would not give back. The test has a process of its own, because all
/// tests of a process share its memory.
#[test]
fn the_server_does_not_grow_by_compiling() {
    const ALONE: &str = "RPI_TEST_ALONE";
    if std::env::var_os(ALONE).is_none() {
        let test = "limits::the_server_does_not_grow_by_compiling";
        let output = rpi_testkit::run_test_in_process(test, ALONE, "1");
        let text = String::from_utf8_lossy(&output.stdout);
        print!("{text}");
        assert!(output.status.success(), "{text}");
        return;
    }
    let scene = Scene::with_workers(|_| {});
    let mut client = scene.client();
    let net = long(40_000);
    let mut load = || {
        let loaded = client.load(&net);
        assert_loaded(&loaded);
        let command = &loaded["result"]["command"];
        client.call("command.unload", &json!({ "command": command }));
    };
    load();
    let before = resident_memory_kb("VmRSS:");
    (0..4).for_each(|_| load());
    let after = resident_memory_kb("VmRSS:");
    println!("{before} kB resident before, {after} kB after");
    assert!(after < before + 32 * 1024, "{before} kB, then {after} kB");
}

/// The page of a net is compiled by a worker as well.
#[test]
fn the_structure_of_a_net_comes_from_a_worker() {
    let [by_worker, in_process] = [Scene::with_workers(|_| {}), Scene::in_process()].map(|scene| {
        let mut client = scene.client();
        let loaded = client.load(SHORT);
        let name = loaded["result"]["command"].as_str().unwrap();
        let mut stream = TcpStream::connect(scene.address()).unwrap();
        write!(
            stream,
            "GET /nets/{name}/xml HTTP/1.1\r\nHost: localhost\r\n\r\n"
        )
        .unwrap();
        let mut response = String::new();
        stream.read_to_string(&mut response).unwrap();
        // The header has the date.
        let (_, body) = response.split_once("\r\n\r\n").unwrap();
        body.to_owned()
    });
    assert!(by_worker.contains("Core::DoubleMultiply"), "{by_worker}");
    assert_eq!(by_worker, in_process);
}
