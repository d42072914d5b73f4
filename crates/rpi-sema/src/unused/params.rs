//! Unused parameters and in-ports.

use crate::check::static_params_of;
use crate::program::{Decl, DeclKind};
use crate::unused::walk;
use rpi_diag::{Code, Diagnostic, Fix};
use rpi_syntax::Name;
use rpi_syntax::ast::{Ident, NodeDef, NodeKind, Signature, VarDecl, Visitor};

/// Name of a parameter or in-port, and the word for its kind in messages, such as "in-port".
type ParamName<'a> = (&'a Ident, &'static str);

/// Parameters and in-ports that no expression visited so far reads.
struct UnusedParams<'a>(Vec<ParamName<'a>>);

impl<'a> Visitor<'a> for UnusedParams<'a> {
    fn visit_name(&mut self, read: &'a Name) {
        self.0.retain(|(name, _)| name.name != *read);
    }
}

/// Returns a warning for each static parameter, parameter and in-port that a declaration does not read. A leading `_`
/// in the name suppresses the warning.
pub(super) fn unread(decl: &Decl<'_>) -> Vec<Diagnostic> {
    let mut left = parameters(decl.kind);
    left.retain(|(name, _)| !name.name.starts_with('_'));
    let mut left = UnusedParams(left);
    if !left.0.is_empty() {
        walk(decl.kind, &mut left);
    }
    let unused = left.0.into_iter();
    unused
        .map(|(name, what)| diagnostic(&decl.name, name, what))
        .collect()
}

/// Returns the parameters and in-ports of a declaration that its body could read. Ports of external declarations,
/// contracts and aliases are left out, because others decide which ports these have.
fn parameters(kind: DeclKind<'_>) -> Vec<ParamName<'_>> {
    let vars: [(&[VarDecl], &'static str); 2] = match kind {
        DeclKind::Node(node) if node.kind == NodeKind::Contract => return Vec::new(),
        DeclKind::Node(node) => match node.definition {
            NodeDef::Body(_) => [(declare_inputs(&node.signature), "in-port"), (&[], "")],
            NodeDef::Alias(_) => [(&[], ""), (&[], "")],
            NodeDef::Extern => return Vec::new(),
        },
        DeclKind::Fragment(fragment) => {
            [(declare_inputs(&fragment.signature), "in-port"), (&[], "")]
        }
        DeclKind::Command(command) => [
            (&command.params, "parameter"),
            (&command.given, "given value"),
        ],
        DeclKind::Task(task) => [(&task.params, "parameter"), (&[], "")],
        DeclKind::Device(_) => [(&[], ""), (&[], "")],
        _ => return Vec::new(),
    };
    let statics = static_params_of(kind).into_iter();
    let statics = statics.map(|param| (param.name(), "static parameter"));
    let ports = vars.into_iter().flat_map(|(vars, what)| {
        let names = vars.iter().flat_map(|var| &var.names);
        names.map(move |name| (name, what))
    });
    statics.chain(ports).collect()
}

fn declare_inputs(signature: &Signature) -> &[VarDecl] {
    signature.inputs.as_deref().unwrap_or_default()
}

fn diagnostic(of: &Name, name: &Ident, what: &str) -> Diagnostic {
    let Ident { name, span } = name;
    Diagnostic::new(
        Code::RPI1017,
        format!("`{of}` does not use its {what} `{name}`"),
    )
    .primary(*span, "never read")
    .help(format!("delete it, or rename it to `_{name}` to keep it"))
    .fix(Fix::maybe("mark it as intentionally unused").insert_before(*span, "_"))
}
