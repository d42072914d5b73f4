//! The table of all methods of the JSON-RPC interface. The documentation and the wrappers of the clients are checked
//! against it.

use serde_json::json;

use super::connection::{Call, MethodResult, RpcConnection};
use super::{commands, devices, motion, rules, sessions, tasks, watch};
use crate::role::Right;
use crate::state::ServerState;

type Handler = fn(&mut RpcConnection, &Call<'_>) -> MethodResult;

/// Method of the JSON-RPC interface: its name, its parameters, the right that it needs, and the function that carries
/// it out.
pub(super) struct Method {
    pub(super) name: &'static str,
    /// Names of the parameters of the method.
    pub(super) params: &'static [&'static str],
    /// Whether a malformed request or an unknown parameter is an error. False for the emergency stop, which must not
    /// fail because of a mistake in the request.
    pub(super) is_checked: bool,
    /// Right that a client must have to call the method.
    pub(super) needs: Right,
    pub(super) handler: Handler,
}

const COMMAND: &[&str] = &["command"];
const TASK: &[&str] = &["task"];

/// Table of all methods of the JSON-RPC interface.
pub(super) const METHODS: &[Method] = &[
    method(
        "session.open",
        &["name", "on_loss", "grace", "shared"],
        Right::Load,
        sessions::open_session,
    ),
    method(
        "session.close",
        &["session"],
        Right::Move,
        sessions::close_session,
    ),
    method(
        "command.load",
        &[
            "session",
            "text",
            "language",
            "command",
            "period",
            "title",
            "on_overrun",
            "watch",
        ],
        Right::Load,
        commands::load,
    ),
    method("command.start", COMMAND, Right::Move, |front, call| {
        commands::one(front, call, ServerState::start)
    }),
    method(
        "command.cancel",
        &["command", "grace"],
        Right::Move,
        commands::cancel,
    ),
    method("command.abort", COMMAND, Right::Move, |front, call| {
        commands::one(front, call, ServerState::abort)
    }),
    method("command.unload", COMMAND, Right::Move, |front, call| {
        commands::one(front, call, ServerState::unload)
    }),
    method(
        "command.set",
        &["command", "values"],
        Right::Move,
        commands::set,
    ),
    method(
        "command.describe",
        COMMAND,
        Right::Watch,
        commands::describe,
    ),
    method(
        "command.schedule",
        &["command", "after", "results", "keep"],
        Right::Load,
        rules::schedule,
    ),
    method(
        "rule.make",
        &["when", "stop", "cancel", "start", "keep"],
        Right::Load,
        rules::make_rule,
    ),
    method("rule.withdraw", &["rule"], Right::Move, rules::withdraw),
    method(
        "watch.command",
        &["command", "period"],
        Right::Watch,
        watch::watch_command,
    ),
    method("watch.rule", &["rule"], Right::Watch, watch::watch_rule),
    method(
        "watch.session",
        &["session"],
        Right::Watch,
        watch::watch_session,
    ),
    method("watch.devices", &[], Right::Watch, watch::watch_devices),
    method("watch.task", TASK, Right::Watch, tasks::watch),
    method("watch.emergency", &[], Right::Watch, tasks::watch_emergency),
    method(
        "task.load",
        &[
            "session",
            "text",
            "language",
            "task",
            "period",
            "title",
            "on_overrun",
            "watch",
        ],
        Right::Load,
        tasks::load,
    ),
    method("task.start", TASK, Right::Move, |front, call| {
        tasks::task_op(front, call, ServerState::start_task)
    }),
    method("task.cancel", TASK, Right::Move, |front, call| {
        tasks::task_op(front, call, ServerState::cancel_task)
    }),
    method("task.unload", TASK, Right::Move, |front, call| {
        tasks::task_op(front, call, ServerState::unload_task)
    }),
    method("task.describe", TASK, Right::Watch, tasks::describe),
    method("tasks", &[], Right::Watch, tasks::list),
    Method {
        name: "emergency.stop",
        params: &["by"],
        is_checked: false,
        needs: Right::Stop,
        handler: tasks::stop,
    },
    method(
        "motion.set",
        &["override", "paused"],
        Right::Move,
        motion::set,
    ),
    method("motion.state", &[], Right::Watch, motion::state),
    method("watch.motion", &[], Right::Watch, motion::watch),
    method("emergency.reset", &[], Right::Reset, tasks::reset),
    method("emergency.state", &[], Right::Stop, tasks::state),
    method("device.list", &[], Right::Watch, devices::list_devices),
    method(
        "device.add",
        &["name", "type", "parameters"],
        Right::Load,
        devices::add_device,
    ),
    method(
        "device.remove",
        &["name"],
        Right::Load,
        devices::remove_device,
    ),
    method("commands", &[], Right::Watch, commands::list_commands),
    method(
        "client.describe",
        &[],
        Right::Stop,
        sessions::describe_client,
    ),
    method("ping", &[], Right::Stop, |_, _| Ok(Some(json!({})))),
];

const fn method(
    name: &'static str,
    params: &'static [&'static str],
    needs: Right,
    act: Handler,
) -> Method {
    Method {
        name,
        params,
        is_checked: true,
        needs,
        handler: act,
    }
}

/// Returns all methods of the JSON-RPC interface: for each one its name and the names of its parameters.
pub fn methods() -> impl Iterator<Item = (&'static str, &'static [&'static str])> {
    METHODS.iter().map(|method| (method.name, method.params))
}
