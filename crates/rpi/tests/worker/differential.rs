//! The same texts give the same results in the process of the server and in workers.

use std::path::Path;
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use crate::client::{Client, Scene};

/// Returns what clients see of the commands and tasks of a text: errors, or the description of the loaded object.
fn results(client: &mut Client, text: &str, language: &str) -> Vec<Value> {
    if language == "rpinet" {
        let loaded = client.load(text);
        return vec![description(client, "command", &loaded)];
    }
    let mut results = Vec::new();
    for kind in ["command", "task"] {
        let only = client.load_named(kind, text, None);
        let names = choices(&only);
        results.push(description(client, kind, &only));
        for name in names {
            let loaded = client.load_named(kind, text, Some(&name));
            results.push(description(client, kind, &loaded));
        }
    }
    results
}

/// Returns the names between which a client must choose.
fn choices(answer: &Value) -> Vec<String> {
    let message = answer["error"]["message"].as_str().unwrap_or_default();
    let names = message
        .split_once("choose one of: ")
        .map(|(_, names)| names);
    let names = names.into_iter().flat_map(|names| names.split(", "));
    names.map(str::to_owned).collect()
}

/// Describes a loaded object and unloads it. An error is returned as it is.
fn description(client: &mut Client, kind: &str, loaded: &Value) -> Value {
    let Some(name) = loaded["result"][kind].as_str() else {
        return loaded["error"].clone();
    };
    let params = json!({ kind: name });
    let mut description = client.call(&format!("{kind}.describe"), &params);
    client.call(&format!("{kind}.unload"), &params);
    description["result"][kind] = Value::Null;
    description["result"]["session"] = Value::Null;
    description["result"].take()
}

/// Loads a text many times. Returns the median of the times.
fn median(client: &mut Client, text: &str, language: &str) -> Duration {
    let mut times: Vec<Duration> = (0..41)
        .map(|_| {
            let begin = Instant::now();
            client.begin_load(text, language);
            let loaded = client.receive();
            let time = begin.elapsed();
            description(client, "command", &loaded);
            time
        })
        .collect();
    times.sort();
    times[times.len() / 2]
}

/// Prints what a process for each text costs. The difference is what a worker that stays for the next text would save.
#[test]
fn the_start_of_a_worker_takes_milliseconds() {
    let program = "command Wait () let finish done when time >= 1[s]; tel";
    for (text, language) in [(crate::SHORT, "rpinet"), (program, "rpi")] {
        let scenes = [Scene::in_process(), Scene::with_workers(|_| {})];
        let [alone, by_worker] = scenes.map(|scene| median(&mut scene.client(), text, language));
        println!("{language}: in process {alone:?}, by a worker {by_worker:?}");
        assert!(by_worker < alone + Duration::from_secs(2));
    }
}

#[test]
fn workers_give_the_results_of_the_process_itself() {
    let folders = ["examples", "tests/motion", "tests/meaning", "tests/ui/nets"];
    let files = folders.map(|folder| rpi_testkit::files_below(folder, &["rpi", "rpinet"]));
    let scenes = [Scene::in_process(), Scene::with_workers(|_| {})];
    let mut clients = scenes.each_ref().map(Scene::client);
    let (mut texts, mut loaded) = (0, 0);
    for file in files.iter().flatten() {
        let text = std::fs::read_to_string(file).unwrap();
        let language = file.extension().and_then(|e| e.to_str()).unwrap();
        let [expected, results] = clients
            .each_mut()
            .map(|client| results(client, &text, language));
        assert_eq!(results, expected, "{}", file.display());
        texts += 1;
        loaded += results.iter().filter(|r| r["code"].is_null()).count();
    }
    println!("{texts} texts, {loaded} objects loaded");
    assert!(texts > 30 && loaded > 20, "{texts} texts, {loaded} objects");
}

/// Programs with devices of their own cells are compared by their errors and images; one of them also runs.
#[test]
fn a_task_by_a_worker_runs() {
    let scene = Scene::with_workers(|_| {});
    let mut client = scene.client();
    let folder = rpi_testkit::workspace_root().join("examples/blending");
    let text = std::fs::read_to_string(Path::new(&folder).join("blending.rpi")).unwrap();
    let only = client.load_named("task", &text, None);
    let name = choices(&only).first().cloned();
    let loaded = match &name {
        Some(name) => client.load_named("task", &text, Some(name)),
        None => only,
    };
    let task = loaded["result"]["task"].clone();
    assert!(task.is_string(), "{loaded}");
    let params = json!({ "task": task });
    let started = client.call("task.start", &params);
    assert!(started["error"].is_null(), "{started}");
    let begin = Instant::now();
    loop {
        let state = client.call("task.describe", &params);
        let text = state["result"].to_string();
        if text.contains("\"done\"") || !state["result"]["ended"][0].is_null() {
            break;
        }
        assert!(begin.elapsed() < crate::client::PATIENCE, "{state}");
        std::thread::sleep(Duration::from_millis(20));
    }
}
