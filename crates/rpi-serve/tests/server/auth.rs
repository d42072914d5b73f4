//! Authentication and permissions.

use std::net::{Ipv4Addr, SocketAddr};
use std::time::{Duration, Instant};

use serde_json::json;

use rpi_serve::{ClientToken, Limits, OnLoss, OpenError, Role, Server, Settings, TlsFiles};
use rpi_sim::Cell;

use crate::client::{Client, PATIENCE, get, http, open, post, server, settings};
use crate::nets::{ECHO, hold, swing};
use crate::rules::{COUNT, Owner};

#[test]
fn beyond_this_machine_a_token_and_tls_are_needed() {
    let cell = Cell::parse("cell.toml", "").unwrap();
    let mut settings = Settings {
        listen: SocketAddr::from((Ipv4Addr::UNSPECIFIED, 0)),
        ..Settings::default()
    };
    let refusal = |settings: &Settings| match Server::open(&cell, settings, ()) {
        Err(OpenError::Unprotected {
            no_token, no_tls, ..
        }) => (no_token, no_tls),
        other => panic!("{other:?}"),
    };
    assert_eq!(refusal(&settings), (true, true));
    settings.tokens = vec![ClientToken::new("test", Role::Programmer, "secret")];
    assert_eq!(refusal(&settings), (false, true));
    let why = Server::open(&cell, &settings, ()).unwrap_err().to_string();
    assert!(why.starts_with("RPI9201: "), "{why}");
    let nowhere = TlsFiles {
        certificates: "nowhere/cert.pem".into(),
        key: "nowhere/key.pem".into(),
    };
    settings.tls = Some(nowhere);
    let why = Server::open(&cell, &settings, ()).unwrap_err().to_string();
    let expected = match cfg!(feature = "tls") {
        true => "nowhere/cert.pem: ",
        false => "this server was built without TLS; build it with ",
    };
    assert!(why.starts_with(expected), "{why}");
    settings.tls = None;
    settings.insecure = true;
    assert!(Server::open(&cell, &settings, ()).is_ok());
}

#[test]
fn wrong_tokens_and_pages_from_elsewhere_are_turned_away() {
    let server = server(
        &Settings {
            tokens: vec![ClientToken::new("test", Role::Programmer, "open sesame")],
            ..settings()
        },
        (),
    );
    let ask = |header: &str| {
        http(
            server.address(),
            &format!("GET /nets HTTP/1.1\r\nHost: localhost\r\n{header}\r\n\r\n"),
        )
    };
    let lacking = ask("X: y");
    assert!(lacking.starts_with("HTTP/1.1 401"), "{lacking}");
    assert!(
        lacking.contains("WWW-Authenticate: Bearer\r\n"),
        "{lacking}"
    );
    assert!(lacking.contains("a token is needed"), "{lacking}");
    let wrong = ask("Authorization: Bearer close sesame");
    assert!(wrong.starts_with("HTTP/1.1 401"), "{wrong}");
    assert!(wrong.contains("the token is wrong"), "{wrong}");
    assert_eq!(
        server.warnings(),
        [
            "rejected a request without a token, from this machine",
            "rejected a request with a wrong token, from this machine"
        ]
    );
    assert!(ask("Authorization: Bearer open sesame").starts_with("HTTP/1.1 200"));
    let client = "Authorization: Bearer open sesame\r\nOrigin: http://elsewhere";
    assert!(ask(client).starts_with("HTTP/1.1 403"));
}

/// Wrong tokens are answered with a delay and use only a few connections; a correct token is accepted meanwhile.
#[test]
fn guessing_a_token_is_slow_and_holds_nobody_up() {
    let token = "open sesame";
    let limits = Limits {
        connections: 16,
        wrong_token_delay: Duration::from_secs(3),
        ..Limits::default()
    };
    let settings = Settings {
        tokens: vec![ClientToken::new("test", Role::Programmer, token)],
        limits,
        ..settings()
    };
    let server = server(&settings, ());
    let address = server.address();
    let ask = move |shown: &str| {
        let header = format!("Authorization: Bearer {shown}");
        http(
            address,
            &format!("GET /nets HTTP/1.1\r\nHost: localhost\r\n{header}\r\n\r\n"),
        )
    };
    let begin = Instant::now();
    let guesses: Vec<_> = (0..12)
        .map(|k| std::thread::spawn(move || ask(&format!("guess {k}"))))
        .collect();
    while !server
        .warnings()
        .iter()
        .any(|warning| warning.contains("10 times"))
    {
        assert!(begin.elapsed() < PATIENCE, "there is no warning");
    }
    assert!(ask(token).starts_with("HTTP/1.1 200"));
    assert!(begin.elapsed() < limits.wrong_token_delay, "it had to wait");
    let answers: Vec<String> = guesses.into_iter().map(|g| g.join().unwrap()).collect();
    assert!(begin.elapsed() >= limits.wrong_token_delay, "they had not");
    let rejected = answers.iter().filter(|a| a.contains("the token is wrong"));
    assert_eq!(rejected.count(), 8, "{answers:?}");
}

#[test]
fn the_server_tells_what_there_is() {
    let server = open();
    let address = server.address();
    assert!(get(address, "/modules").contains("Core::DoubleAdd"));
    assert!(get(address, "/types").contains("World::Frame"));
    assert!(get(address, "/devices").contains("robotarm"));
    let missing = ["/nets/n1/dio", "/nowhere"].map(|page| get(address, page));
    assert!(missing.iter().all(|answer| answer.contains("404")));
    let no_page = ["/rpc", "/DirectIO"].map(|page| get(address, page));
    assert!(no_page.iter().all(|answer| answer.contains("426")));
    let no_key = http(
        address,
        "GET /rpc HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\n\r\n",
    );
    assert!(
        no_key.contains("400") && no_key.contains("needs a key"),
        "{no_key}"
    );
    let no_request = http(address, "hello\r\n\r\n");
    assert!(
        no_request.contains("400") && no_request.contains("HTTP/1.1"),
        "{no_request}"
    );
    let eval = post(
        address,
        "//eval/",
        "dionet=%7Bm%3DRobotArm%3A%3AJointMonitor%28Robot%3D%27arm%27%2CAxis%3D%272%27%29%2C\
         n%3DCore%3A%3ADoubleNetcommOut%28inValue%3Dm.outMeasuredPosition%2CKey%3D%27q%27%29%7D",
    );
    assert!(eval.contains("<data key=\"outq\">0"), "{eval}");
    assert!(post(address, "/eval", "dionet=%7Bx").starts_with("HTTP/1.1 400"));
}

#[test]
fn a_net_and_what_has_happened_can_be_looked_at() {
    let server = open();
    let address = server.address();
    let mut client = Client::dio(address);
    let session = client.ask("nse(\"a client\")").unwrap();
    let net = client.load(&session, ECHO);
    let parts = get(address, &format!("/nets/{net}/xml"));
    for part in [
        "<module id=\"two\" type=\"Core::DoubleMultiply\">",
        "<port name=\"inFirst\" from=\"in.outValue\"/>",
        "<parameter name=\"Key\" value=\"gain\"/>",
    ] {
        assert!(parts.contains(part), "{part}: {parts}");
    }
    client.ask(&format!("nest(\"{net}\")")).unwrap();
    client.ask(&format!("gne(\"{net}\",0.001)")).unwrap();
    client.wait("a value", |text| text.contains("outtwice").then_some(()));
    let page = get(address, &format!("/nets/{net}/debug"));
    assert!(page.contains("<export key=\"twice\">2"), "{page}");
    assert!(page.contains("<input key=\"gain\""), "{page}");
    client.ask(&format!("neab(\"{net}\")")).unwrap();
    client.wait("its end", |text| text.contains("TERMINATED").then_some(()));
    let log = get(address, "/log");
    assert!(log.contains("of a client was opened") && log.contains("(test) has ended: aborted"));
    let groups = get(address, "/extensions");
    assert!(groups.contains("<extension name=\"Core\" modules="));
    assert!(get(address, "/nets/n99/xml").contains("404"));
}

#[test]
fn devices_come_and_go_unless_somebody_holds_them() {
    let server = open();
    let address = server.address();
    let new = "name=arm two&type=kuka_iiwa_sim&link_lengths=[0,0.34,0.2,0.2,0.2,0.2,0.126,0]";
    assert!(post(address, "//devices/", new).contains("200 OK"));
    let mut client = Client::dio(address);
    let session = client.ask("nse(\"test\")").unwrap();
    let net = client.load(&session, &swing(1, 1e9).replace("'arm'", "'arm two'"));
    client.ask(&format!("nest(\"{net}\")")).unwrap();
    client.ask(&format!("gne(\"{net}\",0.02)")).unwrap();
    client.send("d=gde()");
    client.wait("the device", |text| {
        text.contains("\"arm two\":{\"type\":\"kuka_iiwa_sim\"")
            .then_some(())
    });
    let remove = |name: &str| post(address, "/devices", &format!("name={name}&action=remove"));
    let held = remove("arm two");
    assert!(held.contains(&format!("held by {net}")), "{held}");
    assert!(remove("arm").contains("belongs to the cell"));
    client.ask(&format!("neab(\"{net}\")")).unwrap();
    client.wait("the end", |text| text.contains("TERMINATED").then_some(()));
    // Ended commands that used the device do not block its removal; they are unloaded with it.
    assert!(remove("arm two").contains("200 OK"));
    client.wait("the unloading", |text| {
        text.contains("UNLOADED").then_some(())
    });
    client.wait("removed", |text| {
        text.contains("dr([\"arm two\"])").then_some(())
    });
    let unknown = post(address, "/devices", "name=x y&type=toaster");
    assert!(unknown.starts_with("HTTP/1.1 400"));
}

#[test]
fn limits_are_told_and_ended_commands_make_room() {
    let limits = Limits {
        commands: 4,
        sessions: 4,
        ..Limits::default()
    };
    let server = server(
        &Settings {
            limits,
            ..settings()
        },
        (),
    );
    let mut client = Client::dio(server.address());
    let session = client.ask("nse(\"one\")").unwrap();
    client.ask("nse(\"two\")").unwrap();
    assert!(
        client
            .ask("nse(\"three\")")
            .unwrap_err()
            .contains("sessions")
    );
    let first = client.load(&session, ECHO);
    client.load(&session, ECHO);
    let full = format!("nene(\"{ECHO}\",\"{session}\",\"\",0,1)");
    assert!(client.ask(&full).unwrap_err().contains("commands"));
    client.ask(&format!("nest(\"{first}\")")).unwrap();
    client.ask(&format!("neab(\"{first}\")")).unwrap();
    client.ask(&format!("gne(\"{first}\",0.02)")).unwrap();
    client.wait("its end", |text| text.contains("TERMINATED").then_some(()));
    assert!(client.ask(&full).is_ok());
}

#[test]
fn every_fault_of_a_net_is_told() {
    let server = open();
    let mut client = Client::dio(server.address());
    let session = client.ask("nse(\"test\")").unwrap();
    let net = "{a=Core::Nothing(),b=Core::DoubleAdd(inFirst=a.x,inThird=c.y)}";
    let why = client.ask(&format!("nene(\"{net}\",\"{session}\",\"\",0,1)"));
    assert!(why.unwrap_err().matches("1:").count() >= 2);
    let elsewhere = hold(0).replace("'arm'", "'leg'");
    let why = client.ask(&format!("nene(\"{elsewhere}\",\"{session}\",\"\",0,1)"));
    assert!(why.unwrap_err().contains("leg"));
}

#[test]
fn what_becomes_of_commands_without_their_client_is_chosen() {
    let policies = [("cancel", 0), ("abort", 0), ("run-on", 1)];
    for (policy, left) in policies {
        assert!(OnLoss::from_name(policy).is_some());
        let server = open();
        let mut lost = Client::dio(server.address());
        let session = lost.ask(&format!("nse(\"lost\",\"{policy}\")")).unwrap();
        let net = lost.load(&session, &swing(0, 1e9));
        let waiting = lost.load(&session, ECHO);
        lost.ask(&format!("nest(\"{net}\")")).unwrap();
        drop(lost);
        let mut other = Client::dio(server.address());
        std::thread::sleep(std::time::Duration::from_millis(300));
        let running = get(server.address(), "/nets").matches("Running").count();
        assert_eq!(running, left, "{policy}");
        if policy != "run-on" {
            assert!(other.ask(&format!("neca(\"{waiting}\")")).is_err());
        }
    }
}

/// A text from a client cannot read files of the server's machine.
#[test]
fn a_text_from_a_client_reads_no_files() {
    let server = open();
    let mut owner = Owner::new(&server);
    let folder = tempfile::tempdir().unwrap();
    let secret = folder.path().join("secret.lus");
    std::fs::write(&secret, "hush\n").unwrap();
    for method in ["command.load", "task.load"] {
        let text = format!("include {:?}\n{COUNT}", secret.to_str().unwrap());
        let load = json!({"session": owner.session.clone(), "text": text});
        let answer = owner.ask(method, &load).to_string();
        assert!(
            answer.contains("RPI1005") && !answer.contains("hush"),
            "{answer}"
        );
    }
}
