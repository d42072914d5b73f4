//! Pass list, and the analysis result that the passes fill in.

use super::fact_prover::ProofContext;
use super::{
    Dependencies, FlowPresence, Presences, Readers, Resource, Schedule, WorkBounds, Writers,
};
use super::{
    cancellation, causality, hoist, mark_live, schedule, setpoint_coverage, termination,
    unused_flows, verify, writers,
};
use crate::fragment_tree::FragmentTree;
use crate::net::{FragmentId, Net, PortRef};
use crate::verify_error::VerifyError;
use rpi_diag::{Diagnostic, Severity};

/// Net with the results of all analysis passes.
#[derive(Clone, Debug)]
pub struct Analysis {
    /// Net after the passes. Passes may have added nodes.
    pub net: Net,
    /// Tree of the net's fragments.
    pub tree: FragmentTree,
    /// Errors, warnings and hints about the net.
    pub diagnostics: Vec<Diagnostic>,
    /// Name of each pass, in the order of the passes, with a summary of its result in one line of text.
    pub summary: Vec<(&'static str, String)>,
    /// For each node, the nodes that read it; emptied after the last pass.
    users: Readers,
    /// Dependency graphs of the fragments; emptied after scheduling to save memory.
    dependencies: Dependencies,
    /// Order of evaluation; `None` if the net has a dependency cycle.
    pub schedule: Option<Schedule>,
    /// For each flow, whether it has a value in every, some or no cycle.
    pub presences: Presences,
    /// Nodes that write each actuator. The actuators are the resources that the command holds.
    pub writers: Writers,
    /// Upper bounds on the work per cycle of each fragment.
    pub work: WorkBounds,
}

impl Analysis {
    /// Creates an analysis of a net without results.
    fn new(net: Net) -> Self {
        let nothing = Net::new("");
        Analysis {
            diagnostics: Vec::new(),
            summary: Vec::with_capacity(PASSES.len()),
            users: Readers::new(&nothing),
            dependencies: Dependencies::empty(),
            schedule: None,
            presences: Presences::unknown(&nothing),
            writers: Writers::default(),
            work: WorkBounds::default(),
            tree: FragmentTree::new(&nothing),
            net,
        }
    }

    fn run(&mut self, passes: &[Pass], forced: &ForcedOptional<'_>) -> Result<(), VerifyError> {
        for pass in passes {
            let summary = (pass.run)(self, forced)?;
            self.summary.push((pass.name, summary));
        }
        Ok(())
    }

    /// Empties the tables that are needed only while passes run.
    fn drop_pass_tables(mut self) -> Self {
        self.users = Readers::new(&Net::new(""));
        self
    }

    /// Returns the net and the tables that proofs about flows need.
    fn proof_context(&self) -> ProofContext<'_> {
        ProofContext {
            net: &self.net,
            tree: &self.tree,
            users: &self.users,
            presences: &self.presences,
        }
    }

    /// Computes the dependency graphs and the schedule of the current net.
    fn update_schedule(&mut self) {
        self.dependencies = Dependencies::new(&self.net, &self.tree);
        self.schedule = Schedule::new(&self.net, &self.dependencies);
    }
}

/// Analysis pass over a net, which checks or computes one property.
pub struct Pass {
    /// Name of the pass in summaries.
    pub name: &'static str,
    /// Property of the net that the pass checks or computes.
    pub description: &'static str,
    run: fn(&mut Analysis, &ForcedOptional<'_>) -> Result<String, VerifyError>,
}

/// Function that selects out-ports whose flow counts as optional, whatever the presence rule of the out-port.
type ForcedOptional<'a> = dyn Fn(PortRef) -> bool + 'a;

/// Analysis passes in the order in which they run.
pub const PASSES: &[Pass] = &[
    Pass {
        name: "structure",
        description: "indices, arity and types of the net are valid",
        run: |a, _| {
            verify::verify(&a.net)?;
            a.tree = FragmentTree::new(&a.net);
            Ok(format!(
                "{} nodes, {} fragments",
                a.net.nodes.len(),
                a.net.fragments.len()
            ))
        },
    },
    Pass {
        name: "delays",
        description: "delays of imported nets are at the level of the dependency cycle that they break",
        run: |a, _| {
            a.update_schedule();
            let mut added = 0;
            if a.schedule.is_none() {
                added = hoist::hoist_delays(&mut a.net, &a.dependencies);
            }
            if added > 0 {
                a.tree = FragmentTree::new(&a.net);
                a.update_schedule();
            }
            Ok(format!("{added} added"))
        },
    },
    Pass {
        name: "causality",
        description: "no flow depends on itself within a cycle",
        run: |a, _| {
            if a.schedule.is_none() {
                a.diagnostics
                    .extend(causality::check(&a.net, &a.dependencies));
            }
            Ok(match a.diagnostics.len() {
                0 => "no flow depends on itself within a cycle".to_owned(),
                n => format!("{n} dependency cycles"),
            })
        },
    },
    Pass {
        name: "schedule",
        description: "an order of evaluation per fragment, ties broken by declaration",
        run: |a, _| {
            if let Some(schedule) = &a.schedule {
                verified(|| schedule::verify(&a.net, &a.dependencies, schedule))?;
            }
            a.dependencies = Dependencies::empty();
            Ok("each item after all items that it reads".into())
        },
    },
    Pass {
        name: "presence",
        description: "which flows can be absent",
        run: |a, forced| {
            a.users = Readers::new(&a.net);
            let order = a.schedule.as_ref();
            a.presences = Presences::infer(&a.net, &a.tree, &a.users, order, forced);
            verified(|| a.presences.verify(&a.net, &a.tree))?;
            let count = |s| a.presences.iter().filter(|p| *p == s).count();
            let [total, optional, never] = [
                FlowPresence::Total,
                FlowPresence::Optional,
                FlowPresence::Never,
            ]
            .map(count);
            Ok(format!(
                "{total} flows total, {optional} optional, {never} never present"
            ))
        },
    },
    Pass {
        name: "writers",
        description: "no actuator is driven twice in a cycle; the resources that are taken",
        run: |a, _| {
            let writers = Writers::new(a.proof_context(), a.schedule.as_ref());
            // Without a schedule, the dependency cycle is reported instead.
            if a.schedule.is_some() {
                a.diagnostics.extend(writers::check(&a.net, &writers));
            }
            let watched = writers.unproved().count();
            let proved = writers.pairs.len() - watched;
            let taken: Vec<String> = writers
                .by_resource
                .keys()
                .map(Resource::to_string)
                .collect();
            let methods = writers.methods();
            let summary = format!(
                "{} resources{}{}; writer pairs: {proved} exclusive{}{}, {watched} checked at run time",
                taken.len(),
                if taken.is_empty() { "" } else { ": " },
                taken.join(", "),
                if methods.is_empty() { "" } else { " by " },
                methods.join(" and ")
            );
            a.writers = writers;
            Ok(summary)
        },
    },
    Pass {
        name: "set-points",
        description: "cycles in which an actuator may have no set-point",
        run: |a, _| {
            let gaps = setpoint_coverage::missing_setpoints(
                a.proof_context(),
                a.schedule.as_ref(),
                &a.writers,
            );
            // An actuator with two writers is an error that must be corrected first.
            if a.diagnostics
                .iter()
                .all(|f| f.severity() != Severity::Error)
            {
                let found = gaps
                    .iter()
                    .map(|gap| setpoint_coverage::diagnostic(&a.net, gap));
                a.diagnostics.extend(found);
            }
            Ok(setpoint_coverage::summary(&a.net, &a.writers, &gaps))
        },
    },
    Pass {
        name: "ends",
        description: "some `finish` is reachable, and so is every result",
        run: |a, _| {
            let diagnostics = termination::check(a.proof_context());
            let summary = termination::summary(&a.net, diagnostics.len());
            if diagnostics.is_empty() {
                a.diagnostics
                    .extend(cancellation::check(&a.net, &a.writers));
            }
            a.diagnostics.extend(diagnostics);
            Ok(summary)
        },
    },
    Pass {
        name: "effects",
        description: "nodes with an external effect; flows that are never used",
        run: |a, _| {
            let live = mark_live::mark_live(&a.net);
            a.diagnostics.extend(unused_flows::check(&a.net, &live));
            let count = live.iter().filter(|l| **l).count();
            Ok(format!("{count} of {} nodes", live.len()))
        },
    },
    Pass {
        name: "work",
        description: "upper bound on the work of a cycle; of exclusive fragments only the largest counts",
        run: |a, _| {
            a.work = WorkBounds::new(a.proof_context());
            Ok(format!("{} operations", a.work.bound(FragmentId::ROOT)))
        },
    },
];

/// Number of passes at the start of [`PASSES`] that determine whether a schedule exists.
const SCHEDULING_PASSES: usize = 2;

/// Runs a check of the result of a pass in tests and debug builds. Release builds skip it for speed.
fn verified(check: impl FnOnce() -> Result<(), VerifyError>) -> Result<(), VerifyError> {
    match cfg!(debug_assertions) {
        true => check(),
        false => Ok(()),
    }
}

/// Returns whether a flow of the net depends on itself within one cycle of the control core.
#[must_use]
pub fn has_dependency_cycle(net: &Net) -> bool {
    let dependencies = Dependencies::new(net, &FragmentTree::new(net));
    // A delay that `hoist` adds to an imported net may still break the dependency cycle.
    Schedule::new(net, &dependencies).is_none()
        && analyse_unless_cyclic(net.clone(), |_| false).is_ok_and(|analysis| analysis.is_none())
}

/// Runs all passes over a net.
///
/// `forced` selects out-ports whose flow counts as optional, whatever their presence rule: a replay may force an absent
/// value on them.
///
/// # Errors
/// Returns an error if the net is malformed, or if the result of a pass is wrong, which is a bug in the compiler.
pub fn analyse(net: Net, forced: impl Fn(PortRef) -> bool) -> Result<Analysis, VerifyError> {
    let mut analysis = Analysis::new(net);
    analysis.run(PASSES, &forced)?;
    Ok(analysis.drop_pass_tables())
}

/// Runs all passes over a net. Returns `None` if the net has a dependency cycle, for callers that report it from
/// another net of the same program.
///
/// `forced` selects out-ports whose flow counts as optional, whatever their presence rule.
///
/// # Errors
/// Returns an error if the net is malformed, or if the result of a pass is wrong, which is a bug in the compiler.
pub fn analyse_unless_cyclic(
    net: Net,
    forced: impl Fn(PortRef) -> bool,
) -> Result<Option<Analysis>, VerifyError> {
    let (ordering, others) = PASSES.split_at(SCHEDULING_PASSES);
    let mut analysis = Analysis::new(net);
    analysis.run(ordering, &forced)?;
    if analysis.schedule.is_none() {
        return Ok(None);
    }
    analysis.run(others, &forced)?;
    Ok(Some(analysis.drop_pass_tables()))
}
