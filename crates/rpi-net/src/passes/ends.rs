//! Whether a command can end (M10): some `finish` must be reachable, and every result should be. A test is told when it
//! runs that it does not finish.

use super::proof::{Background, never_true};
use crate::net::{Driver, FragmentId, Input, Net, ResultKind, ResultPort};
use rpi_diag::{Code, Finding};

/// What is wrong with the ends of a program. Imported nets may run until they are stopped from outside.
pub(crate) fn check(background: Background<'_>) -> Vec<Finding> {
    let Driver::Results(results) = &background.net.driver else {
        return Vec::new();
    };
    let is_dead = |r: &&ResultPort| never(background, &r.condition);
    let dead: Vec<&ResultPort> = results.iter().filter(is_dead).collect();
    let finishes = |r: &&ResultPort| r.kind == ResultKind::Finish;
    let all = results.iter().filter(finishes).count();
    let is_endless = !background.net.is_test && dead.iter().filter(|r| finishes(r)).count() == all;
    // That no `finish` can happen is one fault and has one message.
    let others = dead.iter().filter(|r| !(is_endless && finishes(r)));
    let mut findings: Vec<Finding> = others.map(|r| unreachable(r)).collect();
    if is_endless {
        findings.push(endless(background, results, all));
    }
    findings
}

/// What was found out about the ends, in words.
pub(crate) fn told(net: &Net, faults: usize) -> String {
    match &net.driver {
        Driver::Results(results) if faults == 0 => {
            let names: Vec<&str> = results.iter().map(|r| r.name.as_str()).collect();
            format!(
                "{} results, each can happen: {}",
                names.len(),
                names.join(", ")
            )
        }
        Driver::Results(results) => format!("{} results, {faults} faults", results.len()),
        Driver::Ports { .. } => "it does not end by results".to_owned(),
    }
}

fn never(background: Background<'_>, condition: &Input) -> bool {
    match condition {
        Input::Open => true,
        Input::Const(value) => value.as_bool() == Some(false),
        Input::Port(port) => never_true(background, FragmentId::ROOT, *port),
    }
}

/// Whether it is told that a result can never happen: true of a command only if it is of each of its nets.
pub fn is_unreachable(finding: &Finding) -> bool {
    finding.code == Code::RPI6103
}

/// Whether it is told that a command can never finish: an error of each of its nets, whatever the others do.
pub fn is_endless(finding: &Finding) -> bool {
    finding.code == Code::RPI6102
}

fn unreachable(result: &ResultPort) -> Finding {
    let message = format!("result `{}` can never happen", result.name);
    Finding::new(Code::RPI6103, message)
        .at(result.origin.span, "this condition is never true")
        .help("correct the condition, or delete the result")
}

fn endless(background: Background<'_>, results: &[ResultPort], finishes: usize) -> Finding {
    let name = &background.net.name;
    let message = format!("command `{name}` can never finish");
    let finding = Finding::new(Code::RPI6102, message);
    let place = results
        .first()
        .map_or(background.net.fragment(FragmentId::ROOT).origin.span, |r| {
            r.origin.span
        });
    let what = match finishes {
        0 => "there is no `finish` among its results",
        _ => "the condition of no `finish` can be true",
    };
    finding
        .at(place, what)
        .help("a command must be able to end without a successor: add `finish r when c`")
}
