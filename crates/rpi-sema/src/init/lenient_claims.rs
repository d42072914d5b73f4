//! Warnings for claims in Lustre that read an uninitialised `pre`. Other tools take an arbitrary value there, so the
//! program is accepted with a warning.

use crate::init::phases::PHASES;
use crate::init::rules::TransferRule;
use crate::init::solve::Solution;
use rpi_diag::{Code, Diagnostic, Quote, Span};
use rpi_net::{FragmentId, Net, NodeId, PortRef};
use std::collections::BTreeSet;

/// Returns the ports with the conditions of claims in Lustre, each with the fragment of the claim. These conditions may
/// be undefined in the first cycle.
pub(super) fn lenient_claims(net: &Net) -> impl Iterator<Item = (PortRef, FragmentId)> + '_ {
    let lenient = net.claims.iter().filter(|claim| !claim.is_strict);
    let keys: BTreeSet<&str> = lenient.map(|claim| claim.key.as_str()).collect();
    let exports = net.exports.iter();
    let exports = exports.filter(move |export| keys.contains(export.key.as_str()));
    exports.map(|export| (export.source, net.node(export.source.node).fragment))
}

/// Returns one warning for each `pre` that claims in Lustre read before it is initialised. `reported` are delays that
/// have been reported because of other reads, and `given` are conditions that are taken as true.
pub(super) fn diagnostics(
    net: &Net,
    rules: &[TransferRule],
    reported: &[NodeId],
    given: &[PortRef],
) -> Vec<Diagnostic> {
    if net.claims.iter().all(|claim| claim.is_strict) {
        return Vec::new();
    }
    let mut rules = rules.to_vec();
    for delay in reported {
        rules[delay.index()] = TransferRule::OptionalDelay;
    }
    let solution = Solution::new(net, rules, given);
    let mut places: BTreeSet<Span> = BTreeSet::new();
    for (port, from) in lenient_claims(net) {
        let roots = (0..PHASES).filter_map(|phase| {
            crate::init::uninitialised_root(&solution.value_for(port, from, phase).value)
        });
        places.extend(roots.map(|root| net.node(root).origin.span));
    }
    let diagnostic = |place: Span| {
        Diagnostic::new(
            Code::RPI5003,
            "a claim reads a `pre` that has no value in the first cycle",
        )
        .primary(
            place,
            "RPI takes 0 or false there; other tools take an arbitrary value",
        )
        .help(format!(
            "write the value for the first cycle before `->`: `(... -> {})`; or begin the condition by `true ->`",
            Quote::text(place)
        ))
    };
    places.into_iter().map(diagnostic).collect()
}
