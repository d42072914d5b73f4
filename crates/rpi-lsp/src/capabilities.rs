//! Capabilities of the client and of the server.

use lsp_types::{
    CodeActionKind, CodeActionOptions, CompletionOptions, HoverProviderCapability,
    InitializeParams, InitializeResult, OneOf, ServerCapabilities, ServerInfo,
    TextDocumentSyncCapability, TextDocumentSyncKind, TextDocumentSyncOptions,
};

use crate::line_index::Encoding;

/// Kind of the code action that applies all sure fixes of a document. Editors can run actions of this kind on saving.
pub(crate) const FIX_ALL: CodeActionKind = CodeActionKind::new("source.fixAll.rpi");

/// Features of the client (the editor) that decide the form of the responses.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ClientFeatures {
    /// Unit in which the client counts columns: bytes or 16-bit code units.
    pub(crate) encoding: Encoding,
    /// True if the client accepts edits that name the version of the document they are for.
    pub(crate) versioned_edits: bool,
    /// True if the client can notify the server of changed files on disk (dynamic registration).
    pub(crate) watches_files: bool,
}

impl ClientFeatures {
    /// Returns the features of the client that its `initialize` request declares.
    pub(crate) fn from_params(params: &InitializeParams) -> ClientFeatures {
        let all = &params.capabilities;
        let encodings = all
            .general
            .as_ref()
            .and_then(|g| g.position_encodings.as_deref());
        let workspace = all.workspace.as_ref();
        let edits = workspace.and_then(|w| w.workspace_edit.as_ref());
        let watching = workspace.and_then(|w| w.did_change_watched_files.as_ref());
        ClientFeatures {
            encoding: Encoding::negotiate(encodings),
            versioned_edits: edits.is_some_and(|e| e.document_changes == Some(true)),
            watches_files: watching.is_some_and(|w| w.dynamic_registration == Some(true)),
        }
    }

    /// Returns the response to the `initialize` request, with the capabilities of the server.
    pub(crate) fn initialize_result(&self) -> InitializeResult {
        InitializeResult {
            capabilities: self.server_capabilities(),
            server_info: Some(ServerInfo {
                name: "rpic lsp".to_owned(),
                version: Some(env!("CARGO_PKG_VERSION").to_owned()),
            }),
        }
    }

    fn server_capabilities(&self) -> ServerCapabilities {
        let triggers = [".", ":", "<", "(", "["].map(str::to_owned);
        ServerCapabilities {
            position_encoding: Some(self.encoding.kind()),
            text_document_sync: Some(TextDocumentSyncCapability::Options(
                TextDocumentSyncOptions {
                    open_close: Some(true),
                    change: Some(TextDocumentSyncKind::INCREMENTAL),
                    ..TextDocumentSyncOptions::default()
                },
            )),
            hover_provider: Some(HoverProviderCapability::Simple(true)),
            definition_provider: Some(OneOf::Left(true)),
            references_provider: Some(OneOf::Left(true)),
            document_highlight_provider: Some(OneOf::Left(true)),
            document_symbol_provider: Some(OneOf::Left(true)),
            document_formatting_provider: Some(OneOf::Left(true)),
            completion_provider: Some(CompletionOptions {
                trigger_characters: Some(triggers.to_vec()),
                ..CompletionOptions::default()
            }),
            code_action_provider: Some(
                CodeActionOptions {
                    code_action_kinds: Some(vec![CodeActionKind::QUICKFIX, FIX_ALL]),
                    ..CodeActionOptions::default()
                }
                .into(),
            ),
            ..ServerCapabilities::default()
        }
    }
}
