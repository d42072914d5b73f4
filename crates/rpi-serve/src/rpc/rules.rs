//! Methods for rules.

use serde_json::json;

use super::front::{Answer, Call, RpcFront};
use crate::condition::{self, Expr, Saying};
use crate::state::{Failure, Make};

/// Schedules `command` as the successor of `after`, for all regular ends of `after` or for some of its results.
pub(super) fn schedule(front: &mut RpcFront, call: &Call<'_>) -> Answer {
    let after = call.text("after")?;
    let said = |saying| Expr::Said(after.to_owned(), saying);
    let results = call.texts("results")?;
    let regular = said(Saying::Regular);
    let results = results
        .iter()
        .map(|r| said(Saying::Result((*r).to_owned())));
    let when = match results.reduce(|a, b| Expr::Or(a.into(), b.into())) {
        Some(any) => Expr::And(regular.into(), any.into()),
        None => regular,
    };
    let make = Make {
        when: &when,
        stop: &[],
        cancel: &[],
        start: &[call.text("command")?],
        maker: front.client,
        keep: call.flag("keep")?,
    };
    front.may_act(make.start)?;
    front
        .office
        .desk()
        .make_rule(&make, call.later(|name| json!({"rule": name})));
    Ok(None)
}

/// Makes a rule.
pub(super) fn make_rule(front: &mut RpcFront, call: &Call<'_>) -> Answer {
    let when = condition::parse(call.text("when")?).map_err(Failure::Bad)?;
    let make = Make {
        when: &when,
        stop: &call.texts("stop")?,
        cancel: &call.texts("cancel")?,
        start: &call.texts("start")?,
        maker: front.client,
        keep: call.flag("keep")?,
    };
    front.office.desk().rules.may_say(&make)?;
    [make.stop, make.cancel, make.start]
        .iter()
        .try_for_each(|names| front.may_act(names))?;
    front
        .office
        .desk()
        .make_rule(&make, call.later(|name| json!({"rule": name})));
    Ok(None)
}

/// Withdraws a rule.
pub(super) fn withdraw(front: &mut RpcFront, call: &Call<'_>) -> Answer {
    let reply = call.later(|_| json!({}));
    let rule = call.text("rule")?;
    front.office.desk().withdraw(front.client, rule, reply);
    Ok(None)
}
