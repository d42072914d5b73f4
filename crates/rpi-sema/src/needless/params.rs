//! Parameters and in-ports that nothing reads.

use super::walk;
use crate::check::params_of;
use crate::program::{Decl, DeclKind};
use rpi_diag::{Code, Finding, Fix};
use rpi_syntax::Name;
use rpi_syntax::ast::{Ident, NodeDef, NodeKind, Signature, VarDecl, Visit};

/// A parameter or in-port, and what it is called in messages.
type Declared<'a> = (&'a Ident, &'static str);

/// Those that nothing was seen to read.
struct Unread<'a>(Vec<Declared<'a>>);

impl<'a> Visit<'a> for Unread<'a> {
    fn name(&mut self, read: &'a Name) {
        self.0.retain(|(name, _)| name.name != *read);
    }
}

/// A warning for each parameter and in-port that a declaration does not read. A name that begins with `_` is meant so.
pub(super) fn unread(decl: &Decl<'_>) -> Vec<Finding> {
    let mut left = parameters(decl.kind);
    left.retain(|(name, _)| !name.name.starts_with('_'));
    let mut left = Unread(left);
    if !left.0.is_empty() {
        walk(decl.kind, &mut left);
    }
    let told = left.0.into_iter();
    told.map(|(name, what)| finding(&decl.name, name, what))
        .collect()
}

/// What a declaration takes and could read. The ports of what is defined outside, of contracts and of other names for
/// something are those of something else.
fn parameters(kind: DeclKind<'_>) -> Vec<Declared<'_>> {
    let vars: [(&[VarDecl], &'static str); 2] = match kind {
        DeclKind::Node(node) if node.kind == NodeKind::Contract => return Vec::new(),
        DeclKind::Node(node) => match node.definition {
            NodeDef::Body(_) => [(inputs(&node.signature), "in-port"), (&[], "")],
            NodeDef::Alias(_) => [(&[], ""), (&[], "")],
            NodeDef::Extern => return Vec::new(),
        },
        DeclKind::Fragment(fragment) => [(inputs(&fragment.signature), "in-port"), (&[], "")],
        DeclKind::Command(command) => [
            (&command.params, "parameter"),
            (&command.given, "given value"),
        ],
        DeclKind::Task(task) => [(&task.params, "parameter"), (&[], "")],
        DeclKind::Device(_) => [(&[], ""), (&[], "")],
        _ => return Vec::new(),
    };
    let statics = params_of(kind).into_iter();
    let statics = statics.map(|param| (param.name(), "static parameter"));
    let ports = vars.into_iter().flat_map(|(vars, what)| {
        let names = vars.iter().flat_map(|var| &var.names);
        names.map(move |name| (name, what))
    });
    statics.chain(ports).collect()
}

fn inputs(signature: &Signature) -> &[VarDecl] {
    signature.inputs.as_deref().unwrap_or_default()
}

fn finding(of: &Name, name: &Ident, what: &str) -> Finding {
    let Ident { name, span } = name;
    Finding::new(
        Code::RPI1017,
        format!("`{of}` does not use its {what} `{name}`"),
    )
    .at(*span, "nothing reads it")
    .help(format!("delete it, or call it `_{name}` if it shall stay"))
    .fix(Fix::maybe("mark it as meant").insert_before(*span, "_"))
}
