//! The table of all methods of the JSON-RPC interface. The documentation and the wrappers of the clients are checked
//! against it.

use serde_json::json;

use super::connection::{Call, MethodResult, RpcConnection};
use super::{commands, devices, motion, rules, sessions, tasks, watch};
use crate::state::ServerState;

type Handler = fn(&mut RpcConnection, &Call<'_>) -> MethodResult;

/// Method of the JSON-RPC interface: its name, and the function that carries it out.
pub(super) struct Method {
    pub(super) name: &'static str,
    /// Names of its parameters.
    pub(super) params: &'static [&'static str],
    /// Whether a malformed request or an unknown parameter is an error. An emergency stop must not fail because of one.
    pub(super) is_checked: bool,
    pub(super) handler: Handler,
}

const COMMAND: &[&str] = &["command"];
const TASK: &[&str] = &["task"];

/// Table of all methods of the JSON-RPC interface.
pub(super) const METHODS: &[Method] = &[
    method(
        "session.open",
        &["name", "on_loss", "grace", "shared"],
        sessions::open_session,
    ),
    method("session.close", &["session"], sessions::close_session),
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
        ],
        commands::load,
    ),
    method("command.start", COMMAND, |front, call| {
        commands::one(front, call, ServerState::start)
    }),
    method("command.cancel", &["command", "grace"], commands::cancel),
    method("command.abort", COMMAND, |front, call| {
        commands::one(front, call, ServerState::abort)
    }),
    method("command.unload", COMMAND, |front, call| {
        commands::one(front, call, ServerState::unload)
    }),
    method("command.set", &["command", "values"], commands::set),
    method("command.describe", COMMAND, commands::describe),
    method(
        "command.schedule",
        &["command", "after", "results", "keep"],
        rules::schedule,
    ),
    method(
        "rule.make",
        &["when", "stop", "cancel", "start", "keep"],
        rules::make_rule,
    ),
    method("rule.withdraw", &["rule"], rules::withdraw),
    method(
        "watch.command",
        &["command", "period"],
        watch::watch_command,
    ),
    method("watch.rule", &["rule"], watch::watch_rule),
    method("watch.session", &["session"], watch::watch_session),
    method("watch.devices", &[], watch::watch_devices),
    method("watch.task", TASK, tasks::watch),
    method("watch.emergency", &[], tasks::watch_emergency),
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
        ],
        tasks::load,
    ),
    method("task.start", TASK, |front, call| {
        tasks::task_op(front, call, ServerState::start_task)
    }),
    method("task.cancel", TASK, |front, call| {
        tasks::task_op(front, call, ServerState::cancel_task)
    }),
    method("task.unload", TASK, |front, call| {
        tasks::task_op(front, call, ServerState::unload_task)
    }),
    method("task.describe", TASK, tasks::describe),
    method("tasks", &[], tasks::list),
    Method {
        name: "emergency.stop",
        params: &["by"],
        is_checked: false,
        handler: tasks::stop,
    },
    method("motion.set", &["override", "paused"], motion::set),
    method("motion.state", &[], motion::state),
    method("watch.motion", &[], motion::watch),
    method("emergency.reset", &[], tasks::reset),
    method("emergency.state", &[], tasks::state),
    method("device.list", &[], devices::list_devices),
    method(
        "device.add",
        &["name", "type", "parameters"],
        devices::add_device,
    ),
    method("device.remove", &["name"], devices::remove_device),
    method("commands", &[], commands::list_commands),
    method("ping", &[], |_, _| Ok(Some(json!({})))),
];

const fn method(name: &'static str, params: &'static [&'static str], act: Handler) -> Method {
    Method {
        name,
        params,
        is_checked: true,
        handler: act,
    }
}

/// Returns the methods of the JSON-RPC interface: for each one its name and the names of its parameters.
pub fn methods() -> impl Iterator<Item = (&'static str, &'static [&'static str])> {
    METHODS.iter().map(|method| (method.name, method.params))
}
