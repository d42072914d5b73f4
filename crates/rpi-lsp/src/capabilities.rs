//! Capabilities of the client and of the server.

use std::path::PathBuf;

use lsp_types::{
    CallHierarchyServerCapability, CodeActionKind, CodeActionOptions, CodeLensOptions,
    CompletionOptions, DiagnosticOptions, DiagnosticServerCapabilities, DocumentLinkOptions,
    DocumentOnTypeFormattingOptions, FoldingRangeProviderCapability, HoverProviderCapability,
    InitializeParams, InitializeResult, LinkedEditingRangeServerCapabilities, OneOf,
    ReferencesOptions, RenameOptions, SelectionRangeProviderCapability, ServerCapabilities,
    ServerInfo, SignatureHelpOptions, TextDocumentSyncCapability, TextDocumentSyncKind,
    TextDocumentSyncOptions, TypeDefinitionProviderCapability, WorkDoneProgressOptions,
    WorkspaceFoldersServerCapabilities, WorkspaceServerCapabilities, WorkspaceSymbolOptions,
};

use crate::line_index::Encoding;
use crate::on_type_formatting::TRIGGERS;
use crate::settings::Settings;
use crate::{semantic_tokens, uri};

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
    /// True if the server can request the configuration of the client.
    pub(crate) has_configuration: bool,
    /// True if the client accepts completion items with places for the cursor (snippets).
    pub(crate) has_snippets: bool,
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
        let document = all.text_document.as_ref();
        let completion = document.and_then(|d| d.completion.as_ref());
        let items = completion.and_then(|c| c.completion_item.as_ref());
        ClientFeatures {
            encoding: Encoding::negotiate(encodings),
            versioned_edits: edits.is_some_and(|e| e.document_changes == Some(true)),
            watches_files: watching.is_some_and(|w| w.dynamic_registration == Some(true)),
            has_configuration: workspace.is_some_and(|w| w.configuration == Some(true)),
            has_snippets: items.is_some_and(|i| i.snippet_support == Some(true)),
        }
    }
}

/// Returns the folders that the `initialize` request opens.
// Older clients send only the root.
#[allow(deprecated)]
pub(crate) fn folders(params: &InitializeParams) -> Vec<PathBuf> {
    match &params.workspace_folders {
        Some(folders) => folders
            .iter()
            .map(|folder| uri::to_path(&folder.uri))
            .collect(),
        None => params.root_uri.iter().map(uri::to_path).collect(),
    }
}

/// Returns the response to the `initialize` request, with the capabilities of the server.
pub(crate) fn initialize_result(client: &ClientFeatures, settings: &Settings) -> InitializeResult {
    InitializeResult {
        capabilities: ServerCapabilities {
            diagnostic_provider: settings.pull_diagnostics.then(|| {
                DiagnosticServerCapabilities::Options(DiagnosticOptions {
                    identifier: Some("rpic".to_owned()),
                    inter_file_dependencies: true,
                    workspace_diagnostics: true,
                    work_done_progress_options: WITH_PROGRESS,
                })
            }),
            ..server_capabilities(client)
        },
        server_info: Some(ServerInfo {
            name: "rpic lsp".to_owned(),
            version: Some(env!("CARGO_PKG_VERSION").to_owned()),
        }),
    }
}

fn server_capabilities(client: &ClientFeatures) -> ServerCapabilities {
    ServerCapabilities {
        position_encoding: Some(client.encoding.kind()),
        text_document_sync: Some(document_sync()),
        hover_provider: Some(HoverProviderCapability::Simple(true)),
        signature_help_provider: Some(SignatureHelpOptions {
            trigger_characters: Some(["(", "<", ","].map(str::to_owned).to_vec()),
            retrigger_characters: Some(vec![";".to_owned()]),
            ..SignatureHelpOptions::default()
        }),
        definition_provider: Some(OneOf::Left(true)),
        type_definition_provider: Some(TypeDefinitionProviderCapability::Simple(true)),
        references_provider: Some(OneOf::Right(ReferencesOptions {
            work_done_progress_options: WITH_PROGRESS,
        })),
        document_highlight_provider: Some(OneOf::Left(true)),
        linked_editing_range_provider: Some(LinkedEditingRangeServerCapabilities::Simple(true)),
        rename_provider: Some(OneOf::Right(RenameOptions {
            prepare_provider: Some(true),
            work_done_progress_options: WITH_PROGRESS,
        })),
        call_hierarchy_provider: Some(CallHierarchyServerCapability::Simple(true)),
        document_symbol_provider: Some(OneOf::Left(true)),
        workspace_symbol_provider: Some(OneOf::Right(WorkspaceSymbolOptions {
            work_done_progress_options: WITH_PROGRESS,
            resolve_provider: None,
        })),
        document_formatting_provider: Some(OneOf::Left(true)),
        document_range_formatting_provider: Some(OneOf::Left(true)),
        document_on_type_formatting_provider: Some(on_type_options()),
        completion_provider: Some(completion_options()),
        code_action_provider: Some(code_action_options().into()),
        code_lens_provider: Some(CodeLensOptions {
            resolve_provider: Some(true),
        }),
        semantic_tokens_provider: Some(semantic_tokens::options().into()),
        inlay_hint_provider: Some(OneOf::Left(true)),
        folding_range_provider: Some(FoldingRangeProviderCapability::Simple(true)),
        selection_range_provider: Some(SelectionRangeProviderCapability::Simple(true)),
        document_link_provider: Some(DocumentLinkOptions {
            resolve_provider: Some(false),
            work_done_progress_options: WorkDoneProgressOptions::default(),
        }),
        workspace: Some(WorkspaceServerCapabilities {
            workspace_folders: Some(WorkspaceFoldersServerCapabilities {
                supported: Some(true),
                change_notifications: Some(OneOf::Left(true)),
            }),
            file_operations: None,
        }),
        ..ServerCapabilities::default()
    }
}

/// Options of requests that report their progress.
const WITH_PROGRESS: WorkDoneProgressOptions = WorkDoneProgressOptions {
    work_done_progress: Some(true),
};

fn document_sync() -> TextDocumentSyncCapability {
    TextDocumentSyncCapability::Options(TextDocumentSyncOptions {
        open_close: Some(true),
        change: Some(TextDocumentSyncKind::INCREMENTAL),
        ..TextDocumentSyncOptions::default()
    })
}

fn code_action_options() -> CodeActionOptions {
    CodeActionOptions {
        code_action_kinds: Some(vec![
            CodeActionKind::QUICKFIX,
            CodeActionKind::REFACTOR,
            FIX_ALL,
        ]),
        ..CodeActionOptions::default()
    }
}

fn on_type_options() -> DocumentOnTypeFormattingOptions {
    DocumentOnTypeFormattingOptions {
        first_trigger_character: TRIGGERS.0.to_owned(),
        more_trigger_character: Some(TRIGGERS.1.map(str::to_owned).to_vec()),
    }
}

fn completion_options() -> CompletionOptions {
    CompletionOptions {
        trigger_characters: Some([".", ":", "<", "(", "["].map(str::to_owned).to_vec()),
        resolve_provider: Some(true),
        ..CompletionOptions::default()
    }
}
