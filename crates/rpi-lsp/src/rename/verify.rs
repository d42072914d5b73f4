//! Verification of a rename: checks all programs with the edits applied, and compares to which declarations their names
//! refer.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use rpi_diag::{Diagnostic, FileId, Severity};
use rpi_driver::{FileLoader, Inspection, inspect};

use super::{ByteRange, RenamePlan, rejection};
use crate::builtin_documents;
use crate::dispatch::RequestError;
use crate::programs::whole_file;
use crate::workspace::Workspace;

/// Returns an error with the reason if the rename changes the meaning of a program.
pub(super) fn verify(world: &Workspace, plan: &RenamePlan, new: &str) -> Result<(), RequestError> {
    let edited = EditedFiles::new(world, plan, new);
    for (done, (path, before)) in plan.programs.iter().enumerate() {
        if !world.goes_on(done, plan.programs.len()) {
            return Ok(());
        }
        let Some(text) = edited.text(path) else {
            continue;
        };
        let after = inspect(path, &text, &edited);
        check_diagnostics(before, &after, new)?;
        check_references(before, &after, plan, new)?;
    }
    Ok(())
}

/// File loader that returns the texts after a rename.
struct EditedFiles<'w> {
    world: &'w Workspace,
    texts: BTreeMap<PathBuf, String>,
}

impl EditedFiles<'_> {
    fn new<'w>(world: &'w Workspace, plan: &RenamePlan, new: &str) -> EditedFiles<'w> {
        let edited = |(path, ranges): (&PathBuf, &Vec<ByteRange>)| {
            let mut text = world.text(path)?;
            for range in ranges.iter().rev() {
                let range = range.start as usize..range.end as usize;
                text.get(range.clone())?;
                text.replace_range(range, new);
            }
            Some((path.clone(), text))
        };
        EditedFiles {
            world,
            texts: plan.edits.iter().filter_map(edited).collect(),
        }
    }
}

impl FileLoader for EditedFiles<'_> {
    fn text(&self, path: &Path) -> Option<String> {
        match self.texts.get(path) {
            Some(text) => Some(text.clone()),
            None => self.world.text(path),
        }
    }
}

/// Returns an error if the program has more errors with a code than before.
fn check_diagnostics(
    before: &Inspection,
    after: &Inspection,
    new: &str,
) -> Result<(), RequestError> {
    let errors = |seen: &Inspection| {
        let mut counts: BTreeMap<String, usize> = BTreeMap::new();
        for one in seen.diagnostics.iter().filter(|d| is_error(d)) {
            *counts.entry(one.code.to_string()).or_default() += 1;
        }
        counts
    };
    let (old, found) = (errors(before), errors(after));
    let more = found
        .iter()
        .find(|(code, count)| old.get(*code).copied().unwrap_or(0) < **count);
    let Some((code, _)) = more else {
        return Ok(());
    };
    let first = after
        .diagnostics
        .iter()
        .find(|d| d.code.to_string() == *code);
    let message = first.map_or("", |diagnostic| diagnostic.message.as_str());
    let place = first.map_or(String::new(), |d| {
        line_text(after, d.span().file, d.span().start)
    });
    Err(rejection(format!(
        "with the name `{new}` the program has an error{place}: {message} ({code})"
    )))
}

fn is_error(diagnostic: &Diagnostic) -> bool {
    diagnostic.severity() == Severity::Error
}

/// Place of an occurrence of a name and of the declaration to which it refers: file and byte offset of each.
type ResolvedName = ((String, u32), (String, u32));

/// Returns an error if a name refers to another declaration than before.
fn check_references(
    before: &Inspection,
    after: &Inspection,
    plan: &RenamePlan,
    new: &str,
) -> Result<(), RequestError> {
    let shift = |file: &str, offset: u32| match plan.edits.get(Path::new(file)) {
        Some(ranges) => shifted(ranges, offset, new),
        None => offset,
    };
    let old = resolved_names(before, &shift);
    let found = resolved_names(after, &|_, offset| offset);
    let Some(((file, offset), _)) = old.symmetric_difference(&found).next() else {
        return Ok(());
    };
    let mut files = after.sources.files();
    let id = files.find(|id| after.sources.name(*id) == file);
    let place = id.map_or(String::new(), |id| line_text(after, id, *offset));
    Err(rejection(format!(
        "`{new}` conflicts with another declaration of this name: a name{place} would refer to another declaration"
    )))
}

/// Returns the offset after the edits of a byte offset before them.
fn shifted(ranges: &[ByteRange], offset: u32, new: &str) -> u32 {
    let length = u32::try_from(new.len()).unwrap_or(u32::MAX);
    let before = ranges.iter().take_while(|range| range.end <= offset);
    before.fold(offset, |at, range| at + length - (range.end - range.start))
}

/// Returns every name of a program, outside of built-in files, with the declaration to which it refers. `shift` maps an
/// offset in a file.
fn resolved_names(seen: &Inspection, shift: &dyn Fn(&str, u32) -> u32) -> BTreeSet<ResolvedName> {
    let index = seen.index();
    let place = |file: FileId, offset: u32| {
        let name = seen.sources.name(file);
        (name.to_owned(), shift(name, offset))
    };
    let is_own = |file: &FileId| {
        let name = Path::new(seen.sources.name(*file));
        !builtin_documents::is_builtin(name)
    };
    let files = seen.sources.files().filter(is_own);
    let references = files.flat_map(|file| index.references_in(whole_file(file)));
    let resolved = references.map(|reference| {
        let def = index.def(reference.def).span;
        let target = place(def.file, def.start);
        (place(reference.span.file, reference.span.start), target)
    });
    resolved.collect()
}

/// Returns ` in line N of FILE` for a place in a program.
fn line_text(seen: &Inspection, file: FileId, offset: u32) -> String {
    let text = seen.sources.text(file);
    let before = text.get(..offset as usize).unwrap_or(text);
    let line = before.matches('\n').count() + 1;
    let name = Path::new(seen.sources.name(file)).file_name();
    let name = name.unwrap_or_default().to_string_lossy();
    format!(" in line {line} of {name}")
}
