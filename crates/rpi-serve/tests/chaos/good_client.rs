//! A client that sends all kinds of valid requests, in both protocols.

use std::time::Duration;

use serde_json::{Value, json};

use crate::Scene;
use crate::bad_clients::{dio, rpc};
use crate::client::Client;
use crate::nets::{ECHO, hold, swing};

/// A net with a set-point that the arm refuses.
const FAR: &str = "{far=Core::DoubleValue(Value='10.0'),\
    a=RobotArm::JointPosition(inPosition=far.outValue,Robot='arm',Axis='1')}";
/// Two commands. The second one can follow the first and runs until it is cancelled.
const PROGRAM: &str = "command First () let finish done when time >= 0.02[s]; tel
    command Second () let finish stopped when cancel; tel";

/// Sends all kinds of requests: loads, starts, rules, takeovers, cancels, aborts, values, subscriptions, faults,
/// unloads, devices.
pub(crate) fn all_requests(scene: &Scene, round: u64) {
    let arm = format!("good{round}");
    let mut client = Rpc(rpc(scene), 0);
    client.call("watch.devices", &json!({}));
    client.call("device.add", &json!({"name": arm, "type": "kuka_lwr_sim"}));
    in_directio(&mut dio(scene), &arm);
    in_json(&mut client);
    client.call("device.remove", &json!({"name": arm}));
}

fn in_directio(client: &mut Client, arm: &str) {
    let own = |net: &str| net.replace("Robot='arm'", &format!("Robot='{arm}'"));
    let session = client.ask("nse(\"good\")").unwrap();
    let texts = [
        own(&swing(0, 0.02)),
        own(&hold(0)),
        ECHO.to_owned(),
        own(FAR),
    ];
    let nets = texts.map(|text| client.load(&session, &text));
    for net in &nets {
        client.ask(&format!("gne(\"{net}\",0.001)")).unwrap();
    }
    let [first, second, echo, far] = nets;
    let blend = format!("nesc(\"{first}.out_1\",[\"{first}\"],[],[\"{second}\"])");
    let rule = client.ask(&blend).unwrap();
    client.send(&format!("rule=gsy(\"{rule}\")"));
    client.ask(&format!("nest(\"{echo}\")")).unwrap();
    client.ask(&format!("nest(\"{first}\")")).unwrap();
    client.wait("the takeover", |text| {
        text.contains("rule=rs(\"FIRED\")").then_some(())
    });
    client
        .ask(&format!("snc({{\"{echo}\":{{\"ingain\":\"21.0\"}}}})"))
        .unwrap();
    client.ask(&format!("neca(\"{echo}\")")).unwrap();
    client.ask(&format!("neab(\"{second}\")")).unwrap();
    client.ask(&format!("nest(\"{far}\")")).unwrap();
    client.listen(Duration::from_millis(20));
    for net in [&far, &echo] {
        // The request fails if the fault has ended the net already.
        let _ = client.ask(&format!("neab(\"{net}\")"));
    }
    client.ask(&format!("neun(\"{first}\")")).unwrap();
    // Everything else is unloaded with the session.
    client.ask(&format!("ase(\"{session}\")")).unwrap();
}

fn in_json(client: &mut Rpc) {
    let session = client.call("session.open", &json!({"name": "good"}))["session"].take();
    let [first, second] = ["First", "Second"].map(|name| {
        let load = json!({"session": session, "text": PROGRAM, "command": name});
        client.call("command.load", &load)["command"].take()
    });
    let of = |command: &Value| json!({"command": command});
    client.call(
        "watch.command",
        &json!({"command": second, "period": 0.001}),
    );
    client.call(
        "command.schedule",
        &json!({"command": second, "after": first}),
    );
    let never = json!({"when": format!("{}@error(3)", second.as_str().unwrap()), "stop": [second]});
    let rule = client.call("rule.make", &never)["rule"].take();
    client.call("rule.withdraw", &json!({"rule": rule}));
    client.call("command.start", &of(&first));
    client.0.wait("the switch", |text| {
        text.contains("\"running\"").then_some(())
    });
    client.call("command.cancel", &of(&second));
    client.0.wait("the end", |text| {
        text.contains("\"terminated\"").then_some(())
    });
    client.call("command.describe", &of(&second));
    client.call("command.unload", &of(&second));
    client.call("session.close", &json!({"session": session}));
}

/// JSON-RPC client with the number of its latest request.
struct Rpc(Client, u64);

impl Rpc {
    fn call(&mut self, method: &str, params: &Value) -> Value {
        self.1 += 1;
        let id = self.1;
        let request = json!({"jsonrpc": "2.0", "id": id, "method": method, "params": params});
        self.0.send(&request.to_string());
        let answer = self.0.wait(method, |text| {
            let answer: Value = serde_json::from_str(text).ok()?;
            (answer["id"] == json!(id)).then_some(answer)
        });
        assert!(answer["error"].is_null(), "{method} {params}: {answer}");
        answer["result"].clone()
    }
}
