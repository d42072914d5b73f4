//! Builds the table of definitions and references from syntax trees.
//!
//! The order of the text does not matter, so there are two passes. The first defines every name in its scope and puts
//! everything that refers to names on a worklist (`items.rs`, `bodies.rs`). The second resolves the worklist
//! (`refs.rs`), which may need the members of a definition (`shapes.rs`). Names are looked up by the same rules as in
//! the checker.

mod bodies;
mod items;
mod refs;
mod shapes;

use crate::hash::FastMap;
use crate::program::{ModuleId, Program, Source};
use crate::query::def::{Def, DefId, DefKind};
use crate::query::index::{Index, InnerScopes, Reference, Scope, ScopeId};
use rpi_diag::{FileId, Span};
use rpi_syntax::Dialect;
use rpi_syntax::ast::{Body, Callee, Clock, Doc, Dotted, Expr, Ident, Run, Target, Type, Update};
use shapes::Shapes;

/// Builds the index of the definitions and references of a program. With `focus`, the bodies of nodes and tests that do not
/// contain this location are left out.
pub(super) fn build<'a>(
    program: &Program<'a>,
    sources: &[Source<'a>],
    focus: Option<Span>,
) -> Index {
    let mut builder = Builder::new();
    builder.focus = focus;
    let scopes: Vec<ScopeId> = sources
        .iter()
        .map(|source| builder.module(source))
        .collect();
    for (module, scope) in (0..).map(ModuleId).zip(&scopes) {
        let used = program.lookup_modules(module);
        let used = used.filter_map(|id| scopes.get(id.0 as usize).copied());
        builder.index.scopes[scope.0 as usize].uses = used.collect();
    }
    for (source, scope) in sources.iter().zip(&scopes) {
        items::index_items(&mut builder, source, *scope);
    }
    refs::resolve_pending(&mut builder);
    builder.index.references.sort_unstable();
    builder.index.references.dedup();
    builder.index
}

/// Part of the syntax tree with names that are resolved after all names have been defined.
#[derive(Clone, Copy)]
enum PendingRef<'a> {
    Expr(&'a Expr),
    Type(&'a Type),
    Clock(&'a Clock),
    Target(&'a Target),
    Dotted(&'a Dotted),
    Callee(&'a Callee),
    Run(&'a Run),
    /// Plain name that refers to a state of an automaton or a step of a task.
    Name(&'a Ident),
    /// Name of a module in a `use` clause.
    Module(&'a Ident),
}

/// Syntax that determines which members a definition has: its type, the expression that defines it, or the target of an
/// alias.
#[derive(Clone, Copy)]
enum ShapeOrigin<'a> {
    Type(&'a Type),
    Value(&'a Expr),
    Alias(&'a Callee),
}

/// Position of a definition: its scope, the span of the whole declaration, and the doc comment above it.
#[derive(Clone, Copy)]
struct DefPosition<'a> {
    scope: ScopeId,
    whole: Span,
    doc: Option<&'a Doc>,
}

impl<'a> DefPosition<'a> {
    /// Returns this position with another span. It also gets the doc comment `doc` if there is one.
    fn with_span(self, whole: Span, doc: Option<&'a Doc>) -> DefPosition<'a> {
        DefPosition {
            whole,
            doc: doc.or(self.doc),
            ..self
        }
    }
}

/// State of building the index of definitions and references.
struct Builder<'a> {
    index: Index,
    mode: Dialect,
    pending: Vec<(ScopeId, PendingRef<'a>)>,
    shapes: Shapes<'a>,
    modules: FastMap<rpi_syntax::Name, DefId>,
    /// Location to whose declaration the index is restricted; `None` for all.
    focus: Option<Span>,
    /// Whether the content of the body of the current declaration is left out.
    omits_body: bool,
}

impl<'a> Builder<'a> {
    fn new() -> Self {
        Builder {
            index: Index {
                defs: Vec::new(),
                references: Vec::new(),
                scopes: Vec::new(),
                inner_scopes: Vec::new(),
                files: Vec::new(),
            },
            mode: Dialect::Rpi,
            pending: Vec::new(),
            shapes: Shapes::default(),
            modules: FastMap::default(),
            focus: None,
            omits_body: false,
        }
    }

    /// Adds a definition for a module and returns the scope of its declarations.
    fn module(&mut self, source: &Source<'a>) -> ScopeId {
        let file = file_of(source);
        let start = file.map_or(Span::NONE, |file| Span::new(file, 0, 0));
        let def = self.push(Def {
            name: source.name.clone(),
            kind: DefKind::Module,
            span: start,
            full_span: start,
            doc: None,
            parent: None,
            ty: None,
            shape: None,
        });
        self.modules.insert(source.name.clone(), def);
        let scope = self.scope(start, None, Some(def));
        for file in source.files.iter().flat_map(|file| file.items.first()) {
            self.index.files.push((file.span.file, scope));
        }
        scope
    }

    fn scope(&mut self, span: Span, parent: Option<ScopeId>, owner: Option<DefId>) -> ScopeId {
        let id = ScopeId(u32::try_from(self.index.scopes.len()).unwrap_or(u32::MAX));
        self.index.scopes.push(Scope {
            span,
            parent,
            owner,
            names: FastMap::default(),
            order: Vec::new(),
            uses: Vec::new(),
        });
        id
    }

    /// Adds a scope for the names inside of the definition `owner` and returns it.
    fn inner(&mut self, at: DefPosition<'a>, owner: DefId) -> ScopeId {
        self.scope(at.whole, Some(at.scope), Some(owner))
    }

    fn push(&mut self, def: Def) -> DefId {
        let id = DefId(u32::try_from(self.index.defs.len()).unwrap_or(u32::MAX));
        self.index.defs.push(def);
        self.index.inner_scopes.push(InnerScopes::default());
        id
    }

    /// Adds a definition of a name to a scope and returns it. If the scope already defines the name, lookups find the
    /// first definition.
    fn define(&mut self, at: DefPosition<'a>, name: &'a Ident, kind: DefKind) -> DefId {
        let id = self.push(Def {
            name: name.name.clone(),
            kind,
            span: name.span,
            full_span: at.whole,
            doc: at.doc.cloned(),
            parent: self.index.scope(at.scope).owner,
            ty: None,
            shape: None,
        });
        let scope = &mut self.index.scopes[at.scope.0 as usize];
        scope.names.entry(name.name.clone()).or_insert(id);
        scope.order.push(id);
        self.refer(name.span, id);
        id
    }

    /// Records that the name at `span` refers to the definition `def`.
    fn refer(&mut self, span: Span, def: DefId) {
        if !span.is_none() {
            self.index.references.push(Reference { span, def });
        }
    }

    /// Records the declared type of a definition. The type determines which members the definition has.
    fn set_type(&mut self, def: DefId, scope: ScopeId, ty: &'a Type) {
        self.index.defs[def.0 as usize].ty = Some(ty.span);
        self.shapes.set(def, scope, ShapeOrigin::Type(ty));
    }

    fn defer(&mut self, scope: ScopeId, work: PendingRef<'a>) {
        self.pending.push((scope, work));
    }

    fn exprs(&mut self, scope: ScopeId, exprs: impl IntoIterator<Item = &'a Expr>) {
        let work = exprs
            .into_iter()
            .map(|expr| (scope, PendingRef::Expr(expr)));
        self.pending.extend(work);
    }
}

/// Returns the file of a module; `None` if the module has no declarations.
fn file_of(source: &Source<'_>) -> Option<FileId> {
    let items = source.files.iter().flat_map(|file| &file.items);
    items.map(|item| item.span.file).next()
}
