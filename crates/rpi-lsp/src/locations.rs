//! Conversion of source spans to the positions and locations of the protocol.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::rc::Rc;

use lsp_types::{Location, Position, Range};
use rpi_diag::{FileId, Span};
use rpi_driver::Inspection;

use crate::builtin_documents;
use crate::line_index::{Encoding, LineIndex};
use crate::workspace::Workspace;

/// Converter from byte ranges in the files of one program to positions of the protocol. The table of lines of a file is
/// computed on first use.
pub(crate) struct LocationMap<'s> {
    analysis: &'s Inspection,
    encoding: Encoding,
    lines: RefCell<BTreeMap<FileId, Rc<LineIndex>>>,
}

impl<'s> LocationMap<'s> {
    pub(crate) fn new(seen: &'s Inspection, encoding: Encoding) -> LocationMap<'s> {
        LocationMap {
            analysis: seen,
            encoding,
            lines: RefCell::default(),
        }
    }

    fn lines(&self, file: FileId) -> Rc<LineIndex> {
        let mut known = self.lines.borrow_mut();
        let lines = || Rc::new(LineIndex::new(self.analysis.sources.text(file)));
        known.entry(file).or_insert_with(lines).clone()
    }

    /// Converts a range of bytes to a range of lines and columns. The range of an item without source text becomes the
    /// start of the text.
    pub(crate) fn range(&self, span: Span) -> Range {
        let text = self.analysis.sources.text(span.file);
        let lines = self.lines(span.file);
        let at = |offset: u32| lines.position(text, offset as usize, self.encoding);
        Range::new(at(span.start), at(span.end.max(span.start)))
    }

    /// Converts a position in the root file of the program to a byte offset in the file.
    pub(crate) fn offset(&self, position: Position) -> u32 {
        let file = FileId(0);
        let text = self.analysis.sources.text(file);
        let offset = self.lines(file).offset(text, position, self.encoding);
        u32::try_from(offset).unwrap_or(u32::MAX)
    }

    /// Returns the path of the file that contains a range; the root file for an item without source text.
    pub(crate) fn file(&self, span: Span) -> PathBuf {
        let file = if span.is_none() { FileId(0) } else { span.file };
        builtin_documents::source_path(self.analysis.sources.name(file))
    }

    /// Converts a range to a location (URI, lines and columns); [`None`] if the file has no URI.
    pub(crate) fn location(&self, world: &Workspace, span: Span) -> Option<Location> {
        let uri = world.uri_of(&self.file(span))?;
        let range = self.range(span);
        Some(Location { uri, range })
    }
}
