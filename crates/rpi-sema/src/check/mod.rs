//! From the syntax tree to the typed program.
//!
//! A [`Unit`] is checked once for each choice of static arguments with which it is called. Types are found bottom up;
//! a local flow without declared type has that of its equation, whatever the order of the text. Everything is checked
//! although parts are faulty: what a fault leaves open is [`Ty::Unknown`], which fits everything, so that one fault
//! gives one message.
//!
//! | file | idea |
//! |---|---|
//! | `unit.rs`, `header.rs`, `alias.rs`, `statics.rs`, `instance.rs`, `sizes.rs` | callables, their ports and static arguments |
//! | `assumptions.rs` | what contracts assume, and which they take up |
//! | `types.rs`, `device.rs`, `consts.rs` | types and constants |
//! | `body.rs`, `locals.rs`, `order.rs`, `untold.rs`, `nothing.rs`, `sums.rs`, `statement.rs`, `contract.rs`, `targets.rs`, `spread.rs`, `definitions.rs`, `automaton.rs` | bodies, their flows and equations |
//! | `blocks.rs`, `elements.rs` | blocks of equations, and arrays that are defined element by element |
//! | `constraint.rs`, `generic.rs` | constraints of type parameters, and generic bodies, checked for all types that these admit |
//! | `sample.rs` | what needs arguments that nobody gives, checked all the same |
//! | `bound.rs`, `quantifier.rs`, `data.rs` | names that expressions bring in: quantifiers, conditions of types, alternatives |
//! | `expr.rs`, `names.rs`, `ops.rs`, `guess.rs`, `apart.rs`, `bracketed.rs`, `access.rs`, `compose.rs`, `update.rs`, `clocked.rs`, `case.rs` | expressions |
//! | `time.rs`, `infer_times.rs` | exact time |
//! | `machine.rs` | machine integers of Kind 2 |
//! | `call.rs`, `callable.rs`, `args.rs`, `applied.rs`, `prim.rs`, `predef.rs`, `special.rs`, `spatial.rs`, `parts.rs`, `iterate.rs`, `condact.rs`, `meant.rs`, `misread.rs` | calls |
//! | `task.rs` | tasks: steps, branches, results |
//! | `nesting.rs`, `recursion.rs` | how deep declarations may need one another, and calls without end |
//! | `dialect.rs` | where other compilers for Lustre read something else |
//! | `report.rs`, `quantity.rs`, `frames.rs`, `unknown.rs`, `foreign.rs` | words that several of them use: of types, of units, of frames, of names |
//! | `words.rs` | names that are there without a declaration, for others |

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
    /// All units that are called from somewhere or can be run.
    pub units: Vec<Unit>,
    /// The unit of each declaration that needs no static arguments, in the order of the declarations.
    pub runnable: Vec<(DeclId, UnitId)>,
    /// What was found.
    pub findings: Vec<Finding>,
    constants: BTreeMap<DeclId, Constant>,
}

impl Checked {
    /// What a parameter of a command or task is when that is run by itself: a device of the same name, the constant of
    /// the same name that the first module declares, or its default.
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

    /// The unit of this index.
    #[must_use]
    pub fn unit(&self, id: UnitId) -> &Unit {
        &self.units[id.0 as usize]
    }
}

/// Checks a program: the whole of its first module, and of the others what that one uses.
#[must_use]
pub fn check(program: &Program<'_>) -> Checked {
    let mut checker = Checker::new(program);
    let mut runnable = Vec::new();
    checker.check_generics();
    for id in &program.root().decls {
        runnable.extend(checker.declaration(*id).map(|unit| (*id, unit)));
    }
    checker.frames_are_placed();
    checker.check_queued();
    checker.check_samples();
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

/// What is defined outside keeps a program from running here, and is no fault of it: that is said if nothing else is wrong.
fn only_what_is_wrong(findings: &mut Vec<Finding>) {
    let is_outside = |finding: &Finding| matches!(finding.code, Code::RPI0017 | Code::RPI1012);
    let is_fault =
        |finding: &Finding| finding.severity() == Severity::Error && !is_outside(finding);
    if findings.iter().any(is_fault) {
        findings.retain(|finding| !is_outside(finding));
    }
    // Once for each construct.
    let mut said = BTreeSet::new();
    findings.retain(|f| f.code != Code::RPI0017 || said.insert(f.message.clone()));
}

/// A constant: its type and its leaves.
#[derive(Clone, Debug)]
pub(crate) struct Constant {
    pub(crate) ty: Ty,
    pub(crate) leaves: Rc<[Leaf]>,
}

/// Something that is worked out once, when it is first needed.
#[derive(Clone, Debug)]
enum Lazy<T> {
    /// Being worked out: needed again meanwhile, it needs itself.
    Busy,
    /// Known; none after a fault.
    Done(Option<T>),
}

/// What is known of a program while it is checked.
struct Checker<'a> {
    program: &'a Program<'a>,
    /// The units; empty until they are checked.
    units: Vec<Unit>,
    entries: Vec<unit::Entry>,
    too_many_units: bool,
    /// What has been told of instances, by what they are instances of.
    told_of_instances: BTreeSet<(DeclId, Code, Span)>,
    /// Generic declarations with a fault that has been reported: none of their instances is reported as well.
    faulty_generics: Set<DeclId>,
    /// Expressions and flows of the units that have been checked.
    written_out: usize,
    /// How many there may be.
    most: usize,
    /// How many instances lie around the unit that is being checked, each made by the one before.
    depth: u32,
    unit_ids: Map<String, UnitId>,
    /// The declarations that have a unit.
    called: Set<DeclId>,
    queue: VecDeque<UnitId>,
    constants: Map<DeclId, Lazy<Constant>>,
    types: Map<String, Lazy<Ty>>,
    headers: Map<String, Option<Rc<Header>>>,
    findings: Vec<Finding>,
    /// The constants and types that are being worked out, each for the sake of the one before.
    open: Vec<DeclId>,
    /// How many expressions and declarations are being checked, each for the sake of the one before.
    nesting: u32,
    /// Callables whose ports are just being found.
    headers_open: u32,
    /// What tasks do with devices.
    task_uses: Map<DeclId, Rc<task::Uses>>,
    too_deep: bool,
    /// The other names for callables that are being looked up, each for the sake of the one before.
    aliases: Vec<DeclId>,
    /// Those that stand for themselves.
    ringed: BTreeSet<DeclId>,
    /// How many names may still be looked at for "did you mean".
    patience: Cell<usize>,
    /// Constants that need others without a value, and what is to be said of that.
    outside: BTreeMap<DeclId, Finding>,
    /// Types whose conditions are about earlier cycles.
    temporal: BTreeSet<DeclId>,
}

/// Names that are looked at for "did you mean", all findings of a program together: whoever has very many wrong names
/// gets to know of the first ones what was meant.
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

    /// The nearest of these names, if one is near enough to be meant.
    fn suggest<'n>(&self, name: &str, names: impl Iterator<Item = &'n str>) -> Option<String> {
        let names = names.take(self.patience.get());
        let names = names.inspect(|_| self.patience.set(self.patience.get().saturating_sub(1)));
        rpi_diag::suggest(name, names)
    }

    /// Checks a declaration of the first module by itself; a callable that needs no static arguments gives a unit.
    fn declaration(&mut self, id: DeclId) -> Option<UnitId> {
        match self.program.decl(id).kind {
            DeclKind::Const(_) if self.is_lustre(id) => self.constant_alone(id),
            DeclKind::Const(_) | DeclKind::Frame(_) => {
                self.constant(id);
            }
            DeclKind::Type(_) | DeclKind::Device(_) => {
                self.type_alone(id);
            }
            DeclKind::Node(_)
            | DeclKind::Fragment(_)
            | DeclKind::Primitive(_)
            | DeclKind::Command(_)
            | DeclKind::Task(_)
            | DeclKind::Test(_) => return self.unit_alone(id),
            DeclKind::EnumValue { .. } | DeclKind::Constructor { .. } | DeclKind::Broken(_) => {}
        }
        None
    }
}
