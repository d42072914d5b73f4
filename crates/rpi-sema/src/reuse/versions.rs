//! Versions of units together with everything that they call.

use crate::facts::callees_first;
use crate::typed::{TypedKind, Unit};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::rc::Rc;

/// Returns for each unit a number that is the same in two checks if the unit and all units that it calls, directly or
/// indirectly, are the same. It is 0 for units without a version and in recursions. `versions` are those of the units
/// themselves.
#[must_use]
pub fn versions_with_callees(units: &[Rc<Unit>], versions: &[u64]) -> Vec<u64> {
    if versions.is_empty() {
        return Vec::new();
    }
    let mut all = vec![0; units.len()];
    for at in callees_first(units) {
        all[at] = version_of(&units[at], versions[at], &all).unwrap_or(0);
    }
    all
}

fn version_of(unit: &Unit, version: u64, all: &[u64]) -> Option<u64> {
    let is_known = |version: &u64| *version != 0;
    let mut hasher = DefaultHasher::new();
    Some(version).filter(is_known)?.hash(&mut hasher);
    for expr in &unit.exprs {
        if let TypedKind::Call(call) = &expr.kind {
            let callee = all.get(call.unit.0 as usize).copied();
            callee.filter(is_known)?.hash(&mut hasher);
        }
    }
    Some(hasher.finish().max(1))
}
