//! Finds the result of a net that means completion of its motion.
//!
//! When a successor takes over, the net cannot publish its results any more, but the reference system's client still
//! waits for the one that means completion. The client names the results that end a net, by rules that stop the net
//! when one of them is true, but not their meanings. The net itself shows it: the results "completed" and "cancelled"
//! have the same condition, except that one requires that the net was not cancelled and the other one that it was. An
//! error result has no such counterpart.

use std::collections::BTreeMap;
use std::time::Instant;

use rpi_image::{PortType, Role, Scalar, Value};
use rpi_net::passes::Conjunction;
use rpi_net::{Net, Node, NodeId, PortRef};
use rpi_runtime::control::{CommandId, CommandState};

use super::commands::Commands;
use super::event_log::EventLog;
use super::record::CommandRecord;
use super::types::Phase;

/// Condition of each Boolean export of a net: the conjunction of flows under which the export is true. The conditions
/// show which export reports the completion of the net's motion.
#[derive(Clone, PartialEq, Debug, Default)]
pub(crate) struct ResultConditions(BTreeMap<String, Conjunction>);

/// A conjunction as plain data: the required value of the cancel request, and each flow (node and port) with its value.
pub(crate) type PlainCondition = (Option<bool>, Vec<((u32, u8), bool)>);

/// Reason why the export that reports the completion of a command's motion cannot be determined.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum CompletionError {
    /// Several pairs of exports have the same condition apart from whether the command was cancelled.
    Ambiguous,
    /// No pair of exports has the same condition apart from whether the command was cancelled, and there is no single
    /// export that could report the completion.
    NotFound,
}

impl ResultConditions {
    /// Derives the conditions of the Boolean exports of a net. An export that is never true has no entry.
    pub(crate) fn from_net(net: &Net) -> ResultConditions {
        let exports = net.nodes.iter().filter(|n| n.desc().role == Role::Export);
        let reason = |node: &Node| {
            let key = node.params.iter().find_map(Value::as_str)?;
            let flow = node.inputs.first().filter(|_| is_boolean(node))?;
            Some((key.to_owned(), Conjunction::from_flow(net, flow)?))
        };
        ResultConditions(exports.filter_map(reason).collect())
    }

    /// Returns the conditions as plain data, by the keys of the exports.
    pub(crate) fn to_plain(&self) -> Vec<(String, PlainCondition)> {
        let plain = |reason: &Conjunction| {
            let flows = reason.flows.iter();
            let flows = flows.map(|(flow, value)| ((flow.node.0, flow.port), *value));
            (reason.cancelled, flows.collect())
        };
        let conditions = self.0.iter();
        conditions
            .map(|(key, reason)| (key.clone(), plain(reason)))
            .collect()
    }

    /// Creates the conditions from plain data.
    pub(crate) fn from_plain(conditions: Vec<(String, PlainCondition)>) -> ResultConditions {
        let flow = |((node, port), value)| {
            let node = NodeId(node);
            (PortRef { node, port }, value)
        };
        let reason = |(cancelled, flows): PlainCondition| Conjunction {
            cancelled,
            flows: flows.into_iter().map(flow).collect(),
        };
        let conditions = conditions.into_iter();
        ResultConditions(
            conditions
                .map(|(key, plain)| (key, reason(plain)))
                .collect(),
        )
    }

    /// Returns the key among `results` of the export that reports the completion of the motion, or, if `cancelled`, the
    /// completion of the cancellation.
    ///
    /// # Errors
    /// If the result cannot be determined.
    pub(super) fn completion<'a>(
        &self,
        results: &[&'a str],
        cancelled: bool,
    ) -> Result<&'a str, CompletionError> {
        let mut pairs = results.iter().flat_map(|a| {
            let twins = results.iter().filter(|b| self.are_counterparts(a, b));
            twins.map(move |b| if cancelled { *b } else { *a })
        });
        match (pairs.next(), pairs.next(), results) {
            (Some(only), None, _) => Ok(only),
            (Some(_), Some(_), _) => Err(CompletionError::Ambiguous),
            // A net without support for cancelling has no pair. Then a single result means completion, as an error
            // result never comes alone.
            (None, _, [only]) if self.0.get(*only).is_some_and(|r| r.cancelled.is_none()) => {
                Ok(only)
            }
            (None, _, _) => Err(CompletionError::NotFound),
        }
    }

    /// Returns whether two exports have the same condition, except that the first one requires that the net was not
    /// cancelled and the second one that it was.
    fn are_counterparts(&self, completed: &str, cancelled: &str) -> bool {
        let (Some(a), Some(b)) = (self.0.get(completed), self.0.get(cancelled)) else {
            return false;
        };
        (a.cancelled, b.cancelled) == (Some(false), Some(true)) && a.flows == b.flows
    }
}

fn is_boolean(node: &Node) -> bool {
    let port = node.desc().inputs.first();
    port.is_some_and(|p| matches!(p.ty, PortType::Scalar(Scalar::Bool)))
}

/// Data from which the export that reports the completion of a command's motion is determined, when a successor takes
/// over before the command itself can set the export.
#[derive(Default)]
pub(super) struct Completion {
    /// Conditions under which each Boolean export of the command can be true.
    pub(super) reasons: ResultConditions,
    /// Keys of the Boolean exports that end the command: its client has made rules that stop the command when one of
    /// them is true.
    end_results: Vec<String>,
    /// Key of the export that is reported as true because a successor has taken over; `None` before the takeover, or if
    /// the export cannot be determined.
    completion_result: Option<String>,
}

impl Completion {
    /// Adds the key of a Boolean export that ends the command, unless it is known already.
    pub(super) fn add_end(&mut self, key: &str) {
        if !self.end_results.iter().any(|known| known == key) {
            self.end_results.push(key.to_owned());
        }
    }

    /// Determines after a takeover the key of the export that reports the completion. `values` are the current exports
    /// (key and literal). Returns `None` if no export ends the command, or if one of those that end the command is true
    /// anyway.
    fn resolve_completion(
        &mut self,
        cancelled: bool,
        values: &[(String, String)],
    ) -> Option<Result<String, CompletionError>> {
        let up =
            |(key, value): &(String, String)| value == "true" && self.end_results.contains(key);
        if self.end_results.is_empty() || values.iter().any(up) {
            return None;
        }
        let results: Vec<&str> = self.end_results.iter().map(String::as_str).collect();
        let found = self.reasons.completion(&results, cancelled);
        let found = found.map(str::to_owned);
        self.completion_result = found.as_ref().ok().cloned();
        Some(found)
    }
}

/// Handles a rule that has fired: determines, for each command that the rule stopped in favour of a successor, the
/// export that reports the command's completion, and logs the key.
pub(super) fn record_takeover(commands: &mut Commands, stopped: &[CommandId], log: &mut EventLog) {
    for command in stopped {
        let Some(record) = commands.record_of(*command) else {
            continue;
        };
        let how = match complete(record) {
            Some(Ok(key)) => format!("and is reported as complete ({key})"),
            Some(Err(why)) => format!("and is not reported as complete: {why}"),
            None => continue,
        };
        log.write(format_args!("{} was taken over, {how}", record.title));
    }
}

fn complete(record: &mut CommandRecord) -> Option<Result<String, CompletionError>> {
    let cancelled = match record.status.phase {
        Phase::Core(CommandState::Running) => false,
        Phase::Core(CommandState::Cancelling) => true,
        _ => return None,
    };
    let values = record.values();
    record.completion.resolve_completion(cancelled, &values)
}

/// Reports the completion of the stopped commands to their subscribers: the determined export is reported first as
/// true, then as false again, so that a rule that is made later does not see it as true.
pub(super) fn report_completions(commands: &mut Commands, stopped: &[CommandId]) {
    for value in [true, false] {
        for command in stopped {
            let Some(record) = commands.record_of(*command) else {
                continue;
            };
            if let Some(key) = record.completion.completion_result.clone() {
                record.publish_now();
                record.subscriptions.report_flag(&key, value);
            }
        }
    }
}

/// Returns whether the firing of a rule must not be reported yet, because values of a command that the rule stopped are
/// still withheld from a subscriber.
pub(super) fn must_delay_report(commands: &Commands, stopped: &[CommandId]) -> bool {
    let now = Instant::now();
    stopped.iter().any(|command| {
        let found = commands.find_by_id(*command);
        found.is_some_and(|(_, record)| {
            record.completion.completion_result.is_some()
                && record.subscriptions.is_withheld_from_any(now)
        })
    })
}

impl std::fmt::Display for CompletionError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            CompletionError::Ambiguous => "several of its results differ only in the cancel flag",
            CompletionError::NotFound => "none of its results has a counterpart for cancellation",
        })
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicBool;

    use super::*;
    use crate::compile::{
        CompileKind, CompileOutput, CompileRequest, Compiler, CompilerSettings, Language, Source,
    };

    /// Analyses a net with these exports and the flows `c` (cancelled), `n` (not cancelled), `d` and `e` (inputs).
    fn reasons(exports: &[(&str, &str)]) -> ResultConditions {
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
        let request = CompileRequest {
            kind: CompileKind::Command,
            source: Source {
                language: Language::Rpinet,
                text: (text + "}").into(),
                command: None,
                arm_axes: None,
                watch: Vec::new(),
            },
            period_ns: 1_000_000,
            tick_ns: 1_000_000,
        };
        let compiler = Compiler::new(&CompilerSettings::InProcess);
        match compiler.compile(&request, None, &AtomicBool::default()) {
            Ok(CompileOutput::Command(command)) => command.reasons,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn completed_is_what_has_the_cancel_as_its_twin() {
        let motion = reasons(&[
            ("_1", "cd.outValue"),
            ("_2", "ne.outValue"),
            ("_3", "nd.outValue"),
            ("_4", "e.outValue"),
        ]);
        // `_2` is for a takeover and ends the net by no rule. `_4` is an error.
        let results = ["_4", "_3", "_1"];
        assert_eq!(motion.completion(&results, false), Ok("_3"));
        assert_eq!(motion.completion(&results, true), Ok("_1"));
        assert_eq!(
            motion.completion(&["_2", "_4", "_1"], false),
            Err(CompletionError::NotFound)
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
            Err(CompletionError::Ambiguous)
        );
        assert_eq!(two.completion(&[], false), Err(CompletionError::NotFound));
        assert_eq!(
            two.completion(&["other"], false),
            Err(CompletionError::NotFound)
        );
    }

    #[test]
    fn a_result_that_stands_alone_is_the_completion_unless_it_is_for_a_cancel() {
        let plain = reasons(&[
            ("done", "d.outValue"),
            ("cancelled", "c.outCancel"),
            ("error", "e.outValue"),
        ]);
        assert_eq!(plain.completion(&["done"], false), Ok("done"));
        assert_eq!(
            plain.completion(&["cancelled"], false),
            Err(CompletionError::NotFound)
        );
        assert_eq!(
            plain.completion(&["done", "error"], false),
            Err(CompletionError::NotFound)
        );
    }
}
