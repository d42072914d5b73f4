//! Flows that a recording does not have: compiles its program again with these flows exported, for a replay.

use std::error::Error;
use std::path::Path;

use rpi_debug::{Lowering, RecordedProgram, RecordedProgramError};
use rpi_driver::Compiled;
use rpi_record::mcap::Recording;

/// Makes the flows called `names` part of the values of a recording. `program` is the file of the program that was run;
/// without one, its text in the recording is used, which is enough if the program uses only modules of the library.
///
/// # Errors
/// Returns an error if a name is unknown, or if the program does not compile to the recorded images.
pub(crate) fn watch(
    recording: &mut Recording,
    names: &[String],
    program: Option<&Path>,
) -> Result<(), Box<dyn Error>> {
    compiled_again(recording, names, program, |net, period, tick| {
        rpi_driver::lower_for_tick(net, period, tick).map(|(image, _)| image)
    })
    .map(|_| ())
}

/// Compiles the program of a recording again, with the flows called `names` exported, and replaces the images of the recording by
/// those that `lower` makes for the period of the cycle in ns. Returns the program.
pub(crate) fn compiled_again(
    recording: &mut Recording,
    names: &[String],
    program: Option<&Path>,
    lower: Lowering,
) -> Result<Compiled, Box<dyn Error>> {
    recording.check_replayable()?;
    let program = RecordedProgram::new(recording, program)?;
    let compiled = program.compile(recording, (names, None), lower);
    let compiled = compiled.map(|compiled| compiled.compiled);
    compiled.map_err(|error| match error {
        RecordedProgramError::Diagnostics { text, .. } => {
            rpi_diag::print_stderr!("{text}");
            format!("{} does not compile", program.path().display()).into()
        }
        other => other.into(),
    })
}
