//! Latency from a keystroke to its diagnostics in a file of 1 000 lines, over pipes, waiting for a pause included.
//!
//! `cargo bench -p rpi-lsp` prints the figures. The target is 30 ms for 99 of 100 keystrokes.

use std::fmt::Write as _;
use std::io::BufReader;
use std::thread;
use std::time::{Duration, Instant};

use rpi_testkit::LspClient;
use serde_json::{Value, json};

const URI: &str = "file:///cell/large.rpi";
const LINES: usize = 1000;
const KEYSTROKES: usize = 400;

/// Time between two keystrokes: 40 ms, as of a fast typist.
const KEYSTROKE_INTERVAL: Duration = Duration::from_millis(40);

/// Returns a program of [`LINES`] lines: controllers that call one another, and commands that use them.
fn program() -> String {
    let mut text = String::from("use motion;\n");
    let mut k = 0;
    while text.lines().count() < LINES {
        // Writing to a string cannot fail.
        let _ = match k % 8 {
            7 => write!(text, "{}", command(k)),
            _ => write!(text, "{}", controller(k)),
        };
        k += 1;
    }
    text
}

/// Returns the text of node number `k`, a filtered PI controller. Every second controller calls the previous one.
fn controller(k: usize) -> String {
    let inner = match k % 2 {
        1 => format!("controller_{}(target: target, seen: seen)", k - 1),
        _ => "error * 3.5[1/s]".to_owned(),
    };
    format!(
        "\n--| Controller {k}.\nnode controller_{k} (target, seen: real[m]) returns (speed: real[m/s])\nlet\n  \
         error = target - seen;\n  smooth = 0[m] -> 0.9 * pre smooth + 0.1 * error;\n  \
         sum = 0[m*s] -> pre sum + smooth * dt;\n  p = {inner};\n  i = sum * 0.25[1/s^2];\n  \
         raw = if abs_{k} > 1[m] then p else p + i;\n  abs_{k} = if error < 0[m] then -error else error;\n  \
         speed = raw;\ntel\n"
    )
}

fn command(k: usize) -> String {
    let used = k - 1;
    format!(
        "\n--| Command {k}.\ncommand Go_{k} (arm: Arm; there: Pose)\nlet\n  \
         way = Line<<speed: 250[mm/s]>>(arm, there);\n  arm.tcp = way.pose;\n  \
         speed = controller_{used}(target: way.travelled, seen: distance(way.start, arm.pose));\n  \
         export speed;\n  finish at_end when way.done;\n  fail arm_error when arm.error;\ntel\n"
    )
}

fn connect() -> LspClient {
    let (server_in, client_out) = std::io::pipe().expect("a pipe");
    let (client_in, server_out) = std::io::pipe().expect("a pipe");
    thread::spawn(|| rpi_lsp::serve(BufReader::new(server_in), server_out));
    LspClient::new(client_in, client_out)
}

/// Returns the change of the document for keystroke number `k`, in the form of the protocol. A word grows letter by
/// letter and is then replaced; most of the texts have a syntax error.
fn edit(k: usize) -> Value {
    let column = 12 + (k % 8) as u64;
    let start = json!({ "line": LINES / 2, "character": 0 });
    match k % 8 {
        0 => {
            let end = json!({ "line": LINES / 2, "character": column + 8 });
            json!({ "range": { "start": start, "end": end }, "text": "  unfinished" })
        }
        _ => {
            let at = json!({ "line": LINES / 2, "character": column - 1 });
            json!({ "range": { "start": at, "end": at }, "text": "x" })
        }
    }
}

fn main() {
    let text = program();
    let mut client = connect();
    client.initialize(json!({}));
    client.open(URI, &text);
    let found = client.diagnostics(URI, 1);
    println!(
        "{} lines, {} diagnostics",
        text.lines().count(),
        found.len()
    );
    let mut spans = Vec::with_capacity(KEYSTROKES);
    for k in 0..KEYSTROKES {
        thread::sleep(KEYSTROKE_INTERVAL);
        let version = k as i64 + 2;
        let begun = Instant::now();
        client.change(URI, version, edit(k));
        client.diagnostics(URI, version);
        spans.push(begun.elapsed());
    }
    spans.sort_unstable();
    let at = |part: f64| spans[((spans.len() - 1) as f64 * part) as usize].as_secs_f64() * 1e3;
    println!(
        "keystroke to diagnostics: {:.1} ms median, {:.1} ms p99, {:.1} ms at most",
        at(0.5),
        at(0.99),
        at(1.0)
    );
    client.shutdown();
}
