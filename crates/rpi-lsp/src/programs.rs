//! Programs of a project: the open documents, and the program files on disk below the folders of the project.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use rpi_diag::{FileId, Span};
use rpi_driver::{FileLoader, Inspection, MANIFEST, inspect};
use rpi_sema::query::{Def, DefId, DefKind};

use crate::workspace::Workspace;

/// Maximum number of program files of a project. Further files are ignored.
const MAX_PROGRAMS: usize = 5_000;

/// Maximum number of entries of folders that are read in search of program files, so that a client that opens a whole
/// disk as a project is answered.
const MAX_ENTRIES: usize = 100_000;

/// Declaration of a name, identified by its place, which is the same in all programs that contain it. Numbers of
/// definitions differ between analyses.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) struct Declaration {
    /// Name of the source file, as in diagnostics.
    pub(crate) file: String,
    /// Kind of the definition.
    kind: DefKind,
    /// Byte offset of the name in the file.
    start: u32,
    /// Declared name.
    pub(crate) name: String,
}

impl Declaration {
    pub(crate) fn new(seen: &Inspection, def: &Def) -> Declaration {
        Declaration {
            file: seen.sources.name(def.span.file).to_owned(),
            kind: def.kind,
            start: def.span.start,
            name: def.name.to_string(),
        }
    }

    /// Returns the definition with this declaration in a program; `None` if the program does not contain it.
    pub(crate) fn find_in(&self, seen: &Inspection) -> Option<DefId> {
        let mut files = seen.sources.files();
        let file = files.find(|id| seen.sources.name(*id) == self.file)?;
        let is_same = |def: &Def| {
            def.kind == self.kind && def.span.start == self.start && def.name == *self.name
        };
        let mut all = seen.index().defs_in(file);
        all.find(|(_, def)| is_same(def)).map(|(id, _)| id)
    }
}

/// Function that is called with a program: the workspace, its path, its analysis, and the definition that is searched for.
pub(crate) type ProgramVisitor<'a> = dyn FnMut(&mut Workspace, &Path, &Rc<Inspection>, DefId) + 'a;

impl Workspace {
    /// Returns the paths of the programs of the project that contains the file `near`: open documents first, then files
    /// on disk, sorted.
    pub(crate) fn programs(&self, near: &Path) -> Vec<PathBuf> {
        let open = self.open_paths();
        let mut folders: BTreeSet<PathBuf> = self.folders().iter().cloned().collect();
        if !folders.iter().any(|folder| near.starts_with(folder)) {
            folders.extend(project_folder(near));
        }
        let mut on_disk = BTreeSet::new();
        let mut budget = MAX_ENTRIES;
        for folder in &folders {
            program_files(folder, &mut on_disk, &mut budget);
        }
        let closed = on_disk.into_iter().filter(|path| !open.contains(path));
        open.iter().cloned().chain(closed).collect()
    }

    /// Returns the text of a program file: in the editor if it is open, otherwise on disk.
    pub(crate) fn text(&self, path: &Path) -> Option<String> {
        self.overlay().text(path)
    }

    /// Returns the analysis of the program whose root file is at `path`: that of the open document, otherwise a new one
    /// of the file on disk.
    pub(crate) fn inspect_path(&mut self, path: &Path) -> Option<Rc<Inspection>> {
        match self.open_uri(path) {
            Some(uri) => self.analysis(&uri),
            None => {
                let text = self.text(path)?;
                Some(Rc::new(inspect(path, &text, &self.overlay())))
            }
        }
    }

    /// Calls `visit` with every program of the project that contains the declaration: with its path, its analysis and
    /// the definition in it. `near` is a file of the project. Ends early if the client cancels the request.
    pub(crate) fn for_programs_with(
        &mut self,
        near: &Path,
        declaration: &Declaration,
        visit: &mut ProgramVisitor<'_>,
    ) {
        let programs = self.programs(near);
        let all = programs.len();
        for (done, path) in programs.into_iter().enumerate() {
            if !self.goes_on(done, all) {
                return;
            }
            // A file without the name cannot refer to it; checking it would take most of the time. The modules that
            // the file uses are programs of their own, unless a program includes them.
            let text = self.text(&path).unwrap_or_default();
            let includes = text.contains("include") && !declaration.name.is_empty();
            if !includes && !text.contains(&declaration.name) {
                continue;
            }
            let Some(seen) = self.inspect_path(&path) else {
                continue;
            };
            if let Some(def) = declaration.find_in(&seen) {
                visit(self, &path, &seen, def);
            }
        }
    }
}

/// Returns the folder of the project that contains a file: the nearest one with a project description, otherwise that of
/// the file. Returns `None` for a document without a folder on disk.
fn project_folder(file: &Path) -> Option<PathBuf> {
    let mut around = file.ancestors().skip(1);
    let described = around.find(|folder| folder.join(MANIFEST).is_file());
    let own = || file.parent().filter(|folder| folder.is_dir());
    described.or_else(own).map(Path::to_owned)
}

/// Adds the program files below a folder to `files`. Hidden folders, build outputs (`target`, `node_modules`) and
/// symbolic links to folders are skipped. `budget` is the number of entries that may still be read.
fn program_files(folder: &Path, files: &mut BTreeSet<PathBuf>, budget: &mut usize) {
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        let Ok(entries) = std::fs::read_dir(folder) else {
            continue;
        };
        for entry in entries.flatten() {
            if *budget == 0 || files.len() >= MAX_PROGRAMS {
                return;
            }
            *budget -= 1;
            let name = entry.file_name();
            let name = name.to_string_lossy();
            let is_skipped = name.starts_with('.') || name == "target" || name == "node_modules";
            match entry.file_type() {
                Ok(kind) if kind.is_dir() && !is_skipped => folders.push(entry.path()),
                Ok(kind) if !kind.is_dir() && is_program(&name) => {
                    files.insert(entry.path());
                }
                _ => {}
            }
        }
    }
}

fn is_program(name: &str) -> bool {
    name.ends_with(".rpi") || name.ends_with(".lus")
}

/// Returns the range of the name of a definition in an occurrence of the name, which may be qualified by a module
/// (`motion::Line`) or in quotes; `None` if the occurrence does not contain the name.
pub(crate) fn name_span(seen: &Inspection, occurrence: Span, name: &str) -> Option<Span> {
    let text = seen.sources.slice(occurrence);
    let at = u32::try_from(text.rfind(name)?).ok()?;
    let length = u32::try_from(name.len()).ok()?;
    let start = occurrence.start + at;
    Some(Span::new(occurrence.file, start, start + length))
}

/// Returns the whole range of a file.
pub(crate) fn whole_file(file: FileId) -> Span {
    Span::new(file, 0, u32::MAX)
}
