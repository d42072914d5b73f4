//! Texts of the program and of the library.

use std::path::Path;

use rpi_diag::{FileId, Span};
use serde_json::{Value, json};

use super::messages::Answer;
use super::session::Debugged;
use crate::debugger::Debugger;

/// The sources of a program that is debugged.
pub(super) struct Sources<'d> {
    debugger: &'d Debugger,
    /// File of the program, if the client can open it.
    program_file: Option<&'d Path>,
}

impl Debugged {
    pub(super) fn sources(&self) -> Sources<'_> {
        Sources {
            debugger: &self.debugger,
            program_file: self.program_file.as_deref(),
        }
    }
}

impl Sources<'_> {
    /// Returns the source and the line, from 1, of a place; `None` for no place.
    pub(super) fn place(&self, place: Span) -> Option<(Value, u32)> {
        let sources = &self.debugger.compiled().sources;
        (!place.is_none()).then(|| {
            let line = sources.line_col(place).line;
            (self.source_json(place.file), line)
        })
    }

    /// Returns a source: a file that the client can open, or a number by which it can get the text.
    fn source_json(&self, file: FileId) -> Value {
        let sources = &self.debugger.compiled().sources;
        let name = sources.name(file);
        let is_program = Path::new(name) == self.debugger.program().path();
        let file_name = Path::new(name).file_name();
        let short = file_name.map_or(name.into(), |name| name.to_string_lossy());
        match self.program_file {
            Some(path) if is_program => json!({ "name": short, "path": path }),
            _ if Path::new(name).is_file() => json!({ "name": short, "path": name }),
            _ => json!({ "name": short, "sourceReference": file.0 + 1 }),
        }
    }

    /// Returns whether a source of a request is the program.
    pub(super) fn is_program(&self, source: &Value) -> bool {
        if let Some(number) = source["sourceReference"]
            .as_u64()
            .filter(|number| *number > 0)
        {
            return self.program_number() == Some(number);
        }
        let Some(path) = source["path"].as_str().map(Path::new) else {
            return false;
        };
        let own = self.program_file;
        let own = own.unwrap_or_else(|| self.debugger.program().path());
        let is_same = |a: &Path, b: &Path| {
            let whole = a.canonicalize().ok().zip(b.canonicalize().ok());
            whole.is_some_and(|(a, b)| a == b)
        };
        path == own || is_same(path, own)
    }

    /// Returns the number of the program among the sources.
    pub(super) fn program_id(&self) -> Option<FileId> {
        let sources = &self.debugger.compiled().sources;
        let path = self.debugger.program().path();
        let mut files = sources.files();
        files.find(|file| Path::new(sources.name(*file)) == path)
    }

    fn program_number(&self) -> Option<u64> {
        self.program_id().map(|file| u64::from(file.0) + 1)
    }

    /// Returns the program as a source.
    pub(super) fn program(&self) -> Value {
        let file = self.program_id();
        file.map_or(Value::Null, |file| self.source_json(file))
    }

    /// Returns the text of a source. That of the program is the one without the expressions of the debugger.
    pub(super) fn text(&self, arguments: &Value) -> Answer {
        let number = arguments["sourceReference"].as_u64();
        let number = number.or_else(|| arguments["source"]["sourceReference"].as_u64());
        let sources = &self.debugger.compiled().sources;
        let mut files = sources.files();
        let file = files.find(|file| Some(u64::from(file.0) + 1) == number);
        let file = file.ok_or_else(|| "there is no such source".to_owned())?;
        let text = match number == self.program_number() {
            true => self.debugger.program().text().map_err(|e| e.to_string())?,
            false => sources.text(file),
        };
        Ok(json!({ "content": text }))
    }

    pub(super) fn all(&self) -> Value {
        let files = self.debugger.compiled().sources.files();
        let sources: Vec<Value> = files.map(|file| self.source_json(file)).collect();
        json!({ "sources": sources })
    }
}
