//! Compilation for editors: all diagnostics of [`compile`](crate::compile), and queries about source locations.
//!
//! The diagnostics are computed at once; the index of names and the presence facts are computed on first use.

use std::cell::{Cell, OnceCell};
use std::collections::BTreeMap;
use std::path::Path;
use std::rc::Rc;

use rpi_diag::{Diagnostic, FileId, SourceMap, Span};
use rpi_sema::CheckedProgram;
use rpi_sema::elab::ClaimPolicy;
use rpi_sema::facts::{self, Facts};
use rpi_sema::query::{Def, FlowType, Index, flow_types, read_types, type_at};
use rpi_syntax::ast::{Item, ItemKind, PortKind};
use rpi_syntax::{Dialect, Name, with_large_stack};

use crate::compile::CompileOptions;
use crate::doctext;
use crate::faults::FaultLocation;
use crate::file_loader::{FileLoader, RecordedFiles};
use crate::input::stem;
use crate::modules::Modules;
use crate::program::SourceText;
use crate::roots::build_modules;

/// Results of checking a program for an editor, also if the program has errors. The text in the editor is file 0.
#[derive(Debug)]
pub struct Inspection {
    /// Source texts to which the locations in the diagnostics refer. Those of the standard library are named
    /// `stdlib/....rpi`.
    pub sources: SourceMap,
    /// Diagnostics of the checked file and of the modules that it uses.
    pub diagnostics: Vec<Diagnostic>,
    /// Modules of the program as they were checked: whole files, or parts of files.
    trees: Option<Modules>,
    /// Modules of the program, parsed as whole files. After an incremental check, they are parsed on first use.
    modules: OnceCell<Modules>,
    /// Files that the modules are parsed from.
    files: RecordedFiles,
    /// Result of the checker. Its locations may refer to parts of files.
    checked: CheckedProgram,
    index: OnceCell<Index>,
    /// Location to which the index is restricted at present; `None` for the index of everything.
    focus: Cell<Option<Span>>,
    /// First location to which the index was restricted, with that index.
    index_around: OnceCell<(Span, Index)>,
    facts: OnceCell<Vec<Rc<Facts>>>,
    flows: OnceCell<BTreeMap<Span, Vec<FlowType>>>,
    faults: OnceCell<Vec<FaultLocation>>,
}

/// Checks a program text with all compiler stages. `path` is the file of the text, whose extension determines the
/// language; other files are read through `files`.
#[must_use]
pub fn inspect(path: &Path, text: &str, files: &dyn FileLoader) -> Inspection {
    let mut sources = SourceMap::new();
    let name = path.display().to_string();
    let modules = Modules::load(&stem(path), &name, text, path.parent(), files, &mut sources);
    let (built, checked) = build_modules(&modules, &sources, &ClaimPolicy::Report.into());
    let seen = Inspection::new(sources, checked, RecordedFiles::default());
    let seen = Inspection {
        modules: OnceCell::from(modules),
        ..seen
    };
    seen.with_diagnostics(built.diagnostics)
}

impl Inspection {
    /// Creates the result for a checked program whose modules are parsed from `files` on first use.
    pub(crate) fn new(
        sources: SourceMap,
        checked: CheckedProgram,
        files: RecordedFiles,
    ) -> Inspection {
        Inspection {
            sources,
            diagnostics: Vec::new(),
            trees: None,
            modules: OnceCell::new(),
            files,
            checked,
            index: OnceCell::new(),
            focus: Cell::new(None),
            index_around: OnceCell::new(),
            facts: OnceCell::new(),
            flows: OnceCell::new(),
            faults: OnceCell::new(),
        }
    }

    /// Sets the modules that were checked, in parts of files.
    pub(crate) fn with_parts(mut self, modules: Modules) -> Inspection {
        self.trees = Some(modules);
        self
    }

    /// Sets the diagnostics of the checker, and adds those about doc comments.
    pub(crate) fn with_diagnostics(mut self, diagnostics: Vec<Diagnostic>) -> Inspection {
        self.diagnostics = diagnostics;
        let links = doctext::broken_links(&self.sources, self.mode(), || self.index());
        self.diagnostics.extend(links);
        self
    }

    /// Returns the modules of the program as they were checked. Their locations may refer to parts of files.
    fn trees(&self) -> &Modules {
        self.trees.as_ref().unwrap_or_else(|| self.whole())
    }

    /// Returns the modules of the program, parsed as whole files.
    fn whole(&self) -> &Modules {
        self.modules.get_or_init(|| {
            let path = self.sources.name(FileId(0)).to_owned();
            let source = SourceText {
                name: &stem(Path::new(&path)),
                path: &path,
                text: self.sources.text(FileId(0)),
                folder: Path::new(&path).parent(),
            };
            source.modules_from(&self.files)
        })
    }

    /// Returns the language (RPI or Lustre) of the checked text.
    #[must_use]
    pub fn mode(&self) -> Dialect {
        Dialect::from_path(self.sources.name(FileId(0)))
    }

    /// Returns the declarations of the main module: those of the checked text and of the files that it includes.
    pub fn own_items(&self) -> impl Iterator<Item = &Item> {
        self.whole().own_items()
    }

    /// Returns the declarations of all modules, those of the main module first.
    pub fn items(&self) -> impl Iterator<Item = &Item> {
        self.whole().items()
    }

    /// Returns the names of all modules of the program, the main module first.
    pub fn modules(&self) -> impl Iterator<Item = &str> {
        self.whole().names()
    }

    /// Restricts the index to what is needed at a location of the root file, until the result is dropped: the bodies of
    /// other nodes and tests are left out. This takes a fraction of the time in a large file.
    #[must_use]
    pub fn focus(&self, offset: u32) -> Focus<'_> {
        let place = Span::new(FileId(0), offset, offset);
        let item = self.item_span_around(place);
        self.focus.set(Some(item.unwrap_or(place)));
        Focus(self)
    }

    /// Returns the index of all definitions and references, or of those that are needed at the [`focus`](Self::focus).
    pub fn index(&self) -> &Index {
        if let (Some(focus), None) = (self.focus.get(), self.index.get()) {
            let index = || {
                let around = self.sources.in_part(focus);
                let mut index = with_large_stack(|| self.trees().index_around(around));
                index.change_spans(|span| self.sources.in_whole_file(span));
                (focus, index)
            };
            let (known, index) = self.index_around.get_or_init(index);
            if *known == focus {
                return index;
            }
        }
        let index = || {
            let mut index = with_large_stack(|| self.trees().index());
            index.change_spans(|span| self.sources.in_whole_file(span));
            index
        };
        self.index.get_or_init(index)
    }

    /// Returns the distinct types of a flow, given by its definition. There are several if the flow is checked for
    /// several static arguments, and none if checking did not reach it.
    #[must_use]
    pub fn types_of(&self, def: &Def) -> &[FlowType] {
        let flows = || with_large_stack(|| flow_types(&self.checked.units, self.facts()));
        let place = self.sources.in_part(def.span);
        let found = self.flows.get_or_init(flows).get(&place);
        found.map_or(&[], Vec::as_slice)
    }

    /// Returns the distinct types of a flow at the location of a use of its name.
    #[must_use]
    pub fn types_of_read(&self, name: Span) -> Vec<FlowType> {
        let name = self.sources.in_part(name);
        with_large_stack(|| read_types(&self.checked.units, self.facts(), name))
    }

    /// Returns the location and the types of the smallest expression that contains the byte at `offset` in a file;
    /// `None` if no expression contains it.
    #[must_use]
    pub fn type_around(&self, file: FileId, offset: u32) -> Option<(Span, Vec<FlowType>)> {
        let at = self.sources.in_part(Span::new(file, offset, offset));
        let (units, facts) = (&self.checked.units, self.facts());
        let (span, types) = with_large_stack(|| type_at(units, facts, at.file, at.start))?;
        Some((self.sources.in_whole_file(span), types))
    }

    /// Returns the possible faults of the smallest operation that can fault at run time and contains the byte at
    /// `offset` in a file.
    pub fn faults_around(&self, file: FileId, offset: u32) -> Vec<FaultLocation> {
        let is_around = |one: &&FaultLocation| {
            one.span.file == file && one.span.start <= offset && offset < one.span.end
        };
        let around = || self.faults().iter().filter(is_around);
        let length = |one: &FaultLocation| one.span.end - one.span.start;
        let smallest = around().map(length).min();
        let all = around().filter(|one| Some(length(one)) == smallest);
        all.copied().collect()
    }

    /// Returns all operations that can fault at run time. They are computed on first use, because the later compiler
    /// stages must run again for them.
    fn faults(&self) -> &[FaultLocation] {
        let options = CompileOptions {
            faults: true,
            ..CompileOptions::from(ClaimPolicy::Report)
        };
        let faults = || {
            build_modules(self.whole(), &self.sources, &options)
                .0
                .faults
        };
        self.faults.get_or_init(faults)
    }

    /// Returns the range of the top-level declaration that contains a source location; `None` if no declaration contains it.
    #[must_use]
    pub fn item_span_around(&self, place: Span) -> Option<Span> {
        let place = self.sources.in_part(place);
        let mut items = self.trees().items();
        let item = items.find(|item| item.span.contains(place))?;
        Some(self.sources.in_whole_file(item.span))
    }

    /// Returns the ranges of the `use` clauses of the main module.
    pub fn use_clauses(&self) -> impl Iterator<Item = Span> + '_ {
        let items = self.trees().own_items();
        let uses = items.filter(|item| matches!(item.kind, ItemKind::Use(_)));
        uses.map(|item| self.sources.in_whole_file(item.span))
    }

    /// Returns the name of the type whose declaration contains a source location; `None` if none does.
    #[must_use]
    pub fn type_around_declaration(&self, place: Span) -> Option<&Name> {
        let place = self.sources.in_part(place);
        let types = self.trees().items().filter_map(|item| match &item.kind {
            ItemKind::Type(defs) => Some(defs),
            _ => None,
        });
        let mut types = types.flatten();
        let found = types.find(|ty| ty.span.contains(place))?;
        Some(&found.name.name)
    }

    /// Returns the kind of the ports among which a source location is; `None` if it is not in the section of a device type.
    #[must_use]
    pub fn port_kind_at(&self, place: Span) -> Option<PortKind> {
        let place = self.sources.in_part(place);
        let devices = self.trees().items().filter_map(|item| match &item.kind {
            ItemKind::Device(device) if item.span.contains(place) => Some(device),
            _ => None,
        });
        let mut sections = devices.flat_map(|device| &device.sections);
        let section = sections.find(|section| section.span.contains(place));
        section.map(|section| section.kind)
    }

    /// Returns the top-level declaration that contains a source location; `None` if no declaration contains it.
    #[must_use]
    pub fn item_around(&self, place: Span) -> Option<&Item> {
        self.whole().items().find(|item| item.span.contains(place))
    }

    fn facts(&self) -> &[Rc<Facts>] {
        let units = &self.checked.units;
        let facts = || with_large_stack(|| facts::analyse_rest(units, &self.checked.facts));
        self.facts.get_or_init(facts)
    }
}

/// Restriction of the index of a program to a location. It ends when this value is dropped.
#[derive(Debug)]
pub struct Focus<'i>(&'i Inspection);

impl Drop for Focus<'_> {
    fn drop(&mut self) {
        self.0.focus.set(None);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::DiskLoader;

    fn offset(text: &str, what: &str) -> u32 {
        u32::try_from(text.find(what).unwrap()).unwrap()
    }

    const TEXT: &str = "--| Half of it.\nfunction half (x: real[m]) returns (y: real[m])\nlet y = x / 2.0; tel\n\
                        node main (a: real[mm]; on: bool) returns (b: real[m]?)\nlet\n  fragment F when on\n\
                        \x20 let z = half(a); tel\n  b = F.z;\n  c = \ntel\n";

    #[test]
    fn names_types_and_presence_are_known_beside_a_fault() {
        let seen = inspect(Path::new("a.rpi"), TEXT, &DiskLoader);
        assert_eq!(seen.diagnostics.len(), 1, "{:?}", seen.diagnostics);
        let index = seen.index();
        let at = |what: &str| {
            index
                .reference_at(FileId(0), offset(TEXT, what))
                .map(|r| index.def(r.def))
        };
        let half = at("half(a)").unwrap();
        assert_eq!(half.doc.as_deref(), Some("Half of it."));
        let z = at("z;").unwrap();
        assert_eq!(z.span.start, offset(TEXT, "z = half"));
        let text = |types: &[FlowType]| types.iter().map(FlowType::to_string).collect::<Vec<_>>();
        assert_eq!(text(seen.types_of(z)), ["real[m]"]);
        let read = index
            .reference_at(FileId(0), offset(TEXT, "z;\n  c"))
            .unwrap();
        assert_eq!(text(&seen.types_of_read(read.span)), ["real[m]?"]);
        let item = seen.item_around(half.full_span).unwrap();
        let head = rpi_syntax::header(item, seen.mode());
        assert_eq!(head, "function half (x: real[m]) returns (y: real[m])");
    }

    #[test]
    fn an_editor_may_have_changed_other_files() {
        struct Changed;
        impl FileLoader for Changed {
            fn text(&self, path: &Path) -> Option<String> {
                path.ends_with("parts.rpi")
                    .then(|| "const n: int = 3;".to_owned())
            }
        }
        let text = "use parts;\nconst m: int = n + 1;\n";
        let seen = inspect(Path::new("a.rpi"), text, &Changed);
        assert_eq!(seen.diagnostics, []);
        let n = seen
            .index()
            .reference_at(FileId(0), offset(text, "n +"))
            .unwrap();
        let def = seen.index().def(n.def);
        assert_eq!(seen.sources.name(def.span.file), "parts.rpi");
    }
}
