//! Programs: from parsed modules to nets.

use std::collections::BTreeSet;
use std::path::Path;

use rpi_diag::{Finding, Severity, SourceMap, Span};
use rpi_net::Net;
use rpi_sema::elab::{Argument, Elaborated, elaborate, elaborate_steps};
use rpi_sema::facts::{self, Facts};
use rpi_sema::program::Program;
use rpi_sema::typed::{Kind, Unit, UnitId, UnitKind};
use rpi_sema::{Checked, check};

use crate::files::Disk;
use crate::modules::Modules;
use crate::tests::{Test, branches};
use crate::violation;

/// What became of a program.
pub(crate) struct Built {
    /// Its commands, in the order of the text; those that can be run.
    pub(crate) nets: Vec<Net>,
    /// Its tests, in the order of the text.
    pub(crate) tests: Vec<Test>,
    /// What was found.
    pub(crate) findings: Vec<Finding>,
}

/// Takes a program's text through all stages up to checked nets.
pub(crate) fn build(
    name: &str,
    path: &str,
    text: &str,
    folder: Option<&Path>,
    sources: &mut SourceMap,
) -> Built {
    build_modules(&Modules::load(name, path, text, folder, &Disk, sources)).0
}

/// Takes parsed modules through all other stages; what the checker made of them is kept for who wants to look at it.
pub(crate) fn build_modules(modules: &Modules) -> (Built, Checked) {
    let texts = modules.sources();
    let (program, mut findings) = Program::collect(&texts);
    findings.splice(0..0, modules.findings.iter().cloned());
    let mut checked = check(&program);
    findings.append(&mut checked.findings);
    let roots = match has_errors(&findings) {
        true => Roots::default(),
        false => roots(&program, &checked, &mut findings),
    };
    // What is only worth knowing about a library is not the business of who uses it.
    let own = texts.first().map_or(0, |root| root.files.len());
    findings.retain(|finding| {
        let file = finding.span().file.0 as usize;
        finding.severity() == Severity::Error || finding.span().is_none() || file < own
    });
    let built = Built {
        nets: roots.nets,
        tests: roots.tests,
        findings: once(findings),
    };
    (built, checked)
}

/// What can be run.
#[derive(Default)]
struct Roots {
    nets: Vec<Net>,
    tests: Vec<Test>,
}

fn roots(program: &Program<'_>, checked: &Checked, findings: &mut Vec<Finding>) -> Roots {
    let (facts, mut found) = facts::find(&checked.units);
    findings.append(&mut found);
    if has_errors(findings) {
        return Roots::default();
    }
    let called = called(checked);
    let mut roots = Roots::default();
    for (_, unit) in &checked.runnable {
        let kind = checked.unit(*unit).kind;
        if !kind.is_root() && called.contains(unit) {
            continue;
        }
        let args = arguments(program, checked, *unit);
        let made = one(checked, &facts, *unit, &args, findings);
        let made = made.filter(|_| !args.contains(&Argument::Unknown));
        match (kind, made) {
            (UnitKind::Command, Some(made)) => roots.nets.push(made.net),
            (UnitKind::Test, Some(made)) => roots.tests.push(test(checked.unit(*unit), made)),
            _ => {}
        }
    }
    roots
}

fn test(unit: &Unit, made: Elaborated) -> Test {
    Test {
        title: unit.name.to_string(),
        span: unit.span,
        branches: branches(&made.net),
        net: made.net,
        expectations: made.expectations,
    }
}

/// The net of one unit, if the passes find nothing against it.
fn one(
    checked: &Checked,
    facts: &[Facts],
    unit: UnitId,
    args: &[Argument],
    findings: &mut Vec<Finding>,
) -> Option<Elaborated> {
    let mut made = elaborate(&checked.units, facts, unit, args);
    let mut found = std::mem::take(&mut made.findings);
    if found.is_empty() {
        match rpi_net::passes::analyse(made.net.clone(), |_| false) {
            Ok(analysis) if analysis.schedule.is_none() => {
                found.extend(rings(checked, facts, unit, args));
            }
            Ok(analysis) => {
                found.extend(analysis.findings);
                found.extend(rpi_sema::init::check(&made.net));
            }
            Err(violation) => found.push(violation::finding(&violation, checked.unit(unit).span)),
        }
    }
    let faulty = has_errors(&found);
    findings.append(&mut found);
    (!faulty).then_some(made)
}

/// The rings of a unit, drawn with every equation on the way: a net for running leaves out those that only pass on.
fn rings(checked: &Checked, facts: &[Facts], unit: UnitId, args: &[Argument]) -> Vec<Finding> {
    let net = elaborate_steps(&checked.units, facts, unit, args);
    let analysis = rpi_net::passes::analyse(net, |_| false);
    analysis.map_or_else(|_| Vec::new(), |analysis| analysis.findings)
}

/// What a command's parameters are when it is run by itself: devices by their names, values by constants of the same
/// name.
fn arguments(program: &Program<'_>, checked: &Checked, unit: UnitId) -> Vec<Argument> {
    let unit = checked.unit(unit);
    let params = rpi_sema::elab::parameters(unit);
    let argument = |id| checked.argument(program, unit.flow(id));
    params.into_iter().map(argument).collect()
}

/// The units that others call.
fn called(checked: &Checked) -> BTreeSet<UnitId> {
    let exprs = checked.units.iter().flat_map(|unit| &unit.exprs);
    let calls = exprs.filter_map(|expr| match &expr.kind {
        Kind::Call(call) => Some(call.unit),
        _ => None,
    });
    calls.collect()
}

fn has_errors(findings: &[Finding]) -> bool {
    findings
        .iter()
        .any(|finding| finding.severity() == Severity::Error)
}

/// Each finding once: a unit that is called in several places is looked at in each of them. What is found at a place
/// where the text itself has a fault follows from that.
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
    let mut seen = BTreeSet::new();
    let mut kept = findings;
    kept.retain(|finding| {
        !follows(finding) && seen.insert((finding.code, finding.span(), finding.message.clone()))
    });
    kept
}

/// Group 0 of the codes, errors only.
fn of_syntax(finding: &Finding) -> bool {
    finding.code.as_str().starts_with("RPI0") && finding.severity() == Severity::Error
}

fn overlap(a: Span, b: Span) -> bool {
    a.file == b.file && a.start < b.end && b.start < a.end
}
