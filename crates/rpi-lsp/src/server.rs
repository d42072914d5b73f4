//! Main loop of the server: handles messages, and analyses documents when their analysis is due.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender};
use std::time::Instant;

use lsp_server::{ErrorCode, Message, Notification, Request};
use lsp_types::notification::{Notification as _, PublishDiagnostics};
use lsp_types::{InitializeParams, PublishDiagnosticsParams};
use serde_json::Value;

use crate::client::Client;
use crate::dispatch;
use crate::wire::{Arrival, answer, outgoing};
use crate::world::World;

/// Lifecycle phase of the server.
enum Phase {
    /// Before the `initialize` request.
    New,
    /// Initialised.
    Running(Box<World>),
    /// After the `shutdown` request.
    Down,
}

/// Runs the main loop until the client sends `exit` or disconnects. Returns an error without a prior `shutdown`.
pub(crate) fn run(inbox: &Receiver<Arrival>, outbox: Sender<Value>) -> Result<(), &'static str> {
    let mut server = Server {
        phase: Phase::New,
        outbox,
    };
    loop {
        match next(inbox, server.next_due()) {
            Ok(Ok(Message::Request(request))) => server.request(request),
            Ok(Ok(Message::Notification(told))) if told.method == "exit" => break,
            Ok(Ok(Message::Notification(told))) => server.told(told),
            Ok(Ok(Message::Response(_))) => {}
            Ok(Err(refusal)) => server.send(refusal),
            Err(RecvTimeoutError::Timeout) => server.look(),
            Err(RecvTimeoutError::Disconnected) => break,
        }
        server.show();
    }
    match server.phase {
        Phase::Down => Ok(()),
        _ => Err("the client disconnected without a shutdown request"),
    }
}

/// Waits for the next message, at most until `due`.
fn next(inbox: &Receiver<Arrival>, due: Option<Instant>) -> Result<Arrival, RecvTimeoutError> {
    let Some(due) = due else {
        return inbox.recv().map_err(|_| RecvTimeoutError::Disconnected);
    };
    let left = due.saturating_duration_since(Instant::now());
    match left.is_zero() {
        true => Err(RecvTimeoutError::Timeout),
        false => inbox.recv_timeout(left),
    }
}

struct Server {
    phase: Phase,
    outbox: Sender<Value>,
}

impl Server {
    fn send(&self, message: Value) {
        // Sending fails only if the writer has stopped; the inbox then reports the disconnected client.
        let _ = self.outbox.send(message);
    }

    fn world(&mut self) -> Option<&mut World> {
        match &mut self.phase {
            Phase::Running(world) => Some(world),
            Phase::New | Phase::Down => None,
        }
    }

    fn next_due(&mut self) -> Option<Instant> {
        self.world()?.next_due()
    }

    fn request(&mut self, request: Request) {
        let result = match (request.method.as_str(), &mut self.phase) {
            ("initialize", Phase::New) => self.initialize(request.params),
            ("initialize", _) => refused(ErrorCode::InvalidRequest, "already initialized"),
            (_, Phase::New) => refused(ErrorCode::ServerNotInitialized, "not initialized yet"),
            (_, Phase::Down) => refused(ErrorCode::InvalidRequest, "already shut down"),
            ("shutdown", Phase::Running(_)) => {
                self.phase = Phase::Down;
                Ok(Value::Null)
            }
            (method, Phase::Running(world)) => {
                let work = || dispatch::ask(world, method, request.params);
                guarded(work).unwrap_or_else(|| broken(method))
            }
        };
        self.send(answer(request.id, result));
    }

    fn initialize(&mut self, params: Value) -> Result<Value, (ErrorCode, String)> {
        let params: InitializeParams = serde_json::from_value(params)
            .map_err(|e| (ErrorCode::InvalidParams, e.to_string()))?;
        let client = Client::of(&params);
        let welcome = serde_json::to_value(client.welcome()).unwrap_or_default();
        self.phase = Phase::Running(Box::new(World::new(client)));
        Ok(welcome)
    }

    fn told(&mut self, told: Notification) {
        let Some(world) = self.world() else {
            return;
        };
        let work = || dispatch::tell(world, &told.method, told.params);
        let asked = guarded(work).unwrap_or_default();
        asked
            .into_iter()
            .for_each(|request| self.send(outgoing(request)));
    }

    fn look(&mut self) {
        if let Some(world) = self.world()
            && guarded(|| world.look_at_due()).is_none()
        {
            world.give_up_due();
        }
    }

    fn show(&mut self) {
        let shown = self.world().map(World::take_shown).unwrap_or_default();
        for one in shown {
            let params = PublishDiagnosticsParams::new(one.uri, one.diagnostics, one.version);
            let method = PublishDiagnostics::METHOD.to_owned();
            self.send(outgoing(Notification::new(method, params)));
        }
    }
}

/// Runs a piece of work and catches panics, so that a bug costs one request and not the session. The panic message has
/// been printed.
fn guarded<T>(work: impl FnOnce() -> T) -> Option<T> {
    catch_unwind(AssertUnwindSafe(work)).ok()
}

fn refused(code: ErrorCode, why: &str) -> Result<Value, (ErrorCode, String)> {
    Err((code, why.to_owned()))
}

fn broken(method: &str) -> Result<Value, (ErrorCode, String)> {
    refused(
        ErrorCode::InternalError,
        &format!("internal error in {method}"),
    )
}
