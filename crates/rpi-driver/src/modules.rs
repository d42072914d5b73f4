//! Modules of a program: its file, included files, imported modules, and the embedded standard library.

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use rpi_diag::{Diagnostic, FileId, SourceMap};
use rpi_net::passes::MachineProfile;
use rpi_sema::program::{Program, Source};
use rpi_sema::query::Index;
use rpi_syntax::ast::{File, Ident, Item, ItemKind};
use rpi_syntax::{Dialect, Name, parse};

use crate::cell;
use crate::file_loader::FileLoader;
use crate::input::InputError;
use crate::machine::load_machine;
use crate::points;
use crate::program::SourceText;

/// Module of the standard library: its name and its source text.
struct Library {
    name: &'static str,
    text: &'static str,
    /// Whether every program imports the module without a `use`.
    implicit: bool,
}

macro_rules! library {
    ($name:literal, $implicit:literal) => {
        Library {
            name: $name,
            text: include_str!(concat!("../../../stdlib/", $name, ".rpi")),
            implicit: $implicit,
        }
    };
}

/// Modules of the standard library. A test checks that every file of the library is listed.
const LIBRARY: &[Library] = &[
    library!("commands", false),
    library!("control", false),
    library!("devices", false),
    library!("filters", false),
    library!("geometry", true),
    library!("io", false),
    library!("logic", false),
    library!("math", true),
    library!("motion", false),
    library!("process", false),
    library!("timers", false),
];

/// Module of a program: its name and its parsed files.
#[derive(Debug)]
struct Module {
    name: String,
    mode: Dialect,
    files: Vec<File>,
    implicit: bool,
}

/// Parsed modules of a program, the main module first, and the machine description.
#[derive(Debug)]
pub(crate) struct Modules {
    modules: Vec<Module>,
    /// Machine for which the program is checked: the time of an elementary operation and the period of a cycle.
    pub(crate) machine: MachineProfile,
    /// Error in the machine description; `None` if there is none. With an error, `machine` is the default.
    pub(crate) machine_error: Option<InputError>,
    /// File of the module `points`, with the entries of its constants and frames; `None` if the program does not use it.
    pub(crate) points: Option<(FileId, BTreeMap<String, String>)>,
    /// Number of axes of the arms of the cell that `cell.toml` in the folder describes; `None` if it does not decide it.
    pub(crate) arm_axes: Option<u32>,
    pub(crate) diagnostics: Vec<Diagnostic>,
}

impl Modules {
    /// Parses the program text of the file `path` and all modules that it needs. Modules are searched for in `folder`
    /// (`None` for a text without a folder), then in the standard library.
    pub(crate) fn load(
        name: &str,
        path: &str,
        text: &str,
        folder: Option<&Path>,
        disk: &dyn FileLoader,
        sources: &mut SourceMap,
    ) -> Modules {
        let mut loader = Loader::new(folder, disk, sources);
        let mode = Dialect::from_path(path);
        loader.module(name, path, text, mode, false);
        loader.finish(mode)
    }

    /// Parses an example in the documentation of the module `of`, as a separate program that imports the module
    /// implicitly.
    pub(crate) fn load_example(
        example: &str,
        of: &SourceText<'_>,
        disk: &dyn FileLoader,
        sources: &mut SourceMap,
    ) -> Modules {
        let mut loader = Loader::new(of.folder, disk, sources);
        let mode = Dialect::from_path(of.path);
        loader.module("example", of.path, example, mode, false);
        loader.module(of.name, of.path, of.text, mode, true);
        loader.finish(mode)
    }

    /// Returns all declarations of all modules.
    pub(crate) fn items(&self) -> impl Iterator<Item = &Item> {
        let files = self.modules.iter().flat_map(|module| &module.files);
        files.flat_map(|file| &file.items)
    }

    /// Returns the declarations of the main module, including those of its included files.
    pub(crate) fn own_items(&self) -> impl Iterator<Item = &Item> {
        let files = self.modules.iter().take(1).flat_map(|module| &module.files);
        files.flat_map(|file| &file.items)
    }

    /// Returns the names of the modules in the order in which they were loaded.
    pub(crate) fn names(&self) -> impl Iterator<Item = &str> {
        self.modules.iter().map(|module| module.name.as_str())
    }

    /// Returns the index of all definitions and references in the modules.
    pub(crate) fn index(&self) -> Index {
        let sources = self.sources();
        let (program, _) = Program::collect(&sources);
        Index::build(&program, &sources)
    }

    /// Returns the modules in the form that the checker expects.
    pub(crate) fn sources(&self) -> Vec<Source<'_>> {
        let mut all = Vec::with_capacity(self.modules.len());
        for module in &self.modules {
            all.push(Source {
                name: Name::from(module.name.as_str()),
                mode: module.mode,
                files: module.files.iter().collect(),
                implicit: module.implicit,
            });
        }
        all
    }
}

struct Loader<'a> {
    folder: Option<PathBuf>,
    disk: &'a dyn FileLoader,
    sources: &'a mut SourceMap,
    modules: Vec<Module>,
    diagnostics: Vec<Diagnostic>,
    pending: VecDeque<String>,
    points: Option<(FileId, BTreeMap<String, String>)>,
}

impl<'a> Loader<'a> {
    fn new(
        folder: Option<&Path>,
        disk: &'a dyn FileLoader,
        sources: &'a mut SourceMap,
    ) -> Loader<'a> {
        Loader {
            folder: folder.map(Path::to_owned),
            disk,
            sources,
            modules: Vec::new(),
            diagnostics: Vec::new(),
            pending: VecDeque::new(),
            points: None,
        }
    }

    /// Loads the modules that every program imports implicitly (only if `mode` is RPI) and all modules that the loaded
    /// ones need. Returns all modules.
    fn finish(mut self, mode: Dialect) -> Modules {
        if mode == Dialect::Rpi {
            let implicit = LIBRARY.iter().filter(|library| library.implicit);
            implicit.for_each(|library| self.library(library));
        }
        while let Some(name) = self.pending.pop_front() {
            self.find(&name);
        }
        let machine = load_machine(self.folder.as_deref(), self.disk);
        // Only programs that can name an arm need the description of the cell.
        let uses_arms = self.modules.iter().any(|module| module.name == "motion");
        let folder = self.folder.as_deref().filter(|_| uses_arms);
        Modules {
            arm_axes: folder.and_then(|folder| cell::arm_axes(folder, self.disk)),
            points: self.points,
            machine: machine.as_ref().copied().unwrap_or_default(),
            machine_error: machine.err(),
            modules: self.modules,
            diagnostics: self.diagnostics,
        }
    }

    fn module(
        &mut self,
        name: &str,
        path: &str,
        text: &str,
        mode: Dialect,
        implicit: bool,
    ) -> FileId {
        let file = self.sources.add(path, text);
        let mut files = vec![self.parse(file, text, mode)];
        // `files` grows during the loop, because an included file may include others.
        let mut next = 0;
        while next < files.len() {
            for include in includes(&files[next]) {
                files.extend(self.include(&include, mode));
            }
            next += 1;
        }
        let used = files.iter().flat_map(uses);
        self.pending.extend(used);
        self.modules.push(Module {
            name: name.to_owned(),
            mode,
            files,
            implicit,
        });
        file
    }

    fn parse(&mut self, file: FileId, text: &str, mode: Dialect) -> File {
        let parsed = parse(file, text, mode);
        self.diagnostics.extend(parsed.diagnostics);
        parsed.file
    }

    /// Parses an included file in the language `mode`. Returns `None` if the file was included before or cannot be
    /// found.
    fn include(&mut self, include: &Ident, mode: Dialect) -> Option<File> {
        let folder = self.folder.as_ref();
        let path = folder.map(|folder| folder.join(include.name.as_str()));
        let path_text = path.as_ref().map(|path| path.display().to_string());
        let is_known = |path: &String| {
            let mut known = self.sources.files().map(|id| self.sources.name(id));
            known.any(|name| name == path)
        };
        if path_text.as_ref().is_some_and(is_known) {
            return None;
        }
        let text = path.and_then(|path| self.disk.text(&path));
        let Some((path, text)) = path_text.zip(text) else {
            self.diagnostics
                .push(rpi_sema::file_not_found(include, folder.is_none()));
            return None;
        };
        // A `.lus` file is Lustre whichever file includes it. Any other file has the language of the including module.
        let mode = match Dialect::from_path(&path) {
            Dialect::Lustre => Dialect::Lustre,
            Dialect::Rpi => mode,
        };
        let file = self.sources.add(path, text.as_str());
        Some(self.parse(file, &text, mode))
    }

    fn library(&mut self, library: &Library) {
        if self
            .modules
            .iter()
            .all(|module| module.name != library.name)
        {
            let path = library_path(library.name);
            self.module(
                library.name,
                &path,
                library.text,
                Dialect::Rpi,
                library.implicit,
            );
        }
    }

    /// Loads the module with this name, from the folder of the program or the standard library. The checker reports a
    /// module that does not exist.
    fn find(&mut self, name: &str) {
        if self.modules.iter().any(|module| module.name == name) {
            return;
        }
        let beside = self
            .folder
            .as_ref()
            .map(|folder| folder.join(format!("{name}.rpi")));
        if let Some(path) = beside
            && let Some(text) = self.disk.text(&path)
        {
            let path = path.display().to_string();
            self.module(name, &path, &text, Dialect::Rpi, false);
            return;
        }
        if name == points::MODULE && self.load_points() {
            return;
        }
        if let Some(library) = LIBRARY.iter().find(|library| library.name == name) {
            self.library(library);
        }
    }
}

impl Loader<'_> {
    /// Loads the module of the taught points from the file in the folder of the program. Returns false if there is no such
    /// file.
    fn load_points(&mut self) -> bool {
        let path = self.folder.as_ref().map(|folder| folder.join(points::FILE));
        let Some((path, text)) = path.and_then(|path| Some((path.clone(), self.disk.text(&path)?)))
        else {
            return false;
        };
        let name = path.display().to_string();
        match points::read(&path, &text, &self.modules[0].name) {
            Ok(module) => {
                let file = self.module(points::MODULE, &name, &module.text, Dialect::Rpi, false);
                self.points = Some((file, module.entries));
            }
            Err(errors) => {
                let file = self.sources.add(name, text.as_str());
                let (mut diagnostics, module) = points::faulty_module(file, &text, &errors);
                self.diagnostics.append(&mut diagnostics);
                self.modules.push(Module {
                    name: points::MODULE.to_owned(),
                    mode: Dialect::Rpi,
                    files: vec![module],
                    implicit: false,
                });
            }
        }
        true
    }
}

fn includes(file: &File) -> Vec<Ident> {
    let include = |kind: &ItemKind| match kind {
        ItemKind::Include(path) => Some(path.clone()),
        _ => None,
    };
    file.items
        .iter()
        .filter_map(|item| include(&item.kind))
        .collect()
}

fn uses(file: &File) -> Vec<String> {
    let mut names = Vec::new();
    for item in &file.items {
        if let ItemKind::Use(used) = &item.kind {
            names.extend(used.iter().map(|name| name.name.to_string()));
        }
    }
    names
}

/// Returns the path by which messages refer to the module of the standard library with this name.
pub(crate) fn library_path(name: &str) -> String {
    format!("stdlib/{name}.rpi")
}

/// Returns whether a path in messages refers to a module of the standard library.
pub(crate) fn is_library_path(path: &str) -> bool {
    let name = path.strip_prefix("stdlib/");
    let name = name.and_then(|name| name.strip_suffix(".rpi"));
    name.is_some_and(|name| library_text(name).is_some())
}

/// Returns the source text of the module of the standard library with this name; `None` if there is none.
#[must_use]
pub fn library_text(name: &str) -> Option<&'static str> {
    let found = LIBRARY.iter().find(|library| library.name == name);
    found.map(|library| library.text)
}

/// Access of the checker to the names in the standard library, for suggestions about missing imports.
pub(crate) const LIBRARY_NAMES: rpi_sema::program::Library = rpi_sema::program::Library {
    modules: || library_modules().collect(),
    declaring: declaring_module,
};

/// Returns the module of the standard library that declares a name, among the modules that are not imported implicitly;
/// `None` if no module does.
fn declaring_module(name: &str) -> Option<&'static str> {
    static NAMES: OnceLock<BTreeMap<String, &'static str>> = OnceLock::new();
    NAMES.get_or_init(library_names).get(name).copied()
}

/// Returns the names that the modules declare that every program imports implicitly.
pub(crate) fn implicit_names() -> &'static BTreeSet<String> {
    static NAMES: OnceLock<BTreeSet<String>> = OnceLock::new();
    NAMES.get_or_init(|| {
        names_where(|library| library.implicit)
            .into_keys()
            .collect()
    })
}

/// Returns every name that a module of the standard library declares, with the module. Only modules that are not
/// imported implicitly count.
fn library_names() -> BTreeMap<String, &'static str> {
    names_where(|library| !library.implicit)
}

/// Returns every name that one of the modules `of` of the standard library declares, with the module.
fn names_where(of: fn(&Library) -> bool) -> BTreeMap<String, &'static str> {
    let mut names = BTreeMap::new();
    for library in LIBRARY.iter().filter(|library| of(library)) {
        let file = parse(FileId(0), library.text, Dialect::Rpi).file;
        let source = Source {
            name: Name::from(library.name),
            mode: Dialect::Rpi,
            files: vec![&file],
            implicit: false,
        };
        let (program, _) = rpi_sema::program::Program::collect(&[source]);
        for decl in &program.decls {
            names.entry(decl.name.to_string()).or_insert(library.name);
        }
    }
    names
}

/// Returns the names of the modules of the standard library.
pub fn library_modules() -> impl Iterator<Item = &'static str> {
    LIBRARY.iter().map(|library| library.name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_file_of_the_library_is_listed() {
        let root = rpi_testkit::workspace_root();
        let mut files: Vec<String> = std::fs::read_dir(root.join("stdlib"))
            .unwrap()
            .filter_map(|entry| {
                let name = entry.unwrap().file_name().to_string_lossy().into_owned();
                name.strip_suffix(".rpi").map(str::to_owned)
            })
            .collect();
        files.sort();
        assert_eq!(files, library_modules().collect::<Vec<_>>());
    }
}
