//! The replay loop: cycle by cycle, node by node.

use rpi_core::{CycleContext, Instance};
use rpi_lower::{LowerOptions, Observe};
use rpi_net::passes::analyse;
use rpi_net::{Net, PortRef};

use super::bank::TraceBank;
use super::comparison_plan::{ComparedNode, ComparisonPlan};
use super::counters::ReportBuilder;
use super::explain;
use super::inputs::is_input;
use super::options::{Options, ReplayError};
use super::relation::Tolerance;
use super::report::{CompareReport, ReplayFault};
use super::trace_view::{CycleView, RecordedValue, varying_ports};
use rpi_record::trace::Trace;
use rpi_runtime::ImageLoadError;

/// Executes a net with the recorded values of a trace as inputs, and compares every computed value that the trace also
/// has.
///
/// # Errors
/// Returns an error if the net cannot be executed or the trace is empty. A deviation is not an error; it is part of the
/// report.
pub fn replay(net: &Net, trace: &Trace, options: &Options) -> Result<CompareReport, ReplayError> {
    if trace.last_cycle() == 0 && trace.start_ms.is_none() {
        return Err(ReplayError::EmptyTrace);
    }
    let mut bank = TraceBank::default();
    let machine = machine(net, options, &mut bank)?;
    let plan = ComparisonPlan::new(net, machine.image(), trace);
    let mut replay = Replay::new(net, plan, machine, bank, trace, options);
    let report = &mut replay.tally.report;
    report.unmatched.clone_from(&replay.plan.unmatched);
    report.renumbered = replay.plan.shift;
    for number in 1..=trace.last_cycle() {
        replay.cycle(number);
        if replay.tally.report.fault.is_some() {
            break;
        }
    }
    Ok(replay.tally.report)
}

/// Lowers the net with all ports observable and loads its image. Every port that the trace or a documented difference
/// may make absent gets a presence bit.
fn machine(net: &Net, options: &Options, bank: &mut TraceBank) -> Result<Instance, ReplayError> {
    let may_be_absent = |port: PortRef| {
        // The passes may have appended delay nodes that the trace does not know.
        net.nodes.get(port.node.index()).is_some_and(|node| {
            is_input(node.desc()) || explain::is_documented(node.desc(), usize::from(port.port))
        })
    };
    let analysis = analyse(net.clone(), may_be_absent);
    let analysis = analysis.map_err(|v| ReplayError::Lowering(v.to_string()))?;
    let plan = rpi_lower::Plan::from_analysis(&analysis).ok_or(ReplayError::DependencyCycle)?;
    let lowering = LowerOptions {
        period_ns: options.period_ns,
        tick_ns: options.period_ns,
        observe: Observe::All,
        may_be_absent: &may_be_absent,
        locates_all: false,
    };
    let image = rpi_lower::lower(&analysis.net, &plan, &lowering)
        .map_err(|error| ReplayError::Lowering(error.to_string()))?;
    let instance = Instance::load(image, bank).map_err(ImageLoadError);
    instance.map_err(ReplayError::Loading)
}

/// State of a replay that is in progress: the running net, the trace, and the report so far.
pub(super) struct Replay<'a> {
    pub(super) net: &'a Net,
    pub(super) plan: ComparisonPlan,
    pub(super) machine: Instance,
    pub(super) view: CycleView<'a>,
    bank: TraceBank,
    start_ns: i64,
    period_ns: u64,
    pub(super) tolerance: Tolerance,
    pub(super) tally: ReportBuilder,
    /// For each port of the trace, by its index, whether it had more than one value.
    pub(super) varies: Vec<bool>,
    /// For each node and out-port whose value comes from the trace, the latest recorded value, which stays valid in
    /// cycles without a recorded value.
    pub(super) held_inputs: Vec<Vec<RecordedValue>>,
    /// For each node, whether its values depend on a value that the trace does not have in this cycle.
    pub(super) unknown: Vec<bool>,
    /// For each node, whether its fragment was inactive in the previous cycle.
    pub(super) was_inactive: Vec<bool>,
    /// For each node, whether its recorded value in this cycle may refer to an object that the reference system (the
    /// control core of the Robotics API) has overwritten since.
    pub(super) aliased: Vec<bool>,
    /// For each node and out-port, the first cycle in which the port deviated from the trace by any amount; `None` if
    /// it did not.
    pub(super) first_deviation: Vec<Vec<Option<u64>>>,
}

impl<'a> Replay<'a> {
    fn new(
        net: &'a Net,
        plan: ComparisonPlan,
        machine: Instance,
        bank: TraceBank,
        trace: &'a Trace,
        options: &Options,
    ) -> Replay<'a> {
        let outs = |of: &ComparedNode| of.out_ports.len();
        Replay {
            held_inputs: plan
                .nodes
                .iter()
                .map(|n| vec![RecordedValue::Absent; outs(n)])
                .collect(),
            first_deviation: plan.nodes.iter().map(|n| vec![None; outs(n)]).collect(),
            unknown: vec![false; plan.nodes.len()],
            was_inactive: vec![false; plan.nodes.len()],
            aliased: vec![false; plan.nodes.len()],
            start_ns: trace.start_ms.unwrap_or(0).saturating_mul(1_000_000),
            period_ns: options.period_ns,
            tolerance: Tolerance {
                default: options.tolerance,
                near_gimbal_lock: options.gimbal_lock_tolerance.max(options.tolerance),
            },
            tally: ReportBuilder::new(&net.name),
            varies: varying_ports(trace),
            view: CycleView::new(trace),
            net,
            plan,
            machine,
            bank,
        }
    }

    fn cycle(&mut self, number: u64) {
        self.view.set_cycle(number);
        self.tally.report.cycles = number;
        // The cycles of a trace count from 1.
        let elapsed = self.period_ns.saturating_mul(number - 1).cast_signed();
        let context = CycleContext {
            net_ns: self.start_ns.saturating_add(elapsed),
            ..CycleContext::default()
        };
        self.machine.read(&mut self.bank, &context);
        for k in 0..self.plan.latched.len() {
            self.process_node(self.plan.latched[k]);
        }
        self.evaluate();
        for k in 0..self.plan.stepless.len() {
            self.process_node(self.plan.stepless[k]);
        }
        for k in 0..self.plan.aliases.len() {
            self.compare_alias(k);
        }
        self.update_inactive();
        self.machine.commit();
        self.store_fault(number);
        self.machine.hand_over(&mut self.bank);
    }

    /// Executes the steps of one cycle. A node is compared as soon as its last step was executed or skipped.
    fn evaluate(&mut self) {
        let mut pc = 0;
        while pc < self.plan.completed_after.len() {
            let next = self.machine.step(pc, &mut self.bank);
            for passed in pc..next {
                for k in 0..self.plan.completed_after[passed].len() {
                    self.process_node(self.plan.completed_after[passed][k]);
                }
            }
            pc = next;
        }
    }

    fn update_inactive(&mut self) {
        for (node, paused) in self.plan.nodes.iter().zip(&mut self.was_inactive) {
            let fragment = node.out_ports.first().map(|out| out.fragment);
            *paused = fragment.is_some_and(|f| !self.machine.is_active(f));
        }
    }

    /// Returns the period of the net in seconds.
    pub(super) fn dt(&self) -> f64 {
        self.period_ns as f64 * 1e-9
    }

    fn store_fault(&mut self, cycle: u64) {
        let Some(fault) = self.machine.fault() else {
            return;
        };
        let place = self.machine.image().location_of(fault.slot);
        self.tally.report.fault = Some(ReplayFault {
            cycle,
            code: format!("{:?}", fault.code),
            place: place.map_or_else(String::new, |p| p.path.clone()),
        });
    }
}
