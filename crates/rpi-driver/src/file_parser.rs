//! Parsers of the files of a program: each file as a whole, or in parts of which only the changed ones are parsed again.

use std::rc::Rc;

use rpi_diag::{Diagnostic, FileId};
use rpi_syntax::ast::File;
use rpi_syntax::{Dialect, parse};

/// Parser of the files of a program.
pub(crate) trait FileParser {
    /// Parses a file and appends its diagnostics. Returns its syntax tree, or those of its parts in text order.
    fn parse(
        &mut self,
        file: FileId,
        text: &str,
        mode: Dialect,
        diagnostics: &mut Vec<Diagnostic>,
    ) -> Vec<Rc<File>>;

    /// Returns the identifier by which locations refer to a file that is not divided into parts.
    fn whole_id(&mut self, file: FileId) -> FileId;

    /// Returns the smallest identifier by which locations can refer to a file.
    fn first_id(&self, file: FileId) -> FileId;
}

/// Parser that parses each file as a whole.
pub(crate) struct WholeFiles;

impl FileParser for WholeFiles {
    fn parse(
        &mut self,
        file: FileId,
        text: &str,
        mode: Dialect,
        diagnostics: &mut Vec<Diagnostic>,
    ) -> Vec<Rc<File>> {
        let parsed = parse(file, text, mode);
        diagnostics.extend(parsed.diagnostics);
        vec![Rc::new(parsed.file)]
    }

    fn whole_id(&mut self, file: FileId) -> FileId {
        file
    }

    fn first_id(&self, file: FileId) -> FileId {
        file
    }
}
