//! Typed units of an earlier check, with the effects of their check on the rest of the checker.
//!
//! A unit is reused if its own declaration is the same as in the last check, and no change of the interface of another
//! declaration can affect it. The interface of a declaration is everything that the check of another one can read: its text
//! without the content of its body, and the whole text of callables that were evaluated for a constant. Locations are part
//! of both. A unit with diagnostics is reused only if all interfaces are the same, because their texts can suggest names.

use crate::check::StaticBindings;
use crate::hash::{FastMap, FastSet};
use crate::program::{DeclId, Program, UsedModules};
use crate::reuse::ItemHash;
use crate::reuse::environment::{ChangeImpact, Environment};
use crate::reuse::item_hash::word_hashes;
use crate::typed::{Unit, UnitId, UnitKind};
use rpi_diag::{Diagnostic, Span};
use rpi_syntax::Name;
use std::rc::Rc;

/// Number of checks after which a unit is dropped that none of them has used. A unit whose environment has an error for a
/// while is then still known when the error has been corrected.
const MAX_AGE: u32 = 8;

/// Step of the check of a unit that creates another unit, or checks one first.
#[derive(Clone, Debug)]
pub(crate) enum Effect {
    /// A callable is called, and becomes the unit with this identifier.
    Instance(Rc<CalledInstance>, UnitId),
    /// The unit with this identifier is needed in checked form.
    CheckNow(UnitId),
}

/// Callable that a unit calls, with its static arguments and the location of the call.
#[derive(Debug)]
pub(crate) struct CalledInstance {
    pub(crate) decl: DeclId,
    pub(crate) module: Name,
    pub(crate) name: Name,
    pub(crate) statics: Rc<StaticBindings>,
    pub(crate) span: Span,
}

/// Result of the check of one unit.
#[derive(Clone, Debug)]
pub(crate) struct StoredUnit {
    pub(crate) unit: Rc<Unit>,
    /// Number that differs for units that differ.
    pub(crate) version: u64,
    /// Hash of the declaration; `None` if the unit must be checked again, and only serves to compare versions.
    pub(crate) declaration: Option<u64>,
    /// Hashes of the words in the static arguments.
    pub(crate) static_words: Rc<[u64]>,
    /// Whether static arguments of the unit, or of one that it calls, are callables.
    pub(crate) has_callable_statics: bool,
    pub(crate) diagnostics: Vec<Diagnostic>,
    pub(crate) effects: Vec<Effect>,
    pub(crate) used_modules: UsedModules,
    /// Share of the size limit of the program.
    pub(crate) expanded_size: usize,
    /// Number of names compared for suggestions.
    pub(crate) compared_names: usize,
    /// Whether an error had been reported before the unit was checked, if the result depends on that.
    pub(crate) follows_error: Option<bool>,
    pub(crate) last_use: u32,
}

impl Default for StoredUnit {
    fn default() -> StoredUnit {
        StoredUnit {
            unit: Rc::new(Unit::new("".into(), UnitKind::Constant, Span::NONE)),
            version: 0,
            declaration: None,
            static_words: Rc::new([]),
            has_callable_statics: false,
            diagnostics: Vec::new(),
            effects: Vec::new(),
            used_modules: UsedModules::default(),
            expanded_size: 0,
            compared_names: 0,
            follows_error: None,
            last_use: 0,
        }
    }
}

/// Typed units of the last checks of a program, for the next one.
#[derive(Debug, Default)]
pub struct UnitMemo {
    units: FastMap<String, StoredUnit>,
    /// Hashes of the words in the names of callables whose bodies were evaluated for constants.
    evaluated: FastSet<u64>,
    /// Units of these callables that were evaluated in the current check.
    evaluated_units: FastSet<UnitId>,
    /// Interfaces in the last check; `None` if nothing of that check must be reused.
    last: Option<Environment>,
    affected: ChangeImpact,
    last_version: u64,
    /// Number of checks so far.
    check_count: u32,
}

impl UnitMemo {
    /// Number of units that are known.
    #[must_use]
    pub fn len(&self) -> usize {
        self.units.len()
    }

    /// Whether no unit is known.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.units.is_empty()
    }

    /// Forgets all units and interfaces.
    pub(crate) fn clear(&mut self) {
        self.units.clear();
        self.evaluated.clear();
        self.last = None;
    }

    /// Begins the check of a program whose declarations have these hashes.
    pub(crate) fn begin(&mut self, program: &Program<'_>, hashes: &[ItemHash]) {
        self.check_count = self.check_count.wrapping_add(1);
        self.evaluated_units.clear();
        let now = Environment::new(program, hashes, &self.evaluated);
        self.affected = match &self.last {
            Some(last) => now.affected_since(last, hashes, &self.evaluated),
            None => ChangeImpact {
                all: true,
                ..ChangeImpact::default()
            },
        };
    }

    /// Ends a check. With `is_exact` the next check can reuse its results; otherwise only the versions of units remain.
    pub(crate) fn end(&mut self, program: &Program<'_>, hashes: &[ItemHash], is_exact: bool) {
        let last = is_exact.then(|| Environment::new(program, hashes, &self.evaluated));
        self.last = last;
        let now = self.check_count;
        self.units
            .retain(|_, known| now.wrapping_sub(known.last_use) < MAX_AGE);
    }

    /// Whether the declarations have the same identifiers as in the last check.
    pub(crate) fn has_same_ids(&self) -> bool {
        self.affected.has_same_ids
    }

    /// Returns the unit with this key if it is valid for a declaration with this hash.
    pub(crate) fn find(&mut self, key: &str, item: &ItemHash) -> Option<&StoredUnit> {
        let known = self.units.get_mut(key)?;
        let is_of_last = known.last_use == self.check_count.wrapping_sub(1);
        known.last_use = self.check_count;
        let affected = &self.affected;
        let is_unaffected = || {
            known.diagnostics.is_empty()
                && !known.has_callable_statics
                && !affected.contains_any(&item.interface_words)
                && !affected.contains_any(&item.body_words)
                && !affected.contains_any(&known.static_words)
        };
        let is_valid = is_of_last
            && known.declaration == Some(item.whole)
            && !affected.all
            && (affected.nothing || is_unaffected());
        is_valid.then_some(&*known)
    }

    /// Returns the last unit with this key, whether it is valid or not.
    pub(crate) fn last(&self, key: &str) -> Option<&StoredUnit> {
        self.units.get(key)
    }

    /// Adds a unit, or replaces the one with the same key. Returns its version.
    pub(crate) fn insert(&mut self, key: String, known: StoredUnit) {
        let known = StoredUnit {
            last_use: self.check_count,
            ..known
        };
        self.units.insert(key, known);
    }

    /// Returns a version that no unit has had.
    pub(crate) fn new_version(&mut self) -> u64 {
        self.last_version += 1;
        self.last_version
    }

    /// Records that the body of the callable with this name was evaluated, as the given unit. Returns whether it is the first
    /// time in this check.
    pub(crate) fn record_evaluated(&mut self, name: &Name, unit: UnitId) -> bool {
        self.evaluated.extend(word_hashes(name).iter());
        self.evaluated_units.insert(unit)
    }

    /// Forgets which units were evaluated in this check, because their identifiers are given to other units.
    pub(crate) fn forget_unit_ids(&mut self) {
        self.evaluated_units.clear();
    }

    /// Replaces a unit and the effects of its check by those with the identifiers of the current check.
    pub(crate) fn replace(&mut self, key: &str, unit: Rc<Unit>, effects: Vec<Effect>) {
        if let Some(known) = self.units.get_mut(key) {
            (known.unit, known.effects) = (unit, effects);
        }
    }
}
