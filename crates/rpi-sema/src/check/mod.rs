//! Type checker: from the syntax tree to the typed program.
//!
//! A [`Unit`] is checked once for each choice of static arguments with which it is called. Types are inferred bottom
//! up; a local flow without a declared type gets the type of its equation, in any order of the text. Checking continues
//! after an error: the type of a faulty expression is [`Ty::Unknown`], which is compatible with every type, so that one
//! error gives one diagnostic.
//!
//! | folder | idea |
//! |---|---|
//! | `signatures` | callables, their ports and static parameters; instances; generic declarations and their constraints |
//! | `types` | type expressions, constants, data types, devices, units, frames, subranges, exact time |
//! | `bodies` | bodies, their flows and equations; type inference; automata; contracts |
//! | `exprs` | expressions |
//! | `calls` | calls, arguments, primitives, iterators |
//! | `task` | tasks: steps, branches, results, handover of values |
//! | `limits` | limits on nesting and size, and infinite recursion |
//! | `diagnostics` | diagnostics and wordings that several folders share |
//!
//! The functions of these modules take the checker ([`Checker`]: declarations, units, instances) or the body that is
//! checked ([`bodies::body::Body`]) as their first argument.

mod bodies;
mod calls;
mod diagnostics;
mod exprs;
mod limits;
mod reuse;
mod reused_unit;
mod signatures;
mod task;
mod types;

use crate::check::reuse::Reuse;
use crate::check::signatures::header::Header;
pub(crate) use crate::check::signatures::static_args::StaticBindings;
use crate::check::types::type_decls;
use crate::elab::Argument;
use crate::facts::Facts;
use crate::hash::{FastMap, FastSet};
use crate::program::{DeclId, DeclKind, Program};
use crate::reuse::{ItemHash, UnitMemo};
use crate::ty::Substitution;
use crate::ty::Ty;
use crate::ty::check_assignable;
use crate::ty::machine_types::external_type;
use crate::typed::{Flow, Leaf, Unit, UnitId};
use rpi_diag::suppression::{self, Cause, suppress};
use rpi_diag::{Code, Diagnostic, Span};
use std::cell::Cell;
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::rc::Rc;

pub use crate::check::diagnostics::undefined_names::file_not_found;
pub(crate) use crate::check::diagnostics::undefined_names::module_not_found;
#[cfg(test)]
pub(crate) use crate::check::exprs::builtins::intrinsic_names;
pub(crate) use crate::check::exprs::builtins::{resolve_predeclared, spatial_parts};
pub use crate::check::exprs::names::result_identity;
pub(crate) use crate::check::signatures::constraint::constraints;
pub(crate) use crate::check::signatures::static_params::{static_params, static_params_of};

/// Program after checking: its typed units, constants and diagnostics.
#[derive(Debug)]
pub struct CheckedProgram {
    /// Units of all declarations that are called or can be run: one for each choice of static arguments.
    pub units: Vec<Rc<Unit>>,
    /// Declarations of the first module that need no static arguments, each with its unit, in declaration order.
    pub runnable: Vec<(DeclId, UnitId)>,
    /// All diagnostics of the program.
    pub diagnostics: Vec<Diagnostic>,
    /// For each unit, a number that is the same in the next check if the unit is the same; 0 for a unit without one. Empty
    /// unless units are reused.
    pub versions: Vec<u64>,
    /// For each unit, the facts about its flows, if they have been computed. Empty before the analysis.
    pub facts: Vec<Option<Rc<Facts>>>,
    /// Values of the constants of the first module, by declaration.
    constants: BTreeMap<DeclId, Constant>,
}

impl CheckedProgram {
    /// Returns the value of a parameter of a command or task that is started directly. It is the device of the same
    /// name, the constant of the same name in the first module, or the default; otherwise it is unknown.
    #[must_use]
    pub fn root_argument(&self, program: &Program<'_>, param: &Flow) -> Argument {
        if let Ty::Device(_) = param.ty {
            return Argument::Value(vec![Leaf::Str(param.name.to_string())]);
        }
        let fits = |constant: &&Constant| {
            check_assignable(
                &external_type(&param.ty).0,
                &external_type(&constant.ty).0,
                &mut Substitution::default(),
            )
            .is_ok()
        };
        let mut named = program.root().decls.iter();
        let found = named.find(|id| program.decl(**id).name == param.name);
        let constant = found.and_then(|id| self.constants.get(id)).filter(fits);
        match (constant, param.default) {
            (Some(constant), _) => Argument::Value(constant.leaves.to_vec()),
            (None, Some(_)) => Argument::Default,
            (None, None) => Argument::Unknown,
        }
    }

    /// Returns the unit with this identifier.
    #[must_use]
    pub fn unit(&self, id: UnitId) -> &Unit {
        &self.units[id.0 as usize]
    }
}

/// Checks a program: all declarations of its first module, and those of other modules that they use.
#[must_use]
pub fn check(program: &Program<'_>) -> CheckedProgram {
    let mut checker = Checker::new(program);
    let runnable = check_all(&mut checker);
    finish(checker, runnable)
}

/// Checks a program like [`check`], and reuses the units of the last check with the same `memo` as far as they are valid.
/// `hashes` are those of all declarations, in the order of [`Program::extents`].
#[must_use]
pub fn check_reusing(
    program: &Program<'_>,
    memo: &mut UnitMemo,
    hashes: Rc<[ItemHash]>,
) -> CheckedProgram {
    let mut checker = Checker::new(program);
    memo.begin(program, &hashes);
    checker.reuse = Some(Box::new(Reuse::new(std::mem::take(memo), hashes.clone())));
    let runnable = check_all(&mut checker);
    let limit_is_reached = checker.has_reached_limit();
    let Some(reuse) = checker.reuse.take() else {
        return finish(checker, runnable);
    };
    *memo = reuse.memo;
    if limit_is_reached {
        memo.clear();
        // Which declaration exceeds a limit depends on the order in which all units are checked.
        if reuse.has_reused {
            return check(program);
        }
    }
    memo.end(program, &hashes, !reuse.is_tainted && !limit_is_reached);
    let mut versions = reuse.versions;
    versions.resize(checker.units.len(), 0);
    CheckedProgram {
        versions,
        ..finish(checker, runnable)
    }
}

/// Checks all declarations of the first module. Returns those that need no static arguments, with their units.
fn check_all(checker: &mut Checker<'_>) -> Vec<(DeclId, UnitId)> {
    let program = checker.program;
    let mut runnable = Vec::new();
    crate::check::signatures::generic::check_generics(checker);
    for id in &program.root().decls {
        runnable.extend(checker.check_declaration(*id).map(|unit| (*id, unit)));
    }
    crate::check::types::frame_placement::check_frame_placement(checker);
    crate::check::signatures::unit::check_queued(checker);
    crate::check::signatures::sample_check::check_samples(checker);
    runnable
}

/// Adds the diagnostics about the program as a whole, and removes those that follow from others.
fn finish(mut checker: Checker<'_>, runnable: Vec<(DeclId, UnitId)>) -> CheckedProgram {
    let program = checker.program;
    checker.diagnostics.extend(program.ambiguous_name_errors());
    checker
        .diagnostics
        .extend(crate::check::limits::recursion::check(&checker.units));
    checker
        .diagnostics
        .extend(crate::check::diagnostics::dialect::check(&checker.units));
    suppression::remove_repeated_fixes(&mut checker.diagnostics);
    if !checker.valueless_constants.is_empty() {
        suppress(&mut checker.diagnostics, Cause::SampleValue);
    }
    suppression::suppress_external(&mut checker.diagnostics);
    suppression::merge_by_subject(&mut checker.diagnostics);
    let root = program
        .root()
        .decls
        .iter()
        .filter_map(|id| match checker.constants.get(id) {
            Some(Lazy::Done(Some(constant))) => Some((*id, constant.clone())),
            _ => None,
        });
    CheckedProgram {
        constants: root.collect(),
        units: checker.units,
        runnable,
        diagnostics: checker.diagnostics,
        versions: Vec::new(),
        facts: Vec::new(),
    }
}

/// Value of a constant: its type and the values of its leaves (scalar parts).
#[derive(Clone, Debug)]
pub(crate) struct Constant {
    pub(crate) ty: Ty,
    pub(crate) leaves: Rc<[Leaf]>,
}

/// Result of a computation that runs at most once, when it is first needed.
#[derive(Clone, Debug)]
enum Lazy<T> {
    /// The computation has begun. Another request for its result in the meantime is a dependency cycle.
    InProgress,
    /// The computation has finished with this result; `None` after an error.
    Done(Option<T>),
}

/// State of the check of a whole program: the units created so far, cached results, and limits.
struct Checker<'a> {
    program: &'a Program<'a>,
    /// Typed units by index. A unit is empty until it is checked.
    units: Vec<Rc<Unit>>,
    /// Units that have been created for declarations, and those that are still to be checked.
    instances: Instances,
    /// Size of the program so far, and its limits.
    limits: Limits,
    constants: FastMap<DeclId, Lazy<Constant>>,
    types: FastMap<String, Lazy<Ty>>,
    headers: FastMap<String, Option<Rc<Header>>>,
    diagnostics: Vec<Diagnostic>,
    /// Constants and types whose check is in progress. Each of them needs the next one.
    in_progress: Vec<DeclId>,
    /// For each task that has been analysed, the devices that it drives.
    task_uses: FastMap<DeclId, Rc<task::DeviceUses>>,
    /// Aliases of callables that are being resolved. Each of them refers to the next one.
    aliases: Vec<DeclId>,
    /// Aliases that are defined by themselves, directly or through other aliases.
    cyclic_aliases: BTreeSet<DeclId>,
    /// Number of names that may still be compared for the help text "did you mean".
    suggestion_budget: Cell<usize>,
    /// Constants whose values depend on constants that are declared without a value, with the diagnostic for using
    /// them.
    valueless_constants: BTreeMap<DeclId, Diagnostic>,
    /// Types that are declared with conditions that refer to earlier cycles, as by `pre`.
    temporal_types: BTreeSet<DeclId>,
    /// Units of an earlier check that may be reused; `None` if there are none.
    reuse: Option<Box<Reuse>>,
}

/// Instances of declarations: one unit for each declaration and choice of static arguments.
#[derive(Default)]
struct Instances {
    /// For each unit, its ports and the progress of its check, indexed by unit.
    entries: Vec<crate::check::signatures::unit::UnitEntry>,
    /// For each instance, its unit. The key is a text that is made of the declaration and its static arguments.
    ids: FastMap<String, UnitId>,
    /// Declarations with at least one unit.
    called: FastSet<DeclId>,
    /// Units whose check has not begun, in the order in which they are to be checked.
    queue: VecDeque<UnitId>,
    /// Nesting of the unit that is being checked: number of instances with static arguments of which each was created
    /// by the check of the previous one.
    depth: u32,
    /// Errors already reported in instances of generic declarations, so that each is reported for one instance only:
    /// the declaration, the code and the location.
    reported: BTreeSet<(DeclId, Code, Span)>,
    /// Generic declarations in which an error has been reported. No errors are reported in their instances.
    erroneous_generics: FastSet<DeclId>,
}

/// Size and nesting of the program so far, and their limits.
struct Limits {
    /// Number of expressions and flows of all checked units, plus a share for the values of constants.
    expanded_size: usize,
    /// Upper limit of `expanded_size`, at which an error is reported.
    max_expanded_size: usize,
    /// Whether an error about too many instances or too many expressions has been reported, which happens only once.
    size_reported: bool,
    /// Number of nested expressions and declarations whose check is in progress. Each of them needs the next one.
    nesting: u32,
    /// Number of callables whose ports are being resolved. Each of them needs the next one.
    header_depth: u32,
    /// Whether the diagnostic about too deeply nested declarations has been reported.
    nesting_reported: bool,
}

/// Number of names compared for the help text "did you mean" in one program. It limits the time for programs with very
/// many undefined names, of which only the first get a suggestion.
const SUGGESTION_BUDGET: usize = 200_000;

impl<'a> Checker<'a> {
    fn new(program: &'a Program<'a>) -> Self {
        Checker {
            program,
            units: Vec::new(),
            instances: Instances::default(),
            limits: Limits {
                expanded_size: 0,
                max_expanded_size: limits::nesting::max_expanded_size(program),
                size_reported: false,
                nesting: 0,
                header_depth: 0,
                nesting_reported: false,
            },
            constants: FastMap::default(),
            types: FastMap::default(),
            headers: FastMap::default(),
            diagnostics: Vec::new(),
            in_progress: Vec::new(),
            task_uses: FastMap::default(),
            aliases: Vec::new(),
            cyclic_aliases: BTreeSet::new(),
            suggestion_budget: Cell::new(SUGGESTION_BUDGET),
            valueless_constants: BTreeMap::new(),
            temporal_types: BTreeSet::new(),
            reuse: None,
        }
    }

    /// Returns whether the result depends on a limit of the whole program, or on the order in which the units are checked.
    fn has_reached_limit(&self) -> bool {
        self.limits.size_reported
            || self.limits.nesting_reported
            || self.suggestion_budget.get() == 0
            || !self.valueless_constants.is_empty()
            || !self.cyclic_aliases.is_empty()
    }

    pub(crate) fn is_lustre(&self, id: DeclId) -> bool {
        self.program.decl(id).mode == rpi_syntax::Dialect::Lustre
    }

    /// Returns the name that is most similar to `name`; `None` if none is similar enough for a suggestion.
    fn suggest<'n>(&self, name: &str, names: impl Iterator<Item = &'n str>) -> Option<String> {
        let names = names.take(self.suggestion_budget.get());
        let names = names.inspect(|_| {
            self.suggestion_budget
                .set(self.suggestion_budget.get().saturating_sub(1))
        });
        rpi_diag::suggest(name, names)
    }

    /// Checks a declaration of the first module on its own. Returns the unit of a callable that needs no static
    /// arguments; `None` for other declarations.
    fn check_declaration(&mut self, id: DeclId) -> Option<UnitId> {
        match self.program.decl(id).kind {
            DeclKind::Const(_) if self.is_lustre(id) => {
                crate::check::types::consts::check_lustre_constant(self, id)
            }
            DeclKind::Const(_) | DeclKind::Frame(_) => {
                crate::check::types::consts::check_constant(self, id);
            }
            DeclKind::Type(_) | DeclKind::Device(_) => {
                type_decls::check_type(self, id);
            }
            DeclKind::Node(_)
            | DeclKind::Fragment(_)
            | DeclKind::Primitive(_)
            | DeclKind::Command(_)
            | DeclKind::Task(_)
            | DeclKind::Test(_) => return crate::check::signatures::unit::root_unit(self, id),
            DeclKind::EnumValue { .. } | DeclKind::Constructor { .. } | DeclKind::Broken(_) => {}
        }
        None
    }
}
