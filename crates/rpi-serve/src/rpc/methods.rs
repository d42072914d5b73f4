//! Methods of the JSON-RPC interface.

use std::collections::BTreeMap;
use std::time::Duration;

use rpi_core::OnOverrun;
use serde_json::{Map, Value, json};

use super::front::{Answer, Call, RpcFront, meant};
use super::sink::{self, RpcSink};
use super::tasks;
use crate::condition::{self, Expr, Saying};
use crate::limits::OnLoss;
use crate::state::{
    Failure, Language, Load, Make, NewDevice, PARAMETERS, Record, Reply, ServerState, TOO_CURIOUS,
    Watching,
};

type Act = fn(&mut RpcFront, &Call<'_>) -> Answer;

/// A method.
pub(super) struct Method {
    pub(super) name: &'static str,
    /// Names of its parameters. With `None`, neither the request nor its parameters are checked: an emergency stop must
    /// not fail because of a malformed request.
    pub(super) params: Option<&'static [&'static str]>,
    pub(super) act: Act,
}

const COMMAND: &[&str] = &["command"];
const TASK: &[&str] = &["task"];

/// All methods.
pub(super) const METHODS: &[Method] = &[
    method("session.open", &["name", "on_loss", "shared"], open_session),
    method("session.close", &["session"], close_session),
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
        load,
    ),
    method("command.start", COMMAND, |front, call| {
        one(front, call, ServerState::start)
    }),
    method("command.cancel", COMMAND, |front, call| {
        one(front, call, ServerState::cancel)
    }),
    method("command.abort", COMMAND, |front, call| {
        one(front, call, ServerState::abort)
    }),
    method("command.unload", COMMAND, |front, call| {
        one(front, call, ServerState::unload)
    }),
    method("command.set", &["command", "values"], set),
    method("command.describe", COMMAND, describe),
    method(
        "command.schedule",
        &["command", "after", "results", "keep"],
        schedule,
    ),
    method(
        "rule.make",
        &["when", "stop", "cancel", "start", "keep"],
        make_rule,
    ),
    method("rule.withdraw", &["rule"], withdraw),
    method("watch.command", &["command", "period"], watch_command),
    method("watch.rule", &["rule"], watch_rule),
    method("watch.session", &["session"], watch_session),
    method("watch.devices", &[], watch_devices),
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
        tasks::one(front, call, ServerState::start_task)
    }),
    method("task.cancel", TASK, |front, call| {
        tasks::one(front, call, ServerState::cancel_task)
    }),
    method("task.unload", TASK, |front, call| {
        tasks::one(front, call, ServerState::unload_task)
    }),
    method("task.describe", TASK, tasks::describe),
    method("tasks", &[], tasks::list),
    Method {
        name: "emergency.stop",
        params: None,
        act: tasks::stop,
    },
    method("emergency.reset", &[], tasks::reset),
    method("emergency.state", &[], tasks::state),
    method("device.list", &[], list_devices),
    method("device.add", &["name", "type", "parameters"], add_device),
    method("device.remove", &["name"], remove_device),
    method("commands", &[], list_commands),
    method("ping", &[], |_, _| Ok(Some(json!({})))),
];

const fn method(name: &'static str, params: &'static [&'static str], act: Act) -> Method {
    Method {
        name,
        params: Some(params),
        act,
    }
}

fn open_session(front: &mut RpcFront, call: &Call<'_>) -> Answer {
    let on_loss = call.one_of("on_loss", &OnLoss::ALL)?;
    let name = call.optional("name", a_text())?;
    let shared = call.flag("shared")?;
    let mut desk = front.office.desk();
    let session = desk.open_session(name.unwrap_or_default(), on_loss, (front.client, shared))?;
    drop(desk);
    front.sessions.push(session.clone());
    Ok(Some(json!({"session": session})))
}

fn close_session(front: &mut RpcFront, call: &Call<'_>) -> Answer {
    let session = call.text("session")?;
    front.may_act(&[session])?;
    front.office.desk().abort_session(session)?;
    front.sessions.retain(|own| own != session);
    Ok(Some(json!({})))
}

fn load(front: &mut RpcFront, call: &Call<'_>) -> Answer {
    let load = call.load("command")?;
    let told = call.told_period(front, load.period_ns);
    let reply = call.later(move |name| told("command", name));
    front.take_up(load.session)?;
    front.office.desk().load(&load, reply);
    Ok(None)
}

fn one(front: &mut RpcFront, call: &Call<'_>, what: fn(&mut ServerState, &str, Reply)) -> Answer {
    let reply = call.later(|_| json!({}));
    let command = call.text("command")?;
    front.may_act(&[command])?;
    what(&mut front.office.desk(), command, reply);
    Ok(None)
}

fn set(front: &mut RpcFront, call: &Call<'_>) -> Answer {
    let command = call.text("command")?;
    front.may_act(&[command])?;
    let values = call.needed("values", an_object())?;
    let texts = values
        .iter()
        .map(|(key, value)| (key.as_str(), literal(value)));
    let texts: Vec<(&str, String)> = texts.collect();
    let values = texts
        .iter()
        .map(|(key, text)| (command, *key, text.as_str()));
    let values: Vec<_> = values.collect();
    front.office.desk().set(&values, call.later(|_| json!({})));
    Ok(None)
}

/// Returns the text of a value: a text itself, a number or Boolean in JSON notation.
fn literal(value: &Value) -> String {
    value
        .as_str()
        .map_or_else(|| value.to_string(), str::to_owned)
}

fn describe(front: &mut RpcFront, call: &Call<'_>) -> Answer {
    let desk = front.office.desk();
    let (_, record) = desk.objects.commands.find(call.text("command")?)?;
    let mut told = description(record);
    if let Some(bound_ns) = desk.core.bound_ns(record) {
        told["bound"] = json!(seconds(bound_ns));
    }
    Ok(Some(told))
}

fn description(record: &Record) -> Value {
    let mut told = sink::status(&record.status);
    told["title"] = json!(record.title);
    told["cycles"] = json!(record.cycles());
    told["period"] = json!(seconds(record.period_ns()));
    told["values"] = sink::values(&record.values());
    if let Some((count, worst)) = record.overruns() {
        told["overruns"] = json!({
            "count": count,
            "tick": worst.tick,
            "took": seconds(worst.took_ns),
            "late": seconds(worst.late_ns),
            "fragment": record.fragment(worst.fragment),
        });
    }
    if let Some(image) = &record.image {
        let port = |key: &str, ty: rpi_image::Type| json!({"key": key, "type": ty.to_string()});
        let inputs = image.inputs.iter().map(|i| port(&i.key, i.value.ty));
        told["inputs"] = inputs.collect();
        let exports = image.exports.iter().map(|e| port(&e.key, e.value.ty));
        told["exports"] = exports.collect();
        told["results"] = json!(crate::state::results(image));
    }
    told
}

fn seconds(ns: u64) -> f64 {
    ns as f64 * 1e-9
}

/// Schedules `command` as the successor of `after`, for all regular ends of `after` or for some of its results.
fn schedule(front: &mut RpcFront, call: &Call<'_>) -> Answer {
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

fn make_rule(front: &mut RpcFront, call: &Call<'_>) -> Answer {
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

fn withdraw(front: &mut RpcFront, call: &Call<'_>) -> Answer {
    let reply = call.later(|_| json!({}));
    let rule = call.text("rule")?;
    front.office.desk().withdraw(front.client, rule, reply);
    Ok(None)
}

fn watch_command(front: &mut RpcFront, call: &Call<'_>) -> Answer {
    let name = call.text("command")?;
    let watching = Watching {
        period: call.seconds("period", 0.02)?,
        settle: Duration::ZERO,
        sink: front.sink(Some(("command", name)))?,
    };
    let mut desk = front.office.desk();
    desk.objects.commands.find(name)?;
    call.answer(json!({}));
    desk.objects.commands.watch(name, watching)?;
    Ok(None)
}

fn watch_rule(front: &mut RpcFront, call: &Call<'_>) -> Answer {
    let name = call.text("rule")?;
    let sink = front.sink(Some(("rule", name)))?;
    let mut desk = front.office.desk();
    desk.rules.find_rule(name)?;
    call.answer(json!({}));
    desk.watch_rule(name, sink)?;
    Ok(None)
}

fn watch_session(front: &mut RpcFront, call: &Call<'_>) -> Answer {
    let name = call.text("session")?;
    let sink = front.sink(Some(("session", name)))?;
    front.office.desk().objects.sessions.watch(name, sink)?;
    Ok(Some(json!({})))
}

fn watch_devices(front: &mut RpcFront, call: &Call<'_>) -> Answer {
    let sink = front.sink(None)?;
    call.answer(json!({}));
    front.office.desk().devices.watch(sink);
    Ok(None)
}

fn list_devices(front: &mut RpcFront, _: &Call<'_>) -> Answer {
    let desk = front.office.desk();
    let devices: Value = desk.devices.all().map(sink::device).collect();
    Ok(Some(json!({"devices": devices})))
}

fn add_device(front: &mut RpcFront, call: &Call<'_>) -> Answer {
    let parameters = call.optional("parameters", an_object())?;
    let parameters = parameters.into_iter().flatten();
    for (key, _) in parameters.clone() {
        if !PARAMETERS.contains(&key.as_str()) {
            let meant = meant(key, PARAMETERS.into_iter());
            let known = PARAMETERS.join(", ");
            return Err(Failure::Bad(format!(
                "parameters: unknown parameter {key}, expected one of {known}{meant}"
            )));
        }
    }
    let parameters: BTreeMap<String, String> = parameters
        .map(|(key, value)| (key.clone(), literal(value)))
        .collect();
    let new = NewDevice {
        peer: front.client.peer(),
        name: call.text("name")?,
        kind: call.text("type")?,
        parameters: &parameters,
    };
    let reply = call.later(|name| json!({"device": name}));
    front.office.desk().add_device(&new, reply);
    Ok(None)
}

fn remove_device(front: &mut RpcFront, call: &Call<'_>) -> Answer {
    let reply = call.later(|_| json!({}));
    front.office.desk().remove_device(call.text("name")?, reply);
    Ok(None)
}

fn list_commands(front: &mut RpcFront, _: &Call<'_>) -> Answer {
    let desk = front.office.desk();
    let told = desk.objects.commands.all().map(|(name, record)| {
        let mut told = sink::status(&record.status);
        told["command"] = json!(name);
        told["title"] = json!(record.title);
        told
    });
    Ok(Some(json!({"commands": told.collect::<Value>()})))
}

impl RpcFront {
    /// Takes over a session whose client has disconnected. Returns an error if the session belongs to another client.
    pub(super) fn take_up(&mut self, session: &str) -> Result<(), Failure> {
        self.may_act(&[session])?;
        if self
            .office
            .desk()
            .objects
            .sessions
            .take_up(session, self.client)
        {
            self.sessions.push(session.to_owned());
        }
        Ok(())
    }

    /// Creates a subscriber for updates about an object, given by kind and name.
    pub(super) fn sink(
        &self,
        about: Option<(&'static str, &str)>,
    ) -> Result<Box<RpcSink>, Failure> {
        let out = self.out.post().ok_or(TOO_CURIOUS)?;
        let about = about.map(|(kind, name)| (kind, name.to_owned()));
        Ok(Box::new(RpcSink { about, out }))
    }
}

impl<'a> Call<'a> {
    /// Returns the load request. `named` is the parameter with the name of the command or task within the text.
    pub(super) fn load(&self, named: &str) -> Result<Load<'a>, Failure> {
        let languages = [("rpi", Language::Rpi), ("rpinet", Language::Rpinet)];
        let language = self.one_of("language", &languages)?;
        Ok(Load {
            session: self.text("session")?,
            title: self.optional("title", a_text())?.unwrap_or_default(),
            language: language.unwrap_or(Language::Rpi),
            text: self.text("text")?,
            command: self.optional(named, a_text())?,
            period_ns: u64::try_from(self.seconds("period", 0.0)?.as_nanos()).unwrap_or(u64::MAX),
            on_overrun: self.on_overrun()?,
        })
    }

    /// Returns the overrun policy, if there is one.
    fn on_overrun(&self) -> Result<Option<OnOverrun>, Failure> {
        let text = self.optional("on_overrun", a_text())?;
        let policy = text.map(str::parse).transpose();
        policy.map_err(|why| Failure::Bad(format!("on_overrun: {why}")))
    }

    /// Returns a function that makes the answer to a load: the name and the period, and whether the period was rounded.
    pub(super) fn told_period(
        &self,
        front: &RpcFront,
        asked_ns: u64,
    ) -> impl FnOnce(&str, String) -> Value + Send + 'static {
        let period_ns = front.office.desk().defaults.period(asked_ns);
        move |kind, name| {
            let mut told = json!({"period": period_ns as f64 * 1e-9});
            told[kind] = json!(name);
            if asked_ns > 0 && asked_ns != period_ns {
                told["rounded"] = json!(true);
            }
            told
        }
    }

    /// Returns a Boolean parameter; false if it is missing.
    fn flag(&self, key: &str) -> Result<bool, Failure> {
        Ok(self.optional(key, a_flag())?.unwrap_or(false))
    }

    /// Returns the value that belongs to a parameter with a fixed set of words; `None` if it is missing.
    fn one_of<T: Copy>(&self, key: &str, words: &[(&str, T)]) -> Result<Option<T>, Failure> {
        let Some(word) = self.optional(key, a_text())? else {
            return Ok(None);
        };
        let found = words.iter().find(|(known, _)| *known == word);
        let known = || words.iter().map(|(known, _)| *known).collect::<Vec<_>>();
        let bad = || Failure::Bad(format!("{key}: expected one of {}", known().join(", ")));
        found.map(|(_, meant)| Some(*meant)).ok_or_else(bad)
    }

    /// Returns an optional parameter, or an error if its value has the wrong type.
    fn optional<T>(&self, key: &str, (what, read): Kind<'a, T>) -> Result<Option<T>, Failure> {
        match self.params.get(key) {
            None | Some(Value::Null) => Ok(None),
            Some(value) => {
                let bad = || Failure::Bad(format!("{key}: expected {what}, found {}", kind(value)));
                read(value).map(Some).ok_or_else(bad)
            }
        }
    }

    fn needed<T>(&self, key: &str, kind: Kind<'a, T>) -> Result<T, Failure> {
        let lacks = || Failure::Bad(format!("the parameter {key} is missing: {}", kind.0));
        self.optional(key, kind)?.ok_or_else(lacks)
    }

    pub(super) fn text(&self, key: &str) -> Result<&'a str, Failure> {
        self.needed(key, a_text())
    }

    /// Returns a list of texts; an empty one if the parameter is missing.
    fn texts(&self, key: &str) -> Result<Vec<&'a str>, Failure> {
        Ok(self.optional(key, some_texts())?.unwrap_or_default())
    }

    /// Returns a duration given in seconds; `unless_said` seconds if the parameter is missing.
    fn seconds(&self, key: &str, unless_said: f64) -> Result<Duration, Failure> {
        let seconds = self.optional(key, a_number())?.unwrap_or(unless_said);
        let time = Duration::try_from_secs_f64(seconds);
        let usable = time.ok().filter(|time| *time <= LONGEST);
        let most = LONGEST.as_secs();
        let bad = || {
            Failure::Bad(format!(
                "{key}: expected 0 to {most} seconds, found {seconds:?}"
            ))
        };
        usable.ok_or_else(bad)
    }
}

/// Maximum duration of a time parameter.
const LONGEST: Duration = Duration::from_secs(3600);

/// Type of a parameter: its description for error messages and the function that reads it.
type Kind<'a, T> = (&'static str, fn(&'a Value) -> Option<T>);

fn a_text<'a>() -> Kind<'a, &'a str> {
    ("a text", Value::as_str)
}

fn a_flag<'a>() -> Kind<'a, bool> {
    ("true or false", Value::as_bool)
}

fn a_number<'a>() -> Kind<'a, f64> {
    ("a number", Value::as_f64)
}

fn an_object<'a>() -> Kind<'a, &'a Map<String, Value>> {
    ("an object", Value::as_object)
}

fn some_texts<'a>() -> Kind<'a, Vec<&'a str>> {
    ("a list of texts", |value| {
        value.as_array()?.iter().map(Value::as_str).collect()
    })
}

/// Describes the type of a JSON value for error messages.
fn kind(value: &Value) -> &'static str {
    match value {
        Value::Null => "null",
        Value::Bool(_) => "true or false",
        Value::Number(_) => "a number",
        Value::String(_) => "a text",
        Value::Array(_) => "a list",
        Value::Object(_) => "an object",
    }
}
