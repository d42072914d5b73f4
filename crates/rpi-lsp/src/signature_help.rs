//! Signature help: the parameters of the call around the cursor, with the one at the cursor.

use lsp_types::{
    Documentation, MarkupContent, MarkupKind, ParameterInformation, ParameterLabel, SignatureHelp,
    SignatureHelpParams, SignatureInformation,
};
use rpi_diag::FileId;
use rpi_driver::Inspection;
use rpi_prims::PrimId;
use rpi_sema::query::{Def, DefKind, builtins};

use crate::cursor_tokens::OpenCall;
use crate::description::summary;
use crate::primitive;
use crate::workspace::Workspace;

/// Handles `textDocument/signatureHelp`: returns the signature of the call around a position; `None` if there is no call,
/// or its callee is undefined.
pub(crate) fn signature_help(
    world: &mut Workspace,
    params: SignatureHelpParams,
) -> Option<SignatureHelp> {
    let at = params.text_document_position_params;
    let seen = world.analysis(&at.text_document.uri)?;
    let offset = world.locations(&seen).offset(at.position);
    let text = seen.sources.text(FileId(0));
    let call = OpenCall::around(text, offset as usize, seen.mode())?;
    let signature = declared(&seen, offset, &call)
        .or_else(|| primitive_signature(&call))
        .or_else(|| builtin_signature(&call))?;
    Some(SignatureHelp {
        signatures: vec![signature.information()],
        active_signature: Some(0),
        active_parameter: signature.active,
    })
}

/// Signature of a callee, with the parameters of the brackets at the cursor.
struct Signature {
    label: String,
    doc: String,
    /// Byte ranges of the parameters in the label, with their documentation.
    parameters: Vec<(std::ops::Range<usize>, String)>,
    active: Option<u32>,
}

impl Signature {
    fn information(&self) -> SignatureInformation {
        let units = |end: usize| {
            let text = &self.label[..end];
            u32::try_from(text.encode_utf16().count()).unwrap_or(u32::MAX)
        };
        let parameter = |(range, doc): &(std::ops::Range<usize>, String)| ParameterInformation {
            label: ParameterLabel::LabelOffsets([units(range.start), units(range.end)]),
            documentation: markdown(doc),
        };
        SignatureInformation {
            label: self.label.clone(),
            documentation: markdown(&self.doc),
            parameters: Some(self.parameters.iter().map(parameter).collect()),
            active_parameter: self.active,
        }
    }
}

fn markdown(text: &str) -> Option<Documentation> {
    let value = text.to_owned();
    let kind = MarkupKind::Markdown;
    (!text.is_empty()).then_some(Documentation::MarkupContent(MarkupContent { kind, value }))
}

/// Returns the signature of a declared callee, such as a node, command or task.
fn declared(seen: &Inspection, offset: u32, call: &OpenCall) -> Option<Signature> {
    let index = seen.index();
    let callee = index.resolve(FileId(0), offset, &call.callee)?;
    let def = index.def(callee);
    let defs: Vec<&Def> = index
        .parameters(callee)
        .iter()
        .map(|id| index.def(*id))
        .collect();
    let statics = defs.iter().filter(|def| def.kind == DefKind::StaticParam);
    let values = defs
        .iter()
        .filter(|def| !matches!(def.kind, DefKind::StaticParam | DefKind::TakenOver));
    let row = |def: &&Def| {
        let doc = def.doc.as_deref().unwrap_or_default().to_owned();
        (summary(seen, def), def.name.to_string(), doc)
    };
    let rows = [statics.map(row).collect(), values.map(row).collect()];
    let doc = def.doc.as_deref().unwrap_or_default();
    Some(signature(call, doc, rows))
}

/// Returns the signature of a primitive.
fn primitive_signature(call: &OpenCall) -> Option<Signature> {
    let desc = PrimId::from_name(&call.callee)?.desc();
    let row = |(name, text): (&str, String)| (text, name.to_owned(), String::new());
    let statics = primitive::static_parameters(desc).into_iter().map(row);
    let ports = primitive::in_ports(desc).into_iter().map(row);
    let rows = [statics.collect(), ports.collect()];
    Some(signature(call, &primitive::doc(desc), rows))
}

/// Parameter in a signature: its text with the type, its name, and its documentation.
type Row = (String, String, String);

/// Returns a signature with the static parameters and the parameters of a callee.
fn signature(call: &OpenCall, doc: &str, [statics, values]: [Vec<Row>; 2]) -> Signature {
    let mut label = call.callee.clone();
    let mut parameters = Vec::new();
    let lists = [(true, statics, "<<", ">>"), (false, values, "(", ")")];
    let mut names = Vec::new();
    for (is_static, rows, open, close) in lists {
        if is_static && rows.is_empty() {
            continue;
        }
        label.push_str(open);
        for (k, (text, name, doc)) in rows.into_iter().enumerate() {
            label.push_str(if k == 0 { "" } else { "; " });
            let start = label.len();
            label.push_str(&text);
            if is_static == call.is_static {
                parameters.push((start..label.len(), doc));
                names.push(name);
            }
        }
        label.push_str(close);
    }
    let named = call
        .name
        .as_ref()
        .map(|name| names.iter().position(|one| one == name));
    let active = named.unwrap_or_else(|| (call.argument < names.len()).then_some(call.argument));
    Signature {
        label,
        doc: doc.to_owned(),
        parameters,
        active: active.and_then(|at| u32::try_from(at).ok()),
    }
}

/// Returns the signature of a predeclared operator, such as `hold(x, init)`.
fn builtin_signature(call: &OpenCall) -> Option<Signature> {
    let known = builtins().find(|one| one.is_call && one.name == call.callee)?;
    let open = if call.is_static { "<<" } else { "(" };
    let start = known.usage.find(open)? + open.len();
    let length = known.usage[start..].find([')', '>'])?;
    let mut parameters = Vec::new();
    let mut at = start;
    for part in known.usage[start..start + length].split_inclusive([',', ';']) {
        let text = part.trim_end_matches([',', ';']);
        let indent = text.len() - text.trim_start().len();
        parameters.push((at + indent..at + text.trim_end().len(), String::new()));
        at += part.len();
    }
    let active = (call.argument < parameters.len()).then_some(call.argument);
    Some(Signature {
        label: known.usage,
        doc: known.doc.trim().to_owned(),
        parameters,
        active: active.and_then(|at| u32::try_from(at).ok()),
    })
}
