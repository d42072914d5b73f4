//! Main loop of the server: handles messages, and analyses documents when their analysis is due.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender};
use std::time::Instant;

use lsp_server::{ErrorCode, Message, Notification, Request, Response};
use lsp_types::notification::{Notification as _, PublishDiagnostics};
use lsp_types::{InitializeParams, PublishDiagnosticsParams};
use serde_json::Value;

use crate::cancellation::Cancellations;
use crate::capabilities::{self, ClientFeatures};
use crate::dispatch::{self, RequestError};
use crate::framing::{Received, response, to_json};
use crate::notifications;
use crate::progress::Progress;
use crate::settings::Settings;
use crate::workspace::Workspace;

/// Lifecycle phase of the server.
enum Phase {
    /// The server waits for the `initialize` request and rejects all other requests.
    Uninitialized,
    /// The server handles requests for the open documents, from `initialize` to `shutdown`.
    Running(Box<Workspace>),
    /// The server has received the `shutdown` request and accepts only the notification `exit`.
    ShutDown,
}

/// Handles messages until the client sends `exit` or disconnects.
///
/// # Errors
/// Returns an error if the client has sent no `shutdown` request before.
pub(crate) fn run(
    inbox: &Receiver<Received>,
    outbox: Sender<Value>,
    cancellations: Cancellations,
) -> Result<(), &'static str> {
    let mut server = Server {
        phase: Phase::Uninitialized,
        outbox,
        cancellations,
    };
    loop {
        match next_message(inbox, server.next_due(), server.is_overdue()) {
            Ok(Ok(Message::Request(request))) => server.request(request),
            Ok(Ok(Message::Notification(notification))) if notification.method == "exit" => break,
            Ok(Ok(Message::Notification(notification))) => server.notification(notification),
            Ok(Ok(Message::Response(response))) => server.response(response),
            Ok(Err(refusal)) => server.send(refusal),
            Err(RecvTimeoutError::Timeout) => server.analyse_due(),
            Err(RecvTimeoutError::Disconnected) => break,
        }
        server.publish();
    }
    match server.phase {
        Phase::ShutDown => Ok(()),
        _ => Err("the client disconnected without a shutdown request"),
    }
}

/// Returns the next message from the client. Waits at most until `due`, the time of the next analysis; returns a
/// timeout error then. Messages that have arrived are handled before the analysis, which they may make unnecessary,
/// unless the analysis is overdue: a stream of messages must not postpone it for ever.
fn next_message(
    inbox: &Receiver<Received>,
    due: Option<Instant>,
    is_overdue: bool,
) -> Result<Received, RecvTimeoutError> {
    let Some(due) = due else {
        return inbox.recv().map_err(|_| RecvTimeoutError::Disconnected);
    };
    match is_overdue {
        true => Err(RecvTimeoutError::Timeout),
        false => inbox.recv_timeout(due.saturating_duration_since(Instant::now())),
    }
}

struct Server {
    phase: Phase,
    outbox: Sender<Value>,
    cancellations: Cancellations,
}

impl Server {
    fn send(&self, message: Value) {
        // Sending fails only if the writer has stopped; the inbox then reports the disconnected client.
        let _ = self.outbox.send(message);
    }

    fn workspace(&mut self) -> Option<&mut Workspace> {
        match &mut self.phase {
            Phase::Running(world) => Some(world),
            Phase::Uninitialized | Phase::ShutDown => None,
        }
    }

    fn next_due(&mut self) -> Option<Instant> {
        self.workspace()?.next_due()
    }

    fn is_overdue(&mut self) -> bool {
        self.workspace().is_some_and(|world| world.is_overdue())
    }

    fn request(&mut self, request: Request) {
        let id = request.id.clone();
        let cancelled = || error(ErrorCode::RequestCanceled, "cancelled by the client");
        let result = match self.cancellations.contains(&id) {
            true => cancelled(),
            false => self.result(request),
        };
        // A result that is cut short by a cancellation is incomplete.
        let result = match self.cancellations.contains(&id) {
            true => cancelled(),
            false => result,
        };
        self.cancellations.remove(&id);
        self.send(response(id, result));
    }

    fn result(&mut self, request: Request) -> Result<Value, RequestError> {
        match (request.method.as_str(), &mut self.phase) {
            ("initialize", Phase::Uninitialized) => self.initialize(request.params),
            ("initialize", _) => error(ErrorCode::InvalidRequest, "already initialized"),
            (_, Phase::Uninitialized) => {
                error(ErrorCode::ServerNotInitialized, "not initialized yet")
            }
            (_, Phase::ShutDown) => error(ErrorCode::InvalidRequest, "already shut down"),
            ("shutdown", Phase::Running(_)) => {
                self.phase = Phase::ShutDown;
                Ok(Value::Null)
            }
            (method, Phase::Running(world)) => {
                world.begin_request(request.id, method, &request.params);
                let work = || dispatch::handle_request(world, method, request.params);
                let result = catch_panic(work).unwrap_or_else(|| internal_error(method));
                world.end_request();
                result
            }
        }
    }

    fn initialize(&mut self, params: Value) -> Result<Value, RequestError> {
        let params: InitializeParams = serde_json::from_value(params)
            .map_err(|e| RequestError::new(ErrorCode::InvalidParams, e.to_string()))?;
        let client = ClientFeatures::from_params(&params);
        let options = params.initialization_options.as_ref();
        let settings = Settings::default().with_options(options.unwrap_or(&Value::Null));
        let welcome = capabilities::initialize_result(&client, &settings);
        let welcome = serde_json::to_value(welcome).unwrap_or_default();
        let folders = capabilities::folders(&params);
        let cancellations = self.cancellations.clone();
        let progress = Progress::new(self.outbox.clone());
        let world = Workspace::new(client, settings, folders, cancellations, progress);
        self.phase = Phase::Running(Box::new(world));
        Ok(welcome)
    }

    /// Handles the response to a request of the server: the configuration of the client.
    fn response(&mut self, response: Response) {
        if let (Some(world), Some(result)) = (self.workspace(), response.result)
            && response.id == dispatch::configuration_id()
        {
            let options = result.get(0).unwrap_or(&Value::Null);
            world.settings = world.settings.with_options(options);
        }
    }

    fn notification(&mut self, notification: Notification) {
        let Some(world) = self.workspace() else {
            return;
        };
        let work =
            || notifications::handle_notification(world, &notification.method, notification.params);
        let requests = catch_panic(work).unwrap_or_default();
        requests
            .into_iter()
            .for_each(|request| self.send(to_json(request)));
    }

    fn analyse_due(&mut self) {
        if let Some(world) = self.workspace()
            && catch_panic(|| world.analyse_due()).is_none()
        {
            world.cancel_due();
        }
    }

    fn publish(&mut self) {
        let shown = self
            .workspace()
            .map(Workspace::take_unpublished)
            .unwrap_or_default();
        for one in shown {
            let params = PublishDiagnosticsParams::new(one.uri, one.diagnostics, one.version);
            let method = PublishDiagnostics::METHOD.to_owned();
            self.send(to_json(Notification::new(method, params)));
        }
    }
}

/// Runs `work` and returns its result, or `None` if it panics, so that a bug ends one request and not the server. The
/// panic message has been printed to standard error.
fn catch_panic<T>(work: impl FnOnce() -> T) -> Option<T> {
    catch_unwind(AssertUnwindSafe(work)).ok()
}

fn error(code: ErrorCode, why: &str) -> Result<Value, RequestError> {
    Err(RequestError::new(code, why.to_owned()))
}

fn internal_error(method: &str) -> Result<Value, RequestError> {
    error(
        ErrorCode::InternalError,
        &format!("internal error in {method}"),
    )
}
