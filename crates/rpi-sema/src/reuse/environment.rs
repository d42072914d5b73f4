//! Declarations of a program as other declarations see them, and what a change of some of them can affect.
//!
//! The check of a declaration looks up names that are written in it, and names in the interfaces of the declarations that
//! it finds. If none of the declarations that have changed is reached in this way, their change cannot affect it. Words are
//! compared instead of names, by their hashes, so that the result errs on the safe side.

use crate::hash::FastSet;
use crate::program::Program;
use crate::reuse::ItemHash;
use crate::reuse::item_hash::word_hashes;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::rc::Rc;

/// Interfaces of all declarations of a program.
#[derive(Debug, Default)]
pub(super) struct Environment {
    /// Hash of the modules and of everything else that is not part of a declaration.
    modules: u64,
    /// Hash of the names of all declarations in order. If it is the same, so are the identifiers of the declarations.
    names: u64,
    items: Vec<Interface>,
}

#[derive(Debug)]
struct Interface {
    hash: u64,
    /// Hashes of the words in the declared names.
    names: Vec<u64>,
    is_import: bool,
}

/// What the changes of a program since the last check affect.
#[derive(Debug, Default)]
pub(super) struct ChangeImpact {
    /// Whether all declarations are affected.
    pub(super) all: bool,
    /// Whether no declaration has another interface than before.
    pub(super) nothing: bool,
    /// Whether the declarations have the same identifiers as before.
    pub(super) has_same_ids: bool,
    /// Hashes of words. Declarations that contain one of them are affected.
    pub(super) words: FastSet<u64>,
}

impl ChangeImpact {
    /// Returns whether one of these words is affected.
    pub(super) fn contains_any(&self, words: &[u64]) -> bool {
        self.all || words.iter().any(|word| self.words.contains(word))
    }
}

impl Environment {
    /// `evaluated` are the hashes of the words in the names of callables whose bodies are evaluated for constants.
    pub(super) fn new(
        program: &Program<'_>,
        hashes: &[ItemHash],
        evaluated: &FastSet<u64>,
    ) -> Environment {
        let mut items: Vec<Interface> = hashes
            .iter()
            .map(|item| Interface {
                hash: item.interface,
                names: Vec::new(),
                is_import: item.is_import,
            })
            .collect();
        let mut names = DefaultHasher::new();
        for decl in &program.decls {
            (decl.module.0, decl.name.as_str()).hash(&mut names);
            if let Some(item) = items.get_mut(decl.item as usize) {
                item.names.extend(word_hashes(&decl.name).iter());
            }
        }
        for (item, hash) in items.iter_mut().zip(hashes) {
            if item.names.iter().any(|name| evaluated.contains(name)) {
                item.hash = hash.whole;
            }
        }
        let mut modules = DefaultHasher::new();
        program.hash_modules(&mut modules);
        Environment {
            modules: modules.finish(),
            names: names.finish(),
            items,
        }
    }

    /// Returns what differs from an earlier environment, and the declarations that this can affect.
    pub(super) fn affected_since(
        &self,
        old: &Environment,
        hashes: &[ItemHash],
        evaluated: &FastSet<u64>,
    ) -> ChangeImpact {
        let known =
            |items: &[Interface]| -> FastSet<u64> { items.iter().map(|item| item.hash).collect() };
        let (before, now) = (known(&old.items), known(&self.items));
        let new = self
            .items
            .iter()
            .filter(|item| !before.contains(&item.hash));
        let removed = old.items.iter().filter(|item| !now.contains(&item.hash));
        let changed: Vec<&Interface> = new.chain(removed).collect();
        let mut affected = ChangeImpact {
            all: self.modules != old.modules || changed.iter().any(|item| item.is_import),
            nothing: changed.is_empty() && self.items.len() == old.items.len(),
            has_same_ids: self.names == old.names,
            words: changed
                .iter()
                .flat_map(|item| item.names.iter().copied())
                .collect(),
        };
        affected.all |= changed.is_empty() && !affected.nothing;
        if !affected.all && !affected.nothing {
            self.add_consequences(&mut affected, hashes, evaluated);
        }
        affected
    }

    /// Adds the names of the declarations whose interfaces contain an affected word, until there are no more.
    fn add_consequences(
        &self,
        affected: &mut ChangeImpact,
        hashes: &[ItemHash],
        evaluated: &FastSet<u64>,
    ) {
        let mut left: Vec<(&Interface, &ItemHash)> = self.items.iter().zip(hashes).collect();
        loop {
            let before = affected.words.len();
            left.retain(|(item, hash)| {
                let is_evaluated = item.names.iter().any(|name| evaluated.contains(name));
                let is_affected = affected.contains_any(&hash.interface_words)
                    || is_evaluated && affected.contains_any(&hash.body_words);
                if is_affected {
                    affected.words.extend(item.names.iter().copied());
                }
                !is_affected
            });
            if affected.words.len() == before {
                return;
            }
        }
    }
}

/// Returns the hashes of the words in the static arguments of an instance, which can name types and frames.
pub(crate) fn words_of_statics(statics: &impl std::fmt::Debug) -> Rc<[u64]> {
    word_hashes(&format!("{statics:?}"))
}
