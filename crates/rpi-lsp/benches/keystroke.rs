//! Latency of the server over pipes: from a keystroke to its diagnostics, and of completion.
//!
//! `cargo bench -p rpi-lsp` prints the figures beside the bars: the median of the 99th percentiles of three runs. The bars
//! are those of a responsive editor: 10 ms in a file of 1 000 lines, 30 ms in 10 000 lines, 20 ms for a completion. The
//! file is open in a workspace of 200 files.
//!
//! Keystrokes in a body change one declaration. Words between declarations are syntax errors. Keystrokes in a header change
//! what other declarations can refer to.

use std::fmt::Write as _;
use std::io::BufReader;
use std::path::Path;
use std::thread;
use std::time::{Duration, Instant};

use rpi_testkit::LspClient;
use serde_json::{Value, json};

const KEYSTROKES: usize = 200;
const RUNS: usize = 3;

/// Time between two keystrokes: 40 ms, as of a fast typist.
const KEYSTROKE_INTERVAL: Duration = Duration::from_millis(40);

/// Number of lines of a file, and the bar for the time from a keystroke to its diagnostics in milliseconds.
const SIZES: [(usize, f64); 2] = [(1000, 10.0), (10_000, 30.0)];

/// Bar for the time of a completion in milliseconds.
const COMPLETION_BAR: f64 = 20.0;

/// Number of files of the workspace beside the edited one.
const OTHER_FILES: usize = 199;

/// Place of the keystrokes.
#[derive(Clone, Copy)]
enum EditPlace {
    Body,
    BetweenDeclarations,
    Header,
}

/// Places of the keystrokes with their names.
const PLACES: [(EditPlace, &str); 3] = [
    (EditPlace::Body, "in a body"),
    (EditPlace::BetweenDeclarations, "between declarations"),
    (EditPlace::Header, "in a header"),
];

/// Returns a program of some lines: controllers that call one another, and commands that use them.
fn program(lines: usize) -> String {
    let mut text = String::from("use motion;\n");
    let mut k = 0;
    while text.lines().count() < lines {
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

/// Returns a folder with the files of a workspace, which the edited file does not use.
fn workspace() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    for k in 0..OTHER_FILES {
        let path = folder.path().join(format!("other_{k}.rpi"));
        std::fs::write(path, program(50)).expect("a file");
    }
    folder
}

/// Returns the number of the line in which the keystrokes are, the first such line from the middle of the text on.
fn edited_line(text: &str, place: EditPlace) -> usize {
    let middle = text.lines().count() / 2;
    let fits = |line: &str| match place {
        EditPlace::Body => line.starts_with("  smooth"),
        EditPlace::BetweenDeclarations => line.starts_with("--|"),
        EditPlace::Header => line.is_empty(),
    };
    let mut lines = text.lines().enumerate().skip(middle);
    lines.find(|(_, line)| fits(line)).map_or(0, |(at, _)| at)
}

/// Returns the change of the document for keystroke number `k`, in the form of the protocol. A word grows letter by
/// letter in the line `line` and is then replaced; most of the texts have a syntax error. In a header, the name of a port of
/// a new node grows.
fn edit(k: usize, line: usize, place: EditPlace) -> Value {
    let letter = (k % 8) as u64;
    let new = match place {
        EditPlace::Body | EditPlace::BetweenDeclarations => "  unfinished",
        EditPlace::Header => "node extra (in_port: int) returns (y: int) let y = 1; tel",
    };
    let column = match place {
        EditPlace::Body | EditPlace::BetweenDeclarations => 12,
        EditPlace::Header => 15,
    };
    let start = json!({ "line": line, "character": 0 });
    match letter {
        0 => {
            let end = json!({ "line": line, "character": 200 });
            json!({ "range": { "start": start, "end": end }, "text": new })
        }
        _ => {
            let at = json!({ "line": line, "character": column + letter - 1 });
            json!({ "range": { "start": at, "end": at }, "text": "x" })
        }
    }
}

/// Latencies of one run in milliseconds, sorted: keystrokes and completions.
fn run(lines: usize, place: EditPlace, folder: &Path) -> (Vec<f64>, Vec<f64>) {
    let text = program(lines);
    let uri = &format!("file://{}", folder.join("large.rpi").display());
    let line = edited_line(&text, place);
    let mut client = connect();
    let root = format!("file://{}", folder.display());
    let folders = json!([{ "uri": root, "name": "cell" }]);
    client.initialize_with(json!({ "capabilities": {}, "workspaceFolders": folders }));
    client.open(uri, &text);
    client.diagnostics(uri, 1);
    let (mut keystrokes, mut completions) = (Vec::new(), Vec::new());
    for k in 0..KEYSTROKES {
        thread::sleep(KEYSTROKE_INTERVAL);
        let version = k as i64 + 2;
        let begun = Instant::now();
        client.change(uri, version, edit(k, line, place));
        client.diagnostics(uri, version);
        keystrokes.push(begun.elapsed().as_secs_f64() * 1e3);
        let begun = Instant::now();
        let position = json!({ "line": line, "character": 6 });
        let params = json!({ "textDocument": { "uri": uri }, "position": position });
        client.result("textDocument/completion", params);
        completions.push(begun.elapsed().as_secs_f64() * 1e3);
    }
    client.shutdown();
    keystrokes.sort_by(f64::total_cmp);
    completions.sort_by(f64::total_cmp);
    (keystrokes, completions)
}

fn percentile(sorted: &[f64], part: f64) -> f64 {
    sorted[((sorted.len() - 1) as f64 * part) as usize]
}

/// Returns the medians over all runs of the median and of the 99th percentile.
fn summary(runs: &[Vec<f64>]) -> (f64, f64) {
    let median = |part: f64| {
        let mut all: Vec<f64> = runs.iter().map(|run| percentile(run, part)).collect();
        all.sort_by(f64::total_cmp);
        percentile(&all, 0.5)
    };
    (median(0.5), median(0.99))
}

fn print(what: &str, runs: &[Vec<f64>], bar: f64) {
    let (p50, p99) = summary(runs);
    let verdict = if p99 < bar { "kept" } else { "NOT kept" };
    println!("{what}: {p50:.1} ms median, {p99:.1} ms p99; bar {bar} ms {verdict}");
}

fn main() {
    let folder = workspace();
    for (lines, bar) in SIZES {
        for (place, name) in PLACES {
            let runs = (0..RUNS).map(|_| run(lines, place, folder.path()));
            let (keystrokes, completions): (Vec<_>, Vec<_>) = runs.unzip();
            let what = format!("{lines} lines, keystroke {name} to diagnostics");
            print(&what, &keystrokes, bar);
            let what = format!("{lines} lines, completion {name}");
            print(&what, &completions, COMPLETION_BAR);
        }
    }
}
