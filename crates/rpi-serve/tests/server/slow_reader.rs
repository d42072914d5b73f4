//! A client that does not read its messages.

use std::time::{Duration, Instant};

use rpi_serve::{Limits, Settings};
use tungstenite::Message;

use crate::client::{Client, PATIENCE, get, server, settings};
use crate::nets::swing;

#[test]
fn a_client_that_does_not_read_is_given_up() {
    let limits = Limits {
        request_timeout: Duration::from_millis(500),
        ..Limits::default()
    };
    let server = server(
        &Settings {
            limits,
            ..settings()
        },
        (),
    );
    let mut deaf = Client::dio(server.address());
    let session = deaf.ask("nse(\"deaf\")").unwrap();
    let net = deaf.load(&session, &swing(0, 1e9));
    deaf.ask(&format!("nest(\"{net}\")")).unwrap();
    let begin = Instant::now();
    // The commands of its session are cancelled once it is disconnected; an endless oscillation shows that by its
    // state.
    while !get(server.address(), "/nets").contains("Cancelling") {
        assert!(begin.elapsed() < PATIENCE, "it is still listened to");
        for _ in 0..1000 {
            deaf.push("f=gde()");
        }
    }
    let log = get(server.address(), "/log");
    assert!(log.contains("from this machine is disconnected"), "{log}");
    let mut other = Client::dio(server.address());
    assert!(other.ask("ver(\"2.0\")").is_ok());
}

impl Client {
    /// Sends a message and ignores errors.
    fn push(&mut self, text: &str) {
        let _ = self.socket_mut().send(Message::text(text));
    }
}
