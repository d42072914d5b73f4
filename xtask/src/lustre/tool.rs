//! Our tools as processes.

use crate::task_error::TaskError;
use std::fs::File;
use std::io::{Read, Seek};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Maximum time for one run of a tool. After that the tool is stopped.
const TIMEOUT: Duration = Duration::from_secs(60);

/// The tools `rpi` and `rpic`, built for testing a corpus of programs.
pub(crate) struct Tools {
    folder: PathBuf,
    /// Options that follow those of each run of a program.
    run_options: Vec<String>,
}

/// Exit status and output of a run of a tool.
pub(crate) struct ToolOutput {
    /// Exit status of the tool; `None` if it crashed, was stopped or could not be started.
    pub(crate) status: Option<i32>,
    pub(crate) out: String,
    pub(crate) err: String,
}

impl Tools {
    /// Builds `rpi` and `rpic` with the build profile of this program (release or debug). With a C compiler, programs also
    /// run in C.
    pub(crate) fn build(compiler: Option<&str>) -> Result<Tools, TaskError> {
        let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".to_owned());
        let args = [
            "build",
            "--quiet",
            "--workspace",
            "--bin",
            "rpi",
            "--bin",
            "rpic",
        ];
        let profile = (!cfg!(debug_assertions)).then_some("--release");
        let status = Command::new(cargo).args(args).args(profile).status();
        if !status.is_ok_and(|status| status.success()) {
            return Err("cannot build the tools".into());
        }
        let me = std::env::current_exe().map_err(|e| e.to_string())?;
        let folder = me.parent().map(Path::to_owned);
        Ok(Tools {
            folder: folder.ok_or("cannot locate the tools")?,
            run_options: compiler.map_or_else(Vec::new, |command| {
                ["--target", "c", "--cc", command].map(str::to_owned).into()
            }),
        })
    }

    /// Runs a tool with arguments to its end, or stops it after the time limit. Returns its exit status and output.
    pub(crate) fn run(&self, tool: &str, args: &[&str]) -> ToolOutput {
        let ended = self.run_to_end(tool, args);
        ended.unwrap_or_else(|error| ToolOutput {
            status: None,
            out: String::new(),
            err: error.to_string(),
        })
    }

    fn run_to_end(&self, tool: &str, args: &[&str]) -> std::io::Result<ToolOutput> {
        let (out, err) = (tempfile::tempfile()?, tempfile::tempfile()?);
        let mut child = Command::new(self.folder.join(tool))
            .args(args)
            .args(
                self.run_options
                    .iter()
                    .filter(|_| args.first() == Some(&"run")),
            )
            .env("NO_COLOR", "1")
            .stdin(Stdio::null())
            .stdout(out.try_clone()?)
            .stderr(err.try_clone()?)
            .spawn()?;
        Ok(ToolOutput {
            status: wait_with_timeout(&mut child)?,
            out: read(out)?,
            err: read(err)?,
        })
    }
}

fn wait_with_timeout(child: &mut Child) -> std::io::Result<Option<i32>> {
    let start = Instant::now();
    while start.elapsed() < TIMEOUT {
        if let Some(status) = child.try_wait()? {
            return Ok(status.code());
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    child.kill()?;
    child.wait()?;
    Ok(None)
}

fn read(mut file: File) -> std::io::Result<String> {
    let mut bytes = Vec::new();
    file.rewind()?;
    file.read_to_end(&mut bytes)?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}
