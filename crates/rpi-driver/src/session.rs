//! Incremental check of a program that an editor changes: what a change does not affect is not computed again.
//!
//! Reused are the parses of all declarations with the same text, and for each unit (node, command, test) the results of the
//! type checker, of the presence analysis and of the analyses of its net, if everything that they depend on is the same.
//! The result equals that of [`inspect`](crate::inspect) at any time.

use std::path::Path;
use std::rc::Rc;

use rpi_diag::{Diagnostic, FileId, SourceMap, SourcePart};
use rpi_sema::elab::ClaimPolicy;
use rpi_syntax::Dialect;
use rpi_syntax::ast::File;

use crate::file_loader::{FileLoader, Recorder};
use crate::file_parser::FileParser;
use crate::input::stem;
use crate::inspect::{Inspection, inspect};
use crate::modules::Modules;
use crate::parted_file::{PartedFile, first_part_id};
use crate::program::SourceText;
use crate::program_memo::ProgramMemo;
use crate::roots::build_reusing;

/// Results of the last check of a program, for the next one. They are as large as the program; results that a check does
/// not use are dropped.
#[derive(Debug, Default)]
pub struct CheckSession {
    /// Files of the program in the order of their identifiers.
    files: Vec<PartedFile>,
    memo: ProgramMemo,
}

impl CheckSession {
    /// Checks a program text like [`inspect`](crate::inspect), and reuses results of the previous check.
    pub fn inspect(&mut self, path: &Path, text: &str, files: &dyn FileLoader) -> Inspection {
        let name = path.display().to_string();
        let source = SourceText {
            name: &stem(path),
            path: &name,
            text,
            folder: path.parent(),
        };
        let (recorder, mut sources) = (Recorder::new(files), SourceMap::new());
        let mut parser = PartParser::new(&mut self.files);
        let mut modules = Modules::load_with(&mut parser, &source, &recorder, &mut sources);
        if parser.has_unparsed_file {
            return inspect(path, text, files);
        }
        let (count, parted) = (parser.count, &mut self.files);
        parted.truncate(count);
        let parts: Vec<SourcePart> = parted.iter().flat_map(PartedFile::source_parts).collect();
        modules.first_parts = first_parts(&parts);
        modules.hashes = Some(parted.iter().flat_map(PartedFile::hashes).collect());
        sources.set_parts(parts);
        let options = ClaimPolicy::Report.into();
        let (mut built, checked) =
            build_reusing(&modules, &sources, &options, Some(&mut self.memo));
        for diagnostic in &mut built.diagnostics {
            diagnostic.change_spans(|span| sources.in_whole_file(span));
        }
        let seen = Inspection::new(sources, checked, recorder.into_recorded());
        seen.with_parts(modules).with_diagnostics(built.diagnostics)
    }
}

/// Returns the identifiers of the first parts of all files. Only the first part of a file begins at its start.
fn first_parts(parts: &[SourcePart]) -> Vec<FileId> {
    let first = parts.iter().filter(|part| part.start == 0);
    first.map(|part| part.id).collect()
}

/// Parser that parses only the changed parts of each file.
struct PartParser<'s> {
    files: &'s mut Vec<PartedFile>,
    /// Number of files parsed so far.
    count: usize,
    /// Whether a file is not parsed in parts: one with invalid points, or one of very many files.
    has_unparsed_file: bool,
}

impl<'s> PartParser<'s> {
    fn new(files: &'s mut Vec<PartedFile>) -> PartParser<'s> {
        PartParser {
            files,
            count: 0,
            has_unparsed_file: false,
        }
    }

    /// Returns the file with this identifier and text, parsed in parts. Files are parsed in the order of their identifiers.
    fn parted(&mut self, file: FileId, text: &str, mode: Dialect) -> Option<&PartedFile> {
        let at = self.count;
        self.count += 1;
        if self.files.get(at).is_some_and(|old| old.is_of(file, mode)) {
            self.files[at].set_text(text);
            return self.files.get(at);
        }
        self.files.truncate(at);
        self.files.push(PartedFile::new(file, text, mode)?);
        self.files.last()
    }
}

impl FileParser for PartParser<'_> {
    fn parse(
        &mut self,
        file: FileId,
        text: &str,
        mode: Dialect,
        diagnostics: &mut Vec<Diagnostic>,
    ) -> Vec<Rc<File>> {
        let Some(parted) = self.parted(file, text, mode) else {
            self.has_unparsed_file = true;
            return Vec::new();
        };
        diagnostics.extend(parted.diagnostics().cloned());
        parted.trees().cloned().collect()
    }

    fn whole_id(&mut self, file: FileId) -> FileId {
        self.has_unparsed_file = true;
        file
    }

    fn first_id(&self, file: FileId) -> FileId {
        first_part_id(file)
    }
}
