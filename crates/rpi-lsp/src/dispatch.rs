//! Table of the supported requests, with their handlers.

use lsp_server::{ErrorCode, RequestId};
use lsp_types::request;
use lsp_types::request::Request as _;
use serde_json::Value;

use crate::workspace::Workspace;
use crate::{
    call_hierarchy, code_actions, code_lenses, completion, document_links, folding, formatting,
    highlights, hover, inlay_hints, linked_editing, navigation, on_type_formatting,
    pull_diagnostics, references, rename, selection_ranges, semantic_tokens, signature_help,
    symbols, workspace_symbols,
};

/// Error response to a request.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) struct RequestError {
    /// Code of the protocol.
    pub(crate) code: i32,
    /// Description of the error for the user.
    pub(crate) message: String,
}

impl RequestError {
    pub(crate) fn new(code: ErrorCode, message: String) -> RequestError {
        RequestError {
            code: code as i32,
            message,
        }
    }
}

type RequestResult = Result<Value, RequestError>;

/// Entry of the table of requests: the method name, and the function that handles the request and returns its result.
type RequestHandler = (&'static str, fn(&mut Workspace, Value) -> RequestResult);

macro_rules! request_handler {
    ($request:ty, $answer:path) => {
        (<$request>::METHOD, |world, params| {
            let params = serde_json::from_value(params)
                .map_err(|e| RequestError::new(ErrorCode::InvalidParams, e.to_string()))?;
            serde_json::to_value($answer(world, params))
                .map_err(|e| RequestError::new(ErrorCode::InternalError, e.to_string()))
        })
    };
}

/// As `request_handler`, for a function that returns an error of the protocol if the request is rejected.
macro_rules! fallible_handler {
    ($request:ty, $answer:path) => {
        (<$request>::METHOD, |world, params| {
            let params = serde_json::from_value(params)
                .map_err(|e| RequestError::new(ErrorCode::InvalidParams, e.to_string()))?;
            serde_json::to_value($answer(world, params)?)
                .map_err(|e| RequestError::new(ErrorCode::InternalError, e.to_string()))
        })
    };
}

const REQUESTS: &[RequestHandler] = &[
    request_handler!(request::HoverRequest, hover::hover),
    request_handler!(
        request::SignatureHelpRequest,
        signature_help::signature_help
    ),
    request_handler!(request::GotoDefinition, navigation::definition),
    request_handler!(request::GotoTypeDefinition, navigation::type_definition),
    request_handler!(request::References, references::references),
    request_handler!(request::DocumentHighlightRequest, highlights::highlights),
    request_handler!(request::LinkedEditingRange, linked_editing::linked_editing),
    fallible_handler!(request::PrepareRenameRequest, rename::prepare),
    fallible_handler!(request::Rename, rename::rename),
    request_handler!(request::CallHierarchyPrepare, call_hierarchy::prepare),
    request_handler!(
        request::CallHierarchyIncomingCalls,
        call_hierarchy::incoming
    ),
    request_handler!(
        request::CallHierarchyOutgoingCalls,
        call_hierarchy::outgoing
    ),
    request_handler!(request::DocumentSymbolRequest, symbols::symbols),
    request_handler!(request::WorkspaceSymbolRequest, workspace_symbols::symbols),
    request_handler!(request::Completion, completion::completion),
    request_handler!(request::ResolveCompletionItem, completion::resolve),
    request_handler!(request::Formatting, formatting::formatting),
    request_handler!(request::RangeFormatting, formatting::range_formatting),
    request_handler!(
        request::OnTypeFormatting,
        on_type_formatting::on_type_formatting
    ),
    request_handler!(request::CodeActionRequest, code_actions::code_actions),
    request_handler!(request::CodeLensRequest, code_lenses::code_lenses),
    request_handler!(request::CodeLensResolve, code_lenses::resolve),
    request_handler!(request::SemanticTokensFullRequest, semantic_tokens::full),
    request_handler!(request::SemanticTokensRangeRequest, semantic_tokens::range),
    request_handler!(
        request::SemanticTokensFullDeltaRequest,
        semantic_tokens::delta
    ),
    request_handler!(request::InlayHintRequest, inlay_hints::inlay_hints),
    request_handler!(request::FoldingRangeRequest, folding::folding),
    request_handler!(
        request::SelectionRangeRequest,
        selection_ranges::selection_ranges
    ),
    request_handler!(request::DocumentLinkRequest, document_links::document_links),
    request_handler!(
        request::DocumentDiagnosticRequest,
        pull_diagnostics::document
    ),
    request_handler!(
        request::WorkspaceDiagnosticRequest,
        pull_diagnostics::workspace
    ),
];

/// Handles a request: calls the function that the table contains for the method, and returns the result or an error of
/// the protocol. An unknown method is such an error.
pub(crate) fn handle_request(world: &mut Workspace, method: &str, params: Value) -> RequestResult {
    match REQUESTS.iter().find(|(known, _)| *known == method) {
        Some((_, answer)) => answer(world, params),
        None => Err(RequestError::new(
            ErrorCode::MethodNotFound,
            format!("unknown method {method}"),
        )),
    }
}

/// Returns the identifier of the request by which the server reads the configuration of the client.
pub(crate) fn configuration_id() -> RequestId {
    RequestId::from("configuration".to_owned())
}
