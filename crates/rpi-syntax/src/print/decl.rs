//! Printing of top-level declarations.

use super::Printer;
use super::body;
use super::call;
use super::contract;
use super::expr;
use super::layout::{Doc, concat, empty, group, indent, text, word};
use super::list;
use super::task;
use super::ty;
use super::ty::{dotted, names, type_params};
use crate::Dialect;
use crate::ast::*;
use crate::string_literal::quote;

/// Prints declarations one below the other. A declaration of several lines has an empty line before and after it.
pub(super) fn print_items(printer: &Printer<'_>, items: &[Item]) -> Doc {
    list::print_lines(
        printer,
        items,
        |item| item.span,
        |p, _, item| {
            let doc = print_item(p, &item.kind);
            let apart = doc.flat_width().is_none();
            (concat([list::doc_lines(p, item.doc.as_ref()), doc]), apart)
        },
    )
}

fn print_item(printer: &Printer<'_>, kind: &ItemKind) -> Doc {
    match kind {
        ItemKind::Use(modules) => text(format!("use {};", names(modules))),
        ItemKind::Include(file) => text(format!("include {}", quote(&file.name))),
        ItemKind::Const(defs) => body::print_section(
            printer,
            "const",
            defs,
            |d| d.span,
            |d| &d.doc,
            ty::const_def,
        ),
        ItemKind::Type(defs) if is_datatype(defs) => {
            body::print_section(printer, "datatype", defs, |d| d.span, |d| &d.doc, type_def)
        }
        ItemKind::Type(defs) => {
            body::print_section(printer, "type", defs, |d| d.span, |d| &d.doc, type_def)
        }
        ItemKind::Node(node) => print_node(printer, node),
        ItemKind::Fragment(fragment) => {
            let head = fragment_head(printer, fragment);
            body::with_body(printer, head, &fragment.contract, &fragment.body)
        }
        ItemKind::Primitive(primitive) => print_primitive(printer, primitive),
        ItemKind::Device(device) => print_device(printer, device),
        ItemKind::Frame(frame) => print_frame(printer, frame),
        ItemKind::Command(command) => print_command(printer, command),
        ItemKind::Task(task) => task::print_task(printer, task),
        ItemKind::Test(test) => {
            let head = text(format!("test {}", quote(&test.title.name)));
            body::with_body(printer, head, &None, &test.body)
        }
        ItemKind::Error(_) => empty(),
    }
}

fn type_def(printer: &Printer<'_>, def: &TypeDef) -> Doc {
    let params = type_params(&def.statics);
    let name = concat([
        list::doc_lines(printer, def.doc.as_ref()),
        ty::print_name(printer, &def.name),
        params,
    ]);
    match &def.ty {
        Some(ty) => concat([name, word(" = "), ty::print_ty(printer, ty)]),
        None => name,
    }
}

/// Prints the name, static parameters and ports of a declaration. The ports are on lines of their own if they do not
/// fit on the line.
pub(super) fn print_signature(printer: &Printer<'_>, signature: &Signature) -> Doc {
    let head = concat([
        ty::print_name(printer, &signature.name),
        ty::static_params(printer, &signature.statics),
    ]);
    let ports = signature_ports(printer, signature);
    group(concat([head, indent(ports)]))
}

fn signature_ports(printer: &Printer<'_>, signature: &Signature) -> Doc {
    let mut parts = Vec::new();
    if let Some(inputs) = &signature.inputs {
        parts.extend([Doc::Line, ty::print_ports(printer, inputs)]);
    }
    if let Some(outputs) = &signature.outputs {
        parts.extend([
            Doc::Line,
            word("returns "),
            ty::print_ports(printer, outputs),
        ]);
    }
    concat(parts)
}

fn print_node(printer: &Printer<'_>, node: &NodeDecl) -> Doc {
    let (before, after) = match node.external_form {
        ExternalForm::Imported => (None, node.external_form.keyword()),
        _ => (node.external_form.keyword(), None),
    };
    let words = [
        node.modifier.keyword(),
        before,
        Some(node.kind.keyword()),
        after,
    ];
    let words = words.into_iter().flatten();
    let mut head: Vec<Doc> = words.flat_map(|of| [word(of), word(" ")]).collect();
    head.push(print_signature(printer, &node.signature));
    let head = concat(head);
    match &node.definition {
        NodeDef::Body(_) if node.kind == NodeKind::Contract => {
            let contract = contract::contract_alone(printer, node.contract.as_ref());
            concat([head, word(";"), contract])
        }
        NodeDef::Body(body) => {
            let semi = word(if printer.mode == Dialect::Lustre {
                ";"
            } else {
                ""
            });
            body::with_body(printer, concat([head, semi]), &node.contract, body)
        }
        NodeDef::Alias(callee) => concat([
            head,
            word(" = "),
            call::print_callee(printer, callee),
            word(";"),
        ]),
        NodeDef::Extern => concat([
            head,
            c_name(node),
            word(";"),
            contract::print_contract(printer, node.contract.as_ref()),
        ]),
    }
}

fn c_name(node: &NodeDecl) -> Doc {
    match &node.c_name {
        Some(name) => text(format!(" = {}", quote(&name.name))),
        None => empty(),
    }
}

/// Prints the header of a fragment: `fragment F (...) returns (...) when c restart budget b`.
pub(super) fn fragment_head(printer: &Printer<'_>, fragment: &FragmentDecl) -> Doc {
    let signature = &fragment.signature;
    let name = ty::print_name(printer, &signature.name);
    let statics = ty::static_params(printer, &signature.statics);
    let mut parts = vec![signature_ports(printer, signature)];
    if let Some(when) = &fragment.when {
        parts.extend([
            Doc::Line,
            word("when "),
            expr::print_expr(printer, &when.condition),
        ]);
        if when.resets {
            parts.push(word(" restart"));
        }
    }
    parts.push(print_budget(printer, fragment.budget.as_ref()));
    group(concat([
        word("fragment "),
        name,
        statics,
        indent(concat(parts)),
    ]))
}

fn print_budget(printer: &Printer<'_>, budget: Option<&Expr>) -> Doc {
    match budget {
        Some(budget) => concat([
            Doc::Line,
            word("budget "),
            expr::print_expr(printer, budget),
        ]),
        None => empty(),
    }
}

fn print_primitive(printer: &Printer<'_>, primitive: &PrimitiveDecl) -> Doc {
    let signature = &primitive.signature;
    let name = ty::print_name(printer, &signature.name);
    let statics = ty::static_params(printer, &signature.statics);
    let ports = signature_ports(printer, signature);
    let budget = print_budget(printer, primitive.budget.as_ref());
    group(concat([
        word("primitive "),
        name,
        statics,
        indent(concat([ports, budget])),
        word(";"),
    ]))
}

fn print_device(printer: &Printer<'_>, device: &DeviceDecl) -> Doc {
    let name = ty::print_name(printer, &device.name);
    let head = concat([
        word("device "),
        name,
        ty::static_params(printer, &device.statics),
    ]);
    let sections = list::print_lines(
        printer,
        &device.sections,
        |s| s.span,
        |p, _, section| (device_section(p, section), false),
    );
    concat([head, indent(concat([Doc::HardLine, sections]))])
}

fn device_section(printer: &Printer<'_>, section: &DeviceSection) -> Doc {
    /// Width in characters of the keyword column of a device's port sections: the longest keyword and a space.
    const COLUMN: usize = "actuator ".len();
    let word = section.kind.keyword();
    let ports = list::print_lines(
        printer,
        &section.ports,
        |port| port.span,
        |p, _, port| (device_port(p, port), false),
    );
    concat([
        text(format!("{word:COLUMN$}")),
        Doc::Indent(COLUMN, Box::new(ports)),
    ])
}

fn device_port(printer: &Printer<'_>, port: &DevicePort) -> Doc {
    let alternatives = list::print_phrases(printer, &port.alternatives, |p, i, var| {
        concat([word(if i == 0 { "" } else { "| " }), ty::var_decl(p, var)])
    });
    concat([alternatives, word(";")])
}

fn print_frame(printer: &Printer<'_>, frame: &FrameDecl) -> Doc {
    let mut parts = vec![text(format!("frame {}", names(&frame.names)))];
    if let Some(parent) = &frame.parent {
        parts.push(text(format!(" in {}", dotted(parent))));
    }
    if let Some(pose) = &frame.pose {
        parts.extend([word(" = "), expr::print_expr(printer, pose)]);
    }
    parts.push(word(";"));
    concat(parts)
}

fn print_command(printer: &Printer<'_>, command: &CommandDecl) -> Doc {
    let name = ty::print_name(printer, &command.name);
    let statics = ty::static_params(printer, &command.statics);
    let mut parts = vec![print_params(printer, &command.params)];
    if !command.given.is_empty() {
        parts.extend([
            Doc::Line,
            word("given "),
            ty::print_ports(printer, &command.given),
        ]);
    }
    parts.push(print_budget(printer, command.budget.as_ref()));
    let head = group(concat([
        word("command "),
        name,
        statics,
        indent(concat(parts)),
    ]));
    body::with_body(printer, head, &command.contract, &command.body)
}

/// Prints the parameters of a command or task in parentheses; prints nothing if there are none.
pub(super) fn print_params(printer: &Printer<'_>, params: &[VarDecl]) -> Doc {
    match params {
        [] => empty(),
        params => concat([Doc::Line, ty::print_ports(printer, params)]),
    }
}

impl NodeKind {
    /// Returns the keyword that begins the declaration.
    pub(super) fn keyword(self) -> &'static str {
        match self {
            NodeKind::Node => "node",
            NodeKind::Function => "function",
            NodeKind::Contract => "contract",
        }
    }
}

impl PortKind {
    /// Returns the keyword that begins a section of ports of this kind.
    fn keyword(self) -> &'static str {
        match self {
            PortKind::Actuator => "actuator",
            PortKind::Sensor => "sensor",
            PortKind::Status => "status",
        }
    }
}

/// Returns whether all definitions are of algebraic data types, so that their section begins with `datatype` instead of
/// `type`.
fn is_datatype(defs: &[TypeDef]) -> bool {
    let is_data = |def: &TypeDef| {
        matches!(
            def.ty.as_ref().map(|ty| &ty.kind),
            Some(TypeKind::Datatype(_))
        )
    };
    defs.iter().all(is_data)
}

impl Modifier {
    /// Returns the keyword of the modifier; `None` for no modifier.
    pub(crate) fn keyword(self) -> Option<&'static str> {
        match self {
            Modifier::None => None,
            Modifier::Unsafe => Some("unsafe"),
            Modifier::Opaque => Some("opaque"),
            Modifier::Transparent => Some("transparent"),
        }
    }
}
