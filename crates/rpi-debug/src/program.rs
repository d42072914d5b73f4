//! The program of a recording, compiled again.

use std::collections::BTreeSet;
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use rpi_diag::{Severity, Style, render};
use rpi_driver::{
    AnalysedNet, ClaimPolicy, CompileOptions, Compiled, Input, InputError, InputKind, LowerError,
};
use rpi_image::Image;
use rpi_record::mcap::Recording;

/// Error in compiling the program of a recording again.
#[derive(Debug)]
pub enum RecordedProgramError {
    /// The recording has no text of a program.
    NoText,
    /// The file of the program cannot be read or is of a wrong kind.
    Input(InputError),
    /// The program does not compile: the messages of the errors without their places, and all diagnostics as text for a terminal.
    Diagnostics {
        /// Messages of the errors.
        messages: Vec<String>,
        /// All diagnostics, rendered.
        text: String,
    },
    /// A flow that is to be watched does not exist; the text names it.
    UnknownFlow(String),
    /// A command is too large.
    Lower(LowerError),
    /// The program is not the one that was recorded; the name of its file.
    OtherProgram {
        /// File of the program.
        path: PathBuf,
        /// Whether the text is that in the recording, without the files that it uses.
        is_stored: bool,
    },
}

impl fmt::Display for RecordedProgramError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            RecordedProgramError::NoText => {
                f.write_str("the recording has no text of a program; name its file with --program")
            }
            RecordedProgramError::Input(error) => error.fmt(f),
            RecordedProgramError::Diagnostics { messages, .. } => f.write_str(&messages.join("; ")),
            RecordedProgramError::UnknownFlow(text) => f.write_str(text),
            RecordedProgramError::Lower(error) => error.fmt(f),
            RecordedProgramError::OtherProgram { path, is_stored } => {
                let hint = match is_stored {
                    true => "; name its file with --program if it uses other files",
                    false => "",
                };
                let name = path.display();
                write!(
                    f,
                    "{name} is not the program that was recorded, or it was compiled by another version{hint}"
                )
            }
        }
    }
}

impl std::error::Error for RecordedProgramError {}

impl From<InputError> for RecordedProgramError {
    fn from(error: InputError) -> Self {
        RecordedProgramError::Input(error)
    }
}

impl From<LowerError> for RecordedProgramError {
    fn from(error: LowerError) -> Self {
        RecordedProgramError::Lower(error)
    }
}

/// Name that stands for all flows of all commands.
pub const ALL_FLOWS: &str = "";

/// How nets are lowered to the images of a replay, for a period of the cycle and a tick, both in ns.
pub type Lowering = fn(&AnalysedNet, u64, u64) -> Result<Image, LowerError>;

/// A program that was compiled for a replay.
#[derive(Debug)]
pub struct CompiledForReplay {
    /// Program with its nets and sources.
    pub compiled: Compiled,
    /// Images that have replaced those of the recording, each with the index of its net in the program.
    pub images: Vec<(usize, Arc<Image>)>,
}

/// Program of a recording: its text and the options with which it was compiled.
#[derive(Clone, Debug)]
pub struct RecordedProgram {
    input: Input,
    options: CompileOptions,
    is_stored: bool,
}

impl RecordedProgram {
    /// Reads the program from `file`, or takes the text in the recording, which is enough if the program uses only modules of the
    /// library.
    ///
    /// # Errors
    /// Returns an error if there is no program, or if the file cannot be read.
    pub fn new(
        recording: &Recording,
        file: Option<&Path>,
    ) -> Result<RecordedProgram, RecordedProgramError> {
        match file {
            Some(file) => Ok(RecordedProgram {
                input: rpi_driver::read(file)?,
                options: CompileOptions::default(),
                is_stored: false,
            }),
            None => RecordedProgram::stored(recording),
        }
    }

    fn stored(recording: &Recording) -> Result<RecordedProgram, RecordedProgramError> {
        let source = recording.source().ok_or(RecordedProgramError::NoText)?;
        let path = PathBuf::from(&recording.program);
        let kind = InputKind::from_path(&path).ok_or(RecordedProgramError::NoText)?;
        Ok(RecordedProgram {
            input: Input {
                kind,
                path,
                bytes: source.as_bytes().to_vec(),
            },
            options: CompileOptions {
                // What lies beside a file of this name here need not be what lay beside the program.
                no_files: true,
                arm_axes: recording.arm_axes().into(),
                ..CompileOptions::default()
            },
            is_stored: true,
        })
    }

    /// Returns the path of the program, as it was given or recorded.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.input.path
    }

    /// Returns the text of the program.
    ///
    /// # Errors
    /// Returns an error if it is not a text.
    pub fn text(&self) -> Result<&str, RecordedProgramError> {
        Ok(self.input.text()?)
    }

    /// Compiles the program again, with the flows called `names` exported ([`ALL_FLOWS`] for all) and with `text` in place of its
    /// text, and replaces the images of the recording by those that `lower` makes. Returns the program.
    ///
    /// # Errors
    /// Returns an error if the program does not compile, a name is unknown, or the program does not compile to the recorded images.
    pub fn compile(
        &self,
        recording: &mut Recording,
        (names, text): (&[String], Option<String>),
        lower: Lowering,
    ) -> Result<CompiledForReplay, RecordedProgramError> {
        let plain = self.compile_text(None, &[])?;
        let watched = watched_flows(&plain, recording);
        let plain = match watched.is_empty() {
            true => plain,
            // Another program may have exports of other names; the images then differ.
            false => self.compile_text(None, &watched).unwrap_or(plain),
        };
        let names: Vec<String> = names.iter().cloned().chain(watched).collect();
        let changed = self.compile_text(text, &names)?;
        let tick = recording.tick_ns;
        let mut images = Vec::new();
        for period in recording.periods() {
            for (plain, changed) in plain.nets().iter().zip(changed.nets()) {
                let (recorded, _) = rpi_driver::lower_for_tick(plain, period, tick)?;
                images.push((recorded, Arc::new(lower(changed, period, tick)?)));
            }
        }
        let replaced = recording.watch(&images);
        if replaced.is_empty() {
            return Err(RecordedProgramError::OtherProgram {
                path: self.input.path.clone(),
                is_stored: self.is_stored,
            });
        }
        let nets = changed.nets().len();
        let replaced = replaced.into_iter().map(|index| {
            let (_, image) = &images[index];
            (index % nets, Arc::clone(image))
        });
        Ok(CompiledForReplay {
            images: replaced.collect(),
            compiled: changed,
        })
    }

    /// Compiles the program with `text` in place of its text, and with all flows exported.
    ///
    /// # Errors
    /// Returns an error if it does not compile.
    pub fn check(&self, text: String, period: u64) -> Result<(), RecordedProgramError> {
        let compiled = self.compile_text(Some(text), &[ALL_FLOWS.to_owned()])?;
        for net in compiled.nets() {
            rpi_driver::lower_for_observation(net, period)?;
        }
        Ok(())
    }

    fn compile_text(
        &self,
        text: Option<String>,
        watch: &[String],
    ) -> Result<Compiled, RecordedProgramError> {
        let mut input = self.input.clone();
        if let Some(text) = text {
            input.bytes = text.into_bytes();
        }
        let options = CompileOptions {
            claims: ClaimPolicy::Off,
            watch: watch.to_vec(),
            ..self.options.clone()
        };
        let compiled = rpi_driver::compile_with(&input, options)?;
        if compiled.has_errors() {
            let errors = compiled.diagnostics.iter();
            let errors = errors.filter(|diagnostic| diagnostic.severity() == Severity::Error);
            let messages = errors.map(|diagnostic| diagnostic.message.clone());
            let style = Style::for_stream(&std::io::stderr());
            return Err(RecordedProgramError::Diagnostics {
                messages: messages.collect(),
                text: render(&compiled.diagnostics, &compiled.sources, style),
            });
        }
        match compiled.unknown_flows.first() {
            Some(unknown) => Err(RecordedProgramError::UnknownFlow(unknown.to_string())),
            None => Ok(compiled),
        }
    }
}

/// Returns the flows that were watched when a program was recorded: those that the recorded commands export in addition to the program,
/// each with its command.
fn watched_flows(plain: &Compiled, recording: &Recording) -> Vec<String> {
    let nets = plain.nets();
    let is_added = |command: &str, flow: &str| {
        let net = nets.iter().find(|net| net.name == command);
        net.is_some_and(|net| net.exports.iter().all(|export| export.key != flow))
    };
    let added = recording.exported_flows();
    let added = added.filter(|(command, flow)| is_added(command, flow));
    let names = added.map(|(command, flow)| {
        let whole = flow.split('[').next().unwrap_or(flow);
        format!("{command}.{whole}")
    });
    names.collect::<BTreeSet<String>>().into_iter().collect()
}
