//! Table of the supported notifications, with their handlers.

use lsp_server::Request;
use lsp_types::notification;
use lsp_types::notification::Notification as _;
use lsp_types::request;
use lsp_types::request::Request as _;
use lsp_types::{
    ConfigurationItem, ConfigurationParams, DidChangeConfigurationParams,
    DidChangeTextDocumentParams, DidChangeWatchedFilesParams,
    DidChangeWatchedFilesRegistrationOptions, DidChangeWorkspaceFoldersParams,
    DidCloseTextDocumentParams, DidOpenTextDocumentParams, FileSystemWatcher, GlobPattern,
    InitializedParams, Registration, RegistrationParams,
};
use serde_json::Value;

use crate::dispatch::configuration_id;
use crate::settings::SECTION;
use crate::uri;
use crate::workspace::Workspace;

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
    notification_handler!(notification::DidChangeWorkspaceFolders, folders_changed),
    notification_handler!(notification::DidChangeConfiguration, settings_changed),
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

/// Handles the notification `initialized`: returns requests for the configuration, and that the client watch source files
/// on disk, as far as the client supports them.
fn initialized(world: &mut Workspace, _: InitializedParams) -> Vec<Request> {
    let mut requests = configuration_requests(world);
    if !world.client.watches_files {
        return requests;
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
    requests.push(Request::new("watch".to_owned().into(), method, params));
    requests
}

/// Returns the request for the settings in the configuration of the client, if the client supports it.
fn configuration_requests(world: &Workspace) -> Vec<Request> {
    if !world.client.has_configuration {
        return Vec::new();
    }
    let section = ConfigurationItem {
        scope_uri: None,
        section: Some(SECTION.to_owned()),
    };
    let params = ConfigurationParams {
        items: vec![section],
    };
    let method = request::WorkspaceConfiguration::METHOD.to_owned();
    vec![Request::new(configuration_id(), method, params)]
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

fn folders_changed(world: &mut Workspace, params: DidChangeWorkspaceFoldersParams) -> Vec<Request> {
    let path = |folder: &lsp_types::WorkspaceFolder| uri::to_path(&folder.uri);
    let removed: Vec<_> = params.event.removed.iter().map(path).collect();
    let added = params.event.added.iter().map(path).collect();
    world.change_folders(&removed, added);
    Vec::new()
}

/// Handles a change of the configuration: a client without support for requests of the configuration sends the settings
/// with the notification.
fn settings_changed(world: &mut Workspace, params: DidChangeConfigurationParams) -> Vec<Request> {
    world.settings = world.settings.with_options(&params.settings);
    configuration_requests(world)
}
