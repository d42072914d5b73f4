//! Printing of top-level declarations.

use super::Printer;
use super::layout::{Doc, concat, group, indent, nothing, text, word};
use super::ty::{dotted, names, type_params};
use crate::Mode;
use crate::ast::*;
use crate::text::quote;

impl Printer<'_> {
    /// Prints declarations one below the other. Those of several lines have empty lines around them.
    pub(super) fn items(&mut self, items: &[Item]) -> Doc {
        self.lines(
            items,
            |item| item.span,
            |p, _, item| {
                let doc = p.item(&item.kind);
                let apart = doc.flat_width().is_none();
                (concat([p.doc_lines(item.doc.as_ref()), doc]), apart)
            },
        )
    }

    fn item(&mut self, kind: &ItemKind) -> Doc {
        match kind {
            ItemKind::Use(modules) => text(format!("use {};", names(modules))),
            ItemKind::Include(file) => text(format!("include {}", quote(&file.name))),
            ItemKind::Const(defs) => {
                self.section("const", defs, |d| d.span, |d| &d.doc, Self::const_def)
            }
            ItemKind::Type(defs) if is_datatype(defs) => {
                self.section("datatype", defs, |d| d.span, |d| &d.doc, Self::type_def)
            }
            ItemKind::Type(defs) => {
                self.section("type", defs, |d| d.span, |d| &d.doc, Self::type_def)
            }
            ItemKind::Node(node) => self.node(node),
            ItemKind::Fragment(fragment) => {
                let head = self.fragment_head(fragment);
                self.with_body(head, &fragment.contract, &fragment.body)
            }
            ItemKind::Primitive(primitive) => self.primitive(primitive),
            ItemKind::Device(device) => self.device(device),
            ItemKind::Frame(frame) => self.frame(frame),
            ItemKind::Command(command) => self.command(command),
            ItemKind::Task(task) => self.task(task),
            ItemKind::Test(test) => {
                let head = text(format!("test {}", quote(&test.title.name)));
                self.with_body(head, &None, &test.body)
            }
            ItemKind::Broken(_) => nothing(),
        }
    }

    fn type_def(&mut self, def: &TypeDef) -> Doc {
        let params = type_params(&def.statics);
        let name = concat([
            self.doc_lines(def.doc.as_ref()),
            self.name(&def.name),
            params,
        ]);
        match &def.ty {
            Some(ty) => concat([name, word(" = "), self.ty(ty)]),
            None => name,
        }
    }

    /// Prints name, static parameters and ports. The ports are on lines of their own if they do not fit.
    pub(super) fn signature(&mut self, signature: &Signature) -> Doc {
        let head = concat([
            self.name(&signature.name),
            self.static_params(&signature.statics),
        ]);
        let ports = self.signature_ports(signature);
        group(concat([head, indent(ports)]))
    }

    fn signature_ports(&mut self, signature: &Signature) -> Doc {
        let mut parts = Vec::new();
        if let Some(inputs) = &signature.inputs {
            parts.extend([Doc::Line, self.ports(inputs)]);
        }
        if let Some(outputs) = &signature.outputs {
            parts.extend([Doc::Line, word("returns "), self.ports(outputs)]);
        }
        concat(parts)
    }

    fn node(&mut self, node: &NodeDecl) -> Doc {
        let (before, after) = match node.outside {
            Outside::Imported => (None, node.outside.word()),
            _ => (node.outside.word(), None),
        };
        let words = [node.modifier.word(), before, Some(node.kind.word()), after];
        let words = words.into_iter().flatten();
        let mut head: Vec<Doc> = words.flat_map(|of| [word(of), word(" ")]).collect();
        head.push(self.signature(&node.signature));
        let head = concat(head);
        match &node.definition {
            NodeDef::Body(_) if node.kind == NodeKind::Contract => {
                let contract = self.contract_alone(node.contract.as_ref());
                concat([head, word(";"), contract])
            }
            NodeDef::Body(body) => {
                let semi = word(if self.mode == Mode::Lustre { ";" } else { "" });
                self.with_body(concat([head, semi]), &node.contract, body)
            }
            NodeDef::Alias(callee) => concat([head, word(" = "), self.callee(callee), word(";")]),
            NodeDef::Extern => concat([head, word(";"), self.contract(node.contract.as_ref())]),
        }
    }

    /// Prints the header of a fragment: `fragment F (...) returns (...) when c restart budget b`.
    pub(super) fn fragment_head(&mut self, fragment: &FragmentDecl) -> Doc {
        let signature = &fragment.signature;
        let name = self.name(&signature.name);
        let statics = self.static_params(&signature.statics);
        let mut parts = vec![self.signature_ports(signature)];
        if let Some(when) = &fragment.when {
            parts.extend([Doc::Line, word("when "), self.expr(&when.condition)]);
            if when.restart {
                parts.push(word(" restart"));
            }
        }
        parts.push(self.budget(fragment.budget.as_ref()));
        group(concat([
            word("fragment "),
            name,
            statics,
            indent(concat(parts)),
        ]))
    }

    fn budget(&mut self, budget: Option<&Expr>) -> Doc {
        match budget {
            Some(budget) => concat([Doc::Line, word("budget "), self.expr(budget)]),
            None => nothing(),
        }
    }

    fn primitive(&mut self, primitive: &PrimitiveDecl) -> Doc {
        let signature = &primitive.signature;
        let name = self.name(&signature.name);
        let statics = self.static_params(&signature.statics);
        let ports = self.signature_ports(signature);
        let budget = self.budget(primitive.budget.as_ref());
        group(concat([
            word("primitive "),
            name,
            statics,
            indent(concat([ports, budget])),
            word(";"),
        ]))
    }

    fn device(&mut self, device: &DeviceDecl) -> Doc {
        let name = self.name(&device.name);
        let head = concat([word("device "), name, self.static_params(&device.statics)]);
        let sections = self.lines(
            &device.sections,
            |s| s.span,
            |p, _, section| (p.device_section(section), false),
        );
        concat([head, indent(concat([Doc::Hard, sections]))])
    }

    fn device_section(&mut self, section: &DeviceSection) -> Doc {
        /// Width of the longest keyword and a space.
        const COLUMN: usize = "actuator ".len();
        let word = section.kind.word();
        let ports = self.lines(
            &section.ports,
            |port| port.span,
            |p, _, port| (p.device_port(port), false),
        );
        concat([
            text(format!("{word:COLUMN$}")),
            Doc::Indent(COLUMN, Box::new(ports)),
        ])
    }

    fn device_port(&mut self, port: &DevicePort) -> Doc {
        let alternatives = self.phrases(&port.alternatives, |p, i, var| {
            concat([word(if i == 0 { "" } else { "| " }), p.var_decl(var)])
        });
        concat([alternatives, word(";")])
    }

    fn frame(&mut self, frame: &FrameDecl) -> Doc {
        let mut parts = vec![text(format!("frame {}", names(&frame.names)))];
        if let Some(parent) = &frame.parent {
            parts.push(text(format!(" in {}", dotted(parent))));
        }
        if let Some(pose) = &frame.pose {
            parts.extend([word(" = "), self.expr(pose)]);
        }
        parts.push(word(";"));
        concat(parts)
    }

    fn command(&mut self, command: &CommandDecl) -> Doc {
        let name = self.name(&command.name);
        let statics = self.static_params(&command.statics);
        let mut parts = vec![self.params(&command.params)];
        if !command.given.is_empty() {
            parts.extend([Doc::Line, word("given "), self.ports(&command.given)]);
        }
        parts.push(self.budget(command.budget.as_ref()));
        let head = group(concat([
            word("command "),
            name,
            statics,
            indent(concat(parts)),
        ]));
        self.with_body(head, &command.contract, &command.body)
    }

    /// Prints the parameters of a command or task, or nothing if there are none.
    pub(super) fn params(&mut self, params: &[VarDecl]) -> Doc {
        match params {
            [] => nothing(),
            params => concat([Doc::Line, self.ports(params)]),
        }
    }
}

impl NodeKind {
    /// Returns the keyword of the declaration.
    pub(super) fn word(self) -> &'static str {
        match self {
            NodeKind::Node => "node",
            NodeKind::Function => "function",
            NodeKind::Contract => "contract",
        }
    }
}

impl PortKind {
    /// Returns the keyword before the ports.
    fn word(self) -> &'static str {
        match self {
            PortKind::Actuator => "actuator",
            PortKind::Sensor => "sensor",
            PortKind::Status => "status",
        }
    }
}

/// Returns whether all definitions are algebraic data types, declared with `datatype`.
fn is_datatype(defs: &[TypeDef]) -> bool {
    let is_data =
        |def: &TypeDef| matches!(def.ty.as_ref().map(|ty| &ty.kind), Some(TypeKind::Data(_)));
    defs.iter().all(is_data)
}

impl Modifier {
    /// Returns the keyword of the modifier.
    pub(crate) fn word(self) -> Option<&'static str> {
        match self {
            Modifier::None => None,
            Modifier::Unsafe => Some("unsafe"),
            Modifier::Opaque => Some("opaque"),
            Modifier::Transparent => Some("transparent"),
        }
    }
}
