//! Table of definitions and references, with its queries.

use crate::hash::FastMap;
use crate::program::{Program, Source};
use crate::query::def::{Def, DefId};
use rpi_diag::{FileId, Span};
use rpi_syntax::Name;

/// Occurrence of a name in the source, with the definition that it refers to.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub struct Reference {
    /// Place of the occurrence in the source.
    pub span: Span,
    /// Definition that the name refers to there.
    pub def: DefId,
}

/// Identifies a scope of names by its index.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct ScopeId(pub(super) u32);

/// Scope of names: a module, or a declaration with a body.
#[derive(Debug)]
pub(super) struct Scope {
    /// Source range of the scope; for a module, its whole first file.
    pub(super) span: Span,
    /// Enclosing scope.
    pub(super) parent: Option<ScopeId>,
    /// Definition whose inner scope this is.
    pub(super) owner: Option<DefId>,
    /// Definitions of the names in the scope.
    pub(super) names: FastMap<Name, DefId>,
    /// Definitions in text order.
    pub(super) order: Vec<DefId>,
    /// Scopes of the modules that a module uses, for names that no enclosing scope defines.
    pub(super) uses: Vec<ScopeId>,
}

/// Scopes inside a definition, in which its members and parameters are found.
#[derive(Clone, Copy, Default, Debug)]
pub(super) struct InnerScopes {
    /// Scope that contains the members.
    pub(super) members: Option<ScopeId>,
    /// Scope that contains the parameters.
    pub(super) parameters: Option<ScopeId>,
}

/// Index of every definition and reference of a program, for editors and documentation.
#[derive(Debug)]
pub struct Index {
    pub(super) defs: Vec<Def>,
    /// References in text order.
    pub(super) references: Vec<Reference>,
    pub(super) scopes: Vec<Scope>,
    /// Inner scopes of each definition.
    pub(super) inner_scopes: Vec<InnerScopes>,
    /// Scope of the module of each file.
    pub(super) files: Vec<(FileId, ScopeId)>,
}

impl Index {
    /// Builds the table of a program. `sources` must be those from which the program was collected.
    #[must_use]
    pub fn build<'a>(program: &Program<'a>, sources: &[Source<'a>]) -> Index {
        crate::query::build::build(program, sources)
    }

    /// Returns the definition that an id of this index denotes.
    #[must_use]
    pub fn def(&self, id: DefId) -> &Def {
        &self.defs[id.0 as usize]
    }

    /// Returns all definitions of a file, parents before their children.
    pub fn defs_in(&self, file: FileId) -> impl Iterator<Item = (DefId, &Def)> {
        let all = (0..).map(DefId).zip(&self.defs);
        all.filter(move |(_, def)| def.span.file == file)
    }

    /// Returns the reference at a position, including the positions at both ends of the name.
    #[must_use]
    pub fn reference_at(&self, file: FileId, offset: u32) -> Option<Reference> {
        let begins = |r: &Reference| (r.span.file, r.span.start) <= (file, offset);
        let after = self.references.partition_point(begins);
        let last = self.references[..after].last()?;
        let holds = last.span.file == file && offset <= last.span.end;
        holds.then_some(*last)
    }

    /// Returns the references within a span, in text order.
    #[must_use]
    pub fn references_in(&self, place: Span) -> &[Reference] {
        let before = |offset: u32| {
            let begins = |r: &Reference| (r.span.file, r.span.start) < (place.file, offset);
            self.references.partition_point(begins)
        };
        &self.references[before(place.start)..before(place.end)]
    }

    /// Returns the spans of all occurrences of a definition's name, in text order.
    pub fn references(&self, def: DefId) -> impl Iterator<Item = Span> + '_ {
        let all = self.references.iter();
        all.filter(move |r| r.def == def).map(|r| r.span)
    }

    /// Resolves a name as if it occurred at a position.
    #[must_use]
    pub fn resolve(&self, file: FileId, offset: u32, name: &str) -> Option<DefId> {
        self.lookup(self.scope_at(file, offset)?, name)
    }

    /// Resolves `name` or `name.part` as if it occurred at a position. A part is a member or a parameter.
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

    /// Returns all definitions that are visible at a position, nearest first, without shadowed ones.
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

    /// Returns the definitions that can be read as `definition.name`.
    #[must_use]
    pub fn members(&self, def: DefId) -> Vec<DefId> {
        let owner = self.member_owner(def);
        let Some(scope) = owner.and_then(|owner| self.inner_scopes(owner).members) else {
            return Vec::new();
        };
        let order = self.scope(scope).order.iter().copied();
        order.filter(|id| self.is_member(owner, *id)).collect()
    }

    /// Returns the port, field or local definition with this name inside a definition; `None` if it has none.
    #[must_use]
    pub fn member(&self, def: DefId, name: &str) -> Option<DefId> {
        let owner = self.member_owner(def)?;
        let scope = self.inner_scopes(owner).members?;
        let found = *self.scope(scope).names.get(name)?;
        self.is_member(Some(owner), found).then_some(found)
    }

    /// Returns the definitions that can be named arguments of a call: static parameters, then in-ports.
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

    /// Resolves an alias: for `node f = g<<3>>;` returns g.
    fn resolve_alias(&self, def: DefId) -> DefId {
        match (self.def(def).kind.is_callable(), self.def(def).shape) {
            (true, Some(shape)) => shape,
            _ => def,
        }
    }

    /// Returns the definition that has the members: the shape of a value, else the definition itself.
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

    /// Resolves a name in a scope.
    pub(super) fn lookup(&self, scope: ScopeId, name: &str) -> Option<DefId> {
        let mut scopes = self.scope_chain(Some(scope)).into_iter();
        let plain = scopes.find_map(|id| self.scope(id).names.get(name).copied());
        plain.or_else(|| self.qualified(scope, name))
    }

    /// Resolves a qualified name, `motion::Line`.
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

    /// Returns a scope, its enclosing scopes, and the modules used there.
    fn scope_chain(&self, innermost: Option<ScopeId>) -> Vec<ScopeId> {
        let around = std::iter::successors(innermost, |id| self.scope(*id).parent);
        let mut chain: Vec<ScopeId> = around.collect();
        if let Some(module) = chain.last() {
            chain.extend(&self.scope(*module).uses);
        }
        chain
    }

    /// Returns the innermost scope at a position.
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
