//! The client with a real server in the same process.

use std::collections::VecDeque;
use std::net::{Ipv4Addr, SocketAddr};
use std::path::Path;

use rpi_client::{Client, Error, Goal, OnLoss, Program, Session};
use rpi_serve::{ClientToken, Role, Server, Settings, TimeBase};
use rpi_sim::Cell;

const COUNT: &str = "
command Count ()
let
  n = 1 -> pre n + 1;
  export n;
  finish done when n >= 200;
tel
";

/// Starts a server with a self-signed certificate. Returns it with the path of the certificate file.
#[cfg(feature = "tls")]
fn secure(folder: &std::path::Path) -> (Server, std::path::PathBuf) {
    let made = rcgen::generate_simple_self_signed(["localhost".to_owned()]).unwrap();
    let [certificates, key] = ["cert.pem", "key.pem"].map(|name| folder.join(name));
    std::fs::write(&certificates, made.cert.pem()).unwrap();
    std::fs::write(&key, made.signing_key.serialize_pem()).unwrap();
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // The server rejects a key that other users may read.
        std::fs::set_permissions(&key, PermissionsExt::from_mode(0o600)).unwrap();
    }
    let cell = Cell::parse("cell.toml", "").unwrap();
    let tls = rpi_serve::TlsFiles {
        certificates: certificates.clone(),
        key,
    };
    let settings = Settings {
        listen: SocketAddr::from((Ipv4Addr::UNSPECIFIED, 0)),
        tokens: vec![ClientToken::new("test", Role::Programmer, "secret")],
        tls: Some(tls),
        ..Settings::default()
    };
    (Server::open(&cell, &settings, ()).unwrap(), certificates)
}

#[cfg(feature = "tls")]
#[test]
fn beyond_loopback_it_is_the_same_over_tls() {
    let folder = tempfile::tempdir().unwrap();
    let (server, certificates) = secure(folder.path());
    let address = format!("localhost:{}", server.address().port());
    assert!(
        Client::connect(&address, Some("secret")).is_err(),
        "it is plain"
    );
    let other = folder.path().join("other.pem");
    let made = rcgen::generate_simple_self_signed(["localhost".to_owned()]).unwrap();
    std::fs::write(&other, made.cert.pem()).unwrap();
    assert!(Client::connect_tls(&address, Some("secret"), &other).is_err());
    assert!(Client::connect_tls(&address, Some("wrong"), &certificates).is_err());
    let client = Client::connect_tls(&address, Some("secret"), &certificates).unwrap();
    let session = client.open_session("test", OnLoss::Cancel).unwrap();
    let goal = session.load(&Program::new(COUNT)).unwrap();
    goal.start().unwrap();
    assert_eq!(goal.result().unwrap().cycles, 200);
}

fn server(token: Option<&str>) -> Server {
    let cell = Cell::parse("cell.toml", "").unwrap();
    let settings = Settings {
        listen: SocketAddr::from((Ipv4Addr::LOCALHOST, 0)),
        tokens: token
            .map(|secret| ClientToken::new("test", Role::Programmer, secret))
            .into_iter()
            .collect(),
        ..Settings::default()
    };
    Server::open(&cell, &settings, ()).unwrap()
}

#[test]
fn goals_follow_one_another_and_tell_how_it_goes() {
    let server = server(None);
    let client = Client::connect(&server.address().to_string(), None).unwrap();
    let session = client.open_session("test", OnLoss::Cancel).unwrap();
    let [first, second] = [(), ()].map(|()| session.load(&Program::new(COUNT)).unwrap());
    second.follow(&first, &["done"]).unwrap();
    first.start().unwrap();
    let last = second.feedback().last().unwrap();
    assert_eq!(
        (last.state.as_str(), last.values["n"].as_str()),
        ("terminated", "200")
    );
    let ending = first.result().unwrap();
    assert_eq!(
        (ending.result.as_deref(), ending.cycles),
        (Some("done"), 200)
    );
    session.close().unwrap();
}

#[test]
fn watched_flows_are_in_the_feedback() {
    let server = server(None);
    let client = Client::connect(&server.address().to_string(), None).unwrap();
    let session = client.open_session("test", OnLoss::Cancel).unwrap();
    let text = COUNT.replace("export n;", "export n;\n  twice = 2 * n;");
    let program = Program {
        watch: vec!["Count.twice".to_owned()],
        ..Program::new(text)
    };
    let goal = session.load(&program).unwrap();
    goal.start().unwrap();
    let last = goal.feedback().last().unwrap();
    assert_eq!([&last.values["n"], &last.values["twice"]], ["200", "400"]);
    session.close().unwrap();
}

#[test]
fn rules_start_commands_unless_they_are_withdrawn() {
    let server = server(None);
    let client = Client::connect(&server.address().to_string(), None).unwrap();
    let session = client.open_session("test", OnLoss::Cancel).unwrap();
    let [first, second, third] = [(), (), ()].map(|()| session.load(&Program::new(COUNT)).unwrap());
    let ended = format!("{}@ended", first.name());
    let withdrawn = session.add_rule(&ended, &[], &[], &[&third]).unwrap();
    session.withdraw_rule(&withdrawn).unwrap();
    assert!(session.withdraw_rule("r1000000").is_err());
    session.add_rule(&ended, &[], &[], &[&second]).unwrap();
    first.start().unwrap();
    assert_eq!(second.result().unwrap().cycles, 200);
    assert!(third.result().is_err(), "it has lost its only rule");
    session.close().unwrap();
}

/// A command that can no longer be started is unloaded by the core, and waiting for its result returns an error.
#[test]
fn losers_are_told_that_they_will_not_run() {
    let server = server(None);
    let client = Client::connect(&server.address().to_string(), None).unwrap();
    let session = client.open_session("test", OnLoss::Cancel).unwrap();
    let turn = "command Turn () let finish left when time >= 50[ms]; finish right when false; tel";
    let load = |text: &str| session.load(&Program::new(text)).unwrap();
    let (turn, left, right) = (load(turn), load(COUNT), load(COUNT));
    left.follow(&turn, &["left"]).unwrap();
    right.follow(&turn, &["right"]).unwrap();
    turn.start().unwrap();
    assert!(matches!(
        right.result(),
        Err(Error::Refused { code: -32001, .. })
    ));
    assert_eq!(left.result().unwrap().cycles, 200);
    assert_eq!(left.result().unwrap().cycles, 200, "it is known for good");
}

const TASK: &str = "
command Count (n: int)
let
  k = 1 -> pre k + 1;
  finish done when k >= n;
  finish asked when cancel;
tel

task All
let
  parallel
  let Count(30); Count(10); tel
  let Count(50); tel
  Count(5);
tel

task Endless
let
  repeat let Count(20); tel
tel
";

/// Rules M11.6 and M11.7.
#[test]
fn a_task_is_carried_out_by_the_server() {
    let server = server(None);
    let client = Client::connect(&server.address().to_string(), None).unwrap();
    let session = client.open_session("test", OnLoss::Cancel).unwrap();
    let load = |name: &str| {
        let program = Program {
            command: Some(name.to_owned()),
            ..Program::new(TASK)
        };
        session.load_task(&program).unwrap()
    };
    let task = load("All");
    task.start().unwrap();
    let end = task.result().unwrap();
    assert_eq!((end.state.as_str(), end.start_error), ("done", None));
    let names: Vec<&str> = end.steps.iter().map(|s| s.command.as_str()).collect();
    assert_eq!(names, ["Count(30)", "Count(10)", "Count(50)", "Count(5)"]);
    let endless = load("Endless");
    endless.start().unwrap();
    std::thread::sleep(std::time::Duration::from_millis(200));
    endless.preempt().unwrap();
    assert_eq!(endless.result().unwrap().state, "cancelled");
    endless.unload().unwrap();
}

/// An emergency stop ends every task: one whose commands end in every tick, and one that has only just been started.
#[test]
fn an_emergency_stop_ends_tasks() {
    let server = server(None);
    let address = server.address().to_string();
    let [one, other] = [(), ()].map(|()| Client::connect(&address, None).unwrap());
    let session = one.open_session("test", OnLoss::Cancel).unwrap();
    let text = "command Tick () let finish done when true; tel
task Endless let repeat let Tick(); Tick(); tel tel";
    for pause in [0, 0, 0, 50, 100] {
        let program = Program {
            command: Some("Endless".to_owned()),
            ..Program::new(text)
        };
        let task = session.load_task(&program).unwrap();
        task.start().unwrap();
        std::thread::sleep(std::time::Duration::from_millis(pause));
        other.emergency_stop("the guard").unwrap();
        assert_eq!(task.result().unwrap().state, "failed");
        let begin = std::time::Instant::now();
        while one.reset_emergency().is_err() {
            assert!(begin.elapsed() < std::time::Duration::from_secs(10));
        }
        task.unload().unwrap();
    }
}

/// An emergency stop ends the commands of all clients and holds until the reset.
#[test]
fn an_emergency_stop_holds_until_it_is_reset() {
    let server = server(None);
    let address = server.address().to_string();
    let [one, other] = [(), ()].map(|()| Client::connect(&address, None).unwrap());
    let session = one.open_session("test", OnLoss::Cancel).unwrap();
    let endless = "command Wait () let finish never when false; finish over when cancel; tel";
    let load = || session.load(&Program::new(endless)).unwrap();
    let (running, next, ready) = (load(), load(), load());
    next.follow(&running, &[]).unwrap();
    running.start().unwrap();
    other.emergency_stop("the door is open").unwrap();
    let ending = running.result().unwrap();
    assert_eq!(
        (ending.cause.as_str(), ending.why.as_deref()),
        ("aborted", Some("emergency stop"))
    );
    let refused = ready.start().unwrap_err();
    assert!(
        matches!(&refused, Error::Refused { code: -32006, .. }),
        "{refused}"
    );
    assert!(
        refused.to_string().contains("the door is open"),
        "{refused}"
    );
    assert!(next.result().is_err(), "its rule is gone, and so is it");
    one.reset_emergency().unwrap();
    ready.start().unwrap();
    ready.preempt().unwrap();
    assert_eq!(ready.result().unwrap().result.as_deref(), Some("over"));
}

/// Only the owner of a session may start, end or change its commands, unless the session is shared.
#[test]
fn a_session_belongs_to_its_client() {
    let server = server(None);
    let address = server.address().to_string();
    let [one, other] = [(), ()].map(|()| Client::connect(&address, None).unwrap());
    let session = one.open_session("test", OnLoss::Cancel).unwrap();
    let goal = session.load(&Program::new(COUNT)).unwrap();
    for method in ["start", "cancel", "abort", "unload"] {
        let refused = other.call(
            &format!("command.{method}"),
            serde_json::json!({"command": goal.name()}),
        );
        assert!(
            matches!(refused, Err(Error::Refused { code: -32007, .. })),
            "{refused:?}"
        );
    }
    goal.start().unwrap();
    let opened = one.call(
        "session.open",
        serde_json::json!({"name": "all", "shared": true}),
    );
    let shared = opened.unwrap()["session"].clone();
    let load = serde_json::json!({"session": shared, "text": COUNT, "period": 0.0025});
    let loaded = other.call("command.load", load).unwrap();
    assert_eq!(
        (&loaded["period"], &loaded["rounded"]),
        (&serde_json::json!(0.003), &serde_json::json!(true))
    );
    other
        .call(
            "command.start",
            serde_json::json!({"command": loaded["command"]}),
        )
        .unwrap();
}

#[test]
fn reasons_tokens_and_lost_connections_are_errors() {
    let server = server(Some("secret"));
    let address = server.address().to_string();
    let why = Client::connect(&address, Some("wrong")).unwrap_err();
    assert!(why.to_string().ends_with("the token is wrong"), "{why}");
    let why = Client::connect(&address, None).unwrap_err();
    assert!(why.to_string().contains("a token is needed"), "{why}");
    let client = Client::connect(&address, Some("secret")).unwrap();
    let session = client.open_session("test", OnLoss::Abort).unwrap();
    let broken = session.load(&Program::new(
        "command X () let finish a when b; finish c when d; tel",
    ));
    assert!(matches!(broken, Err(Error::Refused { reasons, .. }) if reasons.len() >= 2));
    let goal = session.load(&Program::new(COUNT)).unwrap();
    assert!(goal.preempt().is_err());
    drop(server);
    assert!(matches!(goal.start(), Err(Error::Connection(_))));
}

/// Listing 1 of the paper is a loop in a general-purpose language: each round loads a motion and schedules it as the
/// successor of the running one. Every motion to C is taken over at B, and no ended command remains at the server.
#[test]
fn a_loop_outside_blends_motions_for_as_long_as_it_goes_on() {
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/blending");
    let [text, cell] = ["blending.rpi", "cell.toml"]
        .map(|file| std::fs::read_to_string(example.join(file)).unwrap());
    let settings = Settings {
        listen: SocketAddr::from((Ipv4Addr::LOCALHOST, 0)),
        pace: TimeBase::Accelerated(10),
        ..Settings::default()
    };
    let cell = Cell::parse("cell.toml", &cell).unwrap();
    let server = Server::open(&cell, &settings, ()).unwrap();
    let client = Client::connect(&server.address().to_string(), None).unwrap();
    let session = client.open_session("loop", OnLoss::Cancel).unwrap();
    let load = |command: &str| motion(&session, &text, command);
    let first = load("MoveToA");
    let mut line = VecDeque::from([first]);
    let mut ended = Vec::new();
    for round in 0..30 {
        let next = load(["MoveToC", "MoveToE", "MoveToA"][round % 3]);
        next.follow(line.back().unwrap(), &[]).unwrap();
        line.push_back(next);
        if round == 2 {
            line[0].start().unwrap();
        }
        while round >= 2 && line.len() > 3 {
            let done = line.pop_front().unwrap();
            ended.push(done.result().unwrap().result.unwrap());
            done.unload().unwrap();
        }
        let there = client.call("commands", serde_json::json!({})).unwrap();
        let there = there["commands"].as_array().unwrap().len();
        assert!(there <= 4, "{there} commands in round {round}");
    }
    assert_eq!(ended.len(), 28);
    let rounds = ended.chunks_exact(3);
    rounds.for_each(|round| assert_eq!(round, ["at_a", "at_b", "at_e"]));
    session.close().unwrap();
}

fn motion(session: &Session, text: &str, command: &str) -> Goal {
    let program = Program {
        command: Some(command.to_owned()),
        ..Program::new(text)
    };
    session.load(&program).unwrap()
}

/// A client knows its role. A request beyond its rights is refused, and so is the reset of the operator's stop.
#[test]
fn a_client_knows_its_role() {
    let tokens = [
        ("panel", Role::Viewer),
        ("anna", Role::Operator),
        ("cell", Role::Programmer),
    ];
    let tokens = tokens.map(|(name, role)| ClientToken::new(name, role, name));
    let settings = Settings {
        listen: SocketAddr::from((Ipv4Addr::LOCALHOST, 0)),
        tokens: tokens.to_vec(),
        ..Settings::default()
    };
    let cell = Cell::parse("cell.toml", "").unwrap();
    let server = Server::open(&cell, &settings, ()).unwrap();
    let address = server.address().to_string();
    let of = |name| Client::connect(&address, Some(name)).unwrap();
    let [panel, anna, cell] = ["panel", "anna", "cell"].map(of);
    let who = panel.identity().unwrap();
    assert_eq!(
        (who.name.as_deref(), who.role.as_str()),
        (Some("panel"), "viewer")
    );
    assert!(who.may("watch") && !who.may("load"));
    let refused = panel.open_session("test", OnLoss::Cancel).unwrap_err();
    assert!(
        matches!(refused, Error::Refused { code: -32009, .. }),
        "{refused}"
    );
    cell.open_session("test", OnLoss::Cancel).unwrap();
    server.emergency_stop("the operator's button");
    let refused = cell.reset_emergency().unwrap_err();
    assert!(
        matches!(refused, Error::Refused { code: -32009, .. }),
        "{refused}"
    );
    let begin = std::time::Instant::now();
    while let Err(why) = anna.reset_emergency() {
        assert!(
            begin.elapsed() < std::time::Duration::from_secs(10),
            "{why}"
        );
    }
}
