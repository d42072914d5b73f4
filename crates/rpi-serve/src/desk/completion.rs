//! Which of a net's results says that its way was gone to the end.
//!
//! The reference system's client waits for that result even if a successor took over and the net could not publish it any
//! more. It names the results that end a net, by rules which stop the net when one of them is up, but does not say which of
//! them means what. The net shows it: completed and cancelled are true for the same reasons, one while nobody has asked the
//! net to end, the other once somebody has. An error has no such twin.

use std::collections::BTreeMap;
use std::time::Instant;

use rpi_host::control::{CommandId, RuleId, State};
use rpi_image::{PortType, Role, Scalar, Value};
use rpi_net::passes::Conjunction;
use rpi_net::{Net, Node};

use super::{Desk, Phase, Record};

/// What is known of the Boolean exports of a net.
#[derive(Clone, Debug, Default)]
pub(crate) struct Reasons(BTreeMap<String, Conjunction>);

/// What nothing can be said about, and why.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Unclear {
    /// Several pairs of results differ in nothing but the cancel.
    Several,
    /// None do, and there is more than one result, or it is the one for a cancel.
    None,
}

impl Reasons {
    /// The reasons for which each Boolean that a net exports can be true; those that never are have none.
    pub(super) fn of(net: &Net) -> Reasons {
        let exports = net.nodes.iter().filter(|n| n.desc().role == Role::Export);
        let reason = |node: &Node| {
            let key = node.params.iter().find_map(Value::as_str)?;
            let flow = node.inputs.first().filter(|_| is_boolean(node))?;
            Some((key.to_owned(), Conjunction::of(net, flow)?))
        };
        Reasons(exports.filter_map(reason).collect())
    }

    /// The one of the results which end a net by which it says that its way is gone: to its end, or to where it has come to
    /// rest after it was asked to end.
    ///
    /// # Errors
    /// If it cannot be told from the others.
    pub(super) fn completion<'a>(
        &self,
        results: &[&'a str],
        cancelled: bool,
    ) -> Result<&'a str, Unclear> {
        let mut pairs = results.iter().flat_map(|a| {
            let twins = results.iter().filter(|b| self.are_twins(a, b));
            twins.map(move |b| if cancelled { *b } else { *a })
        });
        match (pairs.next(), pairs.next(), results) {
            (Some(only), None, _) => Ok(only),
            (Some(_), Some(_), _) => Err(Unclear::Several),
            // Without support for a cancel there is no twin; an error never stands alone.
            (None, _, [only]) if self.0.get(*only).is_some_and(|r| r.cancelled.is_none()) => {
                Ok(only)
            }
            (None, _, _) => Err(Unclear::None),
        }
    }

    /// Whether two results are true for the same reasons, the first while the net was not asked to end, the second after.
    fn are_twins(&self, completed: &str, cancelled: &str) -> bool {
        let (Some(a), Some(b)) = (self.0.get(completed), self.0.get(cancelled)) else {
            return false;
        };
        (a.cancelled, b.cancelled) == (Some(false), Some(true)) && a.flows == b.flows
    }
}

fn is_boolean(node: &Node) -> bool {
    let port = node.desc().inputs.first();
    port.is_some_and(|p| matches!(p.ty, PortType::One(Scalar::Bool)))
}

impl Desk {
    /// A rule has fired. Looks up which of the results of what it has stopped in favour of a successor says that this is
    /// complete.
    pub(super) fn note_takeover(&mut self, rule: RuleId) {
        for command in self.stopped_by(rule) {
            let Some(record) = self.record_of(command) else {
                continue;
            };
            let how = match record.complete() {
                Some(Ok(key)) => format!("and is told to be complete ({key})"),
                Some(Err(why)) => format!("and is not told to be complete: {why}"),
                None => continue,
            };
            let line = format!("{} was taken over, {how}", record.title);
            self.journal.note(format_args!("{line}"));
        }
    }

    /// Tells these results: that all of them are up, then that they are what they were. Whoever waits for one has seen it;
    /// whoever looks later does not take it for a result that could still be followed.
    pub(super) fn tell_completions(&mut self, rule: RuleId) {
        let stopped = self.stopped_by(rule);
        for value in [true, false] {
            for command in &stopped {
                let Some(record) = self.record_of(*command) else {
                    continue;
                };
                if let Some(key) = record.completed.clone() {
                    record.publish_now();
                    record.tell_flag(&key, value);
                }
            }
        }
    }

    /// Whether nobody can be told yet that a rule has fired: what it has stopped is not yet known to run.
    pub(super) fn is_early(&self, rule: RuleId) -> bool {
        let now = Instant::now();
        self.stopped_by(rule).iter().any(|command| {
            let number = self.by_id.get(command);
            let record = number.and_then(|n| self.commands.get(n));
            record.is_some_and(|r| r.completed.is_some() && r.is_held_back(now))
        })
    }

    /// What a rule stops if it also starts something.
    fn stopped_by(&self, rule: RuleId) -> Vec<CommandId> {
        let rule = self.rules.get(&rule).filter(|r| r.takes_over());
        rule.map(|r| r.stop.clone()).unwrap_or_default()
    }
}

impl Record {
    /// Another has taken over: looks up by which result that is told, unless one that ends it is up anyway.
    fn complete(&mut self) -> Option<Result<String, Unclear>> {
        let cancelled = match self.status.phase {
            Phase::Is(State::Running) => false,
            Phase::Is(State::Cancelling) => true,
            _ => return None,
        };
        let up = |(key, value): &(String, String)| value == "true" && self.ends_by.contains(key);
        if self.ends_by.is_empty() || self.values().iter().any(up) {
            return None;
        }
        let results: Vec<&str> = self.ends_by.iter().map(String::as_str).collect();
        let found = self
            .reasons
            .completion(&results, cancelled)
            .map(str::to_owned);
        self.completed = found.as_ref().ok().cloned();
        Some(found)
    }
}

impl std::fmt::Display for Unclear {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Unclear::Several => "several of its results differ in nothing but the cancel",
            Unclear::None => "none of its results has one for a cancel beside it",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::loader::{Language, Origin};
    use super::*;

    /// Exports of a net with the flows `c` (cancelled), `n` (not), `d` and `e` (from outside).
    fn reasons(exports: &[(&str, &str)]) -> Reasons {
        let mut text = "{c=Cancel(),n=Core::BooleanNot(inValue=c.outCancel),\
            d=Core::BooleanNetcommIn(Key='d'),e=Core::BooleanNetcommIn(Key='e'),\
            nd=Core::BooleanAnd(inFirst=n.outValue,inSecond=d.outValue),\
            cd=Core::BooleanAnd(inFirst=d.outValue,inSecond=c.outCancel),\
            ne=Core::BooleanAnd(inFirst=n.outValue,inSecond=e.outValue),\
            ce=Core::BooleanAnd(inFirst=c.outCancel,inSecond=e.outValue)"
            .to_owned();
        for (key, flow) in exports {
            text += &format!(",x{key}=Core::BooleanNetcommOut(inValue={flow},Key='{key}')");
        }
        let origin = Origin {
            language: Language::Rpinet,
            text: (text + "}").into(),
            command: None,
        };
        origin.net(|net| Ok(Reasons::of(net))).unwrap()
    }

    #[test]
    fn completed_is_what_has_the_cancel_as_its_twin() {
        let motion = reasons(&[
            ("_1", "cd.outValue"),
            ("_2", "ne.outValue"),
            ("_3", "nd.outValue"),
            ("_4", "e.outValue"),
        ]);
        // The second is for a takeover: no rule ends the net by it. The fourth is an error.
        let results = ["_4", "_3", "_1"];
        assert_eq!(motion.completion(&results, false), Ok("_3"));
        assert_eq!(motion.completion(&results, true), Ok("_1"));
        assert_eq!(
            motion.completion(&["_2", "_4", "_1"], false),
            Err(Unclear::None)
        );
    }

    #[test]
    fn what_cannot_be_told_apart_is_not_told() {
        let two = reasons(&[
            ("a", "nd.outValue"),
            ("b", "cd.outValue"),
            ("c", "ne.outValue"),
            ("d", "ce.outValue"),
        ]);
        assert_eq!(
            two.completion(&["a", "b", "c", "d"], false),
            Err(Unclear::Several)
        );
        assert_eq!(two.completion(&[], false), Err(Unclear::None));
        assert_eq!(two.completion(&["other"], false), Err(Unclear::None));
    }

    #[test]
    fn a_result_that_stands_alone_is_the_completion_unless_it_is_for_a_cancel() {
        let plain = reasons(&[
            ("done", "d.outValue"),
            ("cancelled", "c.outCancel"),
            ("error", "e.outValue"),
        ]);
        assert_eq!(plain.completion(&["done"], false), Ok("done"));
        assert_eq!(plain.completion(&["cancelled"], false), Err(Unclear::None));
        assert_eq!(
            plain.completion(&["done", "error"], false),
            Err(Unclear::None)
        );
    }
}
