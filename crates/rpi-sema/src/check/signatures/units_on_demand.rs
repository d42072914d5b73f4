//! Units that a constant needs are checked at once, before those that wait for their check.

use crate::check::Checker;
use crate::check::limits::nesting;
use crate::check::reuse;
use crate::check::signatures::unit::{Progress, check_unit};
use crate::reuse::Effect;
use crate::typed::{TypedKind, UnitId};
use std::collections::BTreeSet;

/// Checks a unit and all units that it calls, directly or indirectly, because their bodies decide a constant or a signature.
pub(crate) fn check_unit_now(checker: &mut Checker<'_>, id: UnitId) {
    check_for_task(checker, id);
    reuse::record_evaluated(checker, id);
}

/// Checks a unit and all units that it calls, directly or indirectly. A unit that has been checked may call others that still
/// wait for their check. Tasks read the bodies of the commands that they run; no other declaration depends on that.
pub(crate) fn check_for_task(checker: &mut Checker<'_>, id: UnitId) {
    reuse::record_effect(checker, Effect::CheckNow(id));
    let mut seen = BTreeSet::new();
    // An explicit stack, so that a long chain of calls costs no call stack.
    let mut open = vec![id];
    while let Some(id) = open.pop() {
        if state(checker, id) == Progress::Complete || !seen.insert(id) {
            continue;
        }
        if state(checker, id) == Progress::Queued {
            if !nesting::may_nest(checker, "call", checker.units[id.0 as usize].span) {
                return;
            }
            nesting::check_nested(checker, |c| check_unit(c, id));
        }
        open.extend(calls_of(checker, id));
    }
    // A unit whose check has begun may still get further calls.
    let is_done = |id: &UnitId| state(checker, *id) == Progress::Done;
    if seen.iter().all(is_done) {
        for id in seen {
            checker.instances.entries[id.0 as usize].state = Progress::Complete;
        }
    }
}

fn state(checker: &Checker<'_>, id: UnitId) -> Progress {
    checker.instances.entries[id.0 as usize].state
}

fn calls_of(checker: &Checker<'_>, id: UnitId) -> Vec<UnitId> {
    let exprs = &checker.units[id.0 as usize].exprs;
    let calls = exprs.iter().filter_map(|expr| match &expr.kind {
        TypedKind::Call(call) => Some(call.unit),
        _ => None,
    });
    calls.collect()
}
