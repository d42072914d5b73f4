//! Places of a program as the client counts them.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::rc::Rc;

use lsp_types::{Location, Position, Range};
use rpi_diag::{FileId, Span};
use rpi_driver::Inspected;

use crate::lines::{Encoding, Lines};
use crate::shelf;
use crate::world::World;

/// The texts of a program with their lines, which are found when they are first needed.
pub(crate) struct Places<'s> {
    seen: &'s Inspected,
    encoding: Encoding,
    lines: RefCell<BTreeMap<FileId, Rc<Lines>>>,
}

impl<'s> Places<'s> {
    pub(crate) fn new(seen: &'s Inspected, encoding: Encoding) -> Places<'s> {
        Places {
            seen,
            encoding,
            lines: RefCell::default(),
        }
    }

    fn lines(&self, file: FileId) -> Rc<Lines> {
        let mut known = self.lines.borrow_mut();
        let lines = || Rc::new(Lines::new(self.seen.sources.text(file)));
        known.entry(file).or_insert_with(lines).clone()
    }

    /// A range; the start of the text for what has no place.
    pub(crate) fn range(&self, span: Span) -> Range {
        let text = self.seen.sources.text(span.file);
        let lines = self.lines(span.file);
        let at = |offset: u32| lines.position(text, offset as usize, self.encoding);
        Range::new(at(span.start), at(span.end.max(span.start)))
    }

    /// The byte of a position in the program's own text.
    pub(crate) fn offset(&self, position: Position) -> u32 {
        let file = FileId(0);
        let text = self.seen.sources.text(file);
        let offset = self.lines(file).offset(text, position, self.encoding);
        u32::try_from(offset).unwrap_or(u32::MAX)
    }

    /// The file of a place; the program's own for what has none.
    pub(crate) fn file(&self, span: Span) -> PathBuf {
        let file = if span.is_none() { FileId(0) } else { span.file };
        shelf::file_of(self.seen.sources.name(file))
    }

    /// A place with its file; none if the file has no address.
    pub(crate) fn location(&self, world: &World, span: Span) -> Option<Location> {
        let uri = world.uri_of(&self.file(span))?;
        let range = self.range(span);
        Some(Location { uri, range })
    }
}
