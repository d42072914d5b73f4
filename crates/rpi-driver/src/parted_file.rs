//! Program text that is parsed in parts. When the text changes, only the changed parts are parsed again.
//!
//! A part contains one or a few declarations, and has an identifier in the place of that of the file. The locations in its
//! syntax tree are relative to the start of the part. A change therefore leaves the trees of all other parts as they are,
//! also of those after the change. The identifiers are ascending in text order, with gaps for new parts.

use std::ops::Range;
use std::rc::Rc;

use rpi_diag::{Diagnostic, FileId, SourcePart};
use rpi_sema::reuse::ItemHash;
use rpi_syntax::ast::File;
use rpi_syntax::{Dialect, divide, parse_part};

/// Number of low bits of an identifier that distinguish the parts of one file.
const PART_BITS: u32 = 22;

/// Smallest number of a part. Identifiers of parts of the first file must not be those of whole files.
const MIN_PART: u32 = MAX_FILES;

/// Maximum number of files with parts.
const MAX_FILES: u32 = (1 << (32 - PART_BITS)) - 1;

/// Maximum distance of the identifiers of new parts. It leaves room for further parts at the same place.
const ID_SPACING: u32 = 64;

/// Number of syntax errors of a file above which it is parsed as a whole, because the parser limits their number.
const MAX_ERRORS: usize = 1000;

/// Text with the parts into which it is divided.
#[derive(Debug)]
pub(crate) struct PartedFile {
    file: FileId,
    mode: Dialect,
    text: String,
    /// Parts in text order. They cover the text.
    parts: Vec<Part>,
}

#[derive(Debug)]
struct Part {
    id: FileId,
    /// Bytes of the part in the text of the file.
    range: Range<usize>,
    tree: Rc<File>,
    diagnostics: Vec<Diagnostic>,
    /// Hashes of the declarations of the part.
    hashes: Rc<[ItemHash]>,
    /// Whether the parse depends on the rest of the file.
    depends_on_file: bool,
}

/// Returns the smallest identifier of a part of a file. Those of the parts of later files are larger.
pub(crate) fn first_part_id(file: FileId) -> FileId {
    FileId((file.0.min(MAX_FILES) << PART_BITS) + MIN_PART)
}

/// Returns the identifier of a file that is one part.
fn only_part_id(file: FileId) -> FileId {
    FileId((file.0 << PART_BITS) + (1 << (PART_BITS - 1)))
}

fn end_of_ids(file: FileId) -> u32 {
    (file.0 << PART_BITS) + (1 << PART_BITS) - 1
}

impl PartedFile {
    /// Divides and parses a text. Returns `None` if the program has too many files.
    pub(crate) fn new(file: FileId, text: &str, mode: Dialect) -> Option<PartedFile> {
        if file.0 >= MAX_FILES {
            return None;
        }
        let mut parted = PartedFile {
            file,
            mode,
            text: text.to_owned(),
            parts: Vec::new(),
        };
        let cuts = divide(text, text, mode).cuts;
        parted.parse_all(ranges(0..text.len(), &cuts));
        parted.limit_errors();
        Some(parted)
    }

    pub(crate) fn is_of(&self, file: FileId, mode: Dialect) -> bool {
        (self.file, self.mode) == (file, mode)
    }

    /// Returns the syntax trees of the parts in text order.
    pub(crate) fn trees(&self) -> impl Iterator<Item = &Rc<File>> {
        self.parts.iter().map(|part| &part.tree)
    }

    /// Returns the diagnostics of the parser, in text order.
    pub(crate) fn diagnostics(&self) -> impl Iterator<Item = &Diagnostic> {
        self.parts.iter().flat_map(|part| &part.diagnostics)
    }

    /// Returns the hashes of all declarations, in text order.
    pub(crate) fn hashes(&self) -> impl Iterator<Item = ItemHash> + '_ {
        self.parts
            .iter()
            .flat_map(|part| part.hashes.iter().cloned())
    }

    /// Returns the parts with their places in the file.
    pub(crate) fn source_parts(&self) -> impl Iterator<Item = SourcePart> + '_ {
        self.parts.iter().map(|part| SourcePart {
            id: part.id,
            file: self.file,
            start: offset(part.range.start),
        })
    }

    /// Changes the text and parses the parts that have changed.
    pub(crate) fn set_text(&mut self, text: &str) {
        if self.text == text {
            return;
        }
        let old = std::mem::replace(&mut self.text, text.to_owned());
        let in_new = |at: usize| at + self.text.len() - old.len();
        let mut window = self.affected_parts(&changed_range(&old, text));
        let mut step = 1;
        let (bytes, cuts) = loop {
            let start = self.parts[window.start].range.start;
            let end = in_new(self.parts[window.end - 1].range.end);
            let found = divide(&text[start..end], text, self.mode);
            let joins_before = window.start > 0 && !found.is_open_before;
            let joins_after = window.end < self.parts.len() && !found.is_open_after;
            if !joins_before && !joins_after {
                let cuts = found.cuts.into_iter().map(|cut| cut + start);
                break (start..end, cuts.collect::<Vec<usize>>());
            }
            // Doubled, so that the time is proportional to the final length.
            if joins_before {
                window.start = window.start.saturating_sub(step);
            }
            if joins_after {
                window.end = (window.end + step).min(self.parts.len());
            }
            step *= 2;
        };
        for part in &mut self.parts[window.end..] {
            part.range = in_new(part.range.start)..in_new(part.range.end);
        }
        self.replace(&old, window, ranges(bytes, &cuts));
        self.limit_errors();
    }

    /// Returns the indices of the parts that a change of these bytes can affect: those that the bytes touch, and those
    /// that depend on the whole file.
    fn affected_parts(&self, changed: &Range<usize>) -> Range<usize> {
        let before = |part: &Part| part.range.end < changed.start;
        let not_after = |part: &Part| part.range.start <= changed.end;
        let mut start = self.parts.partition_point(before);
        let mut end = self.parts.partition_point(not_after);
        let mut depend = (0..self.parts.len()).filter(|k| self.parts[*k].depends_on_file);
        if let Some(first) = depend.next() {
            start = start.min(first);
            end = end.max(depend.next_back().unwrap_or(first) + 1);
        }
        start..end
    }

    /// Parses the file as one part if it has very many errors.
    fn limit_errors(&mut self) {
        if self.parts.len() > 1 && self.diagnostics().nth(MAX_ERRORS).is_some() {
            self.parse_all(ranges(0..self.text.len(), &[]));
        }
    }

    /// Parses the whole text in the given parts, which get new identifiers.
    fn parse_all(&mut self, ranges: Vec<Range<usize>>) {
        let (low, high) = (first_part_id(self.file).0, end_of_ids(self.file));
        let count = u32::try_from(ranges.len()).unwrap_or(u32::MAX);
        let step = (high - low) / count.saturating_add(1);
        let parts = (1..).zip(ranges);
        self.parts = match step {
            // Too many declarations to give each an identifier.
            0 => vec![self.part(0..self.text.len(), only_part_id(self.file))],
            _ => parts
                .map(|(k, range)| self.part(range, FileId(low + k * step)))
                .collect(),
        };
    }

    /// Replaces the parts with the indices `window` by parts of the given bytes. Parts with the same text as before are not
    /// parsed again. `old_text` is the text before the change.
    fn replace(&mut self, old_text: &str, window: Range<usize>, new: Vec<Range<usize>>) {
        let old = &self.parts[window.clone()];
        let is_same = |part: &Part, range: &Range<usize>| {
            !part.depends_on_file && old_text[part.range.clone()] == self.text[range.clone()]
        };
        let pairs = old.iter().zip(&new);
        let head = pairs
            .take_while(|(part, range)| is_same(part, range))
            .count();
        let pairs = old[head..].iter().rev().zip(new[head..].iter().rev());
        let tail = pairs
            .take_while(|(part, range)| is_same(part, range))
            .count();
        let (first, last) = (window.start + head, window.end - tail);
        let Some(ids) = self.new_ids(first..last, new.len() - head - tail) else {
            let before = self.parts[..window.start]
                .iter()
                .map(|part| part.range.clone());
            let after = self.parts[window.end..]
                .iter()
                .map(|part| part.range.clone());
            return self.parse_all(before.chain(new).chain(after).collect());
        };
        for (part, range) in self.parts[last..window.end]
            .iter_mut()
            .zip(&new[new.len() - tail..])
        {
            part.range = range.clone();
        }
        let changed = new[head..new.len() - tail].iter().zip(ids);
        let changed: Vec<Part> = changed
            .map(|(range, id)| self.part(range.clone(), id))
            .collect();
        self.parts.splice(first..last, changed);
    }

    /// Returns identifiers for `count` parts in the place of the parts with the indices `old`: first those of the old parts,
    /// so that locations in an edited declaration stay comparable, then new ones. `None` if there are too few.
    fn new_ids(&self, old: Range<usize>, count: usize) -> Option<Vec<FileId>> {
        let mut ids: Vec<FileId> = self.parts[old.clone()].iter().map(|part| part.id).collect();
        ids.truncate(count);
        let lacking = u32::try_from(count - ids.len()).ok()?;
        let before = old.start.checked_sub(1).map(|k| self.parts[k].id);
        let low = ids.last().copied().or(before);
        let low = low.map_or(first_part_id(self.file).0, |id| id.0);
        let high = self
            .parts
            .get(old.end)
            .map_or(end_of_ids(self.file), |part| part.id.0);
        let step = ((high - low) / lacking.checked_add(1)?).min(ID_SPACING);
        if lacking > 0 && step == 0 {
            return None;
        }
        ids.extend((1..=lacking).map(|k| FileId(low + k * step)));
        Some(ids)
    }

    fn part(&self, range: Range<usize>, id: FileId) -> Part {
        let text = &self.text[range.clone()];
        let parsed = parse_part(id, text, &self.text, self.mode);
        let hashes = parsed.parse.file.items.iter();
        let hashes = hashes.map(|item| ItemHash::new(item, text)).collect();
        Part {
            id,
            range,
            tree: Rc::new(parsed.parse.file),
            diagnostics: parsed.parse.diagnostics,
            hashes,
            depends_on_file: parsed.depends_on_file,
        }
    }
}

/// Returns the parts of the bytes `bytes` that `cuts` separate.
fn ranges(bytes: Range<usize>, cuts: &[usize]) -> Vec<Range<usize>> {
    let starts = std::iter::once(bytes.start).chain(cuts.iter().copied());
    let ends = cuts.iter().copied().chain([bytes.end]);
    starts.zip(ends).map(|(start, end)| start..end).collect()
}

/// Returns the smallest range of the bytes of `old` whose replacement can give `new`.
fn changed_range(old: &str, new: &str) -> Range<usize> {
    let pairs = old.bytes().zip(new.bytes());
    let start = pairs.take_while(|(a, b)| a == b).count();
    let pairs = old[start..].bytes().rev().zip(new[start..].bytes().rev());
    let kept = pairs.take_while(|(a, b)| a == b).count();
    start..old.len() - kept
}

fn offset(at: usize) -> u32 {
    u32::try_from(at).unwrap_or(u32::MAX)
}
