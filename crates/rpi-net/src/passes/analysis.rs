//! Pass list, and the analysis result that the passes fill in.

use super::proof::Background;
use super::{Dependencies, Presences, Resource, Schedule, Sureness, Users, Work, Writers};
use super::{causality, ends, hoist, live, schedule, setpoints, verify, writers};
use crate::net::{FragmentId, Net, PortRef};
use crate::tree::Tree;
use crate::violation::Violation;
use rpi_diag::{Finding, Severity};

/// Net with the analysis results of the passes.
#[derive(Clone, Debug)]
pub struct Analysis {
    /// Net after the passes, which may have changed it.
    pub net: Net,
    /// Tree of the net's fragments.
    pub tree: Tree,
    /// Errors, warnings and hints about the net.
    pub findings: Vec<Finding>,
    /// Summary of each pass: its name and one line of text.
    pub told: Vec<(&'static str, String)>,
    /// Readers of each node; dropped after the last pass.
    users: Users,
    /// Dependency graphs; dropped after scheduling to save memory.
    dependencies: Dependencies,
    /// Order of evaluation; `None` if the net has a dependency cycle.
    pub schedule: Option<Schedule>,
    /// Presence of all flows.
    pub presences: Presences,
    /// Writers of each actuator, which are the resources that the command takes.
    pub writers: Writers,
    /// Upper bounds on the work of a cycle.
    pub work: Work,
}

impl Analysis {
    /// Creates an analysis without results.
    fn begin(net: Net) -> Self {
        let nothing = Net::new("");
        Analysis {
            findings: Vec::new(),
            told: Vec::with_capacity(PASSES.len()),
            users: Users::new(&nothing),
            dependencies: Dependencies::none(),
            schedule: None,
            presences: Presences::unknown(&nothing),
            writers: Writers::default(),
            work: Work::default(),
            tree: Tree::new(&nothing),
            net,
        }
    }

    fn run(&mut self, passes: &[Pass], forced: &Forced<'_>) -> Result<(), Violation> {
        for pass in passes {
            let told = (pass.run)(self, forced)?;
            self.told.push((pass.name, told));
        }
        Ok(())
    }

    /// Drops the tables that only passes read.
    fn end(mut self) -> Self {
        self.users = Users::new(&Net::new(""));
        self
    }

    /// Borrows the tables that proofs read.
    fn background(&self) -> Background<'_> {
        Background {
            net: &self.net,
            tree: &self.tree,
            users: &self.users,
            presences: &self.presences,
        }
    }

    /// Computes the dependency graphs and the schedule again.
    fn order(&mut self) {
        self.dependencies = Dependencies::new(&self.net, &self.tree);
        self.schedule = Schedule::new(&self.net, &self.dependencies);
    }
}

/// Pass over a net, which checks or computes one property.
pub struct Pass {
    /// Name of the pass.
    pub name: &'static str,
    /// Property that the pass establishes.
    pub about: &'static str,
    run: fn(&mut Analysis, &Forced<'_>) -> Result<String, Violation>,
}

/// Selects ports that count as optional regardless of their presence rule.
type Forced<'a> = dyn Fn(PortRef) -> bool + 'a;

/// Passes in the order in which they run.
pub const PASSES: &[Pass] = &[
    Pass {
        name: "structure",
        about: "indices, arity and types of the net are valid",
        run: |a, _| {
            verify::verify(&a.net)?;
            a.tree = Tree::new(&a.net);
            Ok(format!(
                "{} nodes, {} fragments",
                a.net.nodes.len(),
                a.net.fragments.len()
            ))
        },
    },
    Pass {
        name: "delays",
        about: "delays of imported nets are at the level of the dependency cycle that they break",
        run: |a, _| {
            a.order();
            let mut added = 0;
            if a.schedule.is_none() {
                added = hoist::hoist_delays(&mut a.net, &a.dependencies);
            }
            if added > 0 {
                a.tree = Tree::new(&a.net);
                a.order();
            }
            Ok(format!("{added} added"))
        },
    },
    Pass {
        name: "causality",
        about: "no flow depends on itself within a cycle",
        run: |a, _| {
            if a.schedule.is_none() {
                a.findings.extend(causality::check(&a.net, &a.dependencies));
            }
            Ok(match a.findings.len() {
                0 => "no flow depends on itself within a cycle".to_owned(),
                n => format!("{n} dependency cycles"),
            })
        },
    },
    Pass {
        name: "schedule",
        about: "an order of evaluation per fragment, ties broken by declaration",
        run: |a, _| {
            if let Some(schedule) = &a.schedule {
                verified(|| schedule::verify(&a.net, &a.dependencies, schedule))?;
            }
            a.dependencies = Dependencies::none();
            Ok("each item after all items that it reads".into())
        },
    },
    Pass {
        name: "presence",
        about: "which flows can be absent",
        run: |a, forced| {
            a.users = Users::new(&a.net);
            let order = a.schedule.as_ref();
            a.presences = Presences::infer(&a.net, &a.tree, &a.users, order, forced);
            verified(|| a.presences.verify(&a.net, &a.tree))?;
            let count = |s| a.presences.iter().filter(|p| *p == s).count();
            let [total, optional, never] =
                [Sureness::Total, Sureness::Optional, Sureness::Never].map(count);
            Ok(format!(
                "{total} flows total, {optional} optional, {never} never present"
            ))
        },
    },
    Pass {
        name: "writers",
        about: "no actuator is driven twice in a cycle; the resources that are taken",
        run: |a, _| {
            let writers = Writers::new(a.background(), a.schedule.as_ref());
            // Without a schedule, the dependency cycle is reported instead.
            if a.schedule.is_some() {
                a.findings.extend(writers::check(&a.net, &writers));
            }
            let watched = writers.watched().count();
            let proved = writers.pairs.len() - watched;
            let taken: Vec<String> = writers.of.keys().map(Resource::to_string).collect();
            let methods = writers.methods();
            let told = format!(
                "{} resources{}{}; writer pairs: {proved} exclusive{}{}, {watched} checked at run time",
                taken.len(),
                if taken.is_empty() { "" } else { ": " },
                taken.join(", "),
                if methods.is_empty() { "" } else { " by " },
                methods.join(" and ")
            );
            a.writers = writers;
            Ok(told)
        },
    },
    Pass {
        name: "set-points",
        about: "cycles in which an actuator may have no set-point",
        run: |a, _| {
            let gaps = setpoints::gaps(a.background(), a.schedule.as_ref(), &a.writers);
            // An actuator with two writers is an error that must be corrected first.
            if a.findings.iter().all(|f| f.severity() != Severity::Error) {
                let found = gaps.iter().map(|gap| setpoints::finding(&a.net, gap));
                a.findings.extend(found);
            }
            Ok(setpoints::told(&a.net, &a.writers, &gaps))
        },
    },
    Pass {
        name: "ends",
        about: "some `finish` is reachable, and so is every result",
        run: |a, _| {
            let findings = ends::check(a.background());
            let told = ends::told(&a.net, findings.len());
            a.findings.extend(findings);
            Ok(told)
        },
    },
    Pass {
        name: "effects",
        about: "nodes with an external effect; flows that are never used",
        run: |a, _| {
            let live = live::live(&a.net);
            a.findings.extend(live::check(&a.net, &live));
            let count = live.iter().filter(|l| **l).count();
            Ok(format!("{count} of {} nodes", live.len()))
        },
    },
    Pass {
        name: "work",
        about: "upper bound on the work of a cycle; of exclusive fragments only the largest counts",
        run: |a, _| {
            a.work = Work::new(a.background());
            Ok(format!("{} operations", a.work.of(FragmentId::ROOT)))
        },
    },
];

/// Number of passes at the start of [`PASSES`] that determine whether a schedule exists.
const ORDERING: usize = 2;

/// Runs the verifier of a pass in tests and debug builds. Release builds skip it for speed.
fn verified(check: impl FnOnce() -> Result<(), Violation>) -> Result<(), Violation> {
    match cfg!(debug_assertions) {
        true => check(),
        false => Ok(()),
    }
}

/// Whether the net has a dependency cycle within a cycle of the control core.
#[must_use]
pub fn has_ring(net: &Net) -> bool {
    let dependencies = Dependencies::new(net, &Tree::new(net));
    // A delay that `hoist` adds to an imported net may still break the dependency cycle.
    Schedule::new(net, &dependencies).is_none()
        && analyse_unless_ring(net.clone(), |_| false).is_ok_and(|analysis| analysis.is_none())
}

/// Runs all passes over a net. `forced` selects ports that count as optional regardless of their presence rule: a
/// replay may force an absent value on them.
///
/// # Errors
/// Returns an error if the net is malformed or a pass broke its postcondition, which is a bug in the compiler.
pub fn analyse(net: Net, forced: impl Fn(PortRef) -> bool) -> Result<Analysis, Violation> {
    let mut analysis = Analysis::begin(net);
    analysis.run(PASSES, &forced)?;
    Ok(analysis.end())
}

/// Like [`analyse`], but returns `None` if the net has a dependency cycle, for callers that report it from another net.
///
/// # Errors
/// Returns an error in the same cases as [`analyse`].
pub fn analyse_unless_ring(
    net: Net,
    forced: impl Fn(PortRef) -> bool,
) -> Result<Option<Analysis>, Violation> {
    let (ordering, others) = PASSES.split_at(ORDERING);
    let mut analysis = Analysis::begin(net);
    analysis.run(ordering, &forced)?;
    if analysis.schedule.is_none() {
        return Ok(None);
    }
    analysis.run(others, &forced)?;
    Ok(Some(analysis.end()))
}
