//! Collects the declarations of parsed files into a table.

use crate::check::{module_not_found, static_params};
use crate::hash::FastMap;
use crate::program::{
    Decl, DeclId, DeclKind, Extent, Library, Module, ModuleId, ModuleUse, NameSpace, Program,
    Source,
};
use rpi_diag::{Code, Diagnostic, Span};
use rpi_syntax::ast::{
    DeclaredKind, Doc, File, Ident, Item, ItemKind, Signature, StaticParam, TypeDef, TypeKind,
    VarDecl,
};
use rpi_syntax::{Dialect, Name};
use std::cell::Cell;

impl<'a> Program<'a> {
    /// Collects the declarations of a program, and reports errors in their names. The first source is the root module,
    /// which is compiled. Modules in `use` clauses that are not among the sources are reported.
    #[must_use]
    pub fn collect(sources: &[Source<'a>]) -> (Program<'a>, Vec<Diagnostic>) {
        Program::collect_with_library(sources, Library::EMPTY)
    }

    /// Collects the declarations of a program, and reports errors in their names, as [`collect`](Self::collect) does.
    /// `library` lists the modules that the program could use, for suggestions.
    #[must_use]
    pub fn collect_with_library(
        sources: &[Source<'a>],
        library: Library,
    ) -> (Program<'a>, Vec<Diagnostic>) {
        let mut collector = Collector::new(library);
        for source in sources {
            collector.module(source);
        }
        for (id, source) in (0..).map(ModuleId).zip(sources) {
            for file in &source.files {
                collector.uses(id, file, sources);
            }
        }
        let implicit = (0..)
            .map(ModuleId)
            .zip(sources)
            .filter(|(_, source)| source.implicit);
        let program = Program {
            modules: collector.modules,
            decls: collector.decls,
            implicit: implicit.map(|(id, _)| id).collect(),
            ambiguous_names: Default::default(),
            library,
            arm_axes: None,
            extents: collector.extents,
            first_parts: Vec::new(),
        };
        (program, collector.diagnostics)
    }
}

struct Collector<'a> {
    library: Library,
    /// Language of the file whose declarations are being collected: RPI or Lustre.
    mode: Dialect,
    modules: Vec<Module>,
    decls: Vec<Decl<'a>>,
    diagnostics: Vec<Diagnostic>,
    extents: Vec<Extent>,
}

impl<'a> Collector<'a> {
    fn new(library: Library) -> Collector<'a> {
        Collector {
            library,
            mode: Dialect::Rpi,
            modules: Vec::new(),
            decls: Vec::new(),
            diagnostics: Vec::new(),
            extents: Vec::new(),
        }
    }

    fn module(&mut self, source: &Source<'a>) {
        self.modules.push(Module {
            name: source.name.clone(),
            mode: source.mode,
            decls: Vec::new(),
            uses: Vec::new(),
            lacks_use: false,
            names: FastMap::default(),
            spaces: Default::default(),
        });
        for file in &source.files {
            self.mode = file.dialect;
            for item in &file.items {
                self.item(item);
            }
        }
    }

    fn item(&mut self, item: &'a Item) {
        let doc = item.doc.as_ref();
        self.extents.push(Extent::from_item(item));
        match &item.kind {
            ItemKind::Use(_) | ItemKind::Include(_) => {}
            ItemKind::Const(defs) => {
                for def in defs {
                    self.declare_all(&def.names, def.doc.as_ref().or(doc), DeclKind::Const(def));
                }
            }
            ItemKind::Type(defs) => defs.iter().for_each(|def| self.type_def(def, doc)),
            ItemKind::Node(d) => self.callable(&d.signature, doc, DeclKind::Node(d)),
            ItemKind::Fragment(d) => self.callable(&d.signature, doc, DeclKind::Fragment(d)),
            ItemKind::Primitive(d) => self.callable(&d.signature, doc, DeclKind::Primitive(d)),
            ItemKind::Device(d) => {
                let kind = match self.check_unique_names(&d.statics, &[]) {
                    true => DeclKind::Device(d),
                    false => DeclKind::Broken(DeclaredKind::Device),
                };
                self.declare(&d.name, doc, kind);
            }
            ItemKind::Frame(d) => self.declare_all(&d.names, doc, DeclKind::Frame(d)),
            ItemKind::Command(d) => {
                let kind = match self.check_unique_names(&d.statics, &[&d.params, &d.given]) {
                    true => DeclKind::Command(d),
                    false => DeclKind::Broken(DeclaredKind::Command),
                };
                self.declare(&d.name, doc, kind);
            }
            ItemKind::Task(d) => self.declare(&d.name, doc, DeclKind::Task(d)),
            ItemKind::Test(d) => {
                self.push_decl(&d.title, doc, DeclKind::Test(d));
            }
            ItemKind::Error(names) => {
                for declared in names {
                    self.declare(&declared.name, None, DeclKind::Broken(declared.kind));
                }
            }
        }
    }

    fn callable(&mut self, signature: &'a Signature, doc: Option<&'a Doc>, kind: DeclKind<'a>) {
        let ports = [&signature.inputs, &signature.outputs];
        let ports = ports.map(|ports| ports.as_deref().unwrap_or_default());
        let kind = match self.check_unique_names(&signature.statics, &ports) {
            true => kind,
            false => DeclKind::Broken(DeclaredKind::Callable),
        };
        self.declare(&signature.name, doc, kind);
    }

    /// Returns whether the static parameters and ports of a declaration have unique names. Reports duplicates. A
    /// declaration with duplicates is not checked further, because its names are ambiguous.
    fn check_unique_names(&mut self, statics: &[StaticParam], ports: &[&[VarDecl]]) -> bool {
        let statics = static_params(statics);
        let ports = ports.iter().flat_map(|ports| ports.iter());
        let ports = ports.flat_map(|port| &port.names);
        let mut known: FastMap<&Name, &Ident> = FastMap::default();
        let before = self.diagnostics.len();
        for name in statics.iter().map(|param| param.name()) {
            if let Some(first) = known.insert(&name.name, name) {
                self.diagnostics
                    .push(duplicate_name_error(&name.name, name.span, first.span));
            }
        }
        for port in ports {
            if let Some(first) = known.get(&port.name) {
                self.diagnostics
                    .push(duplicate_name_error(&port.name, port.span, first.span));
            }
        }
        self.diagnostics.len() == before
    }

    fn type_def(&mut self, def: &'a TypeDef, doc: Option<&'a Doc>) {
        let doc = def.doc.as_ref().or(doc);
        self.declare(&def.name, doc, DeclKind::Type(def));
        let ty = last_id(&self.decls);
        if let Some(TypeKind::Datatype(all)) = def.ty.as_ref().map(|ty| &ty.kind) {
            let is_plain = def.statics.is_empty() && all.iter().all(|c| c.fields.is_empty());
            for (index, constructor) in (0..).zip(all) {
                let kind = match is_plain {
                    true => DeclKind::EnumValue { ty, index },
                    false => DeclKind::Constructor { ty, index },
                };
                self.declare(&constructor.name, None, kind);
            }
        }
        let Some(TypeKind::Enum(values)) = def.ty.as_ref().map(|ty| &ty.kind) else {
            return;
        };
        for (index, value) in (0..).zip(values) {
            let kind = DeclKind::EnumValue { ty, index };
            self.declare(&value.name, value.doc.as_ref(), kind);
        }
    }

    fn declare_all(&mut self, names: &'a [Ident], doc: Option<&'a Doc>, kind: DeclKind<'a>) {
        for name in names {
            self.declare(name, doc, kind);
        }
    }

    fn declare(&mut self, name: &Ident, doc: Option<&'a Doc>, kind: DeclKind<'a>) {
        let id = self.push_decl(name, doc, kind);
        let current = self.current();
        if current.mode == Dialect::Lustre {
            let space = NameSpace::of_decl(&kind) as usize;
            current.names.entry(name.name.clone()).or_insert(id);
            let first = *current.spaces[space].entry(name.name.clone()).or_insert(id);
            if first != id {
                let first = self.decls[first.0 as usize].span;
                self.diagnostics
                    .push(duplicate_name_error(&name.name, name.span, first));
            }
            return;
        }
        if let Some(first) = current.names.insert(name.name.clone(), id) {
            // The first declaration stays in force, so that uses of the name are checked against it.
            current.names.insert(name.name.clone(), first);
            let first = self.decls[first.0 as usize].span;
            self.diagnostics
                .push(duplicate_name_error(&name.name, name.span, first));
        }
    }

    /// Adds a declaration to the current module, without making it visible by its name, and returns its index.
    fn push_decl(&mut self, name: &Ident, doc: Option<&'a Doc>, kind: DeclKind<'a>) -> DeclId {
        let module = ModuleId(u32::try_from(self.modules.len() - 1).unwrap_or(u32::MAX));
        self.decls.push(Decl {
            name: name.name.clone(),
            span: name.span,
            doc,
            module,
            mode: self.mode,
            item: u32::try_from(self.extents.len().saturating_sub(1)).unwrap_or(u32::MAX),
            kind,
        });
        let id = last_id(&self.decls);
        self.current().decls.push(id);
        id
    }

    fn uses(&mut self, id: ModuleId, file: &File, sources: &[Source<'_>]) {
        let uses = file.items.iter().filter_map(|item| match &item.kind {
            ItemKind::Use(names) => Some((names, item.span)),
            _ => None,
        });
        let uses = uses.flat_map(|(names, phrase)| names.iter().map(move |name| (name, phrase)));
        for (name, phrase) in uses {
            let found = sources.iter().position(|source| source.name == name.name);
            match found.and_then(|k| u32::try_from(k).ok()).map(ModuleId) {
                Some(module) => self.modules[id.0 as usize].uses.push(ModuleUse {
                    module,
                    name: name.span,
                    clause_span: phrase,
                    is_used: Cell::new(false),
                }),
                None => self.no_module(id, name, sources),
            }
        }
    }

    fn no_module(&mut self, id: ModuleId, name: &Ident, sources: &[Source<'_>]) {
        self.modules[id.0 as usize].lacks_use = true;
        let library = (self.library.modules)();
        let known = sources[1..].iter().map(|s| s.name.as_str()).chain(library);
        self.diagnostics
            .push(module_not_found(&name.name, name.span, known));
    }

    fn current(&mut self) -> &mut Module {
        let last = self.modules.len() - 1;
        &mut self.modules[last]
    }
}

fn last_id(decls: &[Decl<'_>]) -> DeclId {
    DeclId(u32::try_from(decls.len() - 1).unwrap_or(u32::MAX))
}

/// Returns the error for a name that is declared a second time. `again` and `first` are the two locations.
pub(crate) fn duplicate_name_error(name: &Name, again: Span, first: Span) -> Diagnostic {
    Diagnostic::new(Code::RPI1002, format!("`{name}` is declared twice"))
        .primary(again, "declared again here")
        .secondary(first, "first declared here")
        .help("rename one of them")
}
