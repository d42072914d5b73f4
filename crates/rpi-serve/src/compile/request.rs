//! What is to be compiled.

use std::sync::Arc;

use rpi_image::encoding::{Bytes, Encoding, ReadError, Reader};
use rpi_image::{encode_enum, encode_struct};

/// Language of the text of a command or task.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Language {
    /// Net in the text format of the reference system (`.rpinet`).
    Rpinet,
    /// Program in RPI.
    Rpi,
}

/// Kind of the result of a compilation.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum CompileKind {
    /// Image of a command.
    Command,
    /// Images and plan of a task.
    Task,
    /// Structure of the net of a command, as XML.
    Structure,
}

/// Text of a command or task with the name of what is to be loaded.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Source {
    pub(crate) language: Language,
    pub(crate) text: Arc<str>,
    /// Name of the command or task within the text; `None` if there is only one.
    pub(crate) command: Option<String>,
    /// Number of axes of the arms of the cell; `None` if they differ.
    pub(crate) arm_axes: Option<u32>,
    /// Flows that the commands export besides those of the text: names that begin with the command, such as
    /// `Move.Approach.way.travelled`. A name of a command, call or fragment stands for all flows inside.
    pub(crate) watch: Vec<String>,
}

/// Request to compile a text.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct CompileRequest {
    pub(crate) kind: CompileKind,
    pub(crate) source: Source,
    /// Period of the command in nanoseconds.
    pub(crate) period_ns: u64,
    /// Tick of the core in nanoseconds.
    pub(crate) tick_ns: u64,
}

encode_enum!(Language { 0 = Rpinet, 1 = Rpi });
encode_enum!(CompileKind { 0 = Command, 1 = Task, 2 = Structure });
encode_struct!(CompileRequest {
    kind: CompileKind,
    source: Source,
    period_ns: u64,
    tick_ns: u64
});

impl Encoding for Source {
    const MIN_BYTES: usize = Language::MIN_BYTES
        + String::MIN_BYTES
        + Option::<String>::MIN_BYTES
        + Option::<u32>::MIN_BYTES
        + Vec::<String>::MIN_BYTES;

    fn encode(&self, out: &mut Bytes) {
        self.language.encode(out);
        String::from(&*self.text).encode(out);
        self.command.encode(out);
        self.arm_axes.encode(out);
        self.watch.encode(out);
    }

    fn decode(from: &mut Reader<'_>) -> Result<Source, ReadError> {
        Ok(Source {
            language: Language::decode(from)?,
            text: String::decode(from)?.into(),
            command: Option::decode(from)?,
            arm_axes: Option::decode(from)?,
            watch: Vec::decode(from)?,
        })
    }
}
