//! The list of passes and what they find.

use super::proof::Background;
use super::{Dependencies, Presences, Resource, Schedule, Sureness, Users, Work, Writers};
use super::{causality, ends, hoist, live, schedule, setpoints, verify, writers};
use crate::net::{FragmentId, Net, PortRef};
use crate::tree::Tree;
use crate::violation::Violation;
use rpi_diag::{Finding, Severity};

/// A net and what the passes found out about it.
#[derive(Clone, Debug)]
pub struct Analysis {
    /// The net, as the passes left it.
    pub net: Net,
    /// Its fragments as a tree.
    pub tree: Tree,
    /// What is wrong with it, or worth knowing.
    pub findings: Vec<Finding>,
    /// What each pass did, in words: its name and a line.
    pub told: Vec<(&'static str, String)>,
    /// Who reads what; let go after the last pass.
    users: Users,
    /// What waits for what; let go once the order is known, for it is large.
    dependencies: Dependencies,
    /// The order of evaluation; none if something depends on itself.
    pub schedule: Option<Schedule>,
    /// Which flows can be absent.
    pub presences: Presences,
    /// Who drives which actuator: the resources that the command takes.
    pub writers: Writers,
    /// Bounds on the work of a cycle.
    pub work: Work,
}

impl Analysis {
    /// A net of which nothing is known.
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

    /// Lets go of what only passes look at.
    fn end(mut self) -> Self {
        self.users = Users::new(&Net::new(""));
        self
    }

    /// What proofs look at.
    fn background(&self) -> Background<'_> {
        Background {
            net: &self.net,
            tree: &self.tree,
            users: &self.users,
            presences: &self.presences,
        }
    }

    /// Finds out anew what depends on what.
    fn order(&mut self) {
        self.dependencies = Dependencies::new(&self.net, &self.tree);
        self.schedule = Schedule::new(&self.net, &self.dependencies);
    }
}

/// One question that is asked of a net.
pub struct Pass {
    /// Its name.
    pub name: &'static str,
    /// What it establishes.
    pub about: &'static str,
    run: fn(&mut Analysis, &Forced<'_>) -> Result<String, Violation>,
}

/// Ports that count as optional whatever their rule says.
type Forced<'a> = dyn Fn(PortRef) -> bool + 'a;

/// The passes in the order in which they run.
pub const PASSES: &[Pass] = &[
    Pass {
        name: "structure",
        about: "indices, arity and types of the net are in order",
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
        about: "delays of imported nets stand at the level of the ring that they break",
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
        about: "nothing depends on itself within a cycle",
        run: |a, _| {
            if a.schedule.is_none() {
                a.findings.extend(causality::check(&a.net, &a.dependencies));
            }
            Ok(match a.findings.len() {
                0 => "nothing depends on itself within a cycle".to_owned(),
                n => format!("{n} rings"),
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
            Ok("each item after all that it reads".into())
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
            // Without an order of evaluation that is what is reported.
            if a.schedule.is_some() {
                a.findings.extend(writers::check(&a.net, &writers));
            }
            let watched = writers.watched().count();
            let proved = writers.pairs.len() - watched;
            let taken: Vec<String> = writers.of.keys().map(Resource::to_string).collect();
            let methods = writers.methods();
            let told = format!(
                "{} resources{}{}; of pairs of writers {proved} exclusive{}{}, {watched} watched",
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
        about: "in which cycles an actuator may get none",
        run: |a, _| {
            let gaps = setpoints::gaps(a.background(), a.schedule.as_ref(), &a.writers);
            // Who drives an actuator twice is told that first.
            if a.findings.iter().all(|f| f.severity() != Severity::Error) {
                let found = gaps.iter().map(|gap| setpoints::finding(&a.net, gap));
                a.findings.extend(found);
            }
            Ok(setpoints::told(&a.net, &a.writers, &gaps))
        },
    },
    Pass {
        name: "ends",
        about: "some `finish` can happen, and every result can",
        run: |a, _| {
            let findings = ends::check(a.background());
            let told = ends::told(&a.net, findings.len());
            a.findings.extend(findings);
            Ok(told)
        },
    },
    Pass {
        name: "effects",
        about: "which nodes have an effect outside; flows that nothing uses",
        run: |a, _| {
            let live = live::live(&a.net);
            a.findings.extend(live::check(&a.net, &live));
            let count = live.iter().filter(|l| **l).count();
            Ok(format!("{count} of {} nodes", live.len()))
        },
    },
    Pass {
        name: "work",
        about: "a bound on the work of a cycle, of exclusive fragments the largest",
        run: |a, _| {
            a.work = Work::new(a.background());
            Ok(format!("{} operations", a.work.of(FragmentId::ROOT)))
        },
    },
];

/// How many of the passes it takes until the order of evaluation is known, or that there is none.
const ORDERING: usize = 2;

/// Holds a pass to its promise in tests and debug builds; a release relies on what they have shown.
fn verified(check: impl FnOnce() -> Result<(), Violation>) -> Result<(), Violation> {
    match cfg!(debug_assertions) {
        true => check(),
        false => Ok(()),
    }
}

/// Whether something in a net depends on itself within a cycle.
#[must_use]
pub fn has_ring(net: &Net) -> bool {
    let dependencies = Dependencies::new(net, &Tree::new(net));
    // A delay that is added to an imported net may break what looks like one.
    Schedule::new(net, &dependencies).is_none()
        && analyse_unless_ring(net.clone(), |_| false).is_ok_and(|analysis| analysis.is_none())
}

/// Runs all passes over a net. `forced` names ports that count as optional whatever their rule says: those on which a
/// replay may force an absent value.
///
/// # Errors
/// If the net is not in order or a pass broke its promise: a fault of the compiler.
pub fn analyse(net: Net, forced: impl Fn(PortRef) -> bool) -> Result<Analysis, Violation> {
    let mut analysis = Analysis::begin(net);
    analysis.run(PASSES, &forced)?;
    Ok(analysis.end())
}

/// The same, but none if something depends on itself within a cycle: for those who draw rings from another net, or only
/// want to know.
///
/// # Errors
/// As [`analyse`].
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
