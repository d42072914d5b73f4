//! The client against a server.

use std::net::{Ipv4Addr, SocketAddr};

use rpi_client::{Core, Error, OnLoss, Program};
use rpi_serve::{Server, Settings};
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
