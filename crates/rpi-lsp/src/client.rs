//! What the client can do, and what we tell it that we can.

use lsp_types::{
    CodeActionKind, CodeActionOptions, CompletionOptions, HoverProviderCapability,
    InitializeParams, InitializeResult, OneOf, ServerCapabilities, ServerInfo,
    TextDocumentSyncCapability, TextDocumentSyncKind, TextDocumentSyncOptions,
};

use crate::lines::Encoding;

/// The name of the code action that applies all sure fixes.
pub(crate) const FIX_ALL: CodeActionKind = CodeActionKind::new("source.fixAll.rpi");

/// What the client can do.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Client {
    /// How it counts within a line.
    pub(crate) encoding: Encoding,
    /// Whether it takes edits that say for which version of a text they are.
    pub(crate) versioned_edits: bool,
    /// Whether it tells, when asked to, which files have changed on disk.
    pub(crate) watches_files: bool,
}

impl Client {
    /// As the client says it.
    pub(crate) fn of(params: &InitializeParams) -> Client {
        let all = &params.capabilities;
        let encodings = all
            .general
            .as_ref()
            .and_then(|g| g.position_encodings.as_deref());
        let workspace = all.workspace.as_ref();
        let edits = workspace.and_then(|w| w.workspace_edit.as_ref());
        let watching = workspace.and_then(|w| w.did_change_watched_files.as_ref());
        Client {
            encoding: Encoding::of(encodings),
            versioned_edits: edits.is_some_and(|e| e.document_changes == Some(true)),
            watches_files: watching.is_some_and(|w| w.dynamic_registration == Some(true)),
        }
    }

    /// What we can do for it.
    pub(crate) fn welcome(&self) -> InitializeResult {
        InitializeResult {
            capabilities: self.capabilities(),
            server_info: Some(ServerInfo {
                name: "rpic lsp".to_owned(),
                version: Some(env!("CARGO_PKG_VERSION").to_owned()),
            }),
        }
    }

    fn capabilities(&self) -> ServerCapabilities {
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
