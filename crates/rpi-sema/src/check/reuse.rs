//! Reuse of units of an earlier check: the effects of the check of each unit are recorded, and repeated when the unit is
//! reused.
//!
//! The check of a unit returns a typed unit and diagnostics. In addition, it creates the units that it calls, marks modules
//! as used, and counts towards limits of the whole program. Where the check has any other effect, such as a diagnostic about
//! another declaration, the unit is not reused.

use crate::check::Checker;
use crate::check::reused_unit::{has_callables, is_same_unit, with_ids};
use crate::check::signatures::header::{Header, check_header};
use crate::check::signatures::instance::instance_key;
use crate::check::signatures::unit;
use crate::check::signatures::units_on_demand::check_unit_now;
use crate::hash::FastSet;
use crate::program::{DeclId, ModuleId, Program, UsedModules};
use crate::reuse::{CalledInstance, Effect, ItemHash, StoredUnit, UnitMemo, words_of_statics};
use crate::typed::{TypedKind, Unit, UnitId, UnitKind};
use rpi_diag::{Code, Diagnostic, Severity, Span};
use rpi_syntax::Dialect;
use std::collections::BTreeMap;
use std::rc::Rc;

/// State of the reuse of units during a check.
pub(super) struct Reuse {
    pub(super) memo: UnitMemo,
    hashes: Rc<[ItemHash]>,
    /// Records of the units whose check is in progress. The check of each of them needs the next one.
    records: Vec<Record>,
    /// Version of each unit, indexed by unit; 0 for a unit without one.
    pub(super) versions: Vec<u64>,
    /// Whether units are checked whose results are discarded.
    is_suspended: bool,
    /// Whether a unit has been reused.
    pub(super) has_reused: bool,
    /// Whether the check of a unit or of ports has reported a diagnostic about another declaration, as the first one that
    /// needs it. Without that check, another one would report it.
    pub(super) is_tainted: bool,
}

/// Effects of the check of a unit so far.
struct Record {
    effects: Vec<Effect>,
    created: FastSet<UnitId>,
    /// Number of diagnostics of the checker when the check began.
    diagnostic_count: usize,
    expanded_size: usize,
    compared_names: usize,
    /// Shares of the units that were checked for this one.
    inner_size: usize,
    inner_names: usize,
    /// Number of diagnostics of the units that were checked for this one.
    inner_diagnostics: usize,
    /// Modules used before the check began.
    used_before: UsedModules,
    /// Whether the check depends on nothing but the declaration and its environment.
    is_reusable: bool,
    /// Whether an error had been reported before, if the check depends on that.
    follows_error: Option<bool>,
}

impl Reuse {
    pub(super) fn new(memo: UnitMemo, hashes: Rc<[ItemHash]>) -> Reuse {
        Reuse {
            memo,
            hashes,
            records: Vec::new(),
            versions: Vec::new(),
            is_suspended: false,
            has_reused: false,
            is_tainted: false,
        }
    }

    fn set_version(&mut self, id: UnitId, version: u64) {
        let at = id.0 as usize;
        if self.versions.len() <= at {
            self.versions.resize(at + 1, 0);
        }
        self.versions[at] = version;
    }
}

fn active<'c>(checker: &'c mut Checker<'_>) -> Option<&'c mut Reuse> {
    let reuse = checker.reuse.as_deref_mut();
    reuse.filter(|reuse| !reuse.is_suspended)
}

/// Begins or ends the check of units whose results are discarded. Returns whether such a check was in progress before.
pub(super) fn suspend(checker: &mut Checker<'_>, is_suspended: bool) -> bool {
    let Some(reuse) = checker.reuse.as_deref_mut() else {
        return false;
    };
    reuse.memo.forget_unit_ids();
    std::mem::replace(&mut reuse.is_suspended, is_suspended)
}

/// Records that the unit whose check is in progress calls the unit `id` at `span`.
pub(super) fn record_call(checker: &mut Checker<'_>, header: &Header, span: Span, id: UnitId) {
    let is_recorded = |reuse: &mut Reuse| {
        let record = reuse.records.last();
        record.is_some_and(|record| !record.created.contains(&id))
    };
    if !active(checker).is_some_and(is_recorded) {
        return;
    }
    let decl = checker.program.decl(header.decl);
    let called = CalledInstance {
        decl: header.decl,
        module: checker.program.module(decl.module).name.clone(),
        name: decl.name.clone(),
        statics: header.statics.clone(),
        span,
    };
    record_effect(checker, Effect::Instance(Rc::new(called), id));
}

/// Records an effect of the check of the unit whose check is in progress.
pub(super) fn record_effect(checker: &mut Checker<'_>, effect: Effect) {
    let Some(record) = active(checker).and_then(|reuse| reuse.records.last_mut()) else {
        return;
    };
    let is_new = match &effect {
        Effect::Instance(_, id) => record.created.insert(*id),
        Effect::CheckNow(_) => true,
    };
    if is_new {
        record.effects.push(effect);
    }
}

/// Records that a constant or type has reported diagnostics when it was first needed. If that was within the check of a unit
/// or of ports, the next check reuses nothing.
pub(super) fn taint(checker: &mut Checker<'_>) {
    let is_in_header = checker.limits.header_depth > 0;
    if let Some(reuse) = active(checker) {
        reuse.is_tainted |= is_in_header || !reuse.records.is_empty();
    }
}

/// Records that the unit whose check is in progress must be checked again in each check.
pub(super) fn forbid_reuse(checker: &mut Checker<'_>) {
    if let Some(record) = active(checker).and_then(|reuse| reuse.records.last_mut()) {
        record.is_reusable = false;
    }
}

/// Records that the check of a unit depends on whether an error was reported before.
pub(super) fn record_error_dependence(checker: &mut Checker<'_>, follows_error: bool) {
    if let Some(record) = active(checker).and_then(|reuse| reuse.records.last_mut()) {
        record.follows_error = Some(follows_error);
    }
}

/// Returns whether an error has been reported so far that suppresses the inference of types of `none`.
pub(super) fn has_error(diagnostics: &[Diagnostic]) -> bool {
    let mut errors = diagnostics
        .iter()
        .filter(|one| one.severity() == Severity::Error);
    errors.any(|error| error.code != Code::RPI2007)
}

/// Records that the body of a unit, and of all units that it calls, is evaluated for a constant.
pub(super) fn record_evaluated(checker: &mut Checker<'_>, id: UnitId) {
    let mut open = vec![id];
    while let Some(id) = open.pop() {
        let decl = checker.instances.entries[id.0 as usize].header.decl;
        let name = checker.program.decl(decl).name.clone();
        let Some(reuse) = checker.reuse.as_deref_mut() else {
            return;
        };
        if reuse.memo.record_evaluated(&name, id) {
            open.extend(called_units(&checker.units[id.0 as usize]));
        }
    }
}

fn called_units(unit: &Unit) -> impl Iterator<Item = UnitId> + '_ {
    unit.exprs.iter().filter_map(|expr| match &expr.kind {
        TypedKind::Call(call) => Some(call.unit),
        _ => None,
    })
}

/// Returns the key of a unit: module, name and static arguments. Declarations with the same name share a key.
fn unit_key(checker: &Checker<'_>, header: &Header) -> String {
    let decl = checker.program.decl(header.decl);
    let module = &checker.program.module(decl.module).name;
    match header.statics.is_empty() {
        true => format!("{module}::{}", decl.name),
        false => {
            let key = instance_key(header.decl, &header.statics);
            let statics = key.split_once(';').map_or("", |(_, statics)| statics);
            format!("{module}::{};{statics}", decl.name)
        }
    }
}

/// Completes a unit with the result of an earlier check. Returns false if there is no valid one.
pub(super) fn reuse_unit(checker: &mut Checker<'_>, id: UnitId) -> bool {
    let header = checker.instances.entries[id.0 as usize].header.clone();
    if active(checker).is_none() || header.kind == UnitKind::Task {
        return false;
    }
    let key = unit_key(checker, &header);
    let follows_error = has_error(&checker.diagnostics);
    let item = checker.program.decl(header.decl).item as usize;
    let Some(reuse) = active(checker) else {
        return false;
    };
    let hashes = reuse.hashes.clone();
    let Some(known) = hashes
        .get(item)
        .and_then(|item| reuse.memo.find(&key, item))
    else {
        return false;
    };
    if known
        .follows_error
        .is_some_and(|before| before != follows_error)
    {
        return false;
    }
    let known = known.clone();
    let has_same_ids = reuse.memo.has_same_ids();
    let Some(decls) = called_declarations(checker.program, &known.effects, has_same_ids) else {
        return false;
    };
    let Some(reuse) = active(checker) else {
        return false;
    };
    reuse.has_reused = true;
    reuse.set_version(id, known.version);
    let names = checker.suggestion_budget.get();
    let names = names.saturating_sub(known.compared_names);
    checker.suggestion_budget.set(names);
    checker.limits.expanded_size += known.expanded_size;
    checker.program.add_used_modules(&known.used_modules);
    let (effects, ids) = repeat_effects(checker, &known.effects, &decls);
    checker
        .diagnostics
        .extend(known.diagnostics.iter().cloned());
    if let Some(outer) = active(checker).and_then(|reuse| reuse.records.last_mut()) {
        outer.inner_diagnostics += known.diagnostics.len();
    }
    let is_same = has_same_ids && ids.iter().all(|(old, new)| old == new);
    let unit = match is_same {
        true => known.unit.clone(),
        false => Rc::new(with_ids(&known.unit, &ids)),
    };
    checker.units[id.0 as usize] = unit.clone();
    if !is_same && let Some(reuse) = active(checker) {
        reuse.memo.replace(&key, unit, effects);
    }
    true
}

/// Returns the declarations that a unit calls. If declarations have got other identifiers, they are looked up by their
/// names. `None` if one is not found.
fn called_declarations(
    program: &Program<'_>,
    effects: &[Effect],
    has_same_ids: bool,
) -> Option<Vec<DeclId>> {
    let called = effects.iter().filter_map(|effect| match effect {
        Effect::Instance(called, _) => Some(called),
        Effect::CheckNow(_) => None,
    });
    let find = |called: &Rc<CalledInstance>| {
        if has_same_ids {
            return Some(called.decl);
        }
        let modules = (0..).map(ModuleId).zip(&program.modules);
        let mut named = modules.filter(|(_, module)| module.name == called.module);
        let (module, found) = named.next()?;
        let is_rpi = found.mode == Dialect::Rpi;
        program.lookup_own(module, &called.name).filter(|_| is_rpi)
    };
    called.map(find).collect()
}

/// Creates and checks other units in the order in which the check of a unit has done so. `decls` are the declarations that
/// it calls. Returns the effects with the identifiers of now, and the identifiers of the created units then and now.
fn repeat_effects(
    checker: &mut Checker<'_>,
    effects: &[Effect],
    decls: &[DeclId],
) -> (Vec<Effect>, BTreeMap<UnitId, UnitId>) {
    let (mut ids, mut repeated, mut decls) = (BTreeMap::new(), Vec::new(), decls.iter());
    // The effects belong to the reused unit, not to one around it.
    begin_record(checker);
    for effect in effects {
        match effect {
            Effect::Instance(called, old) => {
                let decl = decls.next().copied().unwrap_or(called.decl);
                let header = check_header(checker, decl, called.statics.clone());
                let new =
                    header.and_then(|header| unit::instantiate(checker, &header, called.span));
                ids.extend(new.map(|new| (*old, new)));
            }
            Effect::CheckNow(old) => {
                let new = ids.get(old).copied();
                new.into_iter().for_each(|new| check_unit_now(checker, new));
            }
        }
    }
    if let Some((record, _)) = end_record(checker) {
        let foreign =
            checker.diagnostics.len() - record.diagnostic_count - record.inner_diagnostics;
        repeated = record.effects;
        if let Some(reuse) = active(checker) {
            reuse.is_tainted |= foreign > 0;
            if let Some(outer) = reuse.records.last_mut() {
                outer.inner_diagnostics += record.inner_diagnostics;
            }
        }
    }
    (repeated, ids)
}

/// Begins to record the check of a unit.
pub(super) fn begin_record(checker: &mut Checker<'_>) {
    let record = Record {
        effects: Vec::new(),
        created: FastSet::default(),
        diagnostic_count: checker.diagnostics.len(),
        expanded_size: checker.limits.expanded_size,
        compared_names: checker.suggestion_budget.get(),
        inner_size: 0,
        inner_names: 0,
        inner_diagnostics: 0,
        used_before: UsedModules::default(),
        is_reusable: true,
        follows_error: None,
    };
    let program = checker.program;
    if let Some(reuse) = active(checker) {
        let used_before = program.take_used_modules();
        reuse.records.push(Record {
            used_before,
            ..record
        });
    }
}

/// Ends the record of the check of a unit and returns it, with the modules that the check has used.
fn end_record(checker: &mut Checker<'_>) -> Option<(Record, UsedModules)> {
    let (size, names) = (
        checker.limits.expanded_size,
        checker.suggestion_budget.get(),
    );
    let program = checker.program;
    let reuse = active(checker)?;
    let mut record = reuse.records.pop()?;
    let used = program.take_used_modules();
    program.add_used_modules(&record.used_before);
    program.add_used_modules(&used);
    let total = size.saturating_sub(record.expanded_size);
    let compared = record.compared_names.saturating_sub(names);
    if let Some(outer) = reuse.records.last_mut() {
        outer.inner_size += total;
        outer.inner_names += compared;
    }
    record.expanded_size = total.saturating_sub(record.inner_size);
    record.compared_names = compared.saturating_sub(record.inner_names);
    Some((record, used))
}

/// Ends the record of the check of the unit `id`, and stores the result for the next check. The last `own` diagnostics are
/// those of the unit itself.
pub(super) fn store_unit(checker: &mut Checker<'_>, id: UnitId, own: usize) {
    let Some((record, used_modules)) = end_record(checker) else {
        return;
    };
    let header = checker.instances.entries[id.0 as usize].header.clone();
    let key = unit_key(checker, &header);
    let unit = checker.units[id.0 as usize].clone();
    let others = checker.diagnostics.len() - own;
    let foreign = others - record.diagnostic_count - record.inner_diagnostics;
    let is_reusable = record.is_reusable
        && foreign == 0
        && header.kind != UnitKind::Task
        && !used_modules.has_ambiguous_names();
    let diagnostics = checker.diagnostics[others..].to_vec();
    let item = checker.program.decl(header.decl).item as usize;
    let Some(reuse) = active(checker) else {
        return;
    };
    reuse.is_tainted |= foreign > 0;
    if let Some(outer) = reuse.records.last_mut() {
        outer.inner_diagnostics += own + record.inner_diagnostics;
    }
    let declaration = reuse.hashes.get(item).map(|hash| hash.whole);
    let last = reuse.memo.last(&key);
    let same = last.filter(|last| is_same_unit(last, &unit, &record.effects));
    let version = match same.map(|same| same.version) {
        Some(version) => version,
        None => reuse.memo.new_version(),
    };
    reuse.set_version(id, version);
    let known = StoredUnit {
        unit,
        version,
        declaration: declaration.filter(|_| is_reusable),
        static_words: match header.statics.is_empty() {
            true => Rc::new([]),
            false => words_of_statics(&header.statics),
        },
        has_callable_statics: has_callables(&header.statics, &record.effects),
        diagnostics,
        effects: record.effects,
        used_modules,
        expanded_size: record.expanded_size,
        compared_names: record.compared_names,
        follows_error: record.follows_error,
        ..StoredUnit::default()
    };
    reuse.memo.insert(key, known);
}
