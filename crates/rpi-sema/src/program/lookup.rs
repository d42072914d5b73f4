//! Finding a declaration by name.

use super::{DeclId, Module, ModuleId, PRELUDE, Program};
use rpi_diag::suggest;
use rpi_syntax::Name;

/// What a name finds.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Lookup {
    /// One declaration.
    Found(DeclId),
    /// Declarations of several modules that are used.
    Ambiguous(Vec<DeclId>),
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

    fn imported(&self, module: &Module<'_>, name: &Name) -> Lookup {
        let names = |id: &ModuleId| self.module(*id).names.get(name).copied();
        let found: Vec<DeclId> = module.uses.iter().filter_map(names).collect();
        match found[..] {
            [] => self.in_prelude(name),
            [one] => Lookup::Found(one),
            _ => Lookup::Ambiguous(found),
        }
    }

    fn in_prelude(&self, name: &Name) -> Lookup {
        let prelude = self.prelude.map(|id| self.module(id));
        match prelude.and_then(|prelude| prelude.names.get(name)) {
            Some(id) => Lookup::Found(*id),
            None => Lookup::Missing,
        }
    }

    fn qualified(&self, module: &Module<'_>, name: &Name) -> Lookup {
        let Some((first, rest)) = name.split_once("::") else {
            return Lookup::Missing;
        };
        let mut used = module.uses.iter().map(|id| self.module(*id));
        let of_module = used.find(|m| m.name == first);
        let of_module = of_module.or(self.prelude.map(|id| self.module(id)).filter(|_| first == PRELUDE));
        let found = of_module.and_then(|m| m.names.get(rest));
        found.map_or(Lookup::Missing, |id| Lookup::Found(*id))
    }

    /// The nearest visible name among declarations that `fits`, for "did you mean".
    #[must_use]
    pub fn nearest(
        &self,
        from: ModuleId,
        name: &str,
        fits: impl Fn(DeclId) -> bool,
    ) -> Option<String> {
        let own = std::iter::once(&from).chain(&self.module(from).uses);
        let modules = own.chain(&self.prelude).map(|id| self.module(*id));
        let decls = modules.flat_map(|module| module.decls.iter().copied());
        let names = decls.filter(|id| fits(*id)).map(|id| self.decl(id).name.as_str());
        suggest(name, names)
    }
}
