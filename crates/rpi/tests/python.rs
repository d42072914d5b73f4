//! Runs the tests of the Python client against this server, if Python is installed: from its sources, and as a wheel in a
//! fresh virtual environment.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Asyncio and the type annotations of the client require this version.
const SINCE: &str = "import sys; sys.exit(sys.version_info < (3, 10))";

/// Imports the client without any other package, and shows the message for a package that is missing.
const BASE_ONLY: &str = "
import rpi_client
try:
    rpi_client.Recording(rpi_client.__file__).topics
except ImportError as error:
    assert 'rpi-client[mcap]' in str(error), error
else:
    raise AssertionError('mcap is installed')
";

fn client() -> PathBuf {
    rpi_testkit::workspace_root().join("clients/python")
}

/// Returns the name of a Python of a sufficient version; `None` after a line that reports the skipped test.
fn python(test: &str) -> Option<&'static str> {
    let found = ["python3", "python"].into_iter().find(|name| {
        let there = Command::new(name).args(["-c", SINCE]).status();
        there.is_ok_and(|status| status.success())
    });
    if found.is_none() {
        skip(test, "there is no Python 3.10 or later");
    }
    found
}

/// Reports a skipped test. Writes past the test harness, which captures the output of passing tests.
fn skip(test: &str, why: &str) {
    let line = format!("SKIPPED: {test}: {why}\n");
    std::io::stderr().write_all(line.as_bytes()).unwrap();
}

/// Runs the tests of the client in a folder. Prints the last line, which has the number of skipped tests.
fn run_tests(python: &mut Command, folder: &Path) {
    let server = Path::new(env!("CARGO_BIN_EXE_rpi"));
    // The compiler is in the same folder if it was built; cargo does not build it for this crate.
    let compiler = server.with_file_name("rpic");
    if compiler.exists() {
        python.env("RPIC", compiler);
    }
    let arguments = ["-W", "error", "-m", "unittest", "discover", "-s", "tests"];
    python.args(arguments).current_dir(folder);
    let output = python
        .env("RPI", server)
        .env("PYTHONDONTWRITEBYTECODE", "1");
    let stderr = succeeded(&output.output().unwrap());
    println!("{}", stderr.lines().last().unwrap_or_default());
}

/// Returns the messages of a process, which must have succeeded.
fn succeeded(output: &Output) -> String {
    let [stdout, stderr] = [&output.stdout, &output.stderr].map(|s| String::from_utf8_lossy(s));
    assert!(output.status.success(), "{stdout}{stderr}");
    stderr.into_owned()
}

#[test]
fn the_python_client_drives_the_server() {
    if let Some(python) = python("the Python client") {
        run_tests(&mut Command::new(python), &client());
    }
}

/// A virtual environment in a folder.
struct Environment {
    folder: PathBuf,
}

impl Environment {
    /// Creates the environment; `None` if Python was installed without the module for it, as some distributions do.
    fn new(python: &str, folder: &Path) -> Option<Environment> {
        let mut venv = Command::new(python);
        venv.args(["-m", "venv"]).arg(folder);
        let output = venv.output().unwrap();
        output.status.success().then(|| Environment {
            folder: folder.to_owned(),
        })
    }

    fn python(&self) -> Command {
        let mut python = Command::new(self.folder.join("bin/python"));
        python.env_remove("PYTHONPATH");
        python
    }

    fn pip(&self, arguments: &[&str]) -> Output {
        let mut pip = self.python();
        pip.args(["-m", "pip", "--disable-pip-version-check", "--quiet"]);
        // Compiling all modules of the packages ahead takes longer than the tests, which import few of them.
        if arguments[0] == "install" {
            pip.env("PIP_NO_COMPILE", "1");
        }
        pip.args(arguments).output().unwrap()
    }
}

/// The wheel needs nothing but Python without its extras. With them, the tests that need extras or no server pass on the installed
/// wheel, none is skipped for a missing package, and both are free of type errors.
#[test]
fn the_wheel_works_in_a_fresh_environment() {
    const TEST: &str = "the wheel of the Python client";
    let Some(python) = python(TEST) else { return };
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let Some(fresh) = Environment::new(python, &folder.path().join("fresh")) else {
        return skip(TEST, "Python cannot create virtual environments");
    };
    if !fresh.pip(&["install", "hatchling"]).status.success() {
        return skip(TEST, "the registry of Python packages cannot be reached");
    }
    let (source, built) = (client().to_str().unwrap().to_owned(), path("wheels"));
    let build = [
        "wheel",
        "--no-deps",
        "--no-build-isolation",
        "--wheel-dir",
        &built,
    ];
    succeeded(&fresh.pip(&[&build[..], &[&source]].concat()));
    let wheels: Vec<_> = std::fs::read_dir(&built).unwrap().collect();
    let [Ok(wheel)] = &wheels[..] else {
        panic!("expected one wheel: {wheels:?}");
    };
    let wheel = wheel.path().to_str().unwrap().to_owned();

    succeeded(&fresh.pip(&["install", "--no-index", &wheel]));
    let alone = fresh
        .python()
        .args(["-W", "error", "-c", BASE_ONLY])
        .output();
    succeeded(&alone.unwrap());

    let all = format!("{wheel}[ros2,numpy,pandas,polars,parquet,jupyter]");
    succeeded(&fresh.pip(&["install", &all, "mypy", "pandas-stubs"]));
    // Away from the sources, so that the tests import what is installed.
    for part in ["tests", "examples"] {
        std::fs::create_dir(path(part)).unwrap();
        for file in rpi_testkit::files_below(&format!("clients/python/{part}"), &[".py"]) {
            let copy = Path::new(&path(part)).join(file.file_name().unwrap());
            std::fs::copy(&file, copy).unwrap();
        }
    }
    for checked in [&["tests"][..], &["examples"], &["-p", "rpi_client"]] {
        let mut check = fresh.python();
        check.args(["-m", "mypy", "--strict"]).args(checked);
        succeeded(&check.current_dir(&folder).output().unwrap());
    }
    // The other tests with a server have run from the sources, and a wheel has the same modules.
    let mut tests = fresh.python();
    tests.env("RPI_ALL_EXTRAS", "1").env("RPI_ONLY_EXTRAS", "1");
    run_tests(&mut tests, folder.path());
}
