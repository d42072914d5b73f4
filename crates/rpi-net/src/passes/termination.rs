//! Termination check (M10): some `finish` must be reachable, and every result should be. For a test, an unreachable
//! `finish` is reported at run time.

use super::fact_prover::{EffortBudget, ProofContext, never_true_without};
use crate::net::{FragmentId, Input, Net, PortRef, ResultKind, ResultPort, Termination};
use rpi_diag::{Code, Diagnostic};
use rpi_image::{CommandFlow, Role};

/// Checks when a program can end. Returns diagnostics about its results. Imported nets are not checked: they may run
/// until they are stopped from outside.
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

/// Summary of the termination check.
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

/// Maximal number of nodes that all proofs about the results of one command visit together.
const EFFORT: u32 = 300_000;

/// Proofs about the conditions of results.
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

    /// Whether it is proved that a condition is false whenever all `others` are false.
    fn never_without(&self, condition: PortRef, others: &[PortRef]) -> bool {
        let seen = (FragmentId::ROOT, condition);
        never_true_without(self.background, &self.effort, seen, others)
    }

    /// Whether a result happens only if a successor takes over (M10.4).
    fn needs_successor(&self, result: &ResultPort, takeover: &[PortRef]) -> bool {
        let condition = result.condition.port();
        condition.is_some_and(|condition| self.never_without(condition, takeover))
    }
}

/// Maximal number of results of one kind that are tested for precedence over others.
const PRECEDENCE_LIMIT: usize = 8;

/// Results that may take precedence over others (M10.1). A `yield` is not among them, since it needs a successor.
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

    /// First result that takes precedence over result `at` whenever the condition of `at` is true; `None` if there is
    /// none.
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
    precedence_labels(Diagnostic::new(Code::RPI6103, message), result, first)
}

/// Diagnostic for a command whose every `finish` is preceded by another result.
fn always_before(net: &Net, finish: &ResultPort, first: &ResultPort) -> Diagnostic {
    let message = format!("command `{}` can never finish", net.name);
    precedence_labels(Diagnostic::new(Code::RPI6102, message), finish, first)
}

fn precedence_labels(
    diagnostic: Diagnostic,
    result: &ResultPort,
    first: &ResultPort,
) -> Diagnostic {
    diagnostic
        .primary(
            result.origin.span,
            format!("whenever this is true, `{}` takes precedence", first.name),
        )
        .secondary(first.origin.span, "this is also true then")
        .note("`fail` comes first, then the other results in text order")
        .help(format!(
            "exclude the other result: add `and not` with the condition of `{}`, or delete this result",
            first.name
        ))
}

/// Flows that say whether a successor takes over.
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
        .help("a command must be able to end without a successor: add `finish r when c`")
}

/// Whether the diagnostic says that a result is unreachable. For a command this holds only if it holds for each of its
/// nets.
pub fn is_unreachable(diagnostic: &Diagnostic) -> bool {
    diagnostic.code == Code::RPI6103
}

/// Whether the diagnostic says that a command can never finish. This is an error in each of its nets, independently of
/// the others.
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
    let what = match finishes {
        0 => "there is no `finish` among its results",
        _ => "no `finish` condition can ever be true",
    };
    diagnostic
        .primary(place, what)
        .help("a command must be able to end without a successor: add `finish r when c`")
}
