//! `rpi recording`: subcommands, and the code of `info` and `recover`.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use clap::Subcommand;
use rpi_record::mcap::{Recording, RecordingError, RecordingSummary, complete, recording_files};

use crate::exit::{CommandResult, Exit};
use crate::recording_edits::{CutArgs, MergeArgs, cut_command, merge_command};

/// Subcommands of `rpi recording`.
#[derive(Debug, Subcommand)]
pub(crate) enum RecordingCommand {
    /// Print what a recording has: its program, time, commands, files, and how it ends.
    Info {
        /// Recording (.mcap): the file of its first part.
        recording: PathBuf,
        /// Print a JSON object.
        #[arg(long)]
        json: bool,
    },
    /// Give a recording that was cut off, because its process was killed or the disk was full, an index and an end, in place.
    ///
    /// `rpi replay` and `rpi view` read such a recording without this; other viewers may need it.
    Recover {
        /// Recording (.mcap): the file of its first part.
        recording: PathBuf,
    },
    /// Write a part of a recording to a recording of its own.
    ///
    /// A part from 0 on can be replayed. A later one is for `rpi view`, `rpi export` and other viewers: the state of the core at its
    /// beginning is unknown.
    Cut(CutArgs),
    /// Write the messages of several recordings to one file for viewers, on a common time axis.
    ///
    /// Topics that several recordings have get the name of their file as first part of their names. The runs cannot be replayed from
    /// the new file.
    Merge(MergeArgs),
}

/// Carries out `rpi recording`.
pub(crate) fn recording(command: &RecordingCommand) -> CommandResult {
    match command {
        RecordingCommand::Info { recording, json } => info(recording, *json),
        RecordingCommand::Recover { recording } => recover(recording),
        RecordingCommand::Cut(args) => cut_command(args),
        RecordingCommand::Merge(args) => merge_command(args),
    }
}

fn info(path: &Path, json: bool) -> CommandResult {
    let recording = match Recording::open(path) {
        Err(RecordingError::Merged(names)) => return merged_info(path, &names, json),
        opened => opened.map_err(|e| format!("{}: {e}", path.display()))?,
    };
    let summary = recording.summary();
    let summary = summary.map_err(|e| format!("{}: {e}", path.display()))?;
    rpi_cli::print(match json {
        true => format!("{}\n", as_json(&summary, path)),
        false => as_text(&summary, path),
    })?;
    Ok(Exit::Success)
}

/// Prints what is known about a merged recording: the names of the files that it was made of.
fn merged_info(path: &Path, names: &str, json: bool) -> CommandResult {
    rpi_cli::print(match json {
        true => format!(
            "{}\n",
            serde_json::json!({ "merged": names.split(", ").collect::<Vec<_>>(), "replayable": false })
        ),
        false => format!(
            "merged    {names}\nreplay    not possible: use the recordings that it was made of\nfile      {}\n",
            path.display()
        ),
    })?;
    Ok(Exit::Success)
}

/// Returns each file of a recording with its size in bytes.
fn files(path: &Path) -> Vec<(PathBuf, u64)> {
    let size = |file: &PathBuf| std::fs::metadata(file).map_or(0, |data| data.len());
    let files = recording_files(path).into_iter();
    files.map(|file| (file.clone(), size(&file))).collect()
}

fn as_text(summary: &RecordingSummary, path: &Path) -> String {
    let seconds = |tick: u64| tick as f64 * summary.tick_ns as f64 * 1e-9;
    let mut text = String::new();
    let mut line = |name: &str, value: String| {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{name:<9} {value}");
    };
    line("program", summary.program.clone());
    let (start, end) = (summary.ticks.start, summary.ticks.end);
    line(
        "time",
        format!(
            "{:.3} s to {:.3} s, {} ticks of {}",
            seconds(start),
            seconds(end),
            end - start,
            rpi_driver::format_duration(summary.tick_ns)
        ),
    );
    line("devices", summary.devices.join(", "));
    for command in &summary.commands {
        let times = match command.ended {
            Some(ended) => format!(
                "{:.3} s to {:.3} s",
                seconds(command.started),
                seconds(ended)
            ),
            None => format!("from {:.3} s on", seconds(command.started)),
        };
        line("command", format!("{}, {times}", command.name));
    }
    for (file, size) in files(path) {
        line(
            "file",
            format!("{}, {:.2} MB", file.display(), size as f64 * 1e-6),
        );
    }
    if !summary.is_replayable {
        line(
            "replay",
            "not possible: the recording does not begin with the run".to_owned(),
        );
    }
    if summary.lost > 0 {
        line("lost", format!("{} ticks are missing", summary.lost));
    }
    if let Some(cut) = &summary.cut {
        line("cut off", cut.clone());
    }
    text
}

fn as_json(summary: &RecordingSummary, path: &Path) -> serde_json::Value {
    let commands = summary.commands.iter().map(|command| {
        serde_json::json!({"name": command.name, "started": command.started, "ended": command.ended})
    });
    let files = files(path)
        .into_iter()
        .map(|(file, size)| serde_json::json!({"path": file.display().to_string(), "bytes": size}));
    serde_json::json!({
        "program": summary.program,
        "tick_ns": summary.tick_ns,
        "first_tick": summary.ticks.start,
        "end_tick": summary.ticks.end,
        "devices": summary.devices,
        "commands": commands.collect::<Vec<_>>(),
        "files": files.collect::<Vec<_>>(),
        "lost": summary.lost,
        "cut": summary.cut,
        "replayable": summary.is_replayable,
    })
}

fn recover(path: &Path) -> CommandResult {
    let completed = complete(path, "the recording was recovered: it had no end");
    let completed = completed.map_err(|e| format!("{}: {e}", path.display()))?;
    rpi_cli::print(match completed {
        None => format!("{}: complete already\n", path.display()),
        Some(done) => format!(
            "{}: recovered, with {} ticks in this file; {} bytes of an incomplete record were removed\n",
            done.file.display(),
            done.ticks,
            done.removed_bytes
        ),
    })?;
    Ok(Exit::Success)
}
