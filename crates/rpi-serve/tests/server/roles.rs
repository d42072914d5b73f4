//! Roles of clients: what each may do, their names in the log, and who resets the operator's emergency stop.

use std::time::Instant;

use rpi_serve::{ClientToken, Role, Server, Settings, SocketSettings, methods};
use serde_json::{Value, json};

use crate::client::{Client, PATIENCE, get, http, post, server, settings};
use crate::native::call;
use crate::rules::COUNT;

/// Opens a server with a token for each role; the name of the role is the token.
fn with_roles() -> Server {
    let token = |(name, role): &(&str, Role)| ClientToken::new(&format!("the-{name}"), *role, name);
    let settings = Settings {
        tokens: Role::ALL.iter().map(token).collect(),
        ..settings()
    };
    server(&settings, ())
}

fn client(server: &Server, role: &str) -> Client {
    Client::at(server.address(), &format!("/rpc?token={role}"))
}

fn code(answer: &Value) -> i64 {
    answer["error"]["code"].as_i64().unwrap_or_default()
}

const FORBIDDEN: i64 = -32009;

/// Each method is open to exactly the roles that have its right. Methods that need none of the listed rights only watch.
#[test]
fn each_method_is_open_to_the_roles_with_its_right() {
    let server = with_roles();
    let moving = [
        "start", "cancel", "abort", "unload", "set", "close", "withdraw",
    ];
    let loading = ["open", "load", "schedule", "make", "add", "remove"];
    for (role, _) in Role::ALL {
        let mut client = client(&server, role);
        for (id, (method, _)) in methods().enumerate() {
            if method.starts_with("emergency") {
                continue;
            }
            let verb = method.rsplit('.').next().unwrap();
            let expected = match method {
                "motion.set" => role != "viewer",
                _ if method.starts_with("watch") => true,
                _ if moving.contains(&verb) => role != "viewer",
                _ if loading.contains(&verb) => role == "programmer" || role == "admin",
                _ => true,
            };
            let answer = call(&mut client, id as u64 + 1, method, &json!({}));
            assert_eq!(code(&answer) != FORBIDDEN, expected, "{role}: {answer}");
        }
        let described = call(&mut client, 99, "client.describe", &json!({}));
        assert_eq!(described["result"]["role"], role);
        assert_eq!(described["result"]["name"], format!("the-{role}"));
    }
}

/// Resets the emergency stop once all earlier requests are carried out. Returns the answer.
fn reset(client: &mut Client) -> Value {
    let begin = Instant::now();
    loop {
        let answer = call(client, 50, "emergency.reset", &json!({}));
        if code(&answer) != -32003 {
            return answer;
        }
        assert!(begin.elapsed() < PATIENCE, "{answer}");
    }
}

fn reset_by_operator(server: &Server) {
    let begin = Instant::now();
    while let Err(why) = server.reset_emergency() {
        assert!(begin.elapsed() < PATIENCE, "{why}");
    }
}

/// The operator's emergency stop is released by the operator, or by a client whose role may.
#[test]
fn a_stop_of_the_operator_is_not_reset_by_any_client() {
    let server = with_roles();
    for (role, releases) in [
        ("viewer", false),
        ("programmer", false),
        ("operator", true),
        ("admin", true),
    ] {
        server.emergency_stop("SIGQUIT");
        let mut client = client(&server, role);
        let answer = reset(&mut client);
        assert_eq!(code(&answer) == 0, releases, "{role}: {answer}");
        if !releases {
            assert_eq!(code(&answer), FORBIDDEN, "{answer}");
            let state = call(&mut client, 2, "emergency.state", &json!({}));
            assert_eq!(state["result"]["stopped"], true);
            reset_by_operator(&server);
        }
        let state = call(&mut client, 3, "emergency.state", &json!({}));
        assert_eq!(state["result"]["stopped"], false, "{role}");
    }
}

/// A stop of a client stays its own until the operator requests one as well.
#[test]
fn the_operator_takes_a_stop_of_a_client_over() {
    let server = with_roles();
    let mut programmer = client(&server, "programmer");
    let mut viewer = client(&server, "viewer");
    for (id, is_taken_over) in [(10, false), (20, true)] {
        let stopped = call(
            &mut viewer,
            id,
            "emergency.stop",
            &json!({"by": "the panel"}),
        );
        assert_eq!(code(&stopped), 0, "{stopped}");
        if is_taken_over {
            server.emergency_stop("SIGQUIT");
        }
        let refused = reset(&mut viewer);
        assert_eq!(code(&refused), FORBIDDEN, "{refused}");
        let answer = reset(&mut programmer);
        assert_eq!(code(&answer) == FORBIDDEN, is_taken_over, "{answer}");
    }
}

/// Names of tokens appear in the log, and beside what a client says of itself.
#[test]
fn the_log_names_clients_by_their_tokens() {
    let server = with_roles();
    let mut programmer = client(&server, "programmer");
    call(&mut programmer, 1, "session.open", &json!({"name": "weld"}));
    call(&mut programmer, 2, "motion.set", &json!({"override": 0.5}));
    call(
        &mut programmer,
        3,
        "emergency.stop",
        &json!({"by": "the guard"}),
    );
    reset(&mut programmer);
    let log = get(server.address(), "/log?token=viewer");
    let who = "the-programmer (programmer, this machine)";
    for line in [
        format!("of weld was opened by {who}"),
        format!("override 0.5, paused false, by {who}"),
        "EMERGENCY STOP by the guard (client the-programmer)".to_owned(),
        format!("the emergency stop was reset by {who}"),
    ] {
        assert!(log.contains(&line), "{line}: {log}");
    }
}

/// An admin acts on the sessions of others; a programmer does not.
#[test]
fn only_an_admin_acts_on_sessions_of_others() {
    let server = with_roles();
    let mut owner = client(&server, "programmer");
    let opened = call(&mut owner, 1, "session.open", &json!({}));
    let load = json!({"session": opened["result"]["session"], "text": COUNT});
    let loaded = call(&mut owner, 2, "command.load", &load);
    let start = json!({"command": loaded["result"]["command"]});
    let other = call(
        &mut client(&server, "programmer"),
        1,
        "command.start",
        &start,
    );
    assert_eq!(code(&other), -32007, "{other}");
    let admin = call(&mut client(&server, "admin"), 1, "command.start", &start);
    assert_eq!(code(&admin), 0, "{admin}");
}

/// Roles hold for DirectIO and the pages, too.
#[test]
fn roles_hold_for_every_protocol() {
    let server = with_roles();
    let mut viewer = Client::at(server.address(), "/DirectIO/?token=viewer");
    assert!(viewer.ask("gde()").is_ok());
    let why = viewer.ask("nse(\"x\")").unwrap_err();
    assert!(why.contains("nse needs the right to load"), "{why}");
    let body = "name=arm two&type=kuka_iiwa_sim";
    let refused = post(server.address(), "/devices?token=viewer", body);
    assert!(refused.starts_with("HTTP/1.1 403"), "{refused}");
    let added = post(server.address(), "/devices?token=programmer", body);
    assert!(added.starts_with("HTTP/1.1 200"), "{added}");
}

/// Clients of a Unix socket have its role, and the file its permissions.
#[cfg(unix)]
#[test]
fn a_socket_gives_its_role() {
    use std::io::{BufRead, BufReader, Write};
    use std::os::unix::fs::PermissionsExt;

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("panel.sock");
    let socket = SocketSettings {
        role: Role::Viewer,
        mode: Some(0o666),
        ..SocketSettings::new(path.clone())
    };
    let settings = Settings {
        sockets: vec![socket, SocketSettings::new(folder.path().join("rpi.sock"))],
        ..settings()
    };
    let _server = server(&settings, ());
    let mode = std::fs::metadata(&path).unwrap().permissions().mode();
    assert_eq!(mode & 0o777, 0o666);
    let mut stream = std::os::unix::net::UnixStream::connect(&path).unwrap();
    let request = json!({"jsonrpc": "2.0", "id": 1, "method": "session.open"});
    stream.write_all(format!("{request}\n").as_bytes()).unwrap();
    let mut answer = String::new();
    BufReader::new(stream).read_line(&mut answer).unwrap();
    assert!(answer.contains("-32009"), "{answer}");
}

/// Without a token, a request that names another host is refused: its page may be anyone's.
#[test]
fn a_request_to_another_host_is_refused_without_a_token() {
    let server = server(&settings(), ());
    let ask = |host: &str| {
        let request = format!("GET /nets HTTP/1.1\r\nHost: {host}\r\n\r\n");
        http(server.address(), &request)
    };
    let refused = ask("evil.example:8080");
    assert!(refused.starts_with("HTTP/1.1 421"), "{refused}");
    for own in ["localhost:70", "127.0.0.1", "[::1]:80"] {
        assert!(ask(own).starts_with("HTTP/1.1 200"), "{own}");
    }
}
