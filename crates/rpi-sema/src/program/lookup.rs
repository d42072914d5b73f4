//! Finding a declaration by name.

use super::{DeclId, Module, ModuleId, Program, Space};
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
        let names = |id: &ModuleId| self.module(*id).names.get(name).copied();
        let found: Vec<DeclId> = module.uses.iter().filter_map(names).collect();
        match found.first() {
            None => self.implied(module, name),
            Some(first) => Lookup::Found(*first),
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
        let used = module.uses.iter().chain(self.implicit_of(module));
        used.copied()
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
        let used = module.uses.iter().chain(self.implicit_of(module));
        let mut used = used.map(|id| self.module(*id));
        let of_module = used.find(|m| m.name == first);
        let found = of_module.and_then(|m| m.names.get(rest));
        found.map_or(Lookup::Missing, |id| Lookup::Found(*id))
    }

    /// The names of visible declarations that `fits`, for "did you mean".
    pub fn visible(
        &self,
        from: ModuleId,
        fits: impl Fn(DeclId) -> bool,
    ) -> impl Iterator<Item = &str> {
        let own = std::iter::once(from).chain(self.module(from).uses.iter().copied());
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
