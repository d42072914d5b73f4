//! Tests of opening and closing the server.

use std::net::IpAddr;

use super::*;
use crate::peer::Peer;
use crate::role::{Identity, Role};
use crate::state::{Language, LoadRequest, SessionPolicy, Subscriber, Update};

/// A net that moves an axis of the arm back and forth for ever.
const SWING: &str = "{t=Core::Clock(Increment='1.0'),c=Core::DoubleCos(inValue=t.outValue),\
    n=Core::DoubleMultiply(inFirst=c.outValue,Second='-0.1'),\
    p=Core::DoubleAdd(inFirst=n.outValue,Second='0.1'),\
    a=RobotArm::JointPosition(inPosition=p.outValue,Robot='arm',Axis='0')}";

/// Starts a command on the server and waits until the arm moves.
fn swing(shared: &SharedState) {
    let me = Identity::unnamed(Peer::Local, Role::Programmer);
    let client = shared.lock().objects.client(&me);
    let session = shared
        .lock()
        .open_session("test", SessionPolicy::default(), (client, true), &me);
    let session = session.unwrap();
    let load = LoadRequest {
        session: &session,
        title: "swing",
        language: Language::Rpinet,
        text: SWING,
        command: None,
        period_ns: 0,
        on_overrun: None,
        watch: Vec::new(),
    };
    let starter = shared.clone();
    let started = move |name: Result<String, _>| {
        // The reply is called with the state locked, so `start` needs another thread.
        let name = name.unwrap();
        thread::spawn(move || starter.lock().start(&name, Box::new(|_| {})));
    };
    shared.lock().load(&load, Box::new(started));
    let begin = Instant::now();
    while !shared.lock().devices.all().any(|info| info.moving) {
        assert!(
            begin.elapsed() < Duration::from_secs(30),
            "it does not move"
        );
        thread::sleep(UPDATE_INTERVAL);
    }
}

/// A subscriber that accepts the first update and is gone afterwards.
struct Disconnected;

impl Subscriber for Disconnected {
    fn notify(&mut self, _: &Update<'_>) -> bool {
        true
    }

    fn is_connected(&self) -> bool {
        false
    }
}

/// Subscriptions of a disconnected client are removed even if no update ever fails to reach it.
#[test]
fn whoever_is_gone_is_forgotten() {
    let cell = Cell::parse("cell.toml", "").unwrap();
    let settings = Settings {
        listen: SocketAddr::new(IpAddr::from([127, 0, 0, 1]), 0),
        ..Settings::default()
    };
    let server = Server::open(&cell, &settings, ()).unwrap();
    let shared = server.state.clone().unwrap();
    let mut state = shared.lock();
    let me = Identity::unnamed(Peer::Local, Role::Programmer);
    let client = state.objects.client(&me);
    let session = state
        .open_session("test", SessionPolicy::default(), (client, true), &me)
        .unwrap();
    state.emergency.watch(Box::new(Disconnected));
    state.devices.watch(Box::new(Disconnected));
    state.controls.watch(Box::new(Disconnected));
    state
        .objects
        .sessions
        .watch(&session, Box::new(Disconnected))
        .unwrap();
    assert_eq!(state.subscriber_count(), 4);
    state.on_client_lost(client, &[]);
    assert_eq!(state.subscriber_count(), 0);
}

#[test]
fn nobody_lets_go_of_an_arm_that_moves() {
    let text = "[devices.arm]\nkind = \"arm\"\nmodel = \"kuka-lwr4+\"\n\
        enforce = [\"position\", \"velocity\"]\n";
    let cell = Cell::parse("cell.toml", text).unwrap();
    let settings = Settings {
        listen: SocketAddr::new(IpAddr::from([127, 0, 0, 1]), 0),
        ..Settings::default()
    };
    let server = Server::open(&cell, &settings, ()).unwrap();
    let shared = server.state.clone().unwrap();
    swing(&shared);
    server.close().unwrap();
    assert!(!shared.lock().devices.all().any(|info| info.moving));
}
