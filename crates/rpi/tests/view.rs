//! `rpi view` and `rpi run --report`: the files, the server, and the page in a browser.

mod support;

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

use support::{output_text, rpi};

/// Maximum size of the report of `examples/blending` in bytes.
const MAX_REPORT: u64 = 5_000_000;

fn example(name: &str) -> PathBuf {
    rpi_testkit::workspace_root().join(format!("examples/{name}/{name}.rpi"))
}

/// Runs a program with these options and the option `--report`. Returns the path of the report in `folder`.
fn report(program: &Path, name: &str, folder: &Path, options: &[&str]) -> PathBuf {
    let file = folder.join(format!("{name}.html"));
    let mut arguments = vec![
        "run",
        program.to_str().unwrap(),
        "--report",
        file.to_str().unwrap(),
    ];
    arguments.extend(options);
    let run = rpi(&arguments);
    assert_eq!(run.status.code(), Some(0), "{}", output_text(&run));
    file
}

/// Server of a recording, which ends with the test.
struct View {
    process: Child,
    url: String,
}

impl View {
    fn start(recording: &Path) -> View {
        let mut process = Command::new(env!("CARGO_BIN_EXE_rpi"))
            .args(["view", recording.to_str().unwrap(), "--no-open"])
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut url = String::new();
        let output = process.stdout.take().unwrap();
        BufReader::new(output).read_line(&mut url).unwrap();
        let url = url.trim().to_owned();
        View { process, url }
    }

    /// Sends a request with this method, path and host. Returns the response.
    fn request(&self, method: &str, path: &str, host: &str) -> Vec<u8> {
        let address = self.url.trim_start_matches("http://").trim_end_matches('/');
        let mut connection = TcpStream::connect(address).unwrap();
        write!(
            connection,
            "{method} {path} HTTP/1.1\r\nHost: {host}\r\n\r\n"
        )
        .unwrap();
        let mut response = Vec::new();
        connection.read_to_end(&mut response).unwrap();
        response
    }

    fn host(&self) -> &str {
        self.url.trim_start_matches("http://").trim_end_matches('/')
    }
}

impl Drop for View {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

#[test]
fn a_report_is_one_small_file_and_leaves_no_other() {
    let folder = tempfile::tempdir().unwrap();
    let file = report(&example("blending"), "blending", folder.path(), &[]);
    let size = std::fs::metadata(&file).unwrap().len();
    assert!((100_000..MAX_REPORT).contains(&size), "{size} bytes");
    println!("report of examples/blending: {size} bytes");
    let files: Vec<_> = std::fs::read_dir(folder.path())
        .unwrap()
        .flatten()
        .collect();
    assert_eq!(files.len(), 1, "{files:?}");
}

#[test]
fn the_server_shows_the_recording_to_this_machine_only() {
    let folder = tempfile::tempdir().unwrap();
    let recording = folder.path().join("out.mcap");
    let program = example("lifting");
    let options = [
        "run",
        program.to_str().unwrap(),
        "--record",
        recording.to_str().unwrap(),
    ];
    let run = rpi(&options);
    assert_eq!(run.status.code(), Some(0), "{}", output_text(&run));
    let view = View::start(&recording);
    assert!(view.url.starts_with("http://127.0.0.1:"), "{}", view.url);
    let page = view.request("GET", "/", view.host());
    assert!(page.starts_with(b"HTTP/1.1 200 OK\r\n"));
    let policy = b"Content-Security-Policy: default-src 'none'";
    assert!(page.windows(policy.len()).any(|part| part == policy));
    let document = view.request("GET", "/document", view.host());
    let magic = b"RPIVIEW1";
    assert!(document.windows(magic.len()).any(|part| part == magic));
    assert!(
        view.request("GET", "/", "evil.example")
            .starts_with(b"HTTP/1.1 403")
    );
    assert!(
        view.request("POST", "/", view.host())
            .starts_with(b"HTTP/1.1 405")
    );
    assert!(
        view.request("GET", "/x", view.host())
            .starts_with(b"HTTP/1.1 404")
    );
}

#[test]
fn invalid_requests_are_reported() {
    let folder = tempfile::tempdir().unwrap();
    let missing = folder.path().join("none.mcap");
    let view = rpi(&["view", missing.to_str().unwrap(), "--no-open"]);
    assert_eq!(view.status.code(), Some(2), "{}", output_text(&view));
    let same = folder.path().join("same.mcap");
    let (program, same) = (example("lifting"), same.to_str().unwrap());
    let run = rpi(&[
        "run",
        program.to_str().unwrap(),
        "--record",
        same,
        "--report",
        same,
    ]);
    assert_eq!(run.status.code(), Some(2), "{}", output_text(&run));
    assert!(
        output_text(&run).contains("--report"),
        "{}",
        output_text(&run)
    );
}

/// Returns the folder of the page if its packages are installed, with Node and Chromium.
fn browser_tests() -> Option<PathBuf> {
    let web = rpi_testkit::workspace_root().join("crates/rpi-view/web");
    let script = "import('./test/browser.mjs').then((b) => process.exit(b.chromiumPath() ? 0 : 1))";
    let node = Command::new("node")
        .args(["-e", script])
        .current_dir(&web)
        .output();
    node.is_ok_and(|output| output.status.success())
        .then_some(web)
}

#[test]
fn the_page_works_in_chromium() {
    let Some(web) = browser_tests() else {
        // Writes past the test harness, which captures the output of passing tests.
        let line = b"SKIPPED: the page of `rpi view` in a browser: no Node, no Chromium, or `npm ci` was not run in crates/rpi-view/web\n";
        return std::io::stderr().write_all(line).unwrap();
    };
    let folder = tempfile::tempdir().unwrap();
    let recording = folder.path().join("out.mcap");
    let record = ["--record", recording.to_str().unwrap()];
    report(&example("blending"), "blending", folder.path(), &record);
    report(&example("lifting"), "lifting", folder.path(), &[]);
    let long = twice_as_long(folder.path());
    report(&long, "long", folder.path(), &[]);
    let large = folder.path().join("of-20000-flows.rpi");
    std::fs::write(&large, of_20000_flows()).unwrap();
    report(&large, "large", folder.path(), &["--time", "10ms"]);
    let view = View::start(&recording);
    browse(&web, "page.test.mjs", folder.path(), &view.url);
}

/// Runs the tests of a file in Chromium.
fn browse(web: &Path, file: &str, reports: &Path, url: &str) {
    let output = Command::new("node")
        .args(["--test", "--test-concurrency=1", &format!("test/{file}")])
        .current_dir(web)
        .env("RPI_REPORTS", reports)
        .env("RPI_VIEW_URL", url)
        .output()
        .unwrap();
    println!("{}", output_text(&output));
    assert!(output.status.success(), "{}", output_text(&output));
}

/// Returns a program with 200 fragments of 100 flows each. Each flow reads an earlier one and one far back.
fn of_20000_flows() -> String {
    let mut text = "command Main ()\nlet\n  n = (0 -> pre n) + 1;\n".to_owned();
    for fragment in 0..200 {
        let source = match fragment {
            0 => "n".to_owned(),
            _ => format!("(F{}.x99 ?? 0)", fragment - 1),
        };
        text.push_str(&format!(
            "  fragment F{fragment} when n mod {} = 0\n  let\n    x0 = {source} + 1;\n",
            2 + fragment % 7
        ));
        for flow in 1..100 {
            let far = flow * 7 % 13 % flow;
            text.push_str(&format!(
                "    x{flow} = (x{} + x{far}) mod 1000;\n",
                flow - 1
            ));
        }
        text.push_str("  tel\n");
    }
    text.push_str("  last = F199.x99 ?? 0;\n  finish over when last < 0;\n  export last;\ntel\n");
    text
}

#[test]
fn the_page_follows_a_run() {
    let Some(web) = browser_tests() else {
        // Reported by the test above.
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let recording = folder.path().join("out.mcap");
    let mut run = Command::new(env!("CARGO_BIN_EXE_rpi"))
        .arg("run")
        .arg(example("blending"))
        .args(["--real-time", "--time", "20s", "--period", "10ms"])
        .args(["--view", "--no-open", "--record"])
        .arg(&recording)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut messages = BufReader::new(run.stderr.take().unwrap()).lines();
    let mut lines = messages.by_ref().map_while(Result::ok);
    let url = lines.find_map(|line| {
        let (_, url) = line.split_once("the run is shown at ")?;
        Some(url.trim().to_owned())
    });
    let url = url.expect("the run prints the address of its page");
    // The rest of the messages must not fill the pipe.
    let rest = std::thread::spawn(move || messages.map_while(Result::ok).collect::<Vec<_>>());
    browse(&web, "live.test.mjs", folder.path(), &url);
    rustix::process::kill_process(
        rustix::process::Pid::from_child(&run),
        rustix::process::Signal::INT,
    )
    .unwrap();
    let status = run.wait().unwrap();
    let messages = rest.join().unwrap();
    assert_eq!(status.code(), Some(0), "{messages:?}");
    // No tick is missing although a page was shown.
    let replay = rpi(&["replay", recording.to_str().unwrap()]);
    assert_eq!(replay.status.code(), Some(0), "{}", output_text(&replay));
}

/// Writes the program of `examples/blending` with twice as many rounds: more than 100 000 cycles. Returns its path.
fn twice_as_long(folder: &Path) -> PathBuf {
    let program = example("blending");
    let text = std::fs::read_to_string(&program).unwrap();
    assert!(text.contains("repeat 9 times"));
    let folder = folder.join("long");
    std::fs::create_dir(&folder).unwrap();
    std::fs::copy(
        program.with_file_name("cell.toml"),
        folder.join("cell.toml"),
    )
    .unwrap();
    let long = folder.join("long.rpi");
    std::fs::write(&long, text.replace("repeat 9 times", "repeat 18 times")).unwrap();
    long
}
