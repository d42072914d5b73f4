//! Programs: from parsed modules to nets.

use std::collections::BTreeSet;
use std::path::Path;

use rpi_diag::{Code, Finding, Severity, SourceMap, Span};
use rpi_net::Net;
use rpi_sema::elab::{Argument, Elaborated, elaborate, elaborate_steps};
use rpi_sema::facts::{self, Facts};
use rpi_sema::program::Program;
use rpi_sema::typed::{Kind, UnitId, UnitKind};
use rpi_sema::{Checked, check};

use crate::files::Disk;
use crate::modules::Modules;
use crate::violation;

/// What became of a program.
pub(crate) struct Built {
    /// Its commands, in the order of the text; those that can be run.
    pub(crate) nets: Vec<Net>,
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
    let nets = match has_errors(&findings) {
        true => Vec::new(),
        false => nets(&program, &checked, &mut findings),
    };
    // What is only worth knowing about a library is not the business of who uses it.
    let own = texts.first().map_or(0, |root| root.files.len());
    findings.retain(|finding| {
        let file = finding.span().file.0 as usize;
        finding.severity() == Severity::Error || finding.span().is_none() || file < own
    });
    let findings = once(findings);
    (Built { nets, findings }, checked)
}

fn nets(program: &Program<'_>, checked: &Checked, findings: &mut Vec<Finding>) -> Vec<Net> {
    let (facts, mut found) = facts::find(&checked.units);
    findings.append(&mut found);
    if has_errors(findings) {
        return Vec::new();
    }
    let called = called(checked);
    let mut nets = Vec::new();
    for (_, unit) in &checked.runnable {
        let is_command = checked.unit(*unit).kind == UnitKind::Command;
        if !is_command && called.contains(unit) {
            continue;
        }
        let (net, runnable) = one(program, checked, &facts, *unit, findings);
        if is_command && runnable {
            nets.extend(net);
        }
    }
    nets
}

/// The net of one unit, if the passes find nothing against it, and whether all its parameters have values.
fn one(
    program: &Program<'_>,
    checked: &Checked,
    facts: &[Facts],
    unit: UnitId,
    findings: &mut Vec<Finding>,
) -> (Option<Net>, bool) {
    let args = arguments(program, checked, unit);
    let runnable = !args.contains(&Argument::Unknown);
    let Elaborated {
        net,
        findings: mut found,
        ..
    } = elaborate(&checked.units, facts, unit, &args);
    if found.is_empty() {
        match rpi_net::passes::analyse(net.clone(), |_| false) {
            Ok(analysis) if analysis.findings.iter().any(is_ring) => {
                found.extend(rings(checked, facts, unit, &args));
            }
            Ok(analysis) => {
                found.extend(analysis.findings);
                found.extend(rpi_sema::init::check(&net));
            }
            Err(violation) => found.push(violation::finding(&violation, checked.unit(unit).span)),
        }
    }
    let faulty = has_errors(&found);
    findings.append(&mut found);
    ((!faulty).then_some(net), runnable)
}

fn is_ring(finding: &Finding) -> bool {
    finding.code == Code::RPI4001
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
