//! Type checker: from the syntax tree to the typed program.
//!
//! A [`Unit`] is checked once for each choice of static arguments with which it is called. Types are inferred bottom
//! up; a local flow without a declared type gets the type of its equation, in any order of the text. Checking continues
//! after an error: the type of a faulty expression is [`Ty::Unknown`], which is compatible with every type, so that one
//! error gives one diagnostic.
//!
//! | file | idea |
//! |---|---|
//! | `unit.rs`, `header.rs`, `alias.rs`, `statics.rs`, `instance.rs`, `sizes.rs` | callables, their ports and static arguments |
//! | `assumptions.rs` | assumptions of contracts, and of the contracts that they import |
//! | `types.rs`, `device.rs`, `consts.rs` | types and constants |
//! | `body.rs`, `locals.rs`, `order.rs`, `untold.rs`, `nothing.rs`, `sums.rs`, `statement.rs`, `contract.rs`, `targets.rs`, `spread.rs`, `definitions.rs`, `automaton.rs` | bodies, their flows and equations |
//! | `blocks.rs`, `elements.rs` | blocks of equations, and arrays that are defined element by element |
//! | `constraint.rs`, `generic.rs` | constraints of type parameters; generic bodies, checked for all types that satisfy them |
//! | `sample.rs` | callables with static parameters that are never called, checked with sample arguments |
//! | `bound.rs`, `quantifier.rs`, `data.rs` | names that expressions bind: quantifiers, conditions of types, alternatives |
//! | `expr.rs`, `names.rs`, `ops.rs`, `guess.rs`, `apart.rs`, `bracketed.rs`, `access.rs`, `compose.rs`, `update.rs`, `clocked.rs`, `case.rs` | expressions |
//! | `time.rs`, `infer_times.rs` | exact time |
//! | `machine.rs` | machine integers of Kind 2 |
//! | `call.rs`, `callable.rs`, `args.rs`, `applied.rs`, `prim.rs`, `predef.rs`, `special.rs`, `spatial.rs`, `parts.rs`, `iterate.rs`, `condact.rs`, `meant.rs`, `misread.rs` | calls |
//! | `task.rs` | tasks: steps, branches, results |
//! | `nesting.rs`, `recursion.rs` | limits on nesting and size, and infinite recursion |
//! | `dialect.rs` | text that other Lustre compilers read differently |
//! | `report.rs`, `quantity.rs`, `frames.rs`, `unknown.rs`, `foreign.rs` | shared diagnostics: types, units, frames, names |
//! | `words.rs` | predeclared names, for editors and documentation |

mod access;
mod alias;
mod apart;
mod applied;
mod args;
mod assumptions;
mod automaton;
mod blocks;
mod body;
mod bound;
mod bracketed;
mod call;
mod callable;
mod case;
mod clocked;
mod compose;
mod condact;
mod constraint;
mod consts;
mod contract;
mod data;
mod defaults;
mod definitions;
mod device;
mod dialect;
mod elements;
mod elsewhere;
mod expr;
mod foreign;
mod frames;
mod generic;
mod guess;
mod header;
mod imported;
mod infer_times;
mod instance;
mod iterate;
mod locals;
mod machine;
mod matching;
mod meant;
mod misread;
mod names;
mod nesting;
mod nothing;
mod ops;
mod order;
mod parts;
mod phrases;
mod placed;
mod predef;
mod prim;
mod quantifier;
mod quantity;
mod recursion;
mod reorder;
mod report;
mod sample;
mod sizes;
mod spatial;
mod special;
mod spread;
mod statement;
mod statics;
mod subrange;
mod sums;
mod targets;
mod task;
mod time;
mod told;
mod types;
mod unit;
mod unknown;
mod untold;
mod update;
mod valued;
mod words;

use crate::elab::Argument;
use crate::hash::{Map, Set};
use crate::program::{DeclId, DeclKind, Program};
use crate::ty::{Subst, Ty, fit};
use crate::typed::{Flow, Leaf, Unit, UnitId};
use header::Header;
use rpi_diag::{Code, Finding, Severity, Span};
use std::cell::Cell;
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::rc::Rc;

pub(crate) use constraint::constraints;
pub(crate) use names::predeclared_name;
pub use names::result_identity;
pub(crate) use prim::{machine_type, packed, param_default};
pub(crate) use statics::{params, params_of};
pub(crate) use subrange::outside;
pub(crate) use time::outside_type;
pub use unknown::no_file;
pub(crate) use unknown::no_module;
#[cfg(test)]
pub(crate) use words::operator_names;
pub(crate) use words::{predeclared, spatial_parts};

/// A checked program.
#[derive(Debug)]
pub struct Checked {
    /// All units that are called or can be run.
    pub units: Vec<Unit>,
    /// Unit of each declaration of the first module that needs no static arguments, in declaration order.
    pub runnable: Vec<(DeclId, UnitId)>,
    /// All diagnostics.
    pub findings: Vec<Finding>,
    /// Values of the constants of the first module.
    constants: BTreeMap<DeclId, Constant>,
}

impl Checked {
    /// Returns the value of a parameter of a command or task that is started directly: the device of the same name, the
    /// constant of the same name in the first module, or the default.
    #[must_use]
    pub fn argument(&self, program: &Program<'_>, param: &Flow) -> Argument {
        if let Ty::Device(_) = param.ty {
            return Argument::Value(vec![Leaf::Str(param.name.to_string())]);
        }
        let fits = |constant: &&Constant| {
            fit(
                &outside_type(&param.ty).0,
                &outside_type(&constant.ty).0,
                &mut Subst::default(),
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

    /// Returns the unit of an index.
    #[must_use]
    pub fn unit(&self, id: UnitId) -> &Unit {
        &self.units[id.0 as usize]
    }
}

/// Checks a program: all of its first module, and the declarations of other modules that it uses.
#[must_use]
pub fn check(program: &Program<'_>) -> Checked {
    let mut checker = Checker::new(program);
    let mut runnable = Vec::new();
    generic::check_generics(&mut checker);
    for id in &program.root().decls {
        runnable.extend(checker.declaration(*id).map(|unit| (*id, unit)));
    }
    placed::check_frame_placement(&mut checker);
    unit::check_queued(&mut checker);
    sample::check_samples(&mut checker);
    checker.findings.extend(program.clashes());
    checker.findings.extend(recursion::check(&checker.units));
    checker.findings.extend(dialect::check(&checker.units));
    unknown::once_for_each_fix(&mut checker.findings);
    unknown::once_for_each_name(&mut checker.findings);
    if !checker.outside.is_empty() {
        checker
            .findings
            .retain(|finding| !sample::may_be_its_fault(finding));
    }
    only_what_is_wrong(&mut checker.findings);
    let root = program
        .root()
        .decls
        .iter()
        .filter_map(|id| match checker.constants.get(id) {
            Some(Lazy::Done(Some(constant))) => Some((*id, constant.clone())),
            _ => None,
        });
    Checked {
        units: checker.units,
        runnable,
        findings: checker.findings,
        constants: root.collect(),
    }
}

/// Removes the diagnostics about external definitions if the program has other errors. They only keep the program from
/// running here.
fn only_what_is_wrong(findings: &mut Vec<Finding>) {
    let is_outside = |finding: &Finding| matches!(finding.code, Code::RPI0017 | Code::RPI1012);
    let is_fault =
        |finding: &Finding| finding.severity() == Severity::Error && !is_outside(finding);
    if findings.iter().any(is_fault) {
        findings.retain(|finding| !is_outside(finding));
    }
    // One diagnostic for each construct.
    let mut said = BTreeSet::new();
    findings.retain(|f| f.code != Code::RPI0017 || said.insert(f.message.clone()));
}

/// Value of a constant: its type and its leaves.
#[derive(Clone, Debug)]
pub(crate) struct Constant {
    pub(crate) ty: Ty,
    pub(crate) leaves: Rc<[Leaf]>,
}

/// Result of a computation that runs at most once, when it is first needed.
#[derive(Clone, Debug)]
enum Lazy<T> {
    /// In progress. Another request in the meantime is a dependency cycle.
    Busy,
    /// Finished; `None` after an error.
    Done(Option<T>),
}

/// State of checking a program.
struct Checker<'a> {
    program: &'a Program<'a>,
    /// Units by index; empty until they are checked.
    units: Vec<Unit>,
    /// Header and progress of each unit, by index.
    entries: Vec<unit::Entry>,
    /// Whether the diagnostic about too many instances or too many expressions has been reported.
    too_many_units: bool,
    /// Errors already reported in instances, by generic declaration, code and location.
    told_of_instances: BTreeSet<(DeclId, Code, Span)>,
    /// Generic declarations with a reported error. No errors are reported in their instances.
    faulty_generics: Set<DeclId>,
    /// Number of expressions and flows of all checked units, plus a share for the leaves of constants.
    written_out: usize,
    /// Upper limit of `written_out`.
    most: usize,
    /// Number of nested instances around the current unit: each is created while the previous one is checked.
    depth: u32,
    /// Units by the key of their instance: declaration and static arguments.
    unit_ids: Map<String, UnitId>,
    /// Declarations that have a unit.
    called: Set<DeclId>,
    /// Units that wait to be checked.
    queue: VecDeque<UnitId>,
    constants: Map<DeclId, Lazy<Constant>>,
    types: Map<String, Lazy<Ty>>,
    headers: Map<String, Option<Rc<Header>>>,
    findings: Vec<Finding>,
    /// Constants and types in progress, each needed by the previous one.
    open: Vec<DeclId>,
    /// Number of nested expressions and declarations in progress, each needed by the previous one.
    nesting: u32,
    /// Number of callables whose ports are being resolved.
    headers_open: u32,
    /// Devices that each task drives.
    task_uses: Map<DeclId, Rc<task::Uses>>,
    /// Whether the diagnostic about too deeply nested declarations has been reported.
    too_deep: bool,
    /// Aliases of callables being resolved, each needed by the previous one.
    aliases: Vec<DeclId>,
    /// Aliases with a dependency cycle.
    ringed: BTreeSet<DeclId>,
    /// Number of names that may still be compared for "did you mean".
    patience: Cell<usize>,
    /// Constants that depend on constants without a value, with the diagnostic for their use.
    outside: BTreeMap<DeclId, Finding>,
    /// Types whose conditions refer to earlier cycles.
    temporal: BTreeSet<DeclId>,
}

/// Number of names compared for "did you mean" in one program. With very many undefined names only the first ones get a
/// suggestion.
const PATIENCE: usize = 200_000;

impl<'a> Checker<'a> {
    fn new(program: &'a Program<'a>) -> Self {
        Checker {
            program,
            units: Vec::new(),
            entries: Vec::new(),
            too_many_units: false,
            told_of_instances: BTreeSet::new(),
            faulty_generics: Set::default(),
            written_out: 0,
            most: nesting::most(program),
            depth: 0,
            unit_ids: Map::default(),
            called: Set::default(),
            queue: VecDeque::new(),
            constants: Map::default(),
            types: Map::default(),
            headers: Map::default(),
            findings: Vec::new(),
            open: Vec::new(),
            nesting: 0,
            headers_open: 0,
            task_uses: Map::default(),
            too_deep: false,
            aliases: Vec::new(),
            ringed: BTreeSet::new(),
            patience: Cell::new(PATIENCE),
            outside: BTreeMap::new(),
            temporal: BTreeSet::new(),
        }
    }

    pub(super) fn is_lustre(&self, id: DeclId) -> bool {
        self.program.decl(id).mode == rpi_syntax::Mode::Lustre
    }

    /// Returns the most similar of these names, if it is similar enough for a suggestion.
    fn suggest<'n>(&self, name: &str, names: impl Iterator<Item = &'n str>) -> Option<String> {
        let names = names.take(self.patience.get());
        let names = names.inspect(|_| self.patience.set(self.patience.get().saturating_sub(1)));
        rpi_diag::suggest(name, names)
    }

    /// Checks a declaration of the first module on its own; returns the unit of a callable that needs no static
    /// arguments.
    fn declaration(&mut self, id: DeclId) -> Option<UnitId> {
        match self.program.decl(id).kind {
            DeclKind::Const(_) if self.is_lustre(id) => consts::check_lustre_constant(self, id),
            DeclKind::Const(_) | DeclKind::Frame(_) => {
                consts::check_constant(self, id);
            }
            DeclKind::Type(_) | DeclKind::Device(_) => {
                types::check_type(self, id);
            }
            DeclKind::Node(_)
            | DeclKind::Fragment(_)
            | DeclKind::Primitive(_)
            | DeclKind::Command(_)
            | DeclKind::Task(_)
            | DeclKind::Test(_) => return unit::root_unit(self, id),
            DeclKind::EnumValue { .. } | DeclKind::Constructor { .. } | DeclKind::Broken(_) => {}
        }
        None
    }
}
