//! Finding a declaration by name.

use super::{DeclId, DeclKind, Module, ModuleId, Program, Space, Use};
use rpi_diag::{Code, Finding, Fix, Span};
use rpi_syntax::{Mode, Name};

/// What a name finds.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Lookup {
    /// One declaration.
    Found(DeclId),
    /// Nothing.
    Missing,
}

impl Program<'_> {
    /// What a name means in a module: plain, or qualified by a module (`motion::Line`).
    #[must_use]
    pub fn lookup(&self, from: ModuleId, name: &Name) -> Lookup {
        let module = self.module(from);
        match module.names.get(name) {
            Some(id) => Lookup::Found(*id),
            None if name.is_qualified() => self.qualified(module, name),
            None => self.imported(module, name),
        }
    }

    /// The same for what a place looks for: in Lustre a name may stand for something else at another place.
    #[must_use]
    pub fn lookup_in(&self, space: Space, from: ModuleId, name: &Name) -> Lookup {
        match self.module(from).spaces[space as usize].get(name) {
            Some(id) => Lookup::Found(*id),
            None => self.lookup(from, name),
        }
    }

    /// The declaration of a name in the module itself.
    #[must_use]
    pub fn own(&self, module: ModuleId, name: &Name) -> Option<DeclId> {
        self.module(module).names.get(name).copied()
    }

    fn imported(&self, module: &Module, name: &Name) -> Lookup {
        let uses = module.uses.iter();
        let mut found =
            uses.filter_map(|used| Some((used, *self.module(used.module).names.get(name)?)));
        let Some((used, id)) = found.next() else {
            return self.implied(module, name);
        };
        used.found.set(true);
        // Frames of one name are one, wherever they are declared.
        let is_other = |(_, other): &(&Use, DeclId)| {
            let both = [id, *other].map(|id| self.decl(id).kind);
            *other != id && !matches!(both, [DeclKind::Frame(_), DeclKind::Frame(_)])
        };
        if let Some((other, _)) = found.find(is_other) {
            other.found.set(true);
            let mut clashes = self.clashes.borrow_mut();
            clashes
                .entry((used.name, name.clone()))
                .or_insert(other.name);
        }
        Lookup::Found(id)
    }

    /// An error for each name that a module has found in two of those that it uses: none goes before the other.
    pub(crate) fn clashes(&self) -> Vec<Finding> {
        let clashes = self.clashes.borrow();
        let clash = |((first, name), other): (&(Span, Name), &Span)| {
            Finding::new(
                Code::RPI1002,
                format!("`{name}` is declared in two modules that are used"),
            )
            .at(*first, "here")
            .also(*other, "and here")
            .help(format!(
                "say which one is meant, by its module: `module::{name}`"
            ))
        };
        clashes.iter().map(clash).collect()
    }

    /// A warning for each module that the first one says to use and in which no name has been found so far.
    pub(crate) fn needless_uses(&self) -> impl Iterator<Item = Finding> + '_ {
        let uses = self.root().uses.iter();
        let needless = uses.filter(|used| !used.found.get());
        needless.map(|used| {
            let name = &self.module(used.module).name;
            let finding = Finding::new(Code::RPI1016, format!("nothing uses the module `{name}`"))
                .at(used.name, "none of its names stands in this module");
            finding.fix(Fix::sure("delete it").replace(self.needless_text(used), ""))
        })
    }

    /// What goes away with a module that is not used: the whole phrase, or its name and the comma beside it.
    fn needless_text(&self, used: &Use) -> Span {
        let uses = self.root().uses.iter();
        let beside: Vec<&Use> = uses.filter(|other| other.phrase == used.phrase).collect();
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
            _ => used.phrase,
        }
    }

    fn implied(&self, module: &Module, name: &Name) -> Lookup {
        let mut implicit = self.implicit_of(module).iter();
        match implicit.find_map(|id| self.module(*id).names.get(name)) {
            Some(id) => Lookup::Found(*id),
            None => Lookup::Missing,
        }
    }

    /// The modules in which names are looked for that a module does not declare itself, in this order.
    pub fn used_by(&self, module: ModuleId) -> impl Iterator<Item = ModuleId> + '_ {
        let module = self.module(module);
        let used = module.uses.iter().map(|used| used.module);
        used.chain(self.implicit_of(module).iter().copied())
    }

    /// The modules that a module uses without saying so; Lustre has none.
    fn implicit_of(&self, module: &Module) -> &[ModuleId] {
        match module.mode {
            Mode::Rpi => &self.implicit,
            Mode::Lustre => &[],
        }
    }

    fn qualified(&self, module: &Module, name: &Name) -> Lookup {
        let Some((first, rest)) = name.split_once("::") else {
            return Lookup::Missing;
        };
        let is_it = |id: ModuleId| self.module(id).name == first;
        let used = module.uses.iter().find(|used| is_it(used.module));
        used.inspect(|used| used.found.set(true));
        let mut implicit = self.implicit_of(module).iter().copied();
        let used = used.map(|used| used.module);
        let of_module = used.or_else(|| implicit.find(|id| is_it(*id)));
        let found = of_module.and_then(|id| self.module(id).names.get(rest));
        found.map_or(Lookup::Missing, |id| Lookup::Found(*id))
    }

    /// The names of visible declarations that `fits`, for "did you mean".
    pub fn visible(
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
