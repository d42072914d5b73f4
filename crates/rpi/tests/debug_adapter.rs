//! `rpi debug --dap` with a client that has the capabilities of Visual Studio Code: it stops in the first cycle in which a condition
//! holds, goes back, and shows the values of the run.

use std::io::BufReader;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use rpi_files::framing::{read_message, write_message};
use serde_json::{Value, json};

/// Client of a debugger in a process of its own.
struct Client {
    debugger: Child,
    input: Option<ChildStdin>,
    output: BufReader<ChildStdout>,
    sequence: u64,
    events: Vec<Value>,
}

impl Client {
    fn start() -> Client {
        let mut debugger = Command::new(env!("CARGO_BIN_EXE_rpi"))
            .args(["debug", "--dap"])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        Client {
            input: debugger.stdin.take(),
            output: BufReader::new(debugger.stdout.take().unwrap()),
            debugger,
            sequence: 0,
            events: Vec::new(),
        }
    }

    /// Makes a request and returns its response.
    fn response(&mut self, command: &str, arguments: Value) -> Value {
        self.sequence += 1;
        let request = json!({
            "seq": self.sequence, "type": "request", "command": command, "arguments": arguments,
        });
        write_message(self.input.as_mut().unwrap(), &request.to_string()).unwrap();
        loop {
            let message = self.next();
            if message["type"] == "response" {
                assert_eq!(message["request_seq"], self.sequence);
                assert_eq!(message["command"], command);
                return message;
            }
            self.events.push(message);
        }
    }

    /// Makes a request that must succeed and returns the body of its response.
    fn request(&mut self, command: &str, arguments: Value) -> Value {
        let response = self.response(command, arguments);
        assert_eq!(response["success"], true, "{response}");
        response["body"].clone()
    }

    fn next(&mut self) -> Value {
        let body = read_message(&mut self.output).unwrap().unwrap();
        serde_json::from_slice(&body).unwrap()
    }

    /// Waits for an event and returns its body.
    fn event(&mut self, name: &str) -> Value {
        loop {
            if let Some(at) = self.events.iter().position(|event| event["event"] == name) {
                return self.events.remove(at)["body"].clone();
            }
            let message = self.next();
            self.events.push(message);
        }
    }

    /// Moves and returns the body of the event `stopped`.
    fn step(&mut self, command: &str) -> Value {
        self.request(command, json!({ "threadId": 1 }));
        self.event("stopped")
    }

    /// Moves several times.
    fn steps(&mut self, count: usize, command: &str) {
        for _ in 0..count {
            self.step(command);
        }
    }

    /// Returns the value of an expression in the innermost frame of the first command.
    fn value(&mut self, expression: &str) -> String {
        let stack = self.request("stackTrace", json!({ "threadId": 1 }));
        let frame = &stack["stackFrames"][0]["id"];
        let arguments = json!({ "expression": expression, "frameId": frame, "context": "watch" });
        let answer = self.request("evaluate", arguments);
        answer["result"].as_str().unwrap().to_owned()
    }

    fn end(mut self) {
        self.request("disconnect", json!({}));
        drop(self.input.take());
        assert!(self.debugger.wait().unwrap().success());
    }
}

fn initialized() -> Client {
    let mut client = Client::start();
    let capabilities = client.request(
        "initialize",
        json!({
            "clientID": "vscode", "clientName": "Visual Studio Code", "adapterID": "rpi", "pathFormat": "path",
            "linesStartAt1": true, "columnsStartAt1": true, "supportsVariableType": true,
            "supportsVariablePaging": true, "supportsRunInTerminalRequest": true, "locale": "en",
            "supportsProgressReporting": true, "supportsInvalidatedEvent": true, "supportsMemoryReferences": true,
            "supportsArgsCanBeInterpretedByShell": true, "supportsMemoryEvent": true, "supportsStartDebuggingRequest": true,
            "supportsANSIStyling": true,
        }),
    );
    for capability in [
        "supportsStepBack",
        "supportsConditionalBreakpoints",
        "supportsDataBreakpoints",
    ] {
        assert_eq!(capabilities[capability], true, "{capability}");
    }
    client
}

fn program(name: &str) -> String {
    let path = rpi_testkit::workspace_root().join(name).canonicalize();
    path.unwrap().to_str().unwrap().to_owned()
}

/// Opens `examples/lifting` with a breakpoint on a condition, at the first cycle. Returns the client and the number of the breakpoint.
fn at_first_cycle_of_lifting() -> (Client, Value) {
    let lifting = program("examples/lifting/lifting.rpi");
    let mut client = initialized();
    client.request("launch", json!({ "program": lifting }));
    client.event("initialized");
    let text = std::fs::read_to_string(&lifting).unwrap();
    let line = text.lines().position(|line| line.starts_with("command Up"));
    let breakpoints = json!({
        "source": { "path": lifting },
        "breakpoints": [{ "line": line.unwrap() + 1, "condition": "way.travelled > 20[mm]" }],
    });
    let set = client.request("setBreakpoints", breakpoints);
    assert_eq!(set["breakpoints"][0]["verified"], true, "{set}");
    client.request("configurationDone", json!({}));
    assert_eq!(client.event("stopped")["reason"], "entry");
    (client, set["breakpoints"][0]["id"].clone())
}

#[test]
fn a_client_stops_at_a_condition_and_goes_back_a_hundred_cycles() {
    let (mut client, breakpoint) = at_first_cycle_of_lifting();
    let stopped = client.step("continue");
    assert_eq!(stopped["reason"], "breakpoint", "{stopped}");
    assert_eq!(stopped["hitBreakpointIds"], json!([breakpoint]));
    let number = |text: &str| text.parse::<f64>().unwrap();
    let here = client.value("way.travelled");
    assert!(number(&here) > 0.02);
    client.step("stepBack");
    let before = client.value("way.travelled");
    assert!(number(&before) <= 0.02, "it is the first cycle: {before}");
    client.steps(99, "stepBack");
    let earlier = client.value("way.travelled");
    client.steps(100, "next");
    assert_eq!(client.value("way.travelled"), here, "the same bits");
    let second = client.step("continue");
    assert_eq!(
        second["reason"], "breakpoint",
        "the task runs the command twice: {second}"
    );
    let end = client.step("continue");
    assert_eq!(end["reason"], "pause", "{end}");
    assert_eq!(client.step("reverseContinue")["text"], second["text"]);
    assert_eq!(client.step("reverseContinue")["text"], stopped["text"]);
    assert_eq!(client.value("way.travelled"), here);
    client.steps(100, "stepBack");
    assert_eq!(client.value("way.travelled"), earlier);
    client.end();
}

#[test]
fn what_cannot_be_done_is_answered_with_the_reason() {
    let mut client = initialized();
    let early = client.response("next", json!({ "threadId": 1 }));
    assert_eq!(early["success"], false);
    let missing = client.response("launch", json!({ "recording": "nowhere.mcap" }));
    assert!(
        missing["message"]
            .as_str()
            .unwrap()
            .contains("nowhere.mcap"),
        "{missing}"
    );
    let broken = client.response("launch", json!({ "program": "nowhere.rpi" }));
    assert!(
        broken["message"].as_str().unwrap().contains("nowhere.rpi"),
        "{broken}"
    );
    client.request(
        "launch",
        json!({ "program": program("tests/debug/fragments.rpi") }),
    );
    client.request("configurationDone", json!({}));
    client.event("stopped");
    for (condition, reason) in [
        ("nowhere > 2", "nowhere"),
        ("n", "must be of type bool"),
        ("n >", ""),
    ] {
        let breakpoints = json!({
            "source": { "path": program("tests/debug/fragments.rpi") },
            "breakpoints": [{ "line": 4, "condition": condition }],
        });
        let set = client.request("setBreakpoints", breakpoints);
        let answer = &set["breakpoints"][0];
        assert_eq!(answer["verified"], false);
        assert!(
            answer["message"].as_str().unwrap().contains(reason),
            "{answer}"
        );
    }
    assert_eq!(client.response("teleport", json!({}))["success"], false);
    client.end();
}
