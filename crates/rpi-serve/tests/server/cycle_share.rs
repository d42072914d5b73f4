//! Share of a tick by the compiler's bounds: a command that exceeds it, alone or with others, is rejected with the
//! figures.

use std::fmt::Write as _;

use rpi_serve::{Server, Settings};
use serde_json::{Value, json};

use crate::client::{Client, PATIENCE, server, settings};
use crate::native::call;

/// Returns an endless command that computes this many cosines per cycle.
fn cosines(count: usize) -> String {
    let mut text = "command Cosines () let n = 1 -> pre n + 1; x0 = real(n);\n".to_owned();
    for k in 1..=count {
        let _ = writeln!(text, "x{k} = cos(x{});", k - 1);
    }
    let _ = write!(text, "finish done when x{count} > 2.0; tel");
    text
}

struct Scene {
    client: Client,
    session: Value,
    _server: Server,
}

impl Scene {
    fn new(settings: &Settings) -> Scene {
        let server = server(settings, ());
        let mut client = Client::rpc(server.address());
        let opened = call(&mut client, 1, "session.open", &json!({"name": "test"}));
        Scene {
            client,
            session: opened["result"]["session"].clone(),
            _server: server,
        }
    }

    fn load(&mut self, text: &str, language: &str) -> Value {
        let params = json!({"session": self.session, "text": text, "language": language});
        call(&mut self.client, 2, "command.load", &params)
    }

    fn cosines(&mut self, count: usize) -> Value {
        let loaded = self.load(&cosines(count), "rpi");
        let command = loaded["result"]["command"].clone();
        assert!(command.is_string(), "{loaded}");
        command
    }

    fn ask(&mut self, method: &str, command: &Value) -> Value {
        call(&mut self.client, 3, method, &json!({"command": command}))
    }

    /// Returns the bound in s of a command with this many cosines.
    fn bound(&mut self, count: usize) -> f64 {
        let command = self.cosines(count);
        let answer = self.ask("command.describe", &command);
        answer["result"]["bound"].as_f64().unwrap()
    }
}

/// Returns the number of cosines whose bound is about this share of the budget of commands.
fn count_for(scene: &mut Scene, share: f64) -> usize {
    let each = (scene.bound(200) - scene.bound(100)) / 100.0;
    (share * 0.8e-3 / each) as usize
}

#[test]
fn who_is_too_heavy_alone_is_not_loaded() {
    let mut scene = Scene::new(&settings());
    let count = count_for(&mut scene, 1.1);
    let answer = scene.load(&cosines(count), "rpi");
    let error = &answer["error"];
    assert_eq!(error["code"], -32008, "{answer}");
    assert!(error["data"]["needed"].as_f64() > Some(0.8e-3), "{answer}");
    assert_eq!(error["data"]["granted"], 0.8e-3, "{answer}");
    let message = error["message"].as_str().unwrap();
    assert!(message.contains("--cycle-share"), "{message}");
    let unbounded = Settings {
        cycle_share: None,
        ..settings()
    };
    Scene::new(&unbounded).cosines(count);
}

#[test]
fn who_is_too_heavy_beside_others_waits_for_them() {
    let mut scene = Scene::new(&settings());
    let count = count_for(&mut scene, 0.6);
    let [first, second] = [(); 2].map(|()| scene.cosines(count));
    assert!(scene.ask("command.start", &first)["error"].is_null());
    let answer = scene.ask("command.start", &second);
    assert_eq!(answer["error"]["code"], -32008, "{answer}");
    assert!(answer["error"]["data"]["taken"].as_f64() > Some(0.4e-3));
    let message = answer["error"]["message"].as_str().unwrap();
    assert!(message.starts_with("RPI7003: "), "{message}");
    assert!(scene.ask("command.abort", &first)["error"].is_null());
    let begin = std::time::Instant::now();
    while !scene.ask("command.start", &second)["error"].is_null() {
        assert!(begin.elapsed() < PATIENCE, "its place does not come free");
    }
}

#[test]
fn those_that_take_turns_at_an_arm_count_once() {
    let mut scene = Scene::new(&settings());
    let count = count_for(&mut scene, 0.6);
    let text = cosines(count)
        .replace(
            "command Cosines ()",
            "use motion;\ncommand Cosines (arm: Arm)",
        )
        .replace("finish done", "arm.joints = arm.position; finish done");
    let loaded = [(); 2].map(|()| scene.load(&text, "rpi")["result"]["command"].clone());
    let [first, second] = loaded;
    assert!(first.is_string(), "{}", scene.load(&text, "rpi"));
    let after = json!({"command": second, "after": first});
    let answer = call(&mut scene.client, 4, "command.schedule", &after);
    assert!(answer["error"].is_null(), "{answer}");
    assert!(scene.ask("command.start", &first)["error"].is_null());
}

/// Successors count once, whether they use the same actuator or not, because the predecessor has ended when the
/// successor starts.
#[test]
fn those_that_follow_one_another_count_once() {
    let mut scene = Scene::new(&settings());
    let count = count_for(&mut scene, 0.6);
    let chain = [(); 3].map(|()| scene.cosines(count));
    assert!(scene.ask("command.start", &chain[0])["error"].is_null());
    for pair in chain.windows(2) {
        let after = json!({"command": pair[1], "after": pair[0]});
        let answer = call(&mut scene.client, 4, "command.schedule", &after);
        assert!(answer["error"].is_null(), "{answer}");
    }
    let beside = scene.cosines(count);
    let answer = scene.ask("command.start", &beside);
    assert_eq!(answer["error"]["code"], -32008, "{answer}");
}

/// The work of a primitive grows with the size of its matrices.
#[test]
fn large_matrices_are_heavy() {
    let mut scene = Scene::new(&settings());
    let product = |size: usize| {
        format!(
            "{{t=Core::Clock(Increment='1.0'),m=Core::MatrixCreate(Rows='{size}',Cols='{size}'),\
             s=Core::MatrixSet(inMatrix=m.outMatrix,inValue=t.outValue,Rows='{size}',Cols='{size}'),\
             p=Core::MatrixMultiply(inMatrix1=s.outMatrix,inMatrix2=s.outMatrix),\
             g=Core::MatrixGet(inMatrix=p.outMatrix),o=Core::DoubleNetcommOut(inValue=g.outValue,Key='o')}}"
        )
    };
    let small = scene.load(&product(6), "rpinet");
    assert!(small["error"].is_null(), "{small}");
    let large = scene.load(&product(100), "rpinet");
    assert_eq!(large["error"]["code"], -32008, "{large}");
    assert!(
        large["error"]["data"]["needed"].as_f64() > Some(1e-3),
        "{large}"
    );
}

/// The net that the Java framework makes of sixteen linear motions in a row is accepted.
#[test]
fn the_authors_largest_net_fits_a_tick() {
    let Some(path) =
        rpi_testkit::external_data_path("nets/v1/seq-011-opt-contSequential_16_lin.rpinet.gz")
    else {
        return;
    };
    let input = rpi_driver::read(&path).unwrap();
    let compiled = rpi_driver::compile(&input).unwrap();
    let (_, work) = rpi_driver::lower_with_work(&compiled.nets()[0], 1_000_000).unwrap();
    let settings = Settings::default();
    let tick = work as f64 * settings.ns_per_operation / settings.tick_ns as f64;
    assert!(
        work > 100_000 && Some(tick) < settings.cycle_share,
        "{tick} of a tick"
    );
}
