//! Methods for rules.

use serde_json::json;

use super::connection::{Call, MethodResult, RpcConnection};
use crate::condition::{self, Expr, FactExpr};
use crate::state::RuleRequest;

/// JSON-RPC method `command.schedule`: schedules `command` as the successor of `after`. The successor starts at any
/// regular end of `after`, or only at the results that the request lists.
pub(super) fn schedule(front: &mut RpcConnection, call: &Call<'_>) -> MethodResult {
    let after = call.text("after")?;
    // Each fact has a copy of the name, which an unknown name could make as long as a message.
    front.state.lock().objects.commands.find(after)?;
    let results = call.texts("results")?;
    let regular = Expr::Fact(after.to_owned(), FactExpr::Regular);
    let results = results.iter().map(|r| FactExpr::Result((*r).to_owned()));
    let when = match Expr::any(after, results)? {
        Some(any) => Expr::And(regular.into(), any.into()),
        None => regular,
    };
    let make = RuleRequest {
        when: &when,
        stop: &[],
        cancel: &[],
        start: &[call.text("command")?],
        maker: front.client,
        keep: call.boolean("keep")?,
    };
    front.ensure_may_act(make.start)?;
    front
        .state
        .lock()
        .make_rule(&make, call.deferred_reply(|name| json!({"rule": name})));
    Ok(None)
}

/// JSON-RPC method `rule.make`: creates a rule, which stops, cancels and starts commands when its condition holds.
pub(super) fn make_rule(front: &mut RpcConnection, call: &Call<'_>) -> MethodResult {
    let when = condition::parse(call.text("when")?)?;
    let make = RuleRequest {
        when: &when,
        stop: &call.texts("stop")?,
        cancel: &call.texts("cancel")?,
        start: &call.texts("start")?,
        maker: front.client,
        keep: call.boolean("keep")?,
    };
    front.state.lock().rules.ensure_rule_size(&make)?;
    [make.stop, make.cancel, make.start]
        .iter()
        .try_for_each(|names| front.ensure_may_act(names))?;
    front
        .state
        .lock()
        .make_rule(&make, call.deferred_reply(|name| json!({"rule": name})));
    Ok(None)
}

/// JSON-RPC method `rule.withdraw`: removes a rule that has not fired.
pub(super) fn withdraw(front: &mut RpcConnection, call: &Call<'_>) -> MethodResult {
    let reply = call.deferred_reply(|_| json!({}));
    let rule = call.text("rule")?;
    front.state.lock().withdraw(front.client, rule, reply);
    Ok(None)
}
