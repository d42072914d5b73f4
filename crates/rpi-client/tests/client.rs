//! The client against a server.

use std::collections::VecDeque;
use std::net::{Ipv4Addr, SocketAddr};
use std::path::Path;

use rpi_client::{Core, Error, Goal, OnLoss, Program, Session};
use rpi_serve::{Pace, Server, Settings};
use rpi_sim::Cell;

const COUNT: &str = "
command Count ()
let
  n = 1 -> pre n + 1;
  export n;
  finish done when n >= 200;
tel
";

/// A server that shows who it is by a certificate of its own making, and the file that has it.
#[cfg(feature = "tls")]
fn secure(folder: &std::path::Path) -> (Server, std::path::PathBuf) {
    let made = rcgen::generate_simple_self_signed(["localhost".to_owned()]).unwrap();
    let [certificates, key] = ["cert.pem", "key.pem"].map(|name| folder.join(name));
    std::fs::write(&certificates, made.cert.pem()).unwrap();
    std::fs::write(&key, made.signing_key.serialize_pem()).unwrap();
    let cell = Cell::parse("cell.toml", "").unwrap();
    let tls = rpi_serve::TlsFiles {
        certificates: certificates.clone(),
        key,
    };
    let settings = Settings {
        listen: SocketAddr::from((Ipv4Addr::UNSPECIFIED, 0)),
        token: Some("secret".to_owned()),
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
        Core::connect(&address, Some("secret")).is_err(),
        "it is plain"
    );
    let other = folder.path().join("other.pem");
    let made = rcgen::generate_simple_self_signed(["localhost".to_owned()]).unwrap();
    std::fs::write(&other, made.cert.pem()).unwrap();
    assert!(Core::connect_tls(&address, Some("secret"), &other).is_err());
    assert!(Core::connect_tls(&address, Some("wrong"), &certificates).is_err());
    let core = Core::connect_tls(&address, Some("secret"), &certificates).unwrap();
    let session = core.open_session("test", OnLoss::Cancel).unwrap();
    let goal = session.load(&Program::rpi(COUNT)).unwrap();
    goal.start().unwrap();
    assert_eq!(goal.result().unwrap().cycles, 200);
}

fn server(token: Option<&str>) -> Server {
    let cell = Cell::parse("cell.toml", "").unwrap();
    let settings = Settings {
        listen: SocketAddr::from((Ipv4Addr::LOCALHOST, 0)),
        token: token.map(str::to_owned),
        ..Settings::default()
    };
    Server::open(&cell, &settings, ()).unwrap()
}

#[test]
fn goals_follow_one_another_and_tell_how_it_goes() {
    let server = server(None);
    let core = Core::connect(&server.address().to_string(), None).unwrap();
    let session = core.open_session("test", OnLoss::Cancel).unwrap();
    let [first, second] = [(), ()].map(|()| session.load(&Program::rpi(COUNT)).unwrap());
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
fn reasons_tokens_and_lost_connections_are_errors() {
    let server = server(Some("secret"));
    let address = server.address().to_string();
    assert!(Core::connect(&address, Some("wrong")).is_err());
    let core = Core::connect(&address, Some("secret")).unwrap();
    let session = core.open_session("test", OnLoss::Abort).unwrap();
    let broken = session.load(&Program::rpi(
        "command X () let finish a when b; finish c when d; tel",
    ));
    assert!(matches!(broken, Err(Error::Refused { reasons, .. }) if reasons.len() >= 2));
    let goal = session.load(&Program::rpi(COUNT)).unwrap();
    assert!(goal.preempt().is_err());
    drop(server);
    assert!(matches!(goal.start(), Err(Error::Connection(_))));
}

/// The paper's Listing 1 is a loop in a general language: each round loads a motion and schedules it on the one before, while
/// that one runs. Every motion to C is taken over at B, and what is over leaves nothing behind.
#[test]
fn a_loop_outside_blends_motions_for_as_long_as_it_goes_on() {
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/blending");
    let [text, cell] = ["blending.rpi", "cell.toml"]
        .map(|file| std::fs::read_to_string(example.join(file)).unwrap());
    let settings = Settings {
        listen: SocketAddr::from((Ipv4Addr::LOCALHOST, 0)),
        pace: Pace::Faster(10),
        ..Settings::default()
    };
    let cell = Cell::parse("cell.toml", &cell).unwrap();
    let server = Server::open(&cell, &settings, ()).unwrap();
    let core = Core::connect(&server.address().to_string(), None).unwrap();
    let session = core.open_session("loop", OnLoss::Cancel).unwrap();
    let load = |command: &str| motion(&session, &text, command);
    let first = load("MoveToA");
    let mut line = VecDeque::from([first]);
    let mut ended = Vec::new();
    for round in 0..30 {
        let next = load(["MoveToC", "MoveToE"][round % 2]);
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
        let there = core.call("commands", serde_json::json!({})).unwrap();
        let there = there["commands"].as_array().unwrap().len();
        assert!(there <= 4, "{there} commands in round {round}");
    }
    assert_eq!(ended.len(), 28);
    assert_eq!(ended[0], "at_a");
    let rounds = ended[1..].chunks_exact(2);
    rounds.for_each(|round| assert_eq!(round, ["at_b", "at_e"]));
    session.close().unwrap();
}

fn motion(session: &Session, text: &str, command: &str) -> Goal {
    let program = Program {
        command: Some(command.to_owned()),
        ..Program::rpi(text)
    };
    session.load(&program).unwrap()
}
