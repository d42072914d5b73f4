//! The methods of the native interface.

use std::collections::BTreeMap;
use std::time::Duration;

use rpi_core::OnOverrun;
use serde_json::{Value, json};

use super::front::{Answer, Call, RpcFront};
use super::sink::{self, RpcSink};
use super::tasks;
use crate::condition::{self, Expr, Saying};
use crate::desk::{
    Desk, Failure, Language, Load, Make, NewDevice, Record, Reply, TOO_CURIOUS, Watching,
};
use crate::limits::OnLoss;

type Method = fn(&mut RpcFront, &Call<'_>) -> Answer;

/// All methods by name.
pub(super) const METHODS: &[(&str, Method)] = &[
    ("session.open", open_session),
    ("session.close", close_session),
    ("command.load", load),
    ("command.start", |front, call| one(front, call, Desk::start)),
    ("command.cancel", |front, call| {
        one(front, call, Desk::cancel)
    }),
    ("command.abort", |front, call| one(front, call, Desk::abort)),
    ("command.unload", |front, call| {
        one(front, call, Desk::unload)
    }),
    ("command.set", set),
    ("command.describe", describe),
    ("command.schedule", schedule),
    ("rule.make", make_rule),
    ("rule.withdraw", withdraw),
    ("watch.command", watch_command),
    ("watch.rule", watch_rule),
    ("watch.session", watch_session),
    ("watch.devices", watch_devices),
    ("watch.task", tasks::watch),
    ("watch.emergency", tasks::watch_emergency),
    ("task.load", tasks::load),
    ("task.start", |front, call| {
        tasks::one(front, call, Desk::start_task)
    }),
    ("task.cancel", |front, call| {
        tasks::one(front, call, Desk::cancel_task)
    }),
    ("task.unload", |front, call| {
        tasks::one(front, call, Desk::unload_task)
    }),
    ("task.describe", tasks::describe),
    ("tasks", tasks::list),
    ("emergency.stop", tasks::stop),
    ("emergency.reset", tasks::reset),
    ("emergency.state", tasks::state),
    ("device.list", list_devices),
    ("device.add", add_device),
    ("device.remove", remove_device),
    ("commands", list_commands),
    ("ping", |_, _| Ok(Some(json!({})))),
];

fn open_session(front: &mut RpcFront, call: &Call<'_>) -> Answer {
    let on_loss = match call.optional("on_loss", Value::as_str)? {
        None => None,
        Some(name) => Some(OnLoss::by_name(name).ok_or_else(|| bad("on_loss"))?),
    };
    let name = call.optional("name", Value::as_str)?;
    let shared = call.flag("shared")?;
    let owner = Some(front.client).filter(|_| !shared);
    let mut desk = front.office.desk();
    let session = desk.open_session(name.unwrap_or_default(), on_loss, owner)?;
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

fn one(front: &mut RpcFront, call: &Call<'_>, what: fn(&mut Desk, &str, Reply)) -> Answer {
    let reply = call.later(|_| json!({}));
    let command = call.text("command")?;
    front.may_act(&[command])?;
    what(&mut front.office.desk(), command, reply);
    Ok(None)
}

fn set(front: &mut RpcFront, call: &Call<'_>) -> Answer {
    let command = call.text("command")?;
    front.may_act(&[command])?;
    let values = call.params.get("values").and_then(Value::as_object);
    let values = values.ok_or_else(|| bad("values"))?;
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

/// The text of a value: texts are taken as they are, numbers and Booleans as JSON writes them.
fn literal(value: &Value) -> String {
    value
        .as_str()
        .map_or_else(|| value.to_string(), str::to_owned)
}

fn describe(front: &mut RpcFront, call: &Call<'_>) -> Answer {
    let desk = front.office.desk();
    let (_, record) = desk.find(call.text("command")?)?;
    let mut told = description(record);
    if let Some(bound_ns) = desk.bound_ns(record) {
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
        told["results"] = json!(crate::desk::results(image));
    }
    told
}

fn seconds(ns: u64) -> f64 {
    ns as f64 * 1e-9
}

/// `command` follows `after`, for all of its regular results or for some.
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
    front.office.desk().may_say(&make)?;
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
    let seconds = call.optional("period", Value::as_f64)?.unwrap_or(0.02);
    let watching = Watching {
        period: Duration::try_from_secs_f64(seconds).map_err(|_| bad("period"))?,
        settle: Duration::ZERO,
        sink: front.sink(Some(("command", name)))?,
    };
    let mut desk = front.office.desk();
    desk.find(name)?;
    call.answer(json!({}));
    desk.watch(name, watching)?;
    Ok(None)
}

fn watch_rule(front: &mut RpcFront, call: &Call<'_>) -> Answer {
    let name = call.text("rule")?;
    let sink = front.sink(Some(("rule", name)))?;
    let mut desk = front.office.desk();
    desk.find_rule(name)?;
    call.answer(json!({}));
    desk.watch_rule(name, sink)?;
    Ok(None)
}

fn watch_session(front: &mut RpcFront, call: &Call<'_>) -> Answer {
    let name = call.text("session")?;
    let sink = front.sink(Some(("session", name)))?;
    front.office.desk().watch_session(name, sink)?;
    Ok(Some(json!({})))
}

fn watch_devices(front: &mut RpcFront, call: &Call<'_>) -> Answer {
    let sink = front.sink(None)?;
    call.answer(json!({}));
    front.office.desk().watch_devices(sink);
    Ok(None)
}

fn list_devices(front: &mut RpcFront, _: &Call<'_>) -> Answer {
    let desk = front.office.desk();
    let devices: Value = desk.devices().map(sink::device).collect();
    Ok(Some(json!({"devices": devices})))
}

fn add_device(front: &mut RpcFront, call: &Call<'_>) -> Answer {
    let parameters = call.optional("parameters", Value::as_object)?;
    let parameters = parameters.into_iter().flatten();
    let parameters: BTreeMap<String, String> = parameters
        .map(|(key, value)| (key.clone(), literal(value)))
        .collect();
    let new = NewDevice {
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
    let told = desk.commands().map(|(name, record)| {
        let mut told = sink::status(&record.status);
        told["command"] = json!(name);
        told["title"] = json!(record.title);
        told
    });
    Ok(Some(json!({"commands": told.collect::<Value>()})))
}

impl RpcFront {
    /// Takes a session up whose client is gone; fails if it is another client's.
    pub(super) fn take_up(&mut self, session: &str) -> Result<(), Failure> {
        self.may_act(&[session])?;
        if self.office.desk().take_up(session, self.client) {
            self.sessions.push(session.to_owned());
        }
        Ok(())
    }

    /// What tells this client about something: what it is, and its name.
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
    /// What is to be loaded: `named` is the key that tells which of several.
    pub(super) fn load(&self, named: &str) -> Result<Load<'a>, Failure> {
        let language = match self.optional("language", Value::as_str)? {
            None | Some("rpi") => Language::Rpi,
            Some("rpinet") => Language::Rpinet,
            Some(_) => return Err(bad("language")),
        };
        let period = self.optional("period", Value::as_f64)?.unwrap_or(0.0);
        if period < 0.0 {
            return Err(bad("period"));
        }
        Ok(Load {
            session: self.text("session")?,
            title: self.optional("title", Value::as_str)?.unwrap_or_default(),
            language,
            text: self.text("text")?,
            command: self.optional(named, Value::as_str)?,
            period_ns: (period.min(3600.0) * 1e9) as u64,
            on_overrun: self.on_overrun()?,
        })
    }

    /// What becomes of what is loaded if its cycles take too long.
    fn on_overrun(&self) -> Result<Option<OnOverrun>, Failure> {
        let text = self.optional("on_overrun", Value::as_str)?;
        let policy = text.map(str::parse).transpose();
        policy.map_err(|why| Failure::Bad(format!("on_overrun: {why}")))
    }

    /// Tells what was loaded with the period that it has, and says so if that is another than was asked for.
    pub(super) fn told_period(
        &self,
        front: &RpcFront,
        asked_ns: u64,
    ) -> impl FnOnce(&str, String) -> Value + Send + 'static {
        let period_ns = front.office.desk().period(asked_ns);
        move |kind, name| {
            let mut told = json!({"period": period_ns as f64 * 1e-9});
            told[kind] = json!(name);
            if asked_ns > 0 && asked_ns != period_ns {
                told["rounded"] = json!(true);
            }
            told
        }
    }

    /// A truth value; false if it is not said.
    fn flag(&self, key: &str) -> Result<bool, Failure> {
        Ok(self.optional(key, Value::as_bool)?.unwrap_or(false))
    }

    /// What may be left out; what is there is of its kind.
    fn optional<T>(
        &self,
        key: &str,
        read: impl Fn(&'a Value) -> Option<T>,
    ) -> Result<Option<T>, Failure> {
        match self.params.get(key) {
            None | Some(Value::Null) => Ok(None),
            Some(value) => read(value).map(Some).ok_or_else(|| bad(key)),
        }
    }

    pub(super) fn text(&self, key: &str) -> Result<&'a str, Failure> {
        let found = self.params.get(key).and_then(Value::as_str);
        found.ok_or_else(|| bad(key))
    }

    /// A list of texts; without one, none.
    fn texts(&self, key: &str) -> Result<Vec<&'a str>, Failure> {
        let list = self.optional(key, Value::as_array)?;
        let list = list.map_or(&[][..], Vec::as_slice);
        let texts: Option<Vec<&str>> = list.iter().map(Value::as_str).collect();
        texts.ok_or_else(|| bad(key))
    }
}

fn bad(key: &str) -> Failure {
    Failure::Bad(format!("parameter {key} is missing or of the wrong kind"))
}
