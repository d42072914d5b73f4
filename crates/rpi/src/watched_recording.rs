//! Flows that a recording does not have: compiles its program again with these flows exported, for a replay.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use rpi_driver::{
    AnalysedNet, ClaimPolicy, CompileOptions, Compiled, Input, InputKind, LowerError,
};
use rpi_image::Image;
use rpi_record::mcap::Recording;

use crate::program;

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
    compiled_again(recording, names, program, |net, period| {
        rpi_driver::lower_with_work(net, period).map(|(image, _)| image)
    })
    .map(|_| ())
}

/// Compiles the program of a recording again, with the flows called `names` exported, and replaces the images of the recording by
/// those that `lower` makes for the period of the cycle in ns. Returns the program.
pub(crate) fn compiled_again(
    recording: &mut Recording,
    names: &[String],
    program: Option<&Path>,
    lower: fn(&AnalysedNet, u64) -> Result<Image, LowerError>,
) -> Result<Compiled, Box<dyn Error>> {
    let (input, options) = match program {
        Some(file) => (rpi_driver::read(file)?, CompileOptions::default()),
        None => stored_program(recording)?,
    };
    let compile = |watch: &[String]| {
        let options = CompileOptions {
            claims: ClaimPolicy::Off,
            watch: watch.to_vec(),
            ..options.clone()
        };
        program::compile_again(&input, options)
    };
    let (plain, watched) = (compile(&[])?, compile(names)?);
    let period = recording.tick_ns;
    let mut images = Vec::new();
    for (plain, watched) in plain.nets().iter().zip(watched.nets()) {
        let (recorded, _) = rpi_driver::lower_with_work(plain, period)?;
        images.push((recorded, Arc::new(lower(watched, period)?)));
    }
    if recording.watch(&images) == 0 {
        let hint = match program {
            Some(_) => "",
            None => "; name its file with --program if it uses other files",
        };
        let name = input.path.display();
        return Err(format!(
            "{name} is not the program that was recorded, or it was compiled by another version{hint}"
        )
        .into());
    }
    Ok(watched)
}

/// Returns the program of a recording, with the options that its cell demands.
fn stored_program(recording: &Recording) -> Result<(Input, CompileOptions), Box<dyn Error>> {
    let missing = "the recording has no text of a program; name its file with --program";
    let source = recording.source().ok_or(missing)?;
    let path = PathBuf::from(&recording.program);
    let input = Input {
        kind: InputKind::from_path(&path).ok_or(missing)?,
        path,
        bytes: source.as_bytes().to_vec(),
    };
    let options = CompileOptions {
        // What lies beside a file of this name here need not be what lay beside the program.
        no_files: true,
        arm_axes: recording.arm_axes().into(),
        ..CompileOptions::default()
    };
    Ok((input, options))
}
