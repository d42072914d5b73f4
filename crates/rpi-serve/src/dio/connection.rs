//! DirectIO connection of one client: its requests and sessions.

use std::time::Duration;

use super::message::{Arg, Message};
use super::parse;
use super::subscriber::DioSubscriber;
use crate::condition::{self, Expr, FactExpr};
use crate::limits::{Limits, OnLoss};
use crate::message_size::{max_values, wait_for_turn};
use crate::role::{Identity, Right};
use crate::state::{
    ApiError, Client, Language, LoadRequest, Reply, RuleRequest, SessionPolicy, SharedState,
    TOO_MANY_SUBSCRIPTIONS, WatchRequest,
};
use crate::transport::{ConnectionHandler, Outbox};

/// Supported version of the DirectIO protocol. Clients may use any version with the same major number.
const VERSION: &str = "2.0";

/// Delay between the last values of a command and the report of its end. Clients of the reference system (the control
/// core of the Robotics API) queue values but handle states at once, so without the delay they would see the end before
/// the result that caused it.
const END_DELAY: Duration = Duration::from_millis(20);

/// Connection of one client that uses DirectIO, the protocol of the Robotics API.
pub(crate) struct DioConnection {
    state: SharedState,
    client: Client,
    who: Identity,
    outbox: Outbox,
    /// Names of the sessions that belong to this client: opened by the client, or taken over from a disconnected one.
    sessions: Vec<String>,
    /// Maximum number of values in one message.
    max_values: usize,
}

/// Function that carries out one kind of DirectIO request. An error is sent to the client as the answer.
type Handler = fn(&mut DioConnection, &Message) -> Result<(), ApiError>;

/// Table of the requests of the DirectIO protocol: the name of each request, the right that it needs and the function
/// that answers it.
const REQUESTS: &[(&str, Right, Handler)] = &[
    ("ver", Right::Watch, DioConnection::version),
    ("nse", Right::Load, DioConnection::new_session),
    ("ase", Right::Move, DioConnection::abort_session),
    ("nene", Right::Load, DioConnection::new_net),
    ("nest", Right::Move, |front, m| {
        front.net_op(m, |state, net, reply| state.start(net, reply))
    }),
    ("neca", Right::Move, |front, m| {
        front.net_op(m, |state, net, reply| state.cancel(net, None, reply))
    }),
    ("neab", Right::Move, |front, m| {
        front.net_op(m, |state, net, reply| state.abort(net, reply))
    }),
    ("neun", Right::Move, |front, m| {
        front.net_op(m, |state, net, reply| state.unload(net, reply))
    }),
    ("nesc", Right::Load, DioConnection::schedule),
    ("snc", Right::Move, DioConnection::set_values),
    ("gne", Right::Watch, DioConnection::watch_net),
    ("gse", Right::Watch, DioConnection::watch_session),
    ("gsy", Right::Watch, DioConnection::watch_rule),
    ("gde", Right::Watch, DioConnection::watch_devices),
];

impl ConnectionHandler for DioConnection {
    fn on_message(&mut self, text: &str) -> bool {
        let values = max_values(text);
        if values > self.max_values {
            return self.err(tag_of(text), ApiError::Limit("values in one message"));
        }
        let _turn = wait_for_turn(text, values);
        let message = match parse::parse(text) {
            Ok(message) => message,
            Err(why) => {
                let what = format!("expected {} at byte {}", why.expected, why.offset);
                return self.err(tag_of(text), ApiError::Invalid(what));
            }
        };
        if message.name == "quit" {
            self.ok(&message.tag, "");
            return false;
        }
        let known = REQUESTS.iter().find(|(name, ..)| *name == message.name);
        let done = match known {
            Some((name, right, handle)) => self
                .who
                .ensure(*right, name)
                .and_then(|()| handle(self, &message)),
            None => Err(ApiError::Unknown(format!("request {}", message.name))),
        };
        match done {
            Ok(()) => true,
            Err(why) => self.err(&message.tag, why),
        }
    }
}

impl Drop for DioConnection {
    fn drop(&mut self) {
        self.outbox.close();
        self.state
            .lock()
            .on_client_lost(self.client, &self.sessions);
    }
}

impl DioConnection {
    /// Creates the connection of a new client with the identity `who`. `out` is the queue of messages to the client.
    pub(crate) fn new(
        state: SharedState,
        who: Identity,
        out: Outbox,
        limits: &Limits,
    ) -> DioConnection {
        let client = state.lock().objects.client(&who);
        DioConnection {
            state,
            client,
            who,
            outbox: out,
            sessions: Vec::new(),
            max_values: limits.json_values,
        }
    }

    /// Returns an error if one of the named commands, tasks or sessions belongs to another client. Sessions opened over
    /// DirectIO are open to every client that knows their names; sessions opened over JSON-RPC belong to one client by
    /// default.
    fn ensure_may_act<'n>(&self, names: impl Iterator<Item = &'n &'n str>) -> Result<(), ApiError> {
        let (state, client) = (self.state.lock(), self.client);
        let mut names = names;
        names.try_for_each(|name| state.objects.may_act(client, name))
    }

    fn ok(&self, tag: &str, result: &str) -> bool {
        self.outbox.queue(answer(tag, Ok(result.to_owned())))
    }

    fn err(&self, tag: &str, error: ApiError) -> bool {
        self.outbox.queue(answer(tag, Err(error)))
    }

    /// Returns a callback that sends the result of a request to the client as an answer with this tag.
    fn reply(&self, tag: &str) -> Reply {
        let (out, tag) = (self.outbox.clone(), tag.to_owned());
        Box::new(move |result| {
            out.queue(answer(&tag, result));
        })
    }

    fn subscriber(&self, tag: &str) -> Result<Box<DioSubscriber>, ApiError> {
        let out = self
            .outbox
            .subscription_sender()
            .ok_or(TOO_MANY_SUBSCRIPTIONS)?;
        let tag = tag.to_owned();
        Ok(Box::new(DioSubscriber { tag, out }))
    }

    fn version(&mut self, message: &Message) -> Result<(), ApiError> {
        let requested = text_arg(message, 0)?;
        if requested.split('.').next() != VERSION.split('.').next() {
            return Err(ApiError::Invalid(format!(
                "this server speaks version {VERSION}"
            )));
        }
        self.ok(&message.tag, VERSION);
        Ok(())
    }

    fn new_session(&mut self, message: &Message) -> Result<(), ApiError> {
        let on_loss = message.args.get(1).and_then(Arg::as_text);
        let policy = SessionPolicy {
            on_loss: on_loss.and_then(OnLoss::from_name),
            grace: None,
        };
        let (name, owner) = (text_arg(message, 0)?, (self.client, true));
        let name = self
            .state
            .lock()
            .open_session(name, policy, owner, &self.who)?;
        self.ok(&message.tag, &name);
        self.sessions.push(name);
        Ok(())
    }

    fn abort_session(&mut self, message: &Message) -> Result<(), ApiError> {
        let session = text_arg(message, 0)?;
        self.ensure_may_act([&session].into_iter())?;
        self.state.lock().abort_session(session)?;
        self.sessions.retain(|own| own != session);
        self.ok(&message.tag, "");
        Ok(())
    }

    fn new_net(&mut self, message: &Message) -> Result<(), ApiError> {
        let seconds = message.args.get(3).and_then(Arg::as_number).unwrap_or(0.0);
        let load = LoadRequest {
            session: text_arg(message, 1)?,
            title: text_arg(message, 2).unwrap_or_default(),
            language: Language::Rpinet,
            text: text_arg(message, 0)?,
            command: None,
            // A negative or huge period saturates in the cast and is rejected or rounded up later.
            period_ns: (seconds.min(3600.0) * 1e9) as u64,
            on_overrun: None,
            watch: Vec::new(),
        };
        self.ensure_may_act([&load.session].into_iter())?;
        let mut state = self.state.lock();
        if state
            .objects
            .sessions
            .take_over_session(load.session, self.client)
        {
            self.sessions.push(load.session.to_owned());
        }
        state.load(&load, self.reply(&message.tag));
        Ok(())
    }

    fn net_op(
        &mut self,
        message: &Message,
        what: impl FnOnce(&mut crate::state::ServerState, &str, Reply),
    ) -> Result<(), ApiError> {
        let net = text_arg(message, 0)?;
        self.ensure_may_act([&net].into_iter())?;
        what(&mut self.state.lock(), net, self.reply(&message.tag));
        Ok(())
    }

    fn schedule(&mut self, message: &Message) -> Result<(), ApiError> {
        let when = condition::parse(text_arg(message, 0)?)?;
        let make = RuleRequest {
            when: &without_prefix(when),
            stop: &texts_arg(message, 1)?,
            cancel: &texts_arg(message, 2)?,
            start: &texts_arg(message, 3)?,
            maker: self.client,
            // In this protocol, the client that loaded a net also unloads it.
            keep: true,
        };
        self.state.lock().rules.ensure_rule_size(&make)?;
        self.ensure_may_act(make.stop.iter().chain(make.cancel).chain(make.start))?;
        self.state.lock().make_rule(&make, self.reply(&message.tag));
        Ok(())
    }

    fn set_values(&mut self, message: &Message) -> Result<(), ApiError> {
        let nets = message.args.first().and_then(Arg::as_map);
        let nets = nets.ok_or_else(|| ApiError::Invalid("expected a map of nets".to_owned()))?;
        let mut values = Vec::new();
        for (net, keys) in nets {
            for (key, value) in keys.as_map().unwrap_or_default() {
                let key = key.strip_prefix("in").unwrap_or(key);
                let value = value.as_text();
                let bad = || ApiError::Invalid(format!("the value of {key} must be a text"));
                values.push((net.as_str(), key, value.ok_or_else(bad)?));
            }
        }
        self.state.lock().may_set(values.len())?;
        self.ensure_may_act(values.iter().map(|(net, _, _)| net))?;
        self.state.lock().set(&values, self.reply(&message.tag));
        Ok(())
    }

    fn watch_net(&mut self, message: &Message) -> Result<(), ApiError> {
        let net = text_arg(message, 0)?;
        let seconds = message.args.get(1).and_then(Arg::as_number).unwrap_or(0.02);
        let watching = WatchRequest {
            period: Duration::try_from_secs_f64(seconds).unwrap_or(Duration::from_secs(1)),
            end_delay: END_DELAY,
            sink: self.subscriber(&message.tag)?,
        };
        let mut state = self.state.lock();
        state.objects.commands.find(net)?;
        // The client expects `ok` before the first update.
        self.ok(&message.tag, "");
        state.objects.commands.watch(net, watching)
    }

    fn watch_session(&mut self, message: &Message) -> Result<(), ApiError> {
        let sink = self.subscriber(&message.tag)?;
        self.state
            .lock()
            .objects
            .sessions
            .watch(text_arg(message, 0)?, sink)?;
        self.ok(&message.tag, "");
        Ok(())
    }

    fn watch_rule(&mut self, message: &Message) -> Result<(), ApiError> {
        let (rule, sink) = (text_arg(message, 0)?, self.subscriber(&message.tag)?);
        let mut state = self.state.lock();
        state.rules.ensure_rule_exists(rule)?;
        self.ok(&message.tag, "");
        state.watch_rule(rule, sink)
    }

    fn watch_devices(&mut self, message: &Message) -> Result<(), ApiError> {
        let sink = self.subscriber(&message.tag)?;
        self.ok(&message.tag, "");
        self.state.lock().devices.watch(sink);
        Ok(())
    }
}

/// Returns the tag for the error answer to a message that is not parsed: the text before `=` is the best guess for an
/// answer that the client can match.
fn tag_of(text: &str) -> &str {
    let tag = text.split('=').next().unwrap_or_default().trim();
    let is_tag = tag.len() < 32 && tag.chars().all(|c| c.is_ascii_alphanumeric());
    if is_tag { tag } else { "error" }
}

fn answer(tag: &str, result: Result<String, ApiError>) -> String {
    let (name, text) = match result {
        Ok(text) => ("ok", text),
        Err(error) => ("err", error.to_string()),
    };
    let args = if text.is_empty() {
        Vec::new()
    } else {
        vec![Arg::Text(text)]
    };
    Message::new(tag, name, args).to_string()
}

fn text_arg(message: &Message, at: usize) -> Result<&str, ApiError> {
    let found = message.args.get(at).and_then(Arg::as_text);
    found.ok_or_else(|| {
        ApiError::Invalid(format!("argument {at} of {} must be a text", message.name))
    })
}

fn texts_arg(message: &Message, at: usize) -> Result<Vec<&str>, ApiError> {
    let found = message.args.get(at).map_or(Some(Vec::new()), Arg::as_texts);
    found.ok_or_else(|| {
        ApiError::Invalid(format!(
            "argument {at} of {} must be a list of texts",
            message.name
        ))
    })
}

/// Removes the prefix `out`, which DirectIO puts before the keys of exports, from all facts of a condition.
fn without_prefix(expr: Expr) -> Expr {
    let inner = |expr: Box<Expr>| Box::new(without_prefix(*expr));
    match expr {
        Expr::Not(a) => Expr::Not(inner(a)),
        Expr::And(a, b) => Expr::And(inner(a), inner(b)),
        Expr::Or(a, b) => Expr::Or(inner(a), inner(b)),
        Expr::Fact(command, FactExpr::Export(key)) => {
            let key = key.strip_prefix("out").unwrap_or(&key).to_owned();
            Expr::Fact(command, FactExpr::Export(key))
        }
        other => other,
    }
}
