//! The recording of a control core that has crashed.

use std::io;
use std::path::{Path, PathBuf};
use std::thread::JoinHandle;

use rpi_record::mcap::{complete, part_path, recording_files};

/// Completes the recording of a core that has crashed for the reason `why`, on a thread of its own, because a long
/// recording takes a while. With `keep`, its files are renamed first, because the next core writes a recording with the
/// same name.
///
/// # Errors
/// If a file cannot be renamed, or the thread cannot be started.
pub(super) fn complete_recording(
    recording: Option<&Path>,
    why: &str,
    keep: bool,
) -> io::Result<Option<JoinHandle<()>>> {
    let Some(recording) = recording.filter(|recording| recording.is_file()) else {
        return Ok(None);
    };
    let path = match keep {
        true => rename(recording)?,
        false => recording.to_owned(),
    };
    let why = format!("the control core {why}");
    let thread = std::thread::Builder::new().name("rpi-complete".into());
    thread
        .spawn(move || print_completion(&path, &why))
        .map(Some)
}

fn print_completion(path: &Path, why: &str) {
    let name = path.display();
    match complete(path, why) {
        Ok(Some(completed)) => rpi_diag::println_stderr!(
            "guard: the recording {name} is completed, with {} in {}; `rpi replay {name}` replays it",
            rpi_diag::with_noun(completed.ticks, "cycle"),
            completed.file.display()
        ),
        Ok(None) => rpi_diag::println_stderr!("guard: the recording {name} is complete"),
        Err(error) => {
            rpi_diag::println_stderr!("guard: the recording {name} is not completed: {error}");
        }
    }
}

/// Renames the files of a recording to the first name `out.crash-1.mcap`, `out.crash-2.mcap`, ... that does not exist.
fn rename(recording: &Path) -> io::Result<PathBuf> {
    let names = (1_u32..).map(|number| recording.with_extension(format!("crash-{number}.mcap")));
    let free = names.into_iter().find(|name| !name.exists());
    let free = free.ok_or(io::ErrorKind::AlreadyExists)?;
    for (part, file) in (1..).zip(recording_files(recording)) {
        std::fs::rename(file, part_path(&free, part))?;
    }
    Ok(free)
}
