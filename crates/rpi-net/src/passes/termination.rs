//! Termination check (M10): some `finish` must be reachable, and every result should be. For a test, an unreachable
//! `finish` is reported at run time.

use super::fact_prover::{EffortBudget, ProofContext, never_true_without};
use crate::net::{FragmentId, Input, Net, PortRef, ResultKind, ResultPort, Termination};
use rpi_diag::{Code, Diagnostic};
use rpi_image::{CommandFlow, Role};

/// Checks that a program can end with each of its results, and returns diagnostics about results that it cannot end
/// with.
///
/// Imported nets are not checked. They may run until they are stopped from outside.
pub(crate) fn check(background: ProofContext<'_>) -> Vec<Diagnostic> {
    let Termination::Results(results) = &background.net.termination else {
        return Vec::new();
    };
    let proofs = Proofs {
        background,
        effort: EffortBudget::new(EFFORT),
    };
    let dead = results.iter().map(|r| proofs.never(&r.condition));
    let dead: Vec<bool> = dead.collect();
    let those = |wanted: bool| {
        let all = results.iter().zip(&dead);
        all.filter(move |(_, dead)| **dead == wanted)
            .map(|(r, _)| r)
    };
    let finishes = |r: &&ResultPort| r.kind == ResultKind::Finish;
    let all = results.iter().filter(finishes).count();
    let is_endless = !background.net.is_test && those(true).filter(finishes).count() == all;
    let takeover = takeover(background.net);
    let waits = |r: &ResultPort| proofs.needs_successor(r, &takeover);
    if !is_endless && !takeover.is_empty() && those(false).filter(finishes).all(waits) {
        let first = those(false).find(finishes);
        return first
            .map(|r| waits_for_successor(background.net, r))
            .into_iter()
            .collect();
    }
    // Unreachable `finish` results are reported together, as one error.
    let others = those(true).filter(|r| !(is_endless && finishes(r)));
    let mut diagnostics: Vec<Diagnostic> = others.map(unreachable).collect();
    let alive: Vec<usize> = (0..results.len()).filter(|k| !dead[*k]).collect();
    let order = Precedence::new(results);
    let before = |k: &usize| Some((&results[*k], order.preceded_by(&proofs, *k)?));
    let hidden: Vec<_> = alive.iter().filter_map(before).collect();
    let hidden_finishes = hidden.iter().filter(|(r, _)| finishes(r)).count();
    let share_diagnostic = !is_endless
        && !background.net.is_test
        && hidden_finishes == those(false).filter(finishes).count();
    if is_endless {
        diagnostics.push(endless(background, results, all));
    } else if share_diagnostic {
        // Again, all `finish` results share one diagnostic.
        let first = hidden.iter().find(|(r, _)| finishes(r));
        diagnostics.extend(first.map(|(r, first)| always_before(background.net, r, first)));
    }
    let apart = hidden
        .iter()
        .filter(|(r, _)| !(share_diagnostic && finishes(r)));
    diagnostics.extend(apart.map(|(r, first)| hidden_result(r, first)));
    diagnostics
}

/// Returns one line of text on the check of the results. `faults` is the number of diagnostics.
pub(crate) fn summary(net: &Net, faults: usize) -> String {
    match &net.termination {
        Termination::Results(results) if faults == 0 => {
            let names: Vec<&str> = results.iter().map(|r| r.name.as_str()).collect();
            format!(
                "{} results, all reachable: {}",
                names.len(),
                names.join(", ")
            )
        }
        Termination::Results(results) => format!("{} results, {faults} diagnostics", results.len()),
        Termination::Ports { .. } => "no results".to_owned(),
    }
}

/// Maximum number of node visits in all proofs about the results of one command. Bounds the compile time.
const EFFORT: u32 = 300_000;

/// Prover of statements about the conditions of results, with a limited effort.
struct Proofs<'a> {
    background: ProofContext<'a>,
    effort: EffortBudget,
}

impl Proofs<'_> {
    fn never(&self, condition: &Input) -> bool {
        match condition {
            Input::Unconnected => true,
            Input::Const(value) => value.as_bool() == Some(false),
            Input::Port(port) => self.never_without(*port, &[]),
        }
    }

    /// Returns whether it is proved that the flow `condition` is never true in a cycle in which all flows `others` are
    /// false.
    fn never_without(&self, condition: PortRef, others: &[PortRef]) -> bool {
        let seen = (FragmentId::ROOT, condition);
        never_true_without(self.background, &self.effort, seen, others)
    }

    /// Returns whether it is proved that a result happens only if a successor takes over. `takeover` are the flows that
    /// announce a successor.
    fn needs_successor(&self, result: &ResultPort, takeover: &[PortRef]) -> bool {
        let condition = result.condition.port();
        condition.is_some_and(|condition| self.never_without(condition, takeover))
    }
}

/// Maximum number of results of each kind that are tested for precedence over others. Bounds the compile time.
const PRECEDENCE_LIMIT: usize = 8;

/// Results that may take precedence over others, as indices by kind. A `yield` never takes precedence, since it needs a
/// successor.
struct Precedence<'r> {
    results: &'r [ResultPort],
    fails: Vec<usize>,
    finishes: Vec<usize>,
}

impl<'r> Precedence<'r> {
    fn new(results: &'r [ResultPort]) -> Precedence<'r> {
        let of = |kind| {
            let those = (0..results.len()).filter(|k| results[*k].kind == kind);
            those.take(PRECEDENCE_LIMIT).collect()
        };
        Precedence {
            results,
            fails: of(ResultKind::Fail),
            finishes: of(ResultKind::Finish),
        }
    }

    /// Returns the first result that takes precedence whenever the condition of the result with the index `at` is true;
    /// `None` if there is none.
    fn preceded_by(&self, proofs: &Proofs<'_>, at: usize) -> Option<&'r ResultPort> {
        let own = &self.results[at];
        let is_fail = own.kind == ResultKind::Fail;
        let fails = self
            .fails
            .iter()
            .filter(|k| **k < at || (**k > at && !is_fail));
        let finishes = self.finishes.iter().filter(|k| **k < at && !is_fail);
        let mut others = fails.chain(finishes).map(|k| &self.results[*k]);
        others.find(|other| match (&other.condition, &own.condition) {
            (Input::Const(value), _) => value.as_bool() == Some(true),
            (Input::Port(other), Input::Port(own)) => proofs.never_without(*own, &[*other]),
            _ => false,
        })
    }
}

fn hidden_result(result: &ResultPort, first: &ResultPort) -> Diagnostic {
    let message = format!("result `{}` can never happen", result.name);
    let diagnostic = Diagnostic::new(Code::RPI6103, message);
    precedence_labels(diagnostic, result, first, &result.name)
}

/// Returns the diagnostic for a command in which another result takes precedence over every `finish`.
fn always_before(net: &Net, finish: &ResultPort, first: &ResultPort) -> Diagnostic {
    let message = format!("command `{}` can never finish", net.name);
    let diagnostic = Diagnostic::new(Code::RPI6102, message);
    precedence_labels(diagnostic, finish, first, &first.name)
}

/// Adds the labels and the help for a `result` that `first` precedes; `redundant` is the one that may be deleted.
fn precedence_labels(
    diagnostic: Diagnostic,
    result: &ResultPort,
    first: &ResultPort,
    redundant: &str,
) -> Diagnostic {
    diagnostic
        .primary(
            result.origin.span,
            format!("whenever this is true, `{}` takes precedence", first.name),
        )
        .secondary(first.origin.span, "this is also true then")
        .note("`fail` comes first, then the other results in text order")
        .help(format!(
            "narrow the condition of `{}`: it must be false in some cycle in which that of `{}` is true; or delete `{redundant}`",
            first.name, result.name
        ))
}

/// Returns the flows that are true if a successor takes over.
fn takeover(net: &Net) -> Vec<PortRef> {
    let is_takeover = |id: &_| net.node(*id).desc().role == Role::Flow(CommandFlow::Takeover);
    let takeovers = net.node_ids().filter(is_takeover);
    takeovers.map(|node| PortRef { node, port: 0 }).collect()
}

fn waits_for_successor(net: &Net, finish: &ResultPort) -> Diagnostic {
    let name = &net.name;
    let message = format!("command `{name}` cannot finish without a successor");
    Diagnostic::new(Code::RPI6102, message)
        .primary(finish.origin.span, "this is true only with `takeover`")
        .help("a command must be able to end even if no other follows: add a `finish` whose condition does not need `takeover`")
}

/// Returns whether the diagnostic reports an unreachable result. For a command with several nets, the result must be
/// unreachable in each net.
pub fn is_unreachable(diagnostic: &Diagnostic) -> bool {
    diagnostic.code == Code::RPI6103
}

/// Returns whether the diagnostic reports a command that can never finish. This is an error in each net of a command,
/// independently of its other nets.
pub fn is_endless(diagnostic: &Diagnostic) -> bool {
    diagnostic.code == Code::RPI6102
}

fn unreachable(result: &ResultPort) -> Diagnostic {
    let message = format!("result `{}` can never happen", result.name);
    Diagnostic::new(Code::RPI6103, message)
        .primary(result.origin.span, "this condition is never true")
        .help("correct the condition, or delete the result")
}

fn endless(background: ProofContext<'_>, results: &[ResultPort], finishes: usize) -> Diagnostic {
    let name = &background.net.name;
    let message = format!("command `{name}` can never finish");
    let diagnostic = Diagnostic::new(Code::RPI6102, message);
    let place = results
        .first()
        .map_or(background.net.fragment(FragmentId::ROOT).origin.span, |r| {
            r.origin.span
        });
    let (what, help) = match finishes {
        0 => (
            "there is no `finish` among its results",
            "a command must be able to end even if no other follows: add a result such as `finish done when ...;`",
        ),
        _ => (
            "no `finish` condition can ever be true",
            "correct the condition, or add a `finish` that can happen: a command must be able to end even if no other follows",
        ),
    };
    diagnostic.primary(place, what).help(help)
}
