//! The replay itself: cycle by cycle, node by node.

use std::fmt;

use rpi_core::{LoadFault, Machine, Moment};
use rpi_image::Type;
use rpi_lower::{LowerOptions, Observe};
use rpi_net::{Input, Net, NodeId, PortRef};

use super::angles::Measure;
use super::bank::ReplayBank;
use super::explain::{self, Case};
use super::inputs::is_input;
use super::plan::{Alias, AliasPlace, Out, Plan};
use super::recorded::{CycleView, Recorded, varying};
use super::relation::{Nature, Relation, Tolerance, relate};
use super::report::{Fault, Report};
use super::tally::{Occasion, Tally};
use super::text::text;
use crate::trace::Trace;

/// How a replay is done.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Options {
    /// Period in nanoseconds; the corpus was recorded at 25 ms.
    pub period_ns: u64,
    /// How far apart equal values may be.
    pub tolerance: f64,
    /// How far apart Euler angles and rotations may be near gimbal lock, where their digits are worth less.
    pub lock_tolerance: f64,
}

impl Default for Options {
    fn default() -> Options {
        Options {
            period_ns: 25_000_000,
            tolerance: 1e-9,
            lock_tolerance: 1e-6,
        }
    }
}

/// Why a replay could not be done at all.
#[derive(Clone, PartialEq, Debug)]
pub enum ReplayError {
    /// The trace holds no cycle.
    Empty,
    /// Something in the net depends on itself.
    Cyclic,
    /// The net cannot be lowered.
    Lowering(String),
    /// The image cannot be loaded.
    Loading(Vec<LoadFault>),
    /// A text in the trace is no value of the port's type.
    Value {
        /// The cycle, from 1.
        cycle: u64,
        /// The port's path.
        port: String,
        /// What is wrong.
        message: String,
    },
}

impl fmt::Display for ReplayError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ReplayError::Empty => f.write_str("the trace holds no cycle"),
            ReplayError::Cyclic => f.write_str("something in the net depends on itself"),
            ReplayError::Lowering(reason) => write!(f, "the net cannot be lowered: {reason}"),
            ReplayError::Loading(faults) => {
                let reasons: Vec<String> = faults.iter().map(ToString::to_string).collect();
                write!(f, "the net cannot be loaded: {}", reasons.join("; "))
            }
            ReplayError::Value {
                cycle,
                port,
                message,
            } => {
                write!(f, "cycle {cycle}, {port}: {message}")
            }
        }
    }
}

impl std::error::Error for ReplayError {}

/// Runs a net against a trace and compares every recorded value that it computes.
///
/// # Errors
/// If the net cannot run or the trace cannot be read with its types. A difference is no error: it is in the report.
pub fn replay(net: &Net, trace: &Trace, options: &Options) -> Result<Report, ReplayError> {
    if trace.last_cycle() == 0 {
        return Err(ReplayError::Empty);
    }
    let mut bank = ReplayBank::default();
    let machine = machine(net, options, &mut bank)?;
    let plan = Plan::new(net, machine.image(), trace);
    let mut replay = Replay::new(net, plan, machine, bank, trace, options);
    replay
        .tally
        .report
        .unmatched
        .clone_from(&replay.plan.unmatched);
    for number in 1..=trace.last_cycle() {
        replay.cycle(number)?;
        if replay.tally.report.fault.is_some() {
            break;
        }
    }
    Ok(replay.tally.report)
}

/// The net, lowered to be looked at, with a presence for everything that the trace may make absent.
fn machine(net: &Net, options: &Options, bank: &mut ReplayBank) -> Result<Machine, ReplayError> {
    let may_be_absent = |port: PortRef| {
        let desc = net.node(port.node).desc();
        is_input(desc) || explain::concerns(desc, usize::from(port.port))
    };
    let plan = rpi_lower::Plan::new(net, may_be_absent).ok_or(ReplayError::Cyclic)?;
    let lowering = LowerOptions {
        period_ns: options.period_ns,
        observe: Observe::All,
        may_be_absent: &may_be_absent,
    };
    let image = rpi_lower::lower(net, &plan, &lowering).map_err(ReplayError::Lowering)?;
    Machine::load(image, bank).map_err(ReplayError::Loading)
}

/// A replay under way.
pub(super) struct Replay<'a> {
    pub(super) net: &'a Net,
    pub(super) plan: Plan,
    pub(super) machine: Machine,
    pub(super) view: CycleView<'a>,
    bank: ReplayBank,
    start_ns: i64,
    period_ns: u64,
    tolerance: Tolerance,
    tally: Tally,
    /// For each port of the trace whether it carried more than one value.
    varies: Vec<bool>,
    /// What inputs that the trace does not have in every cycle gave last, by node and port.
    held: Vec<Vec<Recorded>>,
    /// Nodes whose values depend on something that the trace does not have in this cycle.
    unsure: Vec<bool>,
    /// The cycle in which a port first was off, by however little.
    pub(super) since: Vec<Vec<Option<u64>>>,
}

impl<'a> Replay<'a> {
    fn new(
        net: &'a Net,
        plan: Plan,
        machine: Machine,
        bank: ReplayBank,
        trace: &'a Trace,
        options: &Options,
    ) -> Replay<'a> {
        let outs = |of: &super::plan::Watched| of.outs.len();
        Replay {
            held: plan
                .nodes
                .iter()
                .map(|n| vec![Recorded::Absent; outs(n)])
                .collect(),
            since: plan.nodes.iter().map(|n| vec![None; outs(n)]).collect(),
            unsure: vec![false; plan.nodes.len()],
            start_ns: trace.start_ms.unwrap_or(0).saturating_mul(1_000_000),
            period_ns: options.period_ns,
            tolerance: Tolerance {
                usual: options.tolerance,
                near_lock: options.lock_tolerance.max(options.tolerance),
            },
            tally: Tally::new(&net.name),
            varies: varying(trace),
            view: CycleView::new(trace),
            net,
            plan,
            machine,
            bank,
        }
    }

    fn cycle(&mut self, number: u64) -> Result<(), ReplayError> {
        self.view.turn_to(number);
        self.tally.report.cycles = number;
        let elapsed = self.period_ns.saturating_mul(number - 1).cast_signed();
        let moment = Moment {
            net_ns: self.start_ns.saturating_add(elapsed),
            ..Moment::default()
        };
        self.machine.read(&mut self.bank, &moment);
        for k in 0..self.plan.latched.len() {
            self.finish(self.plan.latched[k])?;
        }
        self.evaluate()?;
        for k in 0..self.plan.aliases.len() {
            self.alias(k)?;
        }
        self.machine.commit();
        self.note_fault(number);
        self.machine.hand_over(&mut self.bank);
        Ok(())
    }

    /// Steps through the net; a node is compared as soon as its last step is behind, run or jumped over.
    fn evaluate(&mut self) -> Result<(), ReplayError> {
        let mut pc = 0;
        while pc < self.plan.done.len() {
            let next = self.machine.step(pc, &mut self.bank);
            for passed in pc..next {
                for k in 0..self.plan.done[passed].len() {
                    self.finish(self.plan.done[passed][k])?;
                }
            }
            pc = next;
        }
        Ok(())
    }

    fn finish(&mut self, id: NodeId) -> Result<(), ReplayError> {
        let watched = &self.plan.nodes[id.index()];
        let (ports, is_input) = (watched.outs.len(), watched.is_input);
        self.unsure[id.index()] = self.reads_unsure(id);
        for k in 0..ports {
            let port = PortRef {
                node: id,
                port: k as u8,
            };
            match is_input {
                true => self.take(port)?,
                false => self.compare(port)?,
            }
        }
        Ok(())
    }

    /// Whether a node depends on something unknown: once it has, its state may be off for good.
    fn reads_unsure(&self, id: NodeId) -> bool {
        let node = self.net.node(id);
        let keeps = !matches!(node.desc().state, rpi_image::State::None);
        let reads = |input: &Input| matches!(input, Input::Port(p) if self.unsure[p.node.index()]);
        (keeps && self.unsure[id.index()]) || node.inputs.iter().any(reads)
    }

    /// Puts what the trace says in place of what came from outside.
    fn take(&mut self, port: PortRef) -> Result<(), ReplayError> {
        let out = self.plan.out(port);
        let (signal, recorded_as) = (out.signal, out.recorded);
        let recorded = self.recorded(port)?;
        let held = &mut self.held[port.node.index()][usize::from(port.port)];
        match recorded {
            Recorded::Unknown => {
                let varies = recorded_as.is_some_and(|p| self.varies[p.0 as usize]);
                self.unsure[port.node.index()] |= varies;
            }
            known => {
                self.tally.report.taken += u64::from(known != Recorded::Absent);
                *held = known;
            }
        }
        force(&mut self.machine, signal, held);
        Ok(())
    }

    /// Compares what a node has computed with what the trace says.
    fn compare(&mut self, port: PortRef) -> Result<(), ReplayError> {
        let recorded = self.recorded(port)?;
        if self.is_unsure(port.node, &recorded) {
            return Ok(());
        }
        let nature = self.nature(port)?;
        let computed = self.computed(port).map(<[u64]>::to_vec);
        let ty = self.plan.out(port).signal.ty;
        let relation = relate(ty, nature, computed.as_deref(), &recorded, self.tolerance);
        self.note_off(port, relation);
        self.judge(port, ty, computed.as_deref(), &recorded, relation);
        Ok(())
    }

    fn judge(
        &mut self,
        port: PortRef,
        ty: Type,
        computed: Option<&[u64]>,
        recorded: &Recorded,
        relation: Relation,
    ) {
        if relation == Relation::Unknown {
            return;
        }
        self.tally.compared(recorded);
        let name = self.name(port);
        let at = Occasion {
            cycle: self.view.number,
            port: &name,
            primitive: self.net.node(port.node).desc().name,
        };
        match relation {
            Relation::Unknown => {}
            Relation::Agrees(deviation) => {
                let texts = || (text(computed, ty), recorded.text(ty));
                self.tally.agrees(at, deviation, texts);
            }
            Relation::Rewritten => {
                self.tally.report.rewritten += 1;
                force(&mut self.machine, self.plan.out(port).signal, recorded);
            }
            Relation::Differs(deviation) => match self.explained(port, computed, recorded) {
                Some(entry) => {
                    self.tally.explained(at, entry.name, entry.why);
                    force(&mut self.machine, self.plan.out(port).signal, recorded);
                }
                None if self.tally.differs(at, deviation) => {
                    self.tally.report.first = Some(super::path::divergence(self, port));
                }
                None => {}
            },
        }
    }

    fn explained(
        &self,
        port: PortRef,
        computed: Option<&[u64]>,
        recorded: &Recorded,
    ) -> Option<&'static explain::Difference> {
        explain::explain(&Case {
            replay: self,
            port,
            computed,
            recorded,
        })
    }

    fn alias(&mut self, k: usize) -> Result<(), ReplayError> {
        let alias = &self.plan.aliases[k];
        let recorded = match alias.place {
            AliasPlace::Border(port) => self.view.out_port(port, alias.ty),
            AliasPlace::InPort(port) => self.view.in_port(port, alias.ty),
        };
        let recorded = recorded.map_err(|m| self.bad_value(&alias.name, m))?;
        if let Input::Port(port) = alias.source
            && self.unsure[port.node.index()]
        {
            self.tally.report.unknown += u64::from(recorded != Recorded::Unknown);
            return Ok(());
        }
        self.judge_alias(k, &recorded);
        Ok(())
    }

    fn judge_alias(&mut self, k: usize, recorded: &Recorded) {
        let Alias {
            name, ty, source, ..
        } = &self.plan.aliases[k];
        let computed = self.input(source);
        let nature = self.alias_nature(source);
        let relation = relate(*ty, nature, computed, recorded, self.tolerance);
        if relation == Relation::Unknown {
            return;
        }
        self.tally.compared(recorded);
        if let Relation::Differs(deviation) = relation {
            let at = Occasion {
                cycle: self.view.number,
                port: name,
                primitive: "",
            };
            if self.tally.differs(at, deviation) {
                let (name, source) = (name.clone(), source.clone());
                self.tally.report.first = Some(super::path::alias_divergence(self, &name, &source));
            }
        }
    }

    fn is_unsure(&mut self, id: NodeId, recorded: &Recorded) -> bool {
        let unsure = self.unsure[id.index()];
        self.tally.report.unknown += u64::from(unsure && *recorded != Recorded::Unknown);
        unsure
    }

    /// Remembers when a port first is off, by however little.
    fn note_off(&mut self, port: PortRef, relation: Relation) {
        if !matches!(relation, Relation::Unknown) && relation != Relation::Agrees(0.0) {
            let since = &mut self.since[port.node.index()][usize::from(port.port)];
            since.get_or_insert(self.view.number);
        }
    }

    fn note_fault(&mut self, cycle: u64) {
        let Some(fault) = self.machine.fault() else {
            return;
        };
        let place = self.machine.image().place_of(fault.cell);
        self.tally.report.fault = Some(Fault {
            cycle,
            code: format!("{:?}", fault.code),
            place: place.map_or_else(String::new, |p| p.path.clone()),
        });
    }

    /// What the trace says of an out-port in this cycle.
    pub(super) fn recorded(&self, port: PortRef) -> Result<Recorded, ReplayError> {
        let Out {
            recorded, signal, ..
        } = self.plan.out(port);
        let found = self.view.out_port(*recorded, signal.ty);
        found.map_err(|m| self.bad_value(&self.name(port), m))
    }

    /// What an out-port carries in this cycle, seen from its own fragment.
    pub(super) fn computed(&self, port: PortRef) -> Option<&[u64]> {
        let out = self.plan.out(port);
        let active = self.machine.is_active(out.fragment);
        self.machine.value(out.signal).filter(|_| active)
    }

    /// What runs through an input.
    pub(super) fn input<'s>(&'s self, input: &'s Input) -> Option<&'s [u64]> {
        match input {
            Input::Open => None,
            Input::Const(value) => Some(value.cells()),
            Input::Port(port) => self.computed(*port),
        }
    }

    /// `path.port`.
    pub(super) fn name(&self, port: PortRef) -> String {
        let path = &self.plan.nodes[port.node.index()].path;
        let outs = self.net.node(port.node).desc().outputs;
        format!("{path}.{}", outs[usize::from(port.port)].name)
    }

    fn nature(&self, port: PortRef) -> Result<Nature, ReplayError> {
        Ok(match self.plan.out(port).measure {
            Measure::Plain => Nature::Plain,
            Measure::Angle => Nature::Angle,
            Measure::Euler(middle) => {
                let middle = PortRef {
                    port: middle as u8,
                    ..port
                };
                match self.recorded(middle)? {
                    Recorded::Value(cells) => Nature::Euler(f64::from_bits(cells[0])),
                    _ => Nature::Angle,
                }
            }
        })
    }

    /// An alias of an angle has had its source rewritten already if need be.
    fn alias_nature(&self, source: &Input) -> Nature {
        match source {
            Input::Port(port) if self.plan.out(*port).measure != Measure::Plain => Nature::Angle,
            _ => Nature::Plain,
        }
    }

    fn bad_value(&self, port: &str, message: String) -> ReplayError {
        ReplayError::Value {
            cycle: self.view.number,
            port: port.to_owned(),
            message,
        }
    }
}

/// Puts a recorded value into memory; what was not written down stays as it is.
fn force(machine: &mut Machine, signal: rpi_image::image::Signal, recorded: &Recorded) {
    match recorded {
        Recorded::Value(cells) => machine.force(signal, Some(cells)),
        Recorded::Absent => machine.force(signal, None),
        Recorded::Unknown | Recorded::Opaque => true,
    };
}
