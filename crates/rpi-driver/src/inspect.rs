//! Compilation for editors: all diagnostics of [`compile`](crate::compile), and queries about source locations.
//!
//! The diagnostics are computed at once; the index of names and the presence facts are computed on first use.

use std::cell::OnceCell;
use std::collections::BTreeMap;
use std::path::Path;

use rpi_diag::{Diagnostic, FileId, SourceMap, Span};
use rpi_sema::CheckedProgram;
use rpi_sema::elab::ClaimPolicy;
use rpi_sema::facts::{self, Facts};
use rpi_sema::query::{Def, FlowType, Index, flow_types, read_types, type_at};
use rpi_syntax::ast::Item;
use rpi_syntax::{Dialect, with_large_stack};

use crate::compile::CompileOptions;
use crate::doctext;
use crate::faults::FaultLocation;
use crate::file_loader::FileLoader;
use crate::input::stem;
use crate::modules::Modules;
use crate::roots::build_modules;

/// Results of checking a program for an editor, also if the program has errors. The text in the editor is file 0.
#[derive(Debug)]
pub struct Inspection {
    /// Source texts to which the locations in the diagnostics refer. Those of the standard library are named
    /// `stdlib/....rpi`.
    pub sources: SourceMap,
    /// Diagnostics of the checked file and of the modules that it uses.
    pub diagnostics: Vec<Diagnostic>,
    modules: Modules,
    checked: CheckedProgram,
    index: OnceCell<Index>,
    facts: OnceCell<Vec<Facts>>,
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
    let (mut built, checked) = build_modules(&modules, &sources, ClaimPolicy::Report.into());
    let links = doctext::broken_links(&sources, Dialect::from_path(&name), &|| modules.index());
    built.diagnostics.extend(links);
    Inspection {
        sources,
        diagnostics: built.diagnostics,
        modules,
        checked,
        index: OnceCell::new(),
        facts: OnceCell::new(),
        flows: OnceCell::new(),
        faults: OnceCell::new(),
    }
}

impl Inspection {
    /// Returns the language (RPI or Lustre) of the checked text.
    #[must_use]
    pub fn mode(&self) -> Dialect {
        Dialect::from_path(self.sources.name(FileId(0)))
    }

    /// Returns the declarations of the main module: those of the checked text and of the files that it includes.
    pub fn own_items(&self) -> impl Iterator<Item = &Item> {
        self.modules.own_items()
    }

    /// Returns the declarations of all modules, those of the main module first.
    pub fn items(&self) -> impl Iterator<Item = &Item> {
        self.modules.items()
    }

    /// Returns the names of all modules of the program, the main module first.
    pub fn modules(&self) -> impl Iterator<Item = &str> {
        self.modules.names()
    }

    /// Returns the index of all definitions and references.
    pub fn index(&self) -> &Index {
        let index = || with_large_stack(|| self.modules.index());
        self.index.get_or_init(index)
    }

    /// Returns the distinct types of a flow, given by its definition. There are several if the flow is checked for
    /// several static arguments, and none if checking did not reach it.
    #[must_use]
    pub fn types_of(&self, def: &Def) -> &[FlowType] {
        let flows = || with_large_stack(|| flow_types(&self.checked.units, self.facts()));
        let found = self.flows.get_or_init(flows).get(&def.span);
        found.map_or(&[], Vec::as_slice)
    }

    /// Returns the distinct types of a flow at the location of a use of its name.
    #[must_use]
    pub fn types_of_read(&self, name: Span) -> Vec<FlowType> {
        with_large_stack(|| read_types(&self.checked.units, self.facts(), name))
    }

    /// Returns the location and the types of the smallest expression that contains the byte at `offset` in a file;
    /// `None` if no expression contains it.
    #[must_use]
    pub fn type_around(&self, file: FileId, offset: u32) -> Option<(Span, Vec<FlowType>)> {
        with_large_stack(|| type_at(&self.checked.units, self.facts(), file, offset))
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
            build_modules(&self.modules, &self.sources, options)
                .0
                .faults
        };
        self.faults.get_or_init(faults)
    }

    /// Returns the top-level declaration that contains a source location; `None` if no declaration contains it.
    #[must_use]
    pub fn item_around(&self, place: Span) -> Option<&Item> {
        self.modules.items().find(|item| item.span.contains(place))
    }

    fn facts(&self) -> &[Facts] {
        let units = &self.checked.units;
        let facts = || with_large_stack(|| facts::analyse(units, &vec![true; units.len()]).0);
        self.facts.get_or_init(facts)
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
