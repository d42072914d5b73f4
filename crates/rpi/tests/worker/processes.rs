//! Workers as processes: killed from outside, one per client, and their end with the client and the server.

use std::time::{Duration, Instant};

use crate::client::{Scene, assert_loaded, reasons, signal};
use crate::{SHORT, long};

#[test]
fn a_killed_worker_costs_its_client_an_error_and_nobody_else_anything() {
    let scene = Scene::with_workers(|_| {});
    let (mut client, mut other) = (scene.client(), scene.client());
    client.begin_load(&long(100_000), "rpinet");
    let workers = scene.wait_for_workers(1);
    assert_loaded(&other.load(SHORT));
    signal(workers[0], "-KILL");
    let reasons = reasons(&client.receive());
    assert!(
        reasons.contains("RPI9202") && reasons.contains("SIGKILL"),
        "{reasons}"
    );
    assert_loaded(&client.load(SHORT));
    assert_loaded(&other.load(SHORT));
}

#[test]
fn clients_have_one_worker_each_at_a_time() {
    let scene = Scene::with_workers(|_| {});
    let (mut one, mut two) = (scene.client(), scene.client());
    let net = long(30_000);
    for _ in 0..2 {
        one.begin_load(&net, "rpinet");
        two.begin_load(&net, "rpinet");
    }
    scene.wait_for_workers(2);
    let begin = Instant::now();
    while begin.elapsed() < Duration::from_millis(300) {
        assert!(scene.workers().len() <= 2);
    }
    for client in [&mut one, &mut two] {
        assert_loaded(&client.receive());
        assert_loaded(&client.receive());
    }
}

#[test]
fn further_loads_wait_for_a_worker() {
    let scene = Scene::with_workers(|workers| workers.processes = 1);
    let mut clients = [scene.client(), scene.client(), scene.client()];
    for client in &mut clients {
        client.begin_load(&long(10_000), "rpinet");
    }
    scene.wait_for_workers(1);
    for client in &mut clients {
        assert!(scene.workers().len() <= 1);
        assert_loaded(&client.receive());
    }
}

#[test]
fn the_worker_of_a_client_that_leaves_is_killed() {
    let scene = Scene::with_workers(|_| {});
    let (mut client, mut other) = (scene.client(), scene.client());
    client.begin_load(&long(150_000), "rpinet");
    scene.wait_for_workers(1);
    let begin = Instant::now();
    drop(client);
    scene.wait_for_workers(0);
    println!("the worker has ended after {:?}", begin.elapsed());
    assert_loaded(&other.load(SHORT));
}

#[test]
fn workers_end_with_the_server() {
    let mut scene = Scene::with_workers(|_| {});
    let mut client = scene.client();
    client.begin_load(&long(150_000), "rpinet");
    scene.wait_for_workers(1);
    scene.close();
    scene.wait_for_workers(0);
}
