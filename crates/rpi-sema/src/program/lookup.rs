//! Name lookup in the table of declarations.

use crate::program::{DeclId, DeclKind, Module, ModuleId, ModuleUse, NameSpace, Program};
use rpi_diag::{Code, Diagnostic, Fix, Span};
use rpi_syntax::{Dialect, Name};

/// Result of looking up a name in a module.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Lookup {
    /// The name refers to this declaration.
    Found(DeclId),
    /// The name is undefined.
    Missing,
}

impl Program<'_> {
    /// Looks up a name as it is seen in the module `from`: a plain name, or one qualified by a module (`motion::Line`).
    #[must_use]
    pub fn lookup(&self, from: ModuleId, name: &Name) -> Lookup {
        let module = self.module(from);
        match module.names.get(name) {
            Some(id) => Lookup::Found(*id),
            None if name.is_qualified() => self.lookup_qualified(module, name),
            None => self.lookup_used(module, name),
        }
    }

    /// Looks up a name in one name space, as it is seen in the module `from`. In Lustre, a name can have a different
    /// meaning in each name space.
    #[must_use]
    pub fn lookup_in(&self, space: NameSpace, from: ModuleId, name: &Name) -> Lookup {
        match self.module(from).spaces[space as usize].get(name) {
            Some(id) => Lookup::Found(*id),
            None => self.lookup(from, name),
        }
    }

    /// Returns the declaration with this name in the module itself, without the modules that it uses; `None` if there
    /// is none.
    #[must_use]
    pub fn lookup_own(&self, module: ModuleId, name: &Name) -> Option<DeclId> {
        self.module(module).names.get(name).copied()
    }

    fn lookup_used(&self, module: &Module, name: &Name) -> Lookup {
        let uses = module.uses.iter();
        let mut found =
            uses.filter_map(|used| Some((used, *self.module(used.module).names.get(name)?)));
        let Some((used, id)) = found.next() else {
            return self.lookup_implicit(module, name);
        };
        used.is_used.set(true);
        // Frames with the same name are one frame, wherever they are declared.
        let is_other = |(_, other): &(&ModuleUse, DeclId)| {
            let both = [id, *other].map(|id| self.decl(id).kind);
            *other != id && !matches!(both, [DeclKind::Frame(_), DeclKind::Frame(_)])
        };
        if let Some((other, _)) = found.find(is_other) {
            other.is_used.set(true);
            let mut clashes = self.ambiguous_names.borrow_mut();
            clashes
                .entry((used.name, name.clone()))
                .or_insert(other.name);
        }
        Lookup::Found(id)
    }

    /// Returns an error for each name that was looked up and that two used modules declare. Neither declaration takes
    /// precedence.
    pub(crate) fn ambiguous_name_errors(&self) -> Vec<Diagnostic> {
        let clashes = self.ambiguous_names.borrow();
        let clash = |((first, name), other): (&(Span, Name), &Span)| {
            Diagnostic::new(
                Code::RPI1002,
                format!("ambiguous name `{name}`: two used modules declare it"),
            )
            .primary(*first, "declared in this module")
            .secondary(*other, "also declared in this module")
            .help(format!(
                "qualify the name with its module: `module::{name}`"
            ))
        };
        clashes.iter().map(clash).collect()
    }

    /// Returns a warning for each module that the root module uses although no name of it has been looked up
    /// successfully so far.
    pub(crate) fn unused_module_warnings(&self) -> impl Iterator<Item = Diagnostic> + '_ {
        let uses = self.root().uses.iter();
        let unused = uses.filter(|used| !used.is_used.get());
        unused.map(|used| {
            let name = &self.module(used.module).name;
            let diagnostic =
                Diagnostic::new(Code::RPI1016, format!("module `{name}` is never used"))
                    .primary(used.name, "none of its names is used here");
            diagnostic.fix(Fix::sure("delete it").replace(self.unused_use_span(used), ""))
        })
    }

    /// Returns the span to be deleted for an unused module: the whole `use` clause if it names one module, else the
    /// name and a comma.
    fn unused_use_span(&self, used: &ModuleUse) -> Span {
        let uses = self.root().uses.iter();
        let beside: Vec<&ModuleUse> = uses
            .filter(|other| other.clause_span == used.clause_span)
            .collect();
        let at = beside.iter().position(|other| other.name == used.name);
        match (at, &beside[..]) {
            (Some(0), [_, next, ..]) => Span {
                end: next.name.start,
                ..used.name
            },
            (Some(at), [_, _, ..]) => Span {
                start: beside[at - 1].name.end,
                ..used.name
            },
            _ => used.clause_span,
        }
    }

    fn lookup_implicit(&self, module: &Module, name: &Name) -> Lookup {
        let mut implicit = self.implicit_of(module).iter();
        match implicit.find_map(|id| self.module(*id).names.get(name)) {
            Some(id) => Lookup::Found(*id),
            None => Lookup::Missing,
        }
    }

    /// Returns the modules in which the names that a module does not declare are looked up, in this order.
    pub fn lookup_modules(&self, module: ModuleId) -> impl Iterator<Item = ModuleId> + '_ {
        let module = self.module(module);
        let used = module.uses.iter().map(|used| used.module);
        used.chain(self.implicit_of(module).iter().copied())
    }

    /// Returns the modules that a module uses without a `use` clause; none in Lustre.
    fn implicit_of(&self, module: &Module) -> &[ModuleId] {
        match module.mode {
            Dialect::Rpi => &self.implicit,
            Dialect::Lustre => &[],
        }
    }

    fn lookup_qualified(&self, module: &Module, name: &Name) -> Lookup {
        let Some((first, rest)) = name.split_once("::") else {
            return Lookup::Missing;
        };
        let is_it = |id: ModuleId| self.module(id).name == first;
        let used = module.uses.iter().find(|used| is_it(used.module));
        used.inspect(|used| used.is_used.set(true));
        let mut implicit = self.implicit_of(module).iter().copied();
        let used = used.map(|used| used.module);
        let of_module = used.or_else(|| implicit.find(|id| is_it(*id)));
        let found = of_module.and_then(|id| self.module(id).names.get(rest));
        found.map_or(Lookup::Missing, |id| Lookup::Found(*id))
    }

    /// Returns the names of the declarations that are visible in the module `from` and for which `fits` returns true,
    /// for suggestions of similar names.
    pub fn visible_names(
        &self,
        from: ModuleId,
        fits: impl Fn(DeclId) -> bool,
    ) -> impl Iterator<Item = &str> {
        let own =
            std::iter::once(from).chain(self.module(from).uses.iter().map(|used| used.module));
        let implicit = self.implicit_of(self.module(from));
        let modules = own
            .chain(implicit.iter().copied())
            .map(|id| self.module(id));
        let decls = modules.flat_map(|module| module.decls.iter().copied());
        decls
            .filter(move |id| fits(*id))
            .map(|id| self.decl(id).name.as_str())
    }
}
