//! Modules of a program: its file, included files, and imported modules of its folder or of the standard library.

use std::collections::{BTreeMap, VecDeque};
use std::path::{Path, PathBuf};
use std::rc::Rc;

use rpi_diag::{Diagnostic, FileId, SourceMap, Span};
use rpi_net::passes::MachineProfile;
use rpi_sema::program::{Program, Source};
use rpi_sema::query::Index;
use rpi_sema::reuse::ItemHash;
use rpi_syntax::ast::{File, Ident, Item, ItemKind};
use rpi_syntax::{Dialect, Name};

use crate::cell;
use crate::file_loader::FileLoader;
use crate::file_parser::{FileParser, WholeFiles};
use crate::input::InputError;
use crate::library::{LIBRARY, Library, library_path};
use crate::machine::load_machine;
use crate::points;
use crate::program::SourceText;

/// Module of a program: its name and its parsed files.
#[derive(Debug)]
struct Module {
    name: String,
    mode: Dialect,
    /// Parsed files of the module. A file that is parsed in parts has one entry for each part.
    files: Vec<Rc<File>>,
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
    /// Identifier of the first file after those of the main module.
    pub(crate) first_library_file: FileId,
    /// Identifiers of the first parts of all files, in ascending order; empty if the files are parsed as wholes.
    pub(crate) first_parts: Vec<FileId>,
    /// Hashes of all declarations, for the reuse of results; `None` if they are not known.
    pub(crate) hashes: Option<Rc<[ItemHash]>>,
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
        let source = SourceText {
            name,
            path,
            text,
            folder,
        };
        Modules::load_with(&mut WholeFiles, &source, disk, sources)
    }

    /// Parses a program text and all modules that it needs like [`load`](Self::load), with the given parser.
    pub(crate) fn load_with(
        parser: &mut dyn FileParser,
        source: &SourceText<'_>,
        disk: &dyn FileLoader,
        sources: &mut SourceMap,
    ) -> Modules {
        let mut loader = Loader::new(parser, source.folder, disk, sources);
        let mode = Dialect::from_path(source.path);
        loader.module(source.name, source.path, source.text, mode, false);
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
        let mut parser = WholeFiles;
        let mut loader = Loader::new(&mut parser, of.folder, disk, sources);
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

    /// Returns the index without the content of bodies that do not contain `focus`.
    pub(crate) fn index_around(&self, focus: Span) -> Index {
        let sources = self.sources();
        let (program, _) = Program::collect(&sources);
        Index::build_around(&program, &sources, focus)
    }

    /// Returns the modules in the form that the checker expects.
    pub(crate) fn sources(&self) -> Vec<Source<'_>> {
        let mut all = Vec::with_capacity(self.modules.len());
        for module in &self.modules {
            all.push(Source {
                name: Name::from(module.name.as_str()),
                mode: module.mode,
                files: module.files.iter().map(Rc::as_ref).collect(),
                implicit: module.implicit,
            });
        }
        all
    }
}

struct Loader<'a> {
    parser: &'a mut dyn FileParser,
    folder: Option<PathBuf>,
    disk: &'a dyn FileLoader,
    sources: &'a mut SourceMap,
    modules: Vec<Module>,
    diagnostics: Vec<Diagnostic>,
    pending: VecDeque<String>,
    points: Option<(FileId, BTreeMap<String, String>)>,
    /// Number of files of the main module.
    own_file_count: u32,
}

impl<'a> Loader<'a> {
    fn new(
        parser: &'a mut dyn FileParser,
        folder: Option<&Path>,
        disk: &'a dyn FileLoader,
        sources: &'a mut SourceMap,
    ) -> Loader<'a> {
        Loader {
            parser,
            folder: folder.map(Path::to_owned),
            disk,
            sources,
            modules: Vec::new(),
            diagnostics: Vec::new(),
            pending: VecDeque::new(),
            points: None,
            own_file_count: 0,
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
            first_parts: Vec::new(),
            hashes: None,
            first_library_file: self.parser.first_id(FileId(self.own_file_count)),
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
        let mut files = self.parse(file, text, mode);
        // `files` grows during the loop, because an included file may include others.
        let mut next = 0;
        while next < files.len() {
            for include in includes(&files[next]) {
                files.extend(self.include(&include, mode));
            }
            next += 1;
        }
        let used = files.iter().flat_map(|file| uses(file));
        self.pending.extend(used);
        if self.modules.is_empty() {
            self.own_file_count = u32::try_from(self.sources.files().count()).unwrap_or(u32::MAX);
        }
        self.modules.push(Module {
            name: name.to_owned(),
            mode,
            files,
            implicit,
        });
        file
    }

    fn parse(&mut self, file: FileId, text: &str, mode: Dialect) -> Vec<Rc<File>> {
        self.parser.parse(file, text, mode, &mut self.diagnostics)
    }

    /// Parses an included file in the language `mode`. Returns nothing if the file was included before or cannot be
    /// found.
    fn include(&mut self, include: &Ident, mode: Dialect) -> Vec<Rc<File>> {
        let folder = self.folder.as_ref();
        let path = folder.map(|folder| folder.join(include.name.as_str()));
        let path_text = path.as_ref().map(|path| path.display().to_string());
        let is_known = |path: &String| {
            let mut known = self.sources.files().map(|id| self.sources.name(id));
            known.any(|name| name == path)
        };
        if path_text.as_ref().is_some_and(is_known) {
            return Vec::new();
        }
        let text = path.and_then(|path| self.disk.text(&path));
        let Some((path, text)) = path_text.zip(text) else {
            self.diagnostics
                .push(rpi_sema::file_not_found(include, folder.is_none()));
            return Vec::new();
        };
        // A `.lus` file is Lustre whichever file includes it. Any other file has the language of the including module.
        let mode = match Dialect::from_path(&path) {
            Dialect::Lustre => Dialect::Lustre,
            Dialect::Rpi => mode,
        };
        let file = self.sources.add(path, text.as_str());
        self.parse(file, &text, mode)
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
                let file = self.parser.whole_id(file);
                let (mut diagnostics, module) = points::faulty_module(file, &text, &errors);
                self.diagnostics.append(&mut diagnostics);
                self.modules.push(Module {
                    name: points::MODULE.to_owned(),
                    mode: Dialect::Rpi,
                    files: vec![Rc::new(module)],
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
