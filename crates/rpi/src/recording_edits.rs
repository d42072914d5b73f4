//! `rpi recording cut` and `rpi recording merge`: recordings that are made from other recordings.

use std::error::Error;
use std::fs::File;
use std::io::BufWriter;
use std::ops::Range;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use rpi_record::mcap::{Recording, RecordingError, TimeAxis, cut, merge, recording_files};

use crate::exit::{CommandResult, Exit};
use crate::{output, recorded_run};

/// Options of `rpi recording cut`.
#[derive(Args, Debug)]
pub(crate) struct CutArgs {
    /// Recording (.mcap): the file of its first part.
    recording: PathBuf,
    /// Begin at this time of the run, such as 10s; default: with the recording.
    #[arg(long, value_name = "TIME", value_parser = rpi_driver::parse_duration)]
    from: Option<u64>,
    /// End at this time of the run, such as 20s; default: with the recording.
    #[arg(long, value_name = "TIME", value_parser = rpi_driver::parse_duration)]
    to: Option<u64>,
    /// File of the new recording (.mcap).
    #[arg(long, short, visible_alias = "out", value_name = "FILE")]
    output: PathBuf,
}

/// Options of `rpi recording merge`.
#[derive(Args, Debug)]
pub(crate) struct MergeArgs {
    /// Recordings (.mcap): the files of their first parts.
    #[arg(required = true, num_args = 2..)]
    recordings: Vec<PathBuf>,
    /// Common time axis of the recordings.
    #[arg(long, value_name = "AXIS", default_value = "clock")]
    align: Alignment,
    /// File of the new recording (.mcap).
    #[arg(long, short, visible_alias = "out", value_name = "FILE")]
    output: PathBuf,
}

/// Common time axis of merged recordings, as an option.
#[derive(ValueEnum, Clone, Copy, Debug)]
enum Alignment {
    /// The wall clock of each recording.
    Clock,
    /// All recordings begin when the first one begins.
    Start,
}

/// Carries out `rpi recording cut`.
pub(crate) fn cut_command(args: &CutArgs) -> CommandResult {
    let recording = recorded_run::open(&args.recording)?;
    let tick = |ns: u64| ns / recording.tick_ns;
    let ticks: Range<u64> = args.from.map_or(0, tick)..args.to.map_or(u64::MAX, tick);
    if ticks.is_empty() {
        return Err("--from must be before --to".into());
    }
    let file = create(&args.output, std::slice::from_ref(&args.recording))?;
    let done = cut(&recording, &ticks, BufWriter::new(file));
    let done = removed_on_error(done, &args.output, &args.recording)?;
    let seconds = |tick: u64| tick as f64 * recording.tick_ns as f64 * 1e-9;
    let note = match done.is_replayable {
        true => "",
        false => "; it does not begin with the run and cannot be replayed",
    };
    rpi_cli::print(format!(
        "{}: {:.3} s to {:.3} s{note}\n",
        args.output.display(),
        seconds(done.ticks.start),
        seconds(done.ticks.end)
    ))?;
    Ok(Exit::Success)
}

/// Carries out `rpi recording merge`.
pub(crate) fn merge_command(args: &MergeArgs) -> CommandResult {
    let mut recordings: Vec<(String, Recording)> = Vec::new();
    for path in &args.recordings {
        let name = path.file_stem().unwrap_or_default();
        recordings.push((
            name.to_string_lossy().into_owned(),
            recorded_run::open(path)?,
        ));
    }
    let axis = match args.align {
        Alignment::Clock => TimeAxis::WallClock,
        Alignment::Start => TimeAxis::Start,
    };
    let file = create(&args.output, &args.recordings)?;
    let done = merge(&recordings, axis, BufWriter::new(file));
    let done = removed_on_error(done, &args.output, &args.output)?;
    let mut text = format!(
        "{}: {} messages, for viewers; the runs cannot be replayed from this file\n",
        args.output.display(),
        done.messages
    );
    for topic in done.renamed {
        text.push_str(&format!("renamed {topic}\n"));
    }
    rpi_cli::print(text)?;
    Ok(Exit::Success)
}

/// Creates the file of a new recording, which must not be a file of one of the recordings `sources`.
fn create(path: &Path, sources: &[PathBuf]) -> Result<File, Box<dyn Error>> {
    let files: Vec<PathBuf> = sources
        .iter()
        .flat_map(|path| recording_files(path))
        .collect();
    let files: Vec<&Path> = files.iter().map(PathBuf::as_path).collect();
    output::create(path, &files)
}

/// Returns a result; an error begins with the name of the file `about`, and removes the incomplete file `path`.
fn removed_on_error<T>(
    done: Result<T, RecordingError>,
    path: &Path,
    about: &Path,
) -> Result<T, Box<dyn Error>> {
    done.map_err(|error| {
        // The error is what counts, whether the file can be removed or not.
        let _ = std::fs::remove_file(path);
        format!("{}: {error}", about.display()).into()
    })
}
