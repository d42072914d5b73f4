//! DirectIO connection of one client: its requests and sessions.

use std::time::Duration;

use super::message::{Arg, Message};
use super::parse;
use super::sink::DioSink;
use crate::condition::{self, Expr, Saying};
use crate::limits::OnLoss;
use crate::peer::Peer;
use crate::state::{Client, Failure, Language, Load, Make, Office, Reply, TOO_CURIOUS, Watching};
use crate::wire::{Front, Outbox};

/// Supported protocol version; all versions with the same major number are accepted.
const VERSION: &str = "2.0";

/// Delay between the last values and the end of a command. Clients of the reference system queue values but handle
/// states at once, so without the delay they would see the end before the result that caused it.
const SETTLE: Duration = Duration::from_millis(20);

/// DirectIO connection of one client.
pub(crate) struct DioFront {
    office: Office,
    client: Client,
    out: Outbox,
    /// Names of the sessions that the client has opened or taken over.
    sessions: Vec<String>,
}

/// Handler of a request.
type Handler = fn(&mut DioFront, &Message) -> Result<(), Failure>;

/// Handlers of all requests by name.
const REQUESTS: &[(&str, Handler)] = &[
    ("ver", DioFront::version),
    ("nse", DioFront::new_session),
    ("ase", DioFront::abort_session),
    ("nene", DioFront::new_net),
    ("nest", |front, m| {
        front.one_net(m, |state, net, reply| state.start(net, reply))
    }),
    ("neca", |front, m| {
        front.one_net(m, |state, net, reply| state.cancel(net, reply))
    }),
    ("neab", |front, m| {
        front.one_net(m, |state, net, reply| state.abort(net, reply))
    }),
    ("neun", |front, m| {
        front.one_net(m, |state, net, reply| state.unload(net, reply))
    }),
    ("nesc", DioFront::schedule),
    ("snc", DioFront::set_values),
    ("gne", DioFront::watch_net),
    ("gse", DioFront::watch_session),
    ("gsy", DioFront::watch_rule),
    ("gde", DioFront::watch_devices),
];

impl Front for DioFront {
    fn hear(&mut self, text: &str) -> bool {
        let message = match parse::parse(text) {
            Ok(message) => message,
            Err(why) => {
                // A malformed message has no tag. The text before `=` is the best guess for an answer that the client
                // can match.
                let tag = text.split('=').next().unwrap_or_default().trim();
                let fits = tag.len() < 32 && tag.chars().all(|c| c.is_ascii_alphanumeric());
                let tag = if fits { tag } else { "error" };
                let what = format!("expected {} at byte {}", why.expected, why.at);
                return self.err(tag, &what);
            }
        };
        if message.name == "quit" {
            self.ok(&message.tag, "");
            return false;
        }
        let known = REQUESTS.iter().find(|(name, _)| *name == message.name);
        let done = match known {
            Some((_, handle)) => handle(self, &message),
            None => Err(Failure::Unknown(format!("request {}", message.name))),
        };
        match done {
            Ok(()) => true,
            Err(why) => self.err(&message.tag, &why.to_string()),
        }
    }
}

impl Drop for DioFront {
    fn drop(&mut self) {
        self.out.end();
        self.office.desk().lose_client(self.client, &self.sessions);
    }
}

impl DioFront {
    pub(crate) fn new(office: Office, peer: Peer, out: Outbox) -> DioFront {
        let client = office.desk().objects.client(peer);
        DioFront {
            office,
            client,
            out,
            sessions: Vec::new(),
        }
    }

    /// Checks that the client may act on these commands, tasks or sessions. Sessions of this protocol are shared with
    /// every client that knows their names; those of the native interface belong to one client.
    fn may_act<'n>(&self, names: impl Iterator<Item = &'n &'n str>) -> Result<(), Failure> {
        let (state, client) = (self.office.desk(), self.client);
        let mut names = names;
        names.try_for_each(|name| state.objects.may_act(client, name))
    }

    fn ok(&self, tag: &str, result: &str) -> bool {
        self.out.put(done(tag, Ok(result.to_owned())))
    }

    fn err(&self, tag: &str, why: &str) -> bool {
        self.out.put(done(tag, Err(why.to_owned())))
    }

    /// Returns a callback that sends the result with this tag.
    fn reply(&self, tag: &str) -> Reply {
        let (out, tag) = (self.out.clone(), tag.to_owned());
        Box::new(move |result| {
            out.put(done(&tag, result.map_err(|why| why.to_string())));
        })
    }

    fn sink(&self, tag: &str) -> Result<Box<DioSink>, Failure> {
        let out = self.out.post().ok_or(TOO_CURIOUS)?;
        let tag = tag.to_owned();
        Ok(Box::new(DioSink { tag, out }))
    }

    fn version(&mut self, message: &Message) -> Result<(), Failure> {
        let asked = text(message, 0)?;
        if asked.split('.').next() != VERSION.split('.').next() {
            return Err(Failure::Bad(format!(
                "this server speaks version {VERSION}"
            )));
        }
        self.ok(&message.tag, VERSION);
        Ok(())
    }

    fn new_session(&mut self, message: &Message) -> Result<(), Failure> {
        let on_loss = message.args.get(1).and_then(Arg::as_text);
        let on_loss = on_loss.and_then(OnLoss::by_name);
        let name =
            self.office
                .desk()
                .open_session(text(message, 0)?, on_loss, (self.client, true))?;
        self.ok(&message.tag, &name);
        self.sessions.push(name);
        Ok(())
    }

    fn abort_session(&mut self, message: &Message) -> Result<(), Failure> {
        let session = text(message, 0)?;
        self.may_act([&session].into_iter())?;
        self.office.desk().abort_session(session)?;
        self.sessions.retain(|own| own != session);
        self.ok(&message.tag, "");
        Ok(())
    }

    fn new_net(&mut self, message: &Message) -> Result<(), Failure> {
        let seconds = message.args.get(3).and_then(Arg::as_number).unwrap_or(0.0);
        let load = Load {
            session: text(message, 1)?,
            title: text(message, 2).unwrap_or_default(),
            language: Language::Rpinet,
            text: text(message, 0)?,
            command: None,
            // A negative or huge period saturates in the cast and is rejected or rounded up later.
            period_ns: (seconds.min(3600.0) * 1e9) as u64,
            on_overrun: None,
        };
        self.may_act([&load.session].into_iter())?;
        let mut state = self.office.desk();
        if state.objects.sessions.take_up(load.session, self.client) {
            self.sessions.push(load.session.to_owned());
        }
        state.load(&load, self.reply(&message.tag));
        Ok(())
    }

    fn one_net(
        &mut self,
        message: &Message,
        what: impl FnOnce(&mut crate::state::ServerState, &str, Reply),
    ) -> Result<(), Failure> {
        let net = text(message, 0)?;
        self.may_act([&net].into_iter())?;
        what(&mut self.office.desk(), net, self.reply(&message.tag));
        Ok(())
    }

    fn schedule(&mut self, message: &Message) -> Result<(), Failure> {
        let when = condition::parse(text(message, 0)?).map_err(Failure::Bad)?;
        let make = Make {
            when: &without_prefix(when),
            stop: &texts(message, 1)?,
            cancel: &texts(message, 2)?,
            start: &texts(message, 3)?,
            maker: self.client,
            // In this protocol, the client that loaded a net also unloads it.
            keep: true,
        };
        self.office.desk().rules.may_say(&make)?;
        self.may_act(make.stop.iter().chain(make.cancel).chain(make.start))?;
        self.office
            .desk()
            .make_rule(&make, self.reply(&message.tag));
        Ok(())
    }

    fn set_values(&mut self, message: &Message) -> Result<(), Failure> {
        let nets = message.args.first().and_then(Arg::as_map);
        let nets = nets.ok_or_else(|| Failure::Bad("expected a map of nets".to_owned()))?;
        let mut values = Vec::new();
        for (net, keys) in nets {
            for (key, value) in keys.as_map().unwrap_or_default() {
                let key = key.strip_prefix("in").unwrap_or(key);
                let value = value.as_text();
                let bad = || Failure::Bad(format!("the value of {key} must be a text"));
                values.push((net.as_str(), key, value.ok_or_else(bad)?));
            }
        }
        self.office.desk().may_set(values.len())?;
        self.may_act(values.iter().map(|(net, _, _)| net))?;
        self.office.desk().set(&values, self.reply(&message.tag));
        Ok(())
    }

    fn watch_net(&mut self, message: &Message) -> Result<(), Failure> {
        let net = text(message, 0)?;
        let seconds = message.args.get(1).and_then(Arg::as_number).unwrap_or(0.02);
        let watching = Watching {
            period: Duration::try_from_secs_f64(seconds).unwrap_or(Duration::from_secs(1)),
            settle: SETTLE,
            sink: self.sink(&message.tag)?,
        };
        let mut state = self.office.desk();
        state.objects.commands.find(net)?;
        // The client expects `ok` before the first update.
        self.ok(&message.tag, "");
        state.objects.commands.watch(net, watching)
    }

    fn watch_session(&mut self, message: &Message) -> Result<(), Failure> {
        let sink = self.sink(&message.tag)?;
        self.office
            .desk()
            .objects
            .sessions
            .watch(text(message, 0)?, sink)?;
        self.ok(&message.tag, "");
        Ok(())
    }

    fn watch_rule(&mut self, message: &Message) -> Result<(), Failure> {
        let (rule, sink) = (text(message, 0)?, self.sink(&message.tag)?);
        let mut state = self.office.desk();
        state.rules.find_rule(rule)?;
        self.ok(&message.tag, "");
        state.watch_rule(rule, sink)
    }

    fn watch_devices(&mut self, message: &Message) -> Result<(), Failure> {
        let sink = self.sink(&message.tag)?;
        self.ok(&message.tag, "");
        self.office.desk().devices.watch(sink);
        Ok(())
    }
}

fn done(tag: &str, result: Result<String, String>) -> String {
    let (name, text) = match result {
        Ok(text) => ("ok", text),
        Err(text) => ("err", text),
    };
    let args = if text.is_empty() {
        Vec::new()
    } else {
        vec![Arg::Text(text)]
    };
    Message::new(tag, name, args).to_string()
}

fn text(message: &Message, at: usize) -> Result<&str, Failure> {
    let found = message.args.get(at).and_then(Arg::as_text);
    found.ok_or_else(|| Failure::Bad(format!("argument {at} of {} must be a text", message.name)))
}

fn texts(message: &Message, at: usize) -> Result<Vec<&str>, Failure> {
    let found = message.args.get(at).map_or(Some(Vec::new()), Arg::as_texts);
    found.ok_or_else(|| {
        Failure::Bad(format!(
            "argument {at} of {} must be a list of texts",
            message.name
        ))
    })
}

/// Removes the prefix `out` from the export keys of a condition.
fn without_prefix(expr: Expr) -> Expr {
    let inner = |expr: Box<Expr>| Box::new(without_prefix(*expr));
    match expr {
        Expr::Not(a) => Expr::Not(inner(a)),
        Expr::And(a, b) => Expr::And(inner(a), inner(b)),
        Expr::Or(a, b) => Expr::Or(inner(a), inner(b)),
        Expr::Said(command, Saying::Export(key)) => {
            let key = key.strip_prefix("out").unwrap_or(&key).to_owned();
            Expr::Said(command, Saying::Export(key))
        }
        other => other,
    }
}
