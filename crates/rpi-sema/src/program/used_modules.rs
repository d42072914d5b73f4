//! Record of the modules and ambiguous names that lookups use, for a part of a check.

use crate::program::Program;
use rpi_diag::{FileId, Span};
use rpi_syntax::Name;
use std::collections::BTreeMap;
use std::hash::{Hash, Hasher};

/// Effects of name lookups: the `use` clauses in which a name was found, and the ambiguous names.
#[derive(Clone, Debug, Default)]
pub(crate) struct UsedModules {
    /// Indices of modules and of the clauses in them.
    clauses: Vec<(usize, usize)>,
    ambiguous_names: BTreeMap<(Span, Name), Span>,
}

impl UsedModules {
    pub(crate) fn has_ambiguous_names(&self) -> bool {
        !self.ambiguous_names.is_empty()
    }
}

impl Program<'_> {
    /// Returns the effects of all lookups since the start or the last call, and removes them.
    pub(crate) fn take_used_modules(&self) -> UsedModules {
        let mut used = UsedModules {
            clauses: Vec::new(),
            ambiguous_names: self.ambiguous_names.take(),
        };
        for (module, all) in self.modules.iter().enumerate() {
            for (clause, one) in all.uses.iter().enumerate() {
                if one.is_used.replace(false) {
                    used.clauses.push((module, clause));
                }
            }
        }
        used
    }

    /// Adds the effects of lookups. The first place of an ambiguous name stays.
    pub(crate) fn add_used_modules(&self, used: &UsedModules) {
        for (module, clause) in &used.clauses {
            let all = self.modules.get(*module).map(|module| &module.uses);
            if let Some(one) = all.and_then(|uses| uses.get(*clause)) {
                one.is_used.set(true);
            }
        }
        let mut names = self.ambiguous_names.borrow_mut();
        for (name, second) in &used.ambiguous_names {
            names.entry(name.clone()).or_insert(*second);
        }
    }

    /// Hashes what the check of a unit can read of the program beside its declarations.
    pub(crate) fn hash_modules(&self, hasher: &mut impl Hasher) {
        for module in &self.modules {
            (module.name.as_str(), module.mode, module.decls.len()).hash(hasher);
        }
        let implicit: Vec<u32> = self.implicit.iter().map(|id| id.0).collect();
        let first_parts: Vec<FileId> = self.first_parts.clone();
        (implicit, self.arm_axes, first_parts).hash(hasher);
    }
}
