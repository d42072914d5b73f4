//! Live messages for Foxglove: the protocol at its port, subscriptions, and connections that are rejected.

use std::collections::BTreeMap;
use std::io::{Read, Write};
use std::net::{Ipv4Addr, SocketAddr, TcpStream};
use std::time::{Duration, Instant};

use rpi_record::mcap::RunOutputs;
use rpi_serve::{ClientToken, FoxglovePort, FoxgloveSettings, OpenError, Role, Server};
use rpi_sim::Cell;
use serde_json::{Value, json};
use tungstenite::client::IntoClientRequest;
use tungstenite::{Message, WebSocket};

use crate::client::{CELL, PATIENCE, settings};
use crate::rules::Owner;

const PROGRAM: &str = "
use motion;

command Turn (arm: Arm)
var n: int;
let
  n = 0 -> pre n + 1;
  twice = 2 * n;
  arm.joints = [1e-6[rad] * real n, 0[rad], 0[rad], 0[rad], 0[rad], 0[rad], 0[rad]];
  export n;
  finish over when n = 20000;
tel
";

fn port_settings() -> FoxgloveSettings {
    FoxgloveSettings {
        listen: SocketAddr::from((Ipv4Addr::LOCALHOST, 0)),
        tokens: Vec::new(),
        tls: None,
        insecure: false,
        origins: Vec::new(),
    }
}

/// Opens a server whose messages go to a port for Foxglove, without a recording.
fn open() -> (FoxglovePort, Server) {
    let port = FoxglovePort::open(&port_settings()).unwrap();
    let cell = Cell::parse("cell.toml", CELL).unwrap_or_else(|errors| panic!("{errors}"));
    let outputs = RunOutputs {
        recording: None,
        live: Some(port.viewers()),
        ..RunOutputs::default()
    };
    let server = Server::open_with_outputs(&cell, &settings(), (), Some(outputs)).unwrap();
    (port, server)
}

/// Viewer, as the specification of the protocol describes it.
struct Viewer {
    socket: WebSocket<TcpStream>,
    /// Channels by topic.
    channels: BTreeMap<String, Value>,
    /// Numbers of the channels that were removed.
    removed: Vec<u64>,
}

/// Message of a subscription: its number, time and data.
type Data = (u32, u64, Value);

impl Viewer {
    fn connect(address: SocketAddr) -> Viewer {
        let mut request = format!("ws://{address}/").into_client_request().unwrap();
        // As the application offers its versions.
        let protocols = "foxglove.sdk.v1, foxglove.websocket.v1";
        let headers = request.headers_mut();
        headers.insert("Sec-WebSocket-Protocol", protocols.parse().unwrap());
        let stream = TcpStream::connect(address).unwrap();
        let (socket, response) = tungstenite::client(request, stream).unwrap();
        let chosen = response.headers()["Sec-WebSocket-Protocol"].to_str();
        assert_eq!(chosen.unwrap(), "foxglove.websocket.v1");
        let timeout = Some(Duration::from_millis(5));
        socket.get_ref().set_read_timeout(timeout).unwrap();
        let mut viewer = Viewer {
            socket,
            channels: BTreeMap::new(),
            removed: Vec::new(),
        };
        let info = viewer.text("serverInfo");
        assert!(info["name"].as_str().unwrap().starts_with("rpi "), "{info}");
        assert_eq!(info["capabilities"], json!([]));
        viewer.text("advertise");
        viewer
    }

    /// Receives a message, and keeps the channels up to date.
    fn receive(&mut self) -> Option<Result<Value, Data>> {
        match self.socket.read() {
            Ok(Message::Text(text)) => {
                let message: Value = serde_json::from_str(&text).unwrap();
                for channel in message["channels"].as_array().into_iter().flatten() {
                    let topic = channel["topic"].as_str().unwrap().to_owned();
                    self.channels.insert(topic, channel.clone());
                }
                let removed = message["channelIds"].as_array().into_iter().flatten();
                let removed: Vec<u64> = removed.map(|id| id.as_u64().unwrap()).collect();
                self.channels
                    .retain(|_, channel| !removed.contains(&channel["id"].as_u64().unwrap()));
                self.removed.extend(removed);
                Some(Ok(message))
            }
            Ok(Message::Binary(data)) => {
                let (head, payload) = data.split_at(13);
                assert_eq!(head[0], 1, "the number of message data");
                let subscription = u32::from_le_bytes(head[1..5].try_into().unwrap());
                let time = u64::from_le_bytes(head[5..].try_into().unwrap());
                Some(Err((
                    subscription,
                    time,
                    serde_json::from_slice(payload).unwrap(),
                )))
            }
            _ => None,
        }
    }

    fn wait<T>(
        &mut self,
        what: &str,
        mut wanted: impl FnMut(&Viewer, Option<Result<Value, Data>>) -> Option<T>,
    ) -> T {
        let begin = Instant::now();
        loop {
            let message = self.receive();
            if let Some(result) = wanted(self, message) {
                return result;
            }
            assert!(
                begin.elapsed() < PATIENCE,
                "{what}: {:?}",
                self.channels.keys()
            );
        }
    }

    /// Waits for a text message of a kind.
    fn text(&mut self, op: &str) -> Value {
        self.wait(op, |_, message| {
            message?.ok().filter(|message| message["op"] == op)
        })
    }

    /// Waits until a topic is advertised. Returns its channel.
    fn channel(&mut self, topic: &str) -> Value {
        self.wait(topic, |viewer, _| viewer.channels.get(topic).cloned())
    }

    fn subscribe(&mut self, id: u32, topic: &str) {
        let channel = self.channel(topic)["id"].clone();
        let subscription = json!({"id": id, "channelId": channel});
        let message = json!({"op": "subscribe", "subscriptions": [subscription]});
        self.socket
            .send(Message::text(message.to_string()))
            .unwrap();
    }

    /// Waits for this number of messages of a subscription.
    fn data(&mut self, id: u32, count: usize) -> Vec<(u64, Value)> {
        let mut messages = Vec::new();
        self.wait("data", |_, message| {
            if let Some(Err((subscription, time, data))) = message
                && subscription == id
            {
                messages.push((time, data));
            }
            (messages.len() >= count).then_some(())
        });
        messages
    }
}

/// Loads and starts the command with a watched flow. Returns its number.
fn start(owner: &mut Owner) -> Value {
    let params = json!({
        "session": owner.session, "text": PROGRAM, "command": "Turn", "watch": ["Turn.twice"],
    });
    let loaded = owner.ask("command.load", &params);
    let command = loaded["result"]["command"].clone();
    assert!(command.is_string(), "{loaded}");
    owner.ask("command.start", &json!({"command": command}));
    command
}

#[test]
fn the_topics_of_the_cell_are_there_from_the_beginning() {
    let (port, _server) = open();
    let mut viewer = Viewer::connect(port.address());
    for topic in ["/tf", "/log", "/events", "/device/arm", "/joint_states"] {
        let channel = viewer.channel(topic);
        assert_eq!(
            (&channel["encoding"], &channel["schemaEncoding"]),
            (&json!("json"), &json!("jsonschema"))
        );
    }
    assert_eq!(
        viewer.channel("/joint_states")["schemaName"],
        "foxglove.JointStates"
    );
    assert!(
        !viewer
            .channels
            .keys()
            .any(|topic| topic.starts_with("/rpi/"))
    );
    viewer.subscribe(1, "/robot_description");
    let (_, described) = viewer.data(1, 1).remove(0);
    assert!(
        described["data"].as_str().unwrap().contains("<robot"),
        "{described}"
    );
}

#[test]
fn viewers_get_joint_states_and_watched_flows_of_a_running_command() {
    let (port, server) = open();
    let mut viewer = Viewer::connect(port.address());
    let mut owner = Owner::new(&server);
    let command = start(&mut owner);
    let schema = viewer.channel("/command/Turn")["schema"].clone();
    let schema: Value = serde_json::from_str(schema.as_str().unwrap()).unwrap();
    assert_eq!(schema["properties"]["twice"]["type"], "integer", "{schema}");
    viewer.subscribe(2, "/command/Turn");
    viewer.subscribe(3, "/joint_states");
    let flows = viewer.data(2, 200);
    for pair in flows.windows(2) {
        let [(before, old), (after, new)] = pair else {
            unreachable!("two of them")
        };
        let cycles = new["cycle"].as_u64().unwrap() - old["cycle"].as_u64().unwrap();
        assert!(cycles >= 1 && before < after, "{old} {new}");
    }
    assert!(
        flows
            .iter()
            .all(|(_, flows)| flows["twice"] == flows["n"].as_i64().unwrap() * 2)
    );
    let (time, joints) = viewer.data(3, 1).remove(0);
    let joint = &joints["joints"][0];
    assert_eq!(joint["name"], "arm_joint_1");
    assert!(joint["velocity"].as_f64().unwrap() > 0.0, "{joints}");
    let stamp = &joints["timestamp"];
    let stamp = stamp["sec"].as_u64().unwrap() * 1_000_000_000 + stamp["nsec"].as_u64().unwrap();
    assert_eq!(stamp, time);
    // The topic disappears with the command.
    let channel = viewer.channel("/command/Turn")["id"].as_u64().unwrap();
    owner.ask("command.abort", &json!({"command": command}));
    owner.ask("command.unload", &json!({"command": command}));
    viewer.wait("the end", |viewer, _| {
        viewer.removed.contains(&channel).then_some(())
    });
}

#[test]
fn subscriptions_end_and_wrong_requests_are_answered() {
    let (port, _server) = open();
    let mut viewer = Viewer::connect(port.address());
    viewer.subscribe(7, "/device/arm");
    viewer.data(7, 3);
    let message = json!({"op": "unsubscribe", "subscriptionIds": [7]});
    viewer
        .socket
        .send(Message::text(message.to_string()))
        .unwrap();
    // A subscription with the same number is possible from now on.
    viewer.subscribe(7, "/joint_states");
    viewer.wait("joint states", |_, message| match message? {
        Err((7, _, data)) => data.get("joints").map(drop),
        _ => None,
    });
    for (request, part) in [
        (
            r#"{"op":"subscribe","subscriptions":[{"id":9,"channelId":99999}]}"#,
            "no channel 99999",
        ),
        (r#"{"op":"setParameters","parameters":[]}"#, "not supported"),
        ("no JSON", "must be JSON"),
    ] {
        viewer.socket.send(Message::text(request)).unwrap();
        let status = viewer.text("status");
        assert_eq!(status["level"], 2, "{status}");
        assert!(
            status["message"].as_str().unwrap().contains(part),
            "{status}"
        );
    }
    // Clients only receive.
    viewer
        .socket
        .send(Message::binary(vec![1, 0, 0, 0, 0]))
        .unwrap();
    viewer.wait("the end of the connection", |viewer, _| {
        (!viewer.socket.can_read()).then_some(())
    });
}

/// A viewer that does not read loses messages; others and the cycle go on.
#[test]
fn a_viewer_that_does_not_read_is_left_behind() {
    let (port, server) = open();
    let mut idle = Viewer::connect(port.address());
    for (id, topic) in (0..).zip(["/device/arm", "/joint_states", "/tf"]) {
        idle.subscribe(id, topic);
    }
    let mut viewer = Viewer::connect(port.address());
    viewer.subscribe(0, "/joint_states");
    let ticks = server.cycle_metrics().ticks();
    let times = viewer.data(0, 2000);
    assert!(times.windows(2).all(|pair| pair[0].0 < pair[1].0));
    assert!(server.cycle_metrics().ticks() >= ticks + 2000);
    assert_eq!(server.cycle_metrics().unrecorded_ticks(), 0);
}

/// Sends a request for a websocket with these headers. Returns the status line.
fn status(address: SocketAddr, path: &str, headers: &str) -> String {
    let mut stream = TcpStream::connect(address).unwrap();
    stream.set_read_timeout(Some(PATIENCE)).unwrap();
    let request = format!(
        "GET {path} HTTP/1.1\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n\
         Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n{headers}\r\n"
    );
    stream.write_all(request.as_bytes()).unwrap();
    let mut answer = Vec::new();
    let mut chunk = [0; 1024];
    while !answer.contains(&b'\n') {
        let count = stream.read(&mut chunk).unwrap();
        assert!(count > 0, "no answer");
        answer.extend(&chunk[..count]);
    }
    let answer = String::from_utf8_lossy(&answer).into_owned();
    answer.lines().next().unwrap_or_default().to_owned()
}

#[test]
fn the_rules_for_hosts_origins_and_tokens_are_those_of_the_server() {
    let protocol = "Sec-WebSocket-Protocol: foxglove.websocket.v1\r\n";
    let open = |tokens: &[ClientToken], origins: &[&str]| {
        FoxglovePort::open(&FoxgloveSettings {
            tokens: tokens.to_vec(),
            origins: origins.iter().map(|origin| (*origin).to_owned()).collect(),
            ..port_settings()
        })
        .unwrap()
    };
    let port = open(&[], &["https://app.example"]);
    let own = format!("Host: localhost\r\n{protocol}");
    let with = |header: &str| format!("{own}{header}\r\n");
    let at = port.address();
    assert!(status(at, "/", &own).contains("101"));
    assert!(status(at, "/", &with("Origin: https://app.example")).contains("101"));
    assert!(status(at, "/", &with("Origin: https://evil.example")).contains("403"));
    assert!(status(at, "/", &format!("Host: evil.example\r\n{protocol}")).contains("421"));
    assert!(status(at, "/", "Host: localhost\r\n").contains("426"));
    let port = open(&[ClientToken::new("anna", Role::Viewer, "a-secret")], &[]);
    let at = port.address();
    assert!(status(at, "/?token=a-secret", &own).contains("101"));
    assert!(status(at, "/", &with("Authorization: Bearer a-secret")).contains("101"));
    assert!(status(at, "/", &own).contains("401"));
    assert!(status(at, "/?token=guess", &own).contains("401"));
    // Beyond this machine, a token and TLS are needed.
    let listen = SocketAddr::from((Ipv4Addr::UNSPECIFIED, 0));
    let opened = FoxglovePort::open(&FoxgloveSettings {
        listen,
        ..port_settings()
    });
    assert!(matches!(
        opened,
        Err(OpenError::Unprotected {
            no_token: true,
            no_tls: true,
            ..
        })
    ));
}

#[test]
fn there_are_sixteen_places_for_viewers() {
    let port = FoxglovePort::open(&port_settings()).unwrap();
    let mut viewers: Vec<Viewer> = (0..16).map(|_| Viewer::connect(port.address())).collect();
    let headers = "Host: localhost\r\nSec-WebSocket-Protocol: foxglove.websocket.v1\r\n";
    assert!(status(port.address(), "/", headers).contains("503"));
    viewers.pop();
    let begin = Instant::now();
    while !status(port.address(), "/", headers).contains("101") {
        assert!(begin.elapsed() < PATIENCE, "the place stays taken");
    }
    drop(port);
    let mut first = viewers.remove(0);
    first.wait("the end of the port", |viewer, _| {
        (!viewer.socket.can_read()).then_some(())
    });
}
