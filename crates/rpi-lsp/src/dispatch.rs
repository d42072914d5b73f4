//! Tables of the supported requests and notifications, with their handlers.

use lsp_server::{ErrorCode, Request};
use lsp_types::notification;
use lsp_types::notification::Notification as _;
use lsp_types::request;
use lsp_types::request::Request as _;
use lsp_types::{
    DidChangeTextDocumentParams, DidChangeWatchedFilesParams,
    DidChangeWatchedFilesRegistrationOptions, DidCloseTextDocumentParams,
    DidOpenTextDocumentParams, FileSystemWatcher, GlobPattern, InitializedParams, Registration,
    RegistrationParams,
};
use serde_json::Value;

use crate::workspace::Workspace;
use crate::{code_actions, completion, formatting, hover, navigation, symbols};

type RequestResult = Result<Value, (ErrorCode, String)>;

/// Entry of the table of requests: the method name, and the function that handles the request and returns its result.
type RequestHandler = (&'static str, fn(&mut Workspace, Value) -> RequestResult);

macro_rules! request_handler {
    ($request:ty, $answer:path) => {
        (<$request>::METHOD, |world, params| {
            let params = serde_json::from_value(params)
                .map_err(|e| (ErrorCode::InvalidParams, e.to_string()))?;
            serde_json::to_value($answer(world, params))
                .map_err(|e| (ErrorCode::InternalError, e.to_string()))
        })
    };
}

const REQUESTS: &[RequestHandler] = &[
    request_handler!(request::HoverRequest, hover::hover),
    request_handler!(request::GotoDefinition, navigation::definition),
    request_handler!(request::References, navigation::references),
    request_handler!(request::DocumentHighlightRequest, navigation::highlights),
    request_handler!(request::DocumentSymbolRequest, symbols::symbols),
    request_handler!(request::Completion, completion::completion),
    request_handler!(request::Formatting, formatting::formatting),
    request_handler!(request::CodeActionRequest, code_actions::code_actions),
];

/// Handles a request: calls the function that the table contains for the method, and returns the result or an error of
/// the protocol. An unknown method is such an error.
pub(crate) fn handle_request(world: &mut Workspace, method: &str, params: Value) -> RequestResult {
    match REQUESTS.iter().find(|(known, _)| *known == method) {
        Some((_, answer)) => answer(world, params),
        None => Err((
            ErrorCode::MethodNotFound,
            format!("unknown method {method}"),
        )),
    }
}

/// Entry of the table of notifications: the method name, and the function that handles the notification. The function
/// returns requests that the server sends to the client.
type NotificationHandler = (&'static str, fn(&mut Workspace, Value) -> Vec<Request>);

macro_rules! notification_handler {
    ($notification:ty, $take:path) => {
        (<$notification>::METHOD, |world, params| {
            // Invalid parameters are ignored, as a notification has no response.
            let params = serde_json::from_value(params);
            params.map_or_else(|_| Vec::new(), |params| $take(world, params))
        })
    };
}

const NOTIFICATIONS: &[NotificationHandler] = &[
    notification_handler!(notification::Initialized, initialized),
    notification_handler!(notification::DidOpenTextDocument, opened),
    notification_handler!(notification::DidChangeTextDocument, changed),
    notification_handler!(notification::DidCloseTextDocument, closed),
    notification_handler!(notification::DidChangeWatchedFiles, files_changed),
];

/// Handles a notification of the client; an unknown one is ignored. Returns requests that the server sends to the
/// client.
pub(crate) fn handle_notification(
    world: &mut Workspace,
    method: &str,
    params: Value,
) -> Vec<Request> {
    match NOTIFICATIONS.iter().find(|(known, _)| *known == method) {
        Some((_, take)) => take(world, params),
        None => Vec::new(),
    }
}

/// Handles the notification `initialized`: returns a request that the client watch source files on disk, if the client
/// supports it.
fn initialized(world: &mut Workspace, _: InitializedParams) -> Vec<Request> {
    if !world.client.watches_files {
        return Vec::new();
    }
    let watcher = |glob: &str| FileSystemWatcher {
        glob_pattern: GlobPattern::String(glob.to_owned()),
        kind: None,
    };
    let options = DidChangeWatchedFilesRegistrationOptions {
        watchers: vec![watcher("**/*.rpi"), watcher("**/*.lus")],
    };
    let registration = Registration {
        id: "files".to_owned(),
        method: notification::DidChangeWatchedFiles::METHOD.to_owned(),
        register_options: serde_json::to_value(options).ok(),
    };
    let params = RegistrationParams {
        registrations: vec![registration],
    };
    let method = request::RegisterCapability::METHOD.to_owned();
    vec![Request::new("watch".to_owned().into(), method, params)]
}

fn opened(world: &mut Workspace, params: DidOpenTextDocumentParams) -> Vec<Request> {
    let text = params.text_document;
    world.open(text.uri, text.version, text.text);
    Vec::new()
}

fn changed(world: &mut Workspace, params: DidChangeTextDocumentParams) -> Vec<Request> {
    let text = params.text_document;
    world.change(&text.uri, text.version, params.content_changes);
    Vec::new()
}

fn closed(world: &mut Workspace, params: DidCloseTextDocumentParams) -> Vec<Request> {
    world.close(&params.text_document.uri);
    Vec::new()
}

fn files_changed(world: &mut Workspace, _: DidChangeWatchedFilesParams) -> Vec<Request> {
    world.files_changed();
    Vec::new()
}
