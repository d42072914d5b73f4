//! Table of definitions and references, with its queries.

use std::collections::BTreeSet;

use crate::hash::FastMap;
use crate::program::{Program, Source};
use crate::query::def::{Def, DefId};
use rpi_diag::{FileId, Span};
use rpi_syntax::Name;

/// Occurrence of a name in the source, with the definition to which it refers.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub struct Reference {
    /// Location of the occurrence in the source.
    pub span: Span,
    /// Definition to which the name refers.
    pub def: DefId,
}

/// Index of a scope of names in the index of a program.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct ScopeId(pub(super) u32);

/// Scope of names: that of a module, or of a declaration with a body.
#[derive(Debug)]
pub(super) struct Scope {
    /// Source range of the scope; for a module, the start of its first file only.
    pub(super) span: Span,
    /// Scope around this one; `None` for a module.
    pub(super) parent: Option<ScopeId>,
    /// Definition to whose inside the scope belongs.
    pub(super) owner: Option<DefId>,
    /// Definitions of the scope by name. If there are several of one name, the first one is listed.
    pub(super) names: FastMap<Name, DefId>,
    /// Definitions of the scope in text order.
    pub(super) order: Vec<DefId>,
    /// For the scope of a module, the scopes of the modules that it uses. Names that no enclosing scope defines are
    /// looked up in them.
    pub(super) uses: Vec<ScopeId>,
}

/// Scopes inside of a definition, in which its members and its parameters are found.
#[derive(Clone, Copy, Default, Debug)]
pub(super) struct InnerScopes {
    /// Scope with the members of the definition; `None` if it has none.
    pub(super) members: Option<ScopeId>,
    /// Scope with the parameters of the definition; `None` if it has none.
    pub(super) parameters: Option<ScopeId>,
}

/// Index of every definition and reference of a program, for editors and documentation.
#[derive(Debug)]
pub struct Index {
    pub(super) defs: Vec<Def>,
    /// References in text order.
    pub(super) references: Vec<Reference>,
    pub(super) scopes: Vec<Scope>,
    /// Inner scopes of each definition, indexed by definition.
    pub(super) inner_scopes: Vec<InnerScopes>,
    /// For each file, the scope of the module to which it belongs.
    pub(super) files: Vec<(FileId, ScopeId)>,
}

impl Index {
    /// Builds the index of a program. `sources` must be those from which the program was collected.
    #[must_use]
    pub fn build<'a>(program: &Program<'a>, sources: &[Source<'a>]) -> Index {
        crate::query::build::build(program, sources, None)
    }

    /// Builds the index of a program without the content of the bodies of nodes and tests, except for the declaration that
    /// contains `focus`. It has all definitions that are visible there.
    #[must_use]
    pub fn build_around<'a>(program: &Program<'a>, sources: &[Source<'a>], focus: Span) -> Index {
        crate::query::build::build(program, sources, Some(focus))
    }

    /// Replaces all locations by the results of `change`, which must preserve their order.
    pub fn change_spans(&mut self, change: impl Fn(Span) -> Span) {
        for def in &mut self.defs {
            def.span = change(def.span);
            def.full_span = change(def.full_span);
            def.ty = def.ty.map(&change);
        }
        for reference in &mut self.references {
            reference.span = change(reference.span);
        }
        for scope in &mut self.scopes {
            scope.span = change(scope.span);
        }
        for (file, _) in &mut self.files {
            *file = change(Span::new(*file, 0, 0)).file;
        }
    }

    /// Returns the definition with this index.
    #[must_use]
    pub fn def(&self, id: DefId) -> &Def {
        &self.defs[id.0 as usize]
    }

    /// Returns the definition with this index; `None` if there is none, because the index is that of another program.
    #[must_use]
    pub fn get(&self, id: DefId) -> Option<&Def> {
        self.defs.get(id.0 as usize)
    }

    /// Returns all definitions in a file, each after the definition that contains it.
    pub fn defs_in(&self, file: FileId) -> impl Iterator<Item = (DefId, &Def)> {
        let all = (0..).map(DefId).zip(&self.defs);
        all.filter(move |(_, def)| def.span.file == file)
    }

    /// Returns the occurrence of a name at a position, given as a byte offset; `None` if there is none. The positions
    /// at both ends of the name count.
    #[must_use]
    pub fn reference_at(&self, file: FileId, offset: u32) -> Option<Reference> {
        let begins = |r: &Reference| (r.span.file, r.span.start) <= (file, offset);
        let after = self.references.partition_point(begins);
        let last = self.references[..after].last()?;
        let holds = last.span.file == file && offset <= last.span.end;
        holds.then_some(*last)
    }

    /// Returns the occurrences of names within a span, in text order.
    #[must_use]
    pub fn references_in(&self, place: Span) -> &[Reference] {
        let before = |offset: u32| {
            let begins = |r: &Reference| (r.span.file, r.span.start) < (place.file, offset);
            self.references.partition_point(begins)
        };
        &self.references[before(place.start)..before(place.end)]
    }

    /// Returns the spans of all occurrences of the name of a definition, in text order.
    pub fn references(&self, def: DefId) -> impl Iterator<Item = Span> + '_ {
        let all = self.references.iter();
        all.filter(move |r| r.def == def).map(|r| r.span)
    }

    /// Returns the definitions whose names occur in files other than `file`.
    #[must_use]
    pub fn referenced_outside(&self, file: FileId) -> BTreeSet<DefId> {
        let outside = self.references.iter().filter(|r| r.span.file != file);
        outside.map(|r| r.def).collect()
    }

    /// Returns the definition to which a name would refer at a position, given as a byte offset; `None` if it is
    /// undefined there.
    #[must_use]
    pub fn resolve(&self, file: FileId, offset: u32, name: &str) -> Option<DefId> {
        self.lookup(self.scope_at(file, offset)?, name)
    }

    /// Returns the definition to which `name` or `name.part` would refer at a position, given as a byte offset. A part
    /// is a member or a parameter.
    #[must_use]
    pub fn resolve_path(&self, file: FileId, offset: u32, path: &str) -> Option<DefId> {
        let (first, members) = path.split_once('.').unwrap_or((path, ""));
        let start = self.resolve(file, offset, first)?;
        let mut members = members.split('.').filter(|name| !name.is_empty());
        let parameter = |def: DefId, name: &str| {
            let mut all = self.parameters(def).into_iter();
            all.find(|id| self.def(*id).name == name)
        };
        members.try_fold(start, |def, name| {
            self.member(def, name).or_else(|| parameter(def, name))
        })
    }

    /// Returns all definitions that are visible at a position, given as a byte offset, the nearest ones first.
    /// Definitions that are hidden by others of the same name are left out.
    #[must_use]
    pub fn visible(&self, file: FileId, offset: u32) -> Vec<DefId> {
        let mut found = Vec::new();
        let mut seen = std::collections::BTreeSet::new();
        for scope in self.scope_chain(self.scope_at(file, offset)) {
            let defs = self.scope(scope).order.iter();
            found.extend(defs.filter(|id| seen.insert(&self.def(**id).name)));
        }
        found
    }

    /// Returns the members of a definition, which can be read as `definition.name`.
    #[must_use]
    pub fn members(&self, def: DefId) -> Vec<DefId> {
        let owner = self.member_owner(def);
        let Some(scope) = owner.and_then(|owner| self.inner_scopes(owner).members) else {
            return Vec::new();
        };
        let order = self.scope(scope).order.iter().copied();
        order.filter(|id| self.is_member(owner, *id)).collect()
    }

    /// Returns the member with this name of a definition, such as a port, a field or a local flow; `None` if there is
    /// none.
    #[must_use]
    pub fn member(&self, def: DefId, name: &str) -> Option<DefId> {
        let owner = self.member_owner(def)?;
        let scope = self.inner_scopes(owner).members?;
        let found = *self.scope(scope).names.get(name)?;
        self.is_member(Some(owner), found).then_some(found)
    }

    /// Returns the definitions that can be passed by name in a call of `def`: static parameters, then in-ports.
    #[must_use]
    pub fn parameters(&self, def: DefId) -> Vec<DefId> {
        let scope = self.inner_scopes(self.resolve_alias(def)).parameters;
        let order = scope.map_or(&[][..], |scope| &self.scope(scope).order);
        let is_parameter = |id: &DefId| self.def(*id).kind.is_parameter();
        order.iter().copied().filter(is_parameter).collect()
    }

    pub(super) fn inner_scopes(&self, def: DefId) -> InnerScopes {
        self.inner_scopes[def.0 as usize]
    }

    /// Returns the callable for which a definition stands: `g` for the alias `node f = g<<3>>;`, else the definition
    /// itself.
    fn resolve_alias(&self, def: DefId) -> DefId {
        match (self.def(def).kind.is_callable(), self.def(def).shape) {
            (true, Some(shape)) => shape,
            _ => def,
        }
    }

    /// Returns the definition that has the members of `def`: its struct or device type or callee if it has one, else
    /// `def` itself unless it is a value. `None` if there are no members.
    pub(super) fn member_owner(&self, def: DefId) -> Option<DefId> {
        let shape = self.def(def).shape;
        shape.or_else(|| (!self.def(def).kind.is_declared_value()).then_some(def))
    }

    fn is_member(&self, owner: Option<DefId>, id: DefId) -> bool {
        let kind = owner.map(|owner| self.def(owner).kind);
        kind.is_some_and(|owner| self.def(id).kind.is_member_of(owner))
    }

    pub(super) fn scope(&self, id: ScopeId) -> &Scope {
        &self.scopes[id.0 as usize]
    }

    /// Returns the definition to which a plain or qualified name refers in a scope; `None` if it is undefined.
    pub(super) fn lookup(&self, scope: ScopeId, name: &str) -> Option<DefId> {
        let mut scopes = self.scope_chain(Some(scope)).into_iter();
        let plain = scopes.find_map(|id| self.scope(id).names.get(name).copied());
        plain.or_else(|| self.qualified(scope, name))
    }

    /// Returns the definition to which a name qualified by a module, such as `motion::Line`, refers in a scope; `None`
    /// if it is undefined.
    fn qualified(&self, scope: ScopeId, name: &str) -> Option<DefId> {
        let (module, rest) = name.split_once("::")?;
        let chain = self.scope_chain(Some(scope));
        let is_meant = |id: &ScopeId| {
            let owner = self.scope(*id).owner;
            self.scope(*id).parent.is_none() && owner.is_some_and(|o| self.def(o).name == module)
        };
        let found = chain.into_iter().find(is_meant)?;
        self.scope(found).names.get(rest).copied()
    }

    /// Returns a scope, the scopes around it from the inside out, and then the scopes of the modules used there.
    fn scope_chain(&self, innermost: Option<ScopeId>) -> Vec<ScopeId> {
        let around = std::iter::successors(innermost, |id| self.scope(*id).parent);
        let mut chain: Vec<ScopeId> = around.collect();
        if let Some(module) = chain.last() {
            chain.extend(&self.scope(*module).uses);
        }
        chain
    }

    /// Returns the innermost scope at a position, given as a byte offset; `None` if the file is not part of the
    /// program.
    fn scope_at(&self, file: FileId, offset: u32) -> Option<ScopeId> {
        let holds = |span: Span| span.file == file && span.start <= offset && offset <= span.end;
        let inner = (0..).map(ScopeId).zip(&self.scopes);
        let inner = inner.filter(|(_, scope)| scope.parent.is_some() && holds(scope.span));
        let smallest = inner.min_by_key(|(_, scope)| scope.span.end - scope.span.start);
        let module = || self.files.iter().find(|(known, _)| *known == file);
        smallest
            .map(|(id, _)| id)
            .or_else(|| module().map(|(_, scope)| *scope))
    }
}
