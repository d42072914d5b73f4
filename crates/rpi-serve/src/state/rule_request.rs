//! Requests to make rules: resolves the names of commands, exports and results.

use std::collections::BTreeSet;

use rpi_image::{Scalar, Type};
use rpi_runtime::control::{CommandId, Condition, Fact, Rule};

use super::commands::Commands;
use super::parse_number;
use super::record::results;
use super::rules::RuleRecord;
use super::subscribers::Subscribers;
use super::types::{ApiError, RuleState};
use crate::condition::{Expr, FactExpr};
use crate::fair_share::Client;

/// Request of a client to make a rule: its condition, and the names of the commands that the rule stops, cancels and
/// starts.
pub(crate) struct RuleRequest<'a> {
    pub(crate) when: &'a Expr,
    pub(crate) stop: &'a [&'a str],
    pub(crate) cancel: &'a [&'a str],
    pub(crate) start: &'a [&'a str],
    /// Client that makes the rule.
    pub(crate) maker: Client,
    /// Whether a scheduled command that no rule can start any more becomes ready again instead of being unloaded.
    pub(crate) keep: bool,
}

/// Resolves the names in a request for a rule. Returns the rule for the core and its record for the server.
pub(super) fn build_rule(
    make: &RuleRequest<'_>,
    commands: &Commands,
) -> Result<(Rule, RuleRecord), ApiError> {
    // The sets to stop and cancel may have duplicates. A duplicate to start is an error, which the core reports.
    let set = |names: &[&str]| -> Result<Vec<CommandId>, ApiError> {
        let ids: Result<BTreeSet<CommandId>, ApiError> =
            names.iter().map(|name| commands.command_id(name)).collect();
        Ok(ids?.into_iter().collect())
    };
    let start: Result<Vec<CommandId>, ApiError> = make
        .start
        .iter()
        .map(|name| commands.command_id(name))
        .collect();
    let (stop, cancel, start) = (set(make.stop)?, set(make.cancel)?, start?);
    let rule = Rule::when(condition(make.when, commands)?);
    let mut rule = if make.keep { rule.keep_orphans() } else { rule };
    rule = stop.iter().copied().fold(rule, Rule::stop);
    rule = cancel.iter().copied().fold(rule, Rule::cancel);
    rule = start.iter().copied().fold(rule, Rule::start);
    let record = RuleRecord {
        state: RuleState::Active,
        client: make.maker,
        size: make.when.fact_count() + stop.len() + cancel.len() + start.len(),
        stop,
        cancel,
        start,
        watchers: Subscribers::default(),
    };
    Ok((rule, record))
}

fn condition(expr: &Expr, commands: &Commands) -> Result<Condition, ApiError> {
    Ok(match expr {
        Expr::True => Condition::always(),
        Expr::False => !Condition::always(),
        Expr::Not(inner) => !condition(inner, commands)?,
        Expr::And(a, b) => condition(a, commands)? & condition(b, commands)?,
        Expr::Or(a, b) => condition(a, commands)? | condition(b, commands)?,
        Expr::Fact(command, fact_expr) => Condition::from_fact(
            commands.command_id(command)?,
            fact(command, fact_expr, commands)?,
        ),
    })
}

fn fact(command: &str, fact_expr: &FactExpr, commands: &Commands) -> Result<Fact, ApiError> {
    let (_, record) = commands.find(command)?;
    let image = record.image.as_deref();
    let place = |what: &str, key: &str, found: Option<usize>| {
        let index = found.and_then(|k| u32::try_from(k).ok());
        index.ok_or_else(|| ApiError::Unknown(format!("{what} {key} of {command}")))
    };
    Ok(match fact_expr {
        FactExpr::Export(key) => {
            let exports = image.map_or(&[][..], |i| &i.exports);
            let found = exports.iter().position(|e| e.key == *key);
            let ty = found.map(|k| exports[k].value.ty);
            if let Some(ty) = ty.filter(|ty| *ty != Type::Scalar(Scalar::Bool)) {
                return Err(ApiError::Invalid(format!(
                    "expected a Boolean export, found {key} of {command} of type {ty}"
                )));
            }
            Fact::Export(place("export", key, found)?)
        }
        FactExpr::Result(name) => {
            let found = image.and_then(|i| results(i).iter().position(|r| r == name));
            Fact::Result(place("result", name, found)?)
        }
        FactExpr::Error(number) => Fact::Error(*number),
        FactExpr::Ended => Fact::Ended,
        FactExpr::Regular => Fact::Regular,
        FactExpr::Failed => Fact::Failed,
    })
}

/// Records the Boolean exports that end a command: if a rule stops a single command when an export of that command is
/// true, and does nothing else, the export is added to those that end the command.
pub(super) fn record_end_result(make: &RuleRequest<'_>, commands: &mut Commands) {
    let (Expr::Fact(command, FactExpr::Export(key)), [stop], [], []) =
        (make.when, make.stop, make.cancel, make.start)
    else {
        return;
    };
    let number = parse_number(stop, 'n').filter(|_| command == stop);
    if let Some(record) = number.and_then(|n| commands.get_mut(n)) {
        record.completion.add_end(key);
    }
}
