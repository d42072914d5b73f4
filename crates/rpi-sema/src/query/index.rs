//! The table of definitions and references, and what can be asked of it.

use super::def::{Def, DefId};
use crate::hash::Map;
use crate::program::{Program, Source};
use rpi_diag::{FileId, Span};
use rpi_syntax::Name;

/// A place where a name stands.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub struct Reference {
    /// Where.
    pub span: Span,
    /// What it means.
    pub def: DefId,
}

/// Index of a scope.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct ScopeId(pub(super) u32);

/// A part of a text in which names have a meaning.
#[derive(Debug)]
pub(super) struct Scope {
    /// The part of the text; a module's is its whole first file.
    pub(super) span: Span,
    /// The scope around it.
    pub(super) parent: Option<ScopeId>,
    /// The definition whose inside it is.
    pub(super) owner: Option<DefId>,
    /// What its names mean.
    pub(super) names: Map<Name, DefId>,
    /// The same in text order.
    pub(super) order: Vec<DefId>,
    /// Where names are looked for that are nowhere around: the modules that a module uses.
    pub(super) uses: Vec<ScopeId>,
}

/// What is inside a definition.
#[derive(Clone, Copy, Default, Debug)]
pub(super) struct Inside {
    /// The scope in which its members stand.
    pub(super) members: Option<ScopeId>,
    /// The scope in which its parameters stand.
    pub(super) parameters: Option<ScopeId>,
}

/// Every definition and reference of a program.
#[derive(Debug)]
pub struct Index {
    pub(super) defs: Vec<Def>,
    /// In text order.
    pub(super) references: Vec<Reference>,
    pub(super) scopes: Vec<Scope>,
    /// What is inside each definition.
    pub(super) inside: Vec<Inside>,
    /// The scope of the module of each file.
    pub(super) files: Vec<(FileId, ScopeId)>,
}

impl Index {
    /// The table of a program. `sources` are those that the program was collected from.
    #[must_use]
    pub fn of<'a>(program: &Program<'a>, sources: &[Source<'a>]) -> Index {
        super::build::build(program, sources)
    }

    /// The definition of this index.
    #[must_use]
    pub fn def(&self, id: DefId) -> &Def {
        &self.defs[id.0 as usize]
    }

    /// All definitions of a file in the order in which they were met: parents before what is in them.
    pub fn defs_in(&self, file: FileId) -> impl Iterator<Item = (DefId, &Def)> {
        let all = (0..).map(DefId).zip(&self.defs);
        all.filter(move |(_, def)| def.span.file == file)
    }

    /// The name at a place: one that begins before it or there, and ends there or after it.
    #[must_use]
    pub fn at(&self, file: FileId, offset: u32) -> Option<Reference> {
        let begins = |r: &Reference| (r.span.file, r.span.start) <= (file, offset);
        let after = self.references.partition_point(begins);
        let last = self.references[..after].last()?;
        let holds = last.span.file == file && offset <= last.span.end;
        holds.then_some(*last)
    }

    /// The names within a place, in text order, and what they mean.
    #[must_use]
    pub fn references_in(&self, place: Span) -> &[Reference] {
        let before = |offset: u32| {
            let begins = |r: &Reference| (r.span.file, r.span.start) < (place.file, offset);
            self.references.partition_point(begins)
        };
        &self.references[before(place.start)..before(place.end)]
    }

    /// Every place where a definition's name stands, in text order.
    pub fn references(&self, def: DefId) -> impl Iterator<Item = Span> + '_ {
        let all = self.references.iter();
        all.filter(move |r| r.def == def).map(|r| r.span)
    }

    /// What a name means where it would stand at a place.
    #[must_use]
    pub fn resolve(&self, file: FileId, offset: u32, name: &str) -> Option<DefId> {
        self.lookup(self.scope_at(file, offset)?, name)
    }

    /// What `name` or `name.part` means where it would stand at a place; a part is a member or a parameter.
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

    /// Everything that has a name at a place, nearest first. A name that a nearer one hides is left out.
    #[must_use]
    pub fn visible(&self, file: FileId, offset: u32) -> Vec<DefId> {
        let mut found = Vec::new();
        let mut seen = std::collections::BTreeSet::new();
        for scope in self.chain(self.scope_at(file, offset)) {
            let defs = self.scope(scope).order.iter();
            found.extend(defs.filter(|id| seen.insert(&self.def(**id).name)));
        }
        found
    }

    /// What is read as `definition.name`.
    #[must_use]
    pub fn members(&self, def: DefId) -> Vec<DefId> {
        let owner = self.with_members(def);
        let Some(scope) = owner.and_then(|owner| self.inside(owner).members) else {
            return Vec::new();
        };
        let order = self.scope(scope).order.iter().copied();
        order.filter(|id| self.is_member(owner, *id)).collect()
    }

    /// The member of this name.
    #[must_use]
    pub fn member(&self, def: DefId, name: &str) -> Option<DefId> {
        let owner = self.with_members(def)?;
        let scope = self.inside(owner).members?;
        let found = *self.scope(scope).names.get(name)?;
        self.is_member(Some(owner), found).then_some(found)
    }

    /// What a call may give by name: static parameters, then in-ports.
    #[must_use]
    pub fn parameters(&self, def: DefId) -> Vec<DefId> {
        let scope = self.inside(self.declaration_of(def)).parameters;
        let order = scope.map_or(&[][..], |scope| &self.scope(scope).order);
        let is_parameter = |id: &DefId| self.def(*id).kind.is_parameter();
        order.iter().copied().filter(is_parameter).collect()
    }

    pub(super) fn inside(&self, def: DefId) -> Inside {
        self.inside[def.0 as usize]
    }

    /// Behind `node f = g<<3>>;` stands g.
    fn declaration_of(&self, def: DefId) -> DefId {
        match (self.def(def).kind.is_callable(), self.def(def).shape) {
            (true, Some(shape)) => shape,
            _ => def,
        }
    }

    /// The definition whose members are meant: the shape of a value, else the definition itself.
    pub(super) fn with_members(&self, def: DefId) -> Option<DefId> {
        let shape = self.def(def).shape;
        shape.or_else(|| (!self.def(def).kind.is_value()).then_some(def))
    }

    fn is_member(&self, owner: Option<DefId>, id: DefId) -> bool {
        let kind = owner.map(|owner| self.def(owner).kind);
        kind.is_some_and(|owner| self.def(id).kind.is_member_of(owner))
    }

    pub(super) fn scope(&self, id: ScopeId) -> &Scope {
        &self.scopes[id.0 as usize]
    }

    /// What a name means in a scope.
    pub(super) fn lookup(&self, scope: ScopeId, name: &str) -> Option<DefId> {
        let mut scopes = self.chain(Some(scope)).into_iter();
        let plain = scopes.find_map(|id| self.scope(id).names.get(name).copied());
        plain.or_else(|| self.qualified(scope, name))
    }

    /// `motion::Line`
    fn qualified(&self, scope: ScopeId, name: &str) -> Option<DefId> {
        let (module, rest) = name.split_once("::")?;
        let chain = self.chain(Some(scope));
        let is_meant = |id: &ScopeId| {
            let owner = self.scope(*id).owner;
            self.scope(*id).parent.is_none() && owner.is_some_and(|o| self.def(o).name == module)
        };
        let found = chain.into_iter().find(is_meant)?;
        self.scope(found).names.get(rest).copied()
    }

    /// A scope, those around it, and the modules that are used there.
    fn chain(&self, innermost: Option<ScopeId>) -> Vec<ScopeId> {
        let around = std::iter::successors(innermost, |id| self.scope(*id).parent);
        let mut chain: Vec<ScopeId> = around.collect();
        if let Some(module) = chain.last() {
            chain.extend(&self.scope(*module).uses);
        }
        chain
    }

    /// The innermost scope at a place.
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
