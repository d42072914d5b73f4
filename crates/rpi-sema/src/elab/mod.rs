//! From typed units to a net.
//!
//! Calls are inlined, composite values exploded into one link per leaf, parameters folded; what a fragment in place
//! reads and gives becomes links across its border. A flow may be read before its equation has been reached: its reader
//! is connected to an alias, which is settled at the end, so that neither order nor length of a chain matters.
//!
//! The same walk works out constants: then nothing but folding is allowed, and flows are worked out on demand.
//!
//! | file | idea |
//! |---|---|
//! | `signal.rs` | what a leaf is connected to |
//! | `families.rs` | primitives that exist once per value type |
//! | `nodes.rs`, `pack.rs`, `promise.rs` | adding nodes, folding them; arrays at ports |
//! | `scope.rs`, `slots.rs`, `flows.rs` | one inlined unit and its flows |
//! | `expr.rs`, `each.rs`, `guarded.rs`, `needed.rs`, `call.rs`, `time.rs` | expressions |
//! | `block.rs`, `claims.rs`, `automaton.rs`, `clocks.rs`, `leaving.rs`, `entering.rs` | bodies, fragments, states, sampled flows |
//! | `subrange.rs` | checks of what is declared as a subrange |
//! | `device.rs`, `root.rs`, `settle.rs` | devices, commands and nodes that are run, the end |

mod allowance;
mod automaton;
mod block;
mod call;
mod claims;
mod clocks;
mod device;
mod each;
mod entering;
mod expr;
mod families;
mod flows;
mod guarded;
mod landmarks;
mod leaving;
mod needed;
mod nodes;
mod pack;
mod promise;
mod room;
mod root;
mod scope;
mod settle;
mod signal;
mod slots;
mod subrange;
mod time;

pub use claims::Claims;
pub use room::{MAX_STEPS, MAX_TASKS_IN_A_ROW, Room, task_too_large};
pub use root::{
    Argument, Elaborated, Local, PortShape, elaborate, elaborate_alone, elaborate_steps,
    hides_ring, parameters,
};

use crate::facts::Facts;
use crate::hash::{Map, Set};
use crate::typed::{ExprId, Leaf, Unit, UnitId};
pub use needed::Operand;
use rpi_diag::{Finding, Span};
use rpi_image::Scalar;
use rpi_net::{FragmentId, Net, PortRef, Side};
use rpi_prims::PrimId;
use scope::{Scope, State};
use signal::{Signal, Wire};
use std::rc::Rc;

/// Why an expression has no value before the program runs.
#[derive(Clone, PartialEq, Debug)]
pub(crate) enum NotConstant {
    /// A fault that has been reported.
    Faulty,
    /// It depends on something that is known only at run time.
    Flow(Span),
    /// Working it out faults.
    Fault(Span, String),
}

/// The leaves of a constant expression of a unit.
pub(crate) fn constant(units: &[Unit], unit: &Unit, id: ExprId) -> Result<Rc<[Leaf]>, NotConstant> {
    constant_with(units, unit, id, &[])
}

/// The value of an expression of a unit that depends on its parameters alone, of which `args` are the first.
#[must_use]
pub fn argument(units: &[Unit], unit: &Unit, id: ExprId, args: &[Argument]) -> Argument {
    match constant_with(units, unit, id, args) {
        Ok(leaves) => Argument::Value(leaves.to_vec()),
        Err(_) => Argument::Unknown,
    }
}

fn constant_with(
    units: &[Unit],
    unit: &Unit,
    id: ExprId,
    args: &[Argument],
) -> Result<Rc<[Leaf]>, NotConstant> {
    let mut elab = Elab::new(units, &[], Mode::Constant);
    let mut scope = Scope::constant(unit);
    let given = (!args.is_empty()).then(|| parameters(unit));
    for (flow, arg) in given.into_iter().flatten().zip(args) {
        let known: Wire = match (arg, unit.flow(flow).default) {
            (Argument::Value(leaves), _) => leaves.iter().cloned().map(Signal::Const).collect(),
            (Argument::Default, Some(default)) => elab.expr(&mut scope, default, At::ROOT),
            _ => continue,
        };
        *scope.state(flow) = State::Known(known);
    }
    let wire = elab.expr(&mut scope, id, At::ROOT);
    if let Some(failure) = elab.failure.take() {
        return Err(failure);
    }
    let leaf = |signal: &Signal| match signal {
        Signal::Const(value) => Ok(value.clone()),
        _ => Err(NotConstant::Flow(unit.expr(id).span)),
    };
    wire.iter().map(leaf).collect()
}

/// What an elaboration is for.
#[derive(Clone, Copy, PartialEq, Debug)]
enum Mode {
    /// A net.
    Net,
    /// A net of all that the text says, branches included that a constant never chooses: what depends on what (M5).
    Whole,
    /// Such a net in which every equation leaves a node of its own, even one that only passes on: what messages about rings
    /// are drawn from.
    Steps,
    /// A constant.
    Constant,
}

/// Where an expression is evaluated.
#[derive(Clone, Copy, PartialEq, Debug)]
struct At {
    /// The fragment.
    fragment: FragmentId,
    /// Inside a branch of an `if`: true in the cycles in which it is chosen. What can fault is guarded by it.
    guard: Option<PortRef>,
    /// That branch, if it is told which choices there are.
    side: Option<Side>,
}

impl At {
    const ROOT: At = At::fragment(FragmentId::ROOT);

    const fn fragment(fragment: FragmentId) -> At {
        At {
            fragment,
            guard: None,
            side: None,
        }
    }

    fn unguarded(self) -> At {
        At::fragment(self.fragment)
    }
}

/// A net in the making.
struct Elab<'u> {
    units: &'u [Unit],
    facts: &'u [Facts],
    mode: Mode,
    net: Net,
    /// What each alias stands for, once it is known.
    aliases: Vec<Option<Signal>>,
    alias_types: Vec<Scalar>,
    /// The aliases that are just being followed, to see when one comes round.
    settling: Vec<bool>,
    /// The fragments that aliases lead out of: outside their constants are there only while these are active.
    gates: Map<usize, FragmentId>,
    /// The fragments that aliases lead into, each of which is one vertex for what is around it.
    entries: Map<usize, FragmentId>,
    /// The fragments that are written in place.
    in_place: Set<FragmentId>,
    /// Arrays that stand for aliases, in the order of these.
    promises: Vec<promise::Promise>,
    /// `first` of each fragment.
    firsts: Map<FragmentId, PortRef>,
    /// What the core gives in each cycle (`time`, `cancel`), as far as it has been read in a fragment.
    of_cycle: Map<(FragmentId, PrimId), signal::Wire>,
    /// The fragments of clocks.
    clocks: Map<clocks::ClockKey, FragmentId>,
    /// What decides about the clocks of the results of the unit that was inlined last.
    exposed: Vec<Signal>,
    /// Whether the results of the unit that is inlined next are kept while it does not run.
    keeps_results: bool,
    /// By what flows were known before their equations were reached, where something is sampled.
    names_before: Map<PortRef, PortRef>,
    /// Elements that have been taken out of array ports.
    elements: Map<(PortRef, u32), PortRef>,
    /// Sensor ports that have been read.
    sensors: Map<(String, String, u32), PortRef>,
    /// What is in the units in which that was asked for.
    within: Map<UnitId, Rc<guarded::WithinUnit>>,
    /// Why the constant is none.
    failure: Option<NotConstant>,
    /// Name of the flow that is being defined, with the path of calls that leads to it.
    name: String,
    /// The expression that is its whole value.
    top: Option<ExprId>,
    /// Number of nodes made for it.
    serial: u32,
    /// The condition under which the call counts that is being written out.
    entered: Option<PortRef>,
    /// The calls that are being written out, each in the one before.
    calling: Vec<UnitId>,
    /// How much may still be written out.
    allowance: allowance::Allowance,
    findings: Vec<Finding>,
    /// Whether a claim was met.
    has_claims: bool,
    /// Operands that are not always needed and have state.
    operands: Vec<Operand>,
    /// Whether something was left out that only a constant rules out.
    leaves_out: bool,
    /// What becomes of claims.
    claims: Claims,
    /// Whether it is told what is made from which place of the text.
    tells_landmarks: bool,
    /// Flows that somebody looks at although they leave the net nowhere.
    watched: Vec<rpi_net::ExportPort>,
}

/// The deepest nesting of calls: each level costs stack.
pub(crate) const MAX_DEPTH: usize = 400;

impl<'u> Elab<'u> {
    fn new(units: &'u [Unit], facts: &'u [Facts], mode: Mode) -> Self {
        Elab {
            units,
            facts,
            mode,
            net: Net::new(""),
            aliases: Vec::new(),
            alias_types: Vec::new(),
            settling: Vec::new(),
            gates: Map::default(),
            entries: Map::default(),
            in_place: Set::default(),
            promises: Vec::new(),
            top: None,
            firsts: Map::default(),
            of_cycle: Map::default(),
            clocks: Map::default(),
            exposed: Vec::new(),
            keeps_results: false,
            names_before: Map::default(),
            elements: Map::default(),
            sensors: Map::default(),
            within: Map::default(),
            failure: None,
            name: String::new(),
            serial: 0,
            entered: None,
            calling: Vec::new(),
            allowance: allowance::Allowance::new(),
            findings: Vec::new(),
            has_claims: false,
            operands: Vec::new(),
            leaves_out: false,
            claims: Claims::default(),
            tells_landmarks: false,
            watched: Vec::new(),
        }
    }

    /// Notes why a constant is none; the first reason counts.
    fn fail(&mut self, reason: NotConstant) -> Wire {
        self.failure.get_or_insert(reason);
        signal::nothing()
    }
}
