//! The client whose commands must not be disturbed: the paper's Listing 1, for ever.

use std::collections::VecDeque;
use std::net::SocketAddr;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use serde_json::{Value, json};

use crate::TOKEN;
use crate::client::Client;

/// Session name of the owner.
pub(crate) const TITLE: &str = "not to be disturbed";
/// Number of commands loaded ahead, about half a minute of motion.
const AHEAD: usize = 40;

struct Owner {
    client: Client,
    last: u64,
    session: Value,
    program: String,
    made: usize,
    /// The running command and its successors.
    chain: VecDeque<Value>,
    /// Number of commands that were loaded only after their predecessors had started. Those may have stopped instead of
    /// being taken over.
    late: usize,
}

/// Runs `clients` beside the owner's commands. Returns its result and the number of late commands.
pub(crate) fn beside<T>(address: SocketAddr, clients: impl FnOnce() -> T) -> (T, usize) {
    let over = AtomicBool::new(false);
    thread::scope(|scope| {
        let owner = scope.spawn(|| shuttle(address, &over));
        let done = catch_unwind(AssertUnwindSafe(clients));
        over.store(true, Ordering::Relaxed);
        let late = owner.join().unwrap();
        (done.unwrap_or_else(|failed| resume_unwind(failed)), late)
    })
}

/// Runs one command after the other until `over` is set. Returns the number of late commands.
fn shuttle(address: SocketAddr, over: &AtomicBool) -> usize {
    let example = rpi_testkit::workspace_root().join("examples/blending/blending.rpi");
    let path = format!("/rpc?token={TOKEN}");
    let mut owner = Owner {
        client: Client::at(address, &path),
        last: 0,
        session: Value::Null,
        program: std::fs::read_to_string(example).unwrap(),
        made: 0,
        chain: VecDeque::new(),
        late: 0,
    };
    let opened = owner.call(
        "session.open",
        &json!({"name": "owner", "on_loss": "abort"}),
    );
    owner.session = opened["session"].clone();
    (0..AHEAD).for_each(|_| owner.extend());
    let first = owner.chain[0].clone();
    owner.call("command.start", &json!({"command": first}));
    while !over.load(Ordering::Relaxed) {
        owner.go_on();
        thread::sleep(Duration::from_millis(5));
    }
    owner.late
}

impl Owner {
    /// Calls a method; repeats the call while the server is busy.
    fn call(&mut self, method: &str, params: &Value) -> Value {
        loop {
            self.last += 1;
            let id = self.last;
            let request = json!({"jsonrpc": "2.0", "id": id, "method": method, "params": params});
            self.client.send(&request.to_string());
            let mut answer = self.client.wait(method, |text| {
                let answer: Value = serde_json::from_str(text).ok()?;
                (answer["id"] == json!(id)).then_some(answer)
            });
            match answer["error"]["code"].as_i64() {
                None => return answer["result"].take(),
                Some(-32005) => thread::sleep(Duration::from_millis(20)),
                Some(_) => panic!("{method} {params}: {answer}"),
            }
        }
    }

    /// Loads another command and schedules it as the successor of the last one.
    fn extend(&mut self) {
        let name = ["MoveToA", "MoveToC", "MoveToE"][self.made % 3];
        self.made += 1;
        let load = json!({
            "session": self.session,
            "text": self.program,
            "command": name,
            "title": TITLE,
        });
        let command = self.call("command.load", &load)["command"].take();
        if let Some(before) = self.chain.back().cloned() {
            let schedule = json!({"command": command, "after": before});
            self.call("command.schedule", &schedule);
            let waits = ["ready", "scheduled"].map(Value::from);
            self.late += usize::from(!waits.contains(&self.state(&before)));
        }
        self.chain.push_back(command);
    }

    /// Removes the first command of the chain once it has ended.
    fn go_on(&mut self) {
        let first = self.chain[0].clone();
        if self.state(&first) == "terminated" {
            self.call("command.unload", &json!({"command": first}));
            self.chain.pop_front();
            self.extend();
        }
    }

    fn state(&mut self, command: &Value) -> Value {
        self.call("command.describe", &json!({"command": command}))["state"].take()
    }
}
