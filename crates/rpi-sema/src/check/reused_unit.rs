//! Comparison of a unit with that of an earlier check, and its change to the identifiers of the current one.

use crate::check::signatures::static_args::{StaticBinding, StaticBindings};
use crate::reuse::{Effect, StoredUnit};
use crate::typed::{TypedKind, Unit, UnitId};
use std::collections::BTreeMap;

/// Returns a unit with other identifiers of the units that it calls.
pub(super) fn with_ids(unit: &Unit, ids: &BTreeMap<UnitId, UnitId>) -> Unit {
    let mut unit = unit.clone();
    for expr in &mut unit.exprs {
        if let TypedKind::Call(call) = &mut expr.kind {
            call.unit = ids.get(&call.unit).copied().unwrap_or(call.unit);
        }
    }
    unit
}

/// Returns whether one of the static arguments of a unit, or of one that it calls, is a callable. It refers to declarations
/// by identifiers.
pub(super) fn has_callables(statics: &StaticBindings, effects: &[Effect]) -> bool {
    let has_callable = |statics: &StaticBindings| {
        let mut values = statics.values();
        values.any(|value| matches!(value, StaticBinding::Callable(..)))
    };
    let called = effects.iter().any(|effect| match effect {
        Effect::Instance(called, _) => has_callable(&called.statics),
        Effect::CheckNow(_) => false,
    });
    called || has_callable(statics)
}

/// Returns whether a unit is the same as that of the last check, apart from the identifiers of the units that it calls.
pub(super) fn is_same_unit(last: &StoredUnit, unit: &Unit, effects: &[Effect]) -> bool {
    let ids = |effects: &[Effect]| -> Vec<UnitId> {
        let ids = effects.iter().filter_map(|effect| match effect {
            Effect::Instance(_, id) => Some(*id),
            Effect::CheckNow(_) => None,
        });
        ids.collect()
    };
    let (old, new) = (ids(&last.effects), ids(effects));
    if old.len() != new.len() {
        return false;
    }
    match old == new {
        true => *last.unit == *unit,
        false => with_ids(&last.unit, &old.into_iter().zip(new).collect()) == *unit,
    }
}
