//! Compilation of programs: from parsed modules to nets.

use std::cell::RefCell;
use std::collections::BTreeSet;
use std::path::Path;

use rpi_diag::{Finding, Severity, SourceMap, Span};
use rpi_net::passes::{Analysis, CanFault, Machine, over_budget};
use rpi_net::{FragmentId, Net};
use rpi_sema::elab::{Argument, Claims, Elaborated, Room, elaborate, elaborate_steps, hides_ring};
use rpi_sema::facts::{self, Facts};
use rpi_sema::program::Program;
use rpi_sema::typed::{BlockId, Kind, Unit, UnitId, UnitKind};
use rpi_sema::{Checked, check};
use rpi_syntax::with_stack;

use crate::agreed::Found;
use crate::compile::{Asked, Unset};
use crate::faults::{self, FaultPlace};
use crate::files::Disk;
use crate::modules::Modules;
use crate::task::{self, Instance, Task};
use crate::tests::Test;
use crate::unwanted;
use crate::violation;

/// Result of compiling a program.
pub(crate) struct Built {
    /// Commands that can be run, in source order.
    pub(crate) nets: Vec<Net>,
    /// Commands that lack arguments.
    pub(crate) unset: Vec<Unset>,
    /// Tests, in source order.
    pub(crate) tests: Vec<Test>,
    /// Diagnostics.
    pub(crate) findings: Vec<Finding>,
    /// Summaries of the analyses.
    pub(crate) told: Vec<Told>,
    /// Operations that can fault at run time, in source order, if requested.
    pub(crate) faults: Vec<FaultPlace>,
    /// Tasks, in source order.
    pub(crate) tasks: Vec<Task>,
}

/// Text of a program in a file.
pub(crate) struct Text<'t> {
    /// Name of the module.
    pub(crate) name: &'t str,
    /// Path of the file, for messages.
    pub(crate) path: &'t str,
    /// Text.
    pub(crate) text: &'t str,
    /// Folder in which other modules are searched for.
    pub(crate) folder: Option<&'t Path>,
}

impl Text<'_> {
    /// Parses the text and all modules that it needs.
    pub(crate) fn modules(&self, sources: &mut SourceMap) -> Modules {
        Modules::load(self.name, self.path, self.text, self.folder, &Disk, sources)
    }
}

/// Program whose units have been checked, with facts about its flows.
pub(crate) struct Front<'p> {
    pub(crate) program: &'p Program<'p>,
    pub(crate) checked: &'p Checked,
    pub(crate) sources: &'p SourceMap,
    pub(crate) facts: &'p [Facts],
    /// For each unit whether it has no errors so far.
    pub(crate) sound: &'p [bool],
    pub(crate) machine: Machine,
    /// Budget of nodes for all nets together, and its current use.
    pub(crate) room: Room,
    /// Summaries of the units so far, if requested.
    told: RefCell<Option<Vec<Told>>>,
    /// Operations that can fault in the nets so far, if requested.
    faults: RefCell<Option<BTreeSet<FaultPlace>>>,
}

/// Summary of the analyses of one unit: its name, and one line per result.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Told {
    /// Name of the unit.
    pub name: String,
    /// Lines: the name of the analysis and its result.
    pub lines: Vec<(&'static str, String)>,
}

/// Compiles parsed modules with all further stages. Also returns the result of the checker.
pub(crate) fn build_modules(
    modules: &Modules,
    sources: &SourceMap,
    asked: Asked,
) -> (Built, Checked) {
    let back = |front: &Front<'_>, findings: &mut Vec<Finding>| roots(front, asked, findings);
    let (roots, findings, checked) = with_front(modules, sources, back);
    let built = Built {
        nets: roots.nets,
        unset: roots.unset,
        tests: roots.tests,
        told: roots.told,
        faults: roots.faults,
        tasks: roots.tasks,
        findings,
    };
    (built, checked)
}

/// Checks parsed modules and calls `back`, which makes nets of the units without errors.
pub(crate) fn with_front<T>(
    modules: &Modules,
    sources: &SourceMap,
    back: impl FnOnce(&Front<'_>, &mut Vec<Finding>) -> T,
) -> (T, Vec<Finding>, Checked) {
    with_stack(|| checked(modules, sources, back))
}

fn checked<T>(
    modules: &Modules,
    sources: &SourceMap,
    back: impl FnOnce(&Front<'_>, &mut Vec<Finding>) -> T,
) -> (T, Vec<Finding>, Checked) {
    let texts = modules.sources();
    let (program, mut findings) = Program::collect_beside(&texts, crate::modules::BESIDE);
    findings.splice(0..0, modules.findings.iter().cloned());
    let mut checked = check(&program);
    findings.append(&mut checked.findings);
    let mut findings = rpi_sema::without_lacks_of_open_bodies(&program, findings);
    let sound = rpi_sema::sound(&program, &checked.units, &findings);
    let (facts, mut found) = facts::find(&checked.units, &sound);
    findings.append(&mut found);
    let sound = rpi_sema::sound(&program, &checked.units, &findings);
    let front = Front {
        program: &program,
        checked: &checked,
        sources,
        facts: &facts,
        sound: &sound,
        machine: modules.machine,
        room: Room::of(&program, &checked),
        told: RefCell::default(),
        faults: RefCell::default(),
    };
    let (is_faulty, before) = (has_errors(&findings), findings.len());
    let made = back(&front, &mut findings);
    if is_faulty {
        // An error may hide a use of this text, so it may not be unused.
        let needless = |f: &Finding| f.code.is_about_needless_text();
        let mut found = findings.split_off(before);
        found.retain(|finding| !needless(finding));
        findings.append(&mut found);
    }
    if !has_errors(&findings) {
        let known: BTreeSet<_> = findings.iter().map(|f| (f.code, f.span())).collect();
        let mut more = rpi_sema::needless(&program, &checked.units);
        more.retain(|f| !known.contains(&(f.code, f.span())));
        findings.append(&mut more);
    }
    crate::fixes::typed(&mut findings, &checked);
    // Warnings and notes about library modules are not useful for the user of the library.
    let own = texts.first().map_or(0, |root| root.files.len());
    findings.retain(|finding| {
        let file = finding.span().file.0 as usize;
        finding.severity() == Severity::Error || finding.span().is_none() || file < own
    });
    (made, once(findings), checked)
}

/// Units that can be run.
#[derive(Default)]
struct Roots {
    nets: Vec<Net>,
    unset: Vec<Unset>,
    tests: Vec<Test>,
    told: Vec<Told>,
    faults: Vec<FaultPlace>,
    tasks: Vec<Task>,
}

fn roots(front: &Front<'_>, asked: Asked, findings: &mut Vec<Finding>) -> Roots {
    let (claims, checked) = (asked.claims, front.checked);
    front.told.replace(asked.told.then(Vec::new));
    front.faults.replace(asked.faults.then(BTreeSet::new));
    let called = called(&checked.units);
    let (mut roots, mut found) = (Roots::default(), Found::default());
    for (_, unit) in &checked.runnable {
        let kind = checked.unit(*unit).kind;
        if !front.is_sound(*unit) {
            continue;
        }
        if kind == UnitKind::Task {
            front.tell_task(*unit);
            continue;
        }
        if !kind.is_root() && called.contains(unit) && !is_bounded_alone(checked.unit(*unit)) {
            continue;
        }
        let args = arguments(front, *unit);
        let made = one(front, *unit, &args, found.net_of(*unit, None));
        if kind == UnitKind::Command {
            roots.unset.extend(unset(checked.unit(*unit), &args));
        }
        let made = made.filter(|_| !args.contains(&Argument::Unknown));
        match (kind, made) {
            (UnitKind::Command, Some(made)) => {
                roots
                    .nets
                    .push(with_claims(front, *unit, &args, made, claims).net);
            }
            (UnitKind::Test, Some(made)) => roots.tests.push(test(checked.unit(*unit), made)),
            _ => {}
        }
    }
    let (tasks, instances) = task::tasks(front, findings);
    let nets = instances.into_iter();
    let nets = nets.filter_map(|made| instance(front, made, claims, &mut found));
    roots.nets.extend(nets);
    findings.extend(found.agreed());
    roots.tasks = tasks;
    roots.told = front.told.take().unwrap_or_default();
    roots.faults = front
        .faults
        .take()
        .unwrap_or_default()
        .into_iter()
        .collect();
    roots
}

/// Returns the net of a command for the arguments given by a task.
fn instance(
    front: &Front<'_>,
    instance: Instance,
    claims: Claims,
    found: &mut Found,
) -> Option<Net> {
    let Instance {
        name,
        unit,
        args,
        span,
    } = instance;
    let run = Some((name.clone(), span));
    let made = one(front, unit, &args, found.net_of(unit, run))?;
    if let Some(told) = front
        .told
        .borrow_mut()
        .as_mut()
        .and_then(|told| told.last_mut())
    {
        told.name.clone_from(&name);
    }
    let made = with_claims(front, unit, &args, made, claims);
    Some(Net { name, ..made.net })
}

/// Returns whether a called unit has a budget that the analysis of its callers does not check: nodes are inlined into
/// their callers, so the budget must be checked separately.
fn is_bounded_alone(unit: &Unit) -> bool {
    let budget = unit.block(BlockId::ROOT).budget_ns;
    unit.kind != UnitKind::Fragment && budget.is_some()
}

fn test(unit: &Unit, made: Elaborated) -> Test {
    Test {
        title: unit.name.to_string(),
        span: unit.span,
        net: made.net,
    }
}

/// Elaborates a unit again with other treatment of its claims, if it has any.
pub(crate) fn with_claims(
    front: &Front<'_>,
    unit: UnitId,
    args: &[Argument],
    made: Elaborated,
    claims: Claims,
) -> Elaborated {
    match claims == Claims::Report || !made.has_claims {
        true => made,
        false => elaborate(&front.checked.units, front.facts, unit, args, claims),
    }
}

/// Elaborates and analyses one unit. Returns `None` if the passes report errors. Claims are always published here,
/// because the passes analyse them as well.
fn one(
    front: &Front<'_>,
    unit: UnitId,
    args: &[Argument],
    findings: &mut Vec<Finding>,
) -> Option<Elaborated> {
    let units = &front.checked.units;
    if !front.room.is_left() {
        findings.extend(front.room.used_up(front.checked.unit(unit).span));
        return None;
    }
    let made = elaborate(units, front.facts, unit, args, Claims::Report);
    front.room.take(made.net.nodes.len());
    analysed(front, unit, args, made, findings)
}

/// Analyses the net of a unit. Returns `None` if the passes report errors.
pub(crate) fn analysed(
    front: &Front<'_>,
    unit: UnitId,
    args: &[Argument],
    mut made: Elaborated,
    findings: &mut Vec<Finding>,
) -> Option<Elaborated> {
    let mut found = std::mem::take(&mut made.findings);
    if !has_errors(&found) {
        // The analysis consumes the net and returns the optimised one.
        let net = std::mem::replace(&mut made.net, Net::new(""));
        match rpi_net::passes::analyse_unless_ring(net, |_| false) {
            Ok(None) => found.extend(rings(front, unit, args)),
            // The net for execution omits equations that only copy a flow, so it can hide a dependency cycle through
            // them.
            Ok(Some(_)) if made.leaves_out && front.hides_ring(unit, args) => {
                found.extend(rings(front, unit, args));
            }
            Ok(Some(analysis)) => {
                found.extend(front.faults(unit, &analysis, &made));
                found.extend(analysis.findings);
                let over = over_budget(&analysis.net, &analysis.work, front.machine);
                found.extend(over);
                made.net = analysis.net;
                found.extend(rpi_sema::init::check(&made.net));
            }
            Err(violation) => {
                let span = front.checked.unit(unit).span;
                found.push(violation::finding(&violation, span));
            }
        }
    }
    unwanted::forgive(&front.checked.units, unit, &mut found);
    let faulty = has_errors(&found);
    findings.append(&mut found);
    (!faulty).then_some(made)
}

impl Front<'_> {
    /// Returns whether a unit and everything it depends on have no errors so far.
    pub(crate) fn is_sound(&self, unit: UnitId) -> bool {
        self.sound[unit.0 as usize]
    }

    fn hides_ring(&self, unit: UnitId, args: &[Argument]) -> bool {
        hides_ring(&self.checked.units, self.facts, unit, args)
    }

    /// Records the summary of a task.
    fn tell_task(&self, unit: UnitId) {
        if let Some(told) = self.told.borrow_mut().as_mut() {
            let lines = rpi_sema::told(&self.checked.units, unit);
            let name = self.checked.unit(unit).name.to_string();
            told.push(Told { name, lines });
        }
    }

    /// Returns the diagnostics about operations that can fault. They are computed only if a summary, the locations or
    /// warnings are needed.
    fn faults(&self, unit: UnitId, analysis: &Analysis, made: &Elaborated) -> Vec<Finding> {
        let mut kept = self.faults.borrow_mut();
        let is_told = self.told.borrow().is_some();
        if !is_told && kept.is_none() && made.operands.is_empty() {
            return Vec::new();
        }
        let found = faults::of(analysis);
        if let Some(kept) = kept.as_mut() {
            kept.append(&mut faults::places(&found));
        }
        self.tell(unit, analysis, made, &found);
        faults::of_operands(&made.operands, &found)
    }

    /// Records the summary of a unit.
    fn tell(&self, unit: UnitId, analysis: &Analysis, made: &Elaborated, faults: &[CanFault]) {
        let mut told = self.told.borrow_mut();
        let Some(told) = told.as_mut() else {
            return;
        };
        let mut lines = rpi_sema::told(&self.checked.units, unit);
        lines.extend(analysis.told.iter().cloned());
        lines.push(("initialisation", rpi_sema::init::told(&analysis.net)));
        lines.push(("budget", budget(analysis, self.machine)));
        lines.extend(faults::lines(faults, self.sources));
        if made.has_claims {
            let count = analysis.net.claims.len();
            lines.push(("claims", format!("{count} assertions and contract clauses")));
        }
        let name = self.checked.unit(unit).name.to_string();
        told.push(Told { name, lines });
    }
}

/// Returns the summary of the work bound and the declared budgets.
fn budget(analysis: &Analysis, machine: Machine) -> String {
    let bound = machine.time_of(analysis.work.of(FragmentId::ROOT)) / 1e3;
    let fragments = analysis.net.fragments.iter();
    let stated = fragments
        .filter(|fragment| fragment.budget_ns.is_some())
        .count();
    format!(
        "at most {bound:.2} us of {} us at {} ns per operation; {stated} budgets declared",
        machine.period_ns / 1000,
        machine.ns_per_operation
    )
}

/// Returns the dependency cycles of a unit with every equation on the path. They are computed from a second net,
/// because the net for execution omits equations that only copy a flow.
fn rings(front: &Front<'_>, unit: UnitId, args: &[Argument]) -> Vec<Finding> {
    let net = elaborate_steps(&front.checked.units, front.facts, unit, args);
    let analysis = rpi_net::passes::analyse(net, |_| false);
    analysis.map_or_else(|_| Vec::new(), |analysis| analysis.findings)
}

/// Returns the arguments of a command that is run on its own: devices are bound by name, values to constants of the
/// same name.
fn arguments(front: &Front<'_>, unit: UnitId) -> Vec<Argument> {
    let unit = front.checked.unit(unit);
    let params = rpi_sema::elab::parameters(unit);
    let argument = |id| front.checked.argument(front.program, unit.flow(id));
    params.into_iter().map(argument).collect()
}

/// Returns a command that lacks arguments, or `None` if it lacks none.
fn unset(unit: &Unit, args: &[Argument]) -> Option<Unset> {
    let params = rpi_sema::elab::parameters(unit).into_iter().zip(args);
    let lacking = params.filter(|(_, arg)| **arg == Argument::Unknown);
    let declared = |(id, _)| {
        let flow = unit.flow(id);
        format!("{}: {}", flow.name, flow.ty)
    };
    let params: Vec<String> = lacking.map(declared).collect();
    (!params.is_empty()).then(|| Unset {
        command: unit.name.to_string(),
        params,
    })
}

/// Returns the units that others call.
pub(crate) fn called<'u>(units: impl IntoIterator<Item = &'u Unit>) -> BTreeSet<UnitId> {
    let exprs = units.into_iter().flat_map(|unit| &unit.exprs);
    let calls = exprs.filter_map(|expr| match &expr.kind {
        Kind::Call(call) => Some(call.unit),
        _ => None,
    });
    calls.collect()
}

pub(crate) fn has_errors(findings: &[Finding]) -> bool {
    findings
        .iter()
        .any(|finding| finding.severity() == Severity::Error)
}

/// Removes duplicates and consequential diagnostics. A unit called in several places is analysed in each of them,
/// possibly with other names for its flows; diagnostics with the same fixes at the same location are the same error. A
/// diagnostic at the location of a syntax error is a consequence of it.
fn once(findings: Vec<Finding>) -> Vec<Finding> {
    let syntax = findings.iter().filter(|finding| of_syntax(finding));
    let broken: Vec<Span> = syntax
        .flat_map(|f| &f.labels)
        .map(|label| label.span)
        .collect();
    let follows = |finding: &Finding| {
        let mut places = finding.labels.iter().map(|label| label.span);
        !of_syntax(finding) && places.any(|place| broken.iter().any(|fault| overlap(place, *fault)))
    };
    let (mut seen, mut mended) = (BTreeSet::new(), BTreeSet::new());
    let mut kept = findings;
    kept.retain(|finding| {
        let place = (finding.code, finding.span());
        !follows(finding)
            && seen.insert((place, finding.message.clone()))
            && (finding.fixes.is_empty() || mended.insert((place, changes(finding))))
    });
    kept
}

/// Returns the changes that the fixes of a diagnostic make.
fn changes(finding: &Finding) -> Vec<(Span, String)> {
    let edits = finding.fixes.iter().flat_map(|fix| &fix.edits);
    edits.map(|edit| (edit.span, edit.text.clone())).collect()
}

/// Returns whether a diagnostic is a syntax error (group 0 of the codes).
fn of_syntax(finding: &Finding) -> bool {
    finding.code.as_str().starts_with("RPI0") && finding.severity() == Severity::Error
}

fn overlap(a: Span, b: Span) -> bool {
    a.file == b.file && a.start < b.end && b.start < a.end
}
