//! Order of updates.

use std::time::Duration;

use crate::client::{Client, open};
use crate::nets::{ECHO, hold, swing, way};

fn position(heard: &[String], what: &str) -> usize {
    let found = heard.iter().position(|text| text.contains(what));
    found.unwrap_or_else(|| panic!("no {what} in {heard:?}"))
}

#[test]
fn an_end_is_told_after_the_firing_and_the_values_that_led_to_it() {
    let server = open();
    let mut client = Client::dio(server.address());
    let session = client.ask("nse(\"test\")").unwrap();
    let net = client.load(&session, &hold(0));
    client.ask(&format!("gne(\"{net}\",0.02)")).unwrap();
    let stop = client
        .ask(&format!("nesc(\"{net}.out_1\",[\"{net}\"],[],[])"))
        .unwrap();
    let start = client
        .ask(&format!("nesc(\"t\",[],[],[\"{net}\"])"))
        .unwrap();
    client.send(&format!("s=gsy(\"{start}\")"));
    client.send(&format!("e=gsy(\"{stop}\")"));
    let mut heard = client.listen(Duration::from_millis(400));
    heard.retain(|text| !text.contains("=ok("));
    let order = [
        "ns(\"READY\")",
        "ns(\"RUNNING\")",
        "s=rs(\"FIRED\")",
        "\"out_1\":\"true\"",
        "ns(\"TERMINATED\")",
    ];
    let at = order.map(|what| position(&heard, what));
    assert!(at.is_sorted(), "{heard:?}");
    assert!(position(&heard, "e=rs(\"FIRED\")") < at[4]);
}

/// The predecessor ends after a blend; in the reference system its handle stays running for ever.
#[test]
fn a_predecessor_ends_when_its_successor_takes_over() {
    let server = open();
    let mut client = Client::dio(server.address());
    let session = client.ask("nse(\"test\")").unwrap();
    let first = client.load(&session, &swing(0, 0.2));
    let second = client.load(&session, &hold(0));
    for net in [&first, &second] {
        client.ask(&format!("gne(\"{net}\",0.02)")).unwrap();
    }
    let blend = format!("nesc(\"{first}.out_1\",[\"{first}\"],[],[\"{second}\"])");
    let rule = client.ask(&blend).unwrap();
    client.ask(&format!("nest(\"{first}\")")).unwrap();
    client.send(&format!("r=gsy(\"{rule}\")"));
    client.wait("the blend", |text| {
        text.contains("r=rs(\"FIRED\")").then_some(())
    });
    for phase in ["RUNNING", "RUNNING", "TERMINATED"] {
        client.wait(phase, |text| text.contains(phase).then_some(()));
    }
    assert!(client.ask(&format!("neun(\"{first}\")")).is_ok());
    let again = client.ask(&format!("neca(\"{first}\")"));
    assert!(again.unwrap_err().contains("no command"));
}

/// A motion that is taken over is reported as complete once, before its rule is reported as fired, however early the
/// successor takes over.
#[test]
fn what_is_taken_over_is_told_to_be_complete_after_its_own_start() {
    let server = open();
    let mut client = Client::dio(server.address());
    let session = client.ask("nse(\"test\")").unwrap();
    for round in 0..10 {
        let first = client.load(&session, &way(f64::from(round % 5) * 0.01));
        let second = client.load(&session, &hold(0));
        client.ask(&format!("gne(\"{first}\",0.02)")).unwrap();
        for key in ["completed", "cancelled"] {
            let end = format!("nesc(\"{first}.out{key}\",[\"{first}\"],[],[])");
            client.ask(&end).unwrap();
        }
        let blend = format!("nesc(\"{first}.outblend\",[\"{first}\"],[],[\"{second}\"])");
        let blend = client.ask(&blend).unwrap();
        client.send(&format!("b=gsy(\"{blend}\")"));
        let start = client
            .ask(&format!("nesc(\"t\",[],[],[\"{first}\"])"))
            .unwrap();
        client.send(&format!("s=gsy(\"{start}\")"));
        let heard = client.listen(Duration::from_millis(300));
        let complete = heard
            .iter()
            .filter(|t| t.contains("nc({\"outcompleted\":\"true\"})"));
        assert_eq!(complete.count(), 1, "{heard:?}");
        let order = [
            "s=rs(\"FIRED\")",
            "nc({\"outcompleted\":\"true\"})",
            "nc({\"outcompleted\":\"false\"})",
            "b=rs(\"FIRED\")",
            "ns(\"TERMINATED\")",
        ];
        let at = order.map(|what| position(&heard, what));
        assert!(at.is_sorted(), "{heard:?}");
        client.ask(&format!("neab(\"{second}\")")).unwrap();
    }
}

#[test]
fn values_go_in_and_come_out_and_a_cancel_is_seen() {
    let server = open();
    let mut client = Client::dio(server.address());
    let session = client.ask("nse(\"test\")").unwrap();
    let net = client.load(&session, ECHO);
    client.ask(&format!("nest(\"{net}\")")).unwrap();
    client.ask(&format!("gne(\"{net}\",0.001)")).unwrap();
    client.wait("2", |text| text.contains("\"outtwice\":\"2").then_some(()));
    client
        .ask(&format!("snc({{\"{net}\":{{\"ingain\":\"21.0\"}}}})"))
        .unwrap();
    client.wait("42", |text| {
        text.contains("\"outtwice\":\"42").then_some(())
    });
    client.ask(&format!("neca(\"{net}\")")).unwrap();
    client.wait("cancelled", |text| {
        text.contains("\"outcancelled\":\"true\"").then_some(())
    });
    for wrong in ["inother", "ingain"] {
        let set = format!("snc({{\"{net}\":{{\"{wrong}\":\"x\"}}}})");
        assert!(client.ask(&set).is_err());
    }
}
