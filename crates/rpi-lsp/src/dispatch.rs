//! Tables of the supported requests and notifications, with their handlers.

use lsp_server::{ErrorCode, Request};
use lsp_types::notification as told;
use lsp_types::notification::Notification as _;
use lsp_types::request as asked;
use lsp_types::request::Request as _;
use lsp_types::{
    DidChangeTextDocumentParams, DidChangeWatchedFilesParams,
    DidChangeWatchedFilesRegistrationOptions, DidCloseTextDocumentParams,
    DidOpenTextDocumentParams, FileSystemWatcher, GlobPattern, InitializedParams, Registration,
    RegistrationParams,
};
use serde_json::Value;

use crate::world::World;
use crate::{actions, completion, formatting, hover, navigate, symbols};

type Answer = Result<Value, (ErrorCode, String)>;

/// Row of the request table: method and handler.
type Row = (&'static str, fn(&mut World, Value) -> Answer);

macro_rules! asked {
    ($request:ty, $answer:path) => {
        (<$request>::METHOD, |world, params| {
            let params = serde_json::from_value(params)
                .map_err(|e| (ErrorCode::InvalidParams, e.to_string()))?;
            serde_json::to_value($answer(world, params))
                .map_err(|e| (ErrorCode::InternalError, e.to_string()))
        })
    };
}

const ASKED: &[Row] = &[
    asked!(asked::HoverRequest, hover::hover),
    asked!(asked::GotoDefinition, navigate::definition),
    asked!(asked::References, navigate::references),
    asked!(asked::DocumentHighlightRequest, navigate::highlights),
    asked!(asked::DocumentSymbolRequest, symbols::symbols),
    asked!(asked::Completion, completion::completion),
    asked!(asked::Formatting, formatting::formatting),
    asked!(asked::CodeActionRequest, actions::actions),
];

/// Handles a request.
pub(crate) fn ask(world: &mut World, method: &str, params: Value) -> Answer {
    match ASKED.iter().find(|(known, _)| *known == method) {
        Some((_, answer)) => answer(world, params),
        None => Err((
            ErrorCode::MethodNotFound,
            format!("unknown method {method}"),
        )),
    }
}

/// Row of the notification table: method and handler. The handler returns requests to the client.
type Told = (&'static str, fn(&mut World, Value) -> Vec<Request>);

macro_rules! told {
    ($notification:ty, $take:path) => {
        (<$notification>::METHOD, |world, params| {
            // Invalid parameters are ignored, as a notification has no response.
            let params = serde_json::from_value(params);
            params.map_or_else(|_| Vec::new(), |params| $take(world, params))
        })
    };
}

const TOLD: &[Told] = &[
    told!(told::Initialized, initialized),
    told!(told::DidOpenTextDocument, opened),
    told!(told::DidChangeTextDocument, changed),
    told!(told::DidCloseTextDocument, closed),
    told!(told::DidChangeWatchedFiles, files_changed),
];

/// Handles a notification. Unknown notifications are ignored. Returns requests to the client.
pub(crate) fn tell(world: &mut World, method: &str, params: Value) -> Vec<Request> {
    match TOLD.iter().find(|(known, _)| *known == method) {
        Some((_, take)) => take(world, params),
        None => Vec::new(),
    }
}

/// Handles `initialized`: asks the client to watch source files on disk.
fn initialized(world: &mut World, _: InitializedParams) -> Vec<Request> {
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
        method: told::DidChangeWatchedFiles::METHOD.to_owned(),
        register_options: serde_json::to_value(options).ok(),
    };
    let params = RegistrationParams {
        registrations: vec![registration],
    };
    let method = asked::RegisterCapability::METHOD.to_owned();
    vec![Request::new("watch".to_owned().into(), method, params)]
}

fn opened(world: &mut World, params: DidOpenTextDocumentParams) -> Vec<Request> {
    let text = params.text_document;
    world.open(text.uri, text.version, text.text);
    Vec::new()
}

fn changed(world: &mut World, params: DidChangeTextDocumentParams) -> Vec<Request> {
    let text = params.text_document;
    world.change(&text.uri, text.version, params.content_changes);
    Vec::new()
}

fn closed(world: &mut World, params: DidCloseTextDocumentParams) -> Vec<Request> {
    world.close(&params.text_document.uri);
    Vec::new()
}

fn files_changed(world: &mut World, _: DidChangeWatchedFilesParams) -> Vec<Request> {
    world.all_changed();
    Vec::new()
}
