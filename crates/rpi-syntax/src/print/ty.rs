//! Printing of types, units and variables.

use super::Printer;
use super::layout::{Doc, concat, nothing, text, word};
use super::list::{PORTS, SPACED_COMMAS, SPACED_SEMIS, SQUARE, STATIC_PARAMS};
use crate::Mode;
use crate::ast::*;
use crate::ops::BinaryOp;
use std::fmt::Write as _;

impl Printer<'_> {
    pub(super) fn ty(&mut self, ty: &Type) -> Doc {
        match &ty.kind {
            TypeKind::Bool => self.part(ty.span, word("bool")),
            TypeKind::Int => self.part(ty.span, word("int")),
            TypeKind::Real(None) => self.part(ty.span, word("real")),
            TypeKind::Real(Some(unit)) => concat([word("real["), self.unit(unit), word("]")]),
            TypeKind::Named(named) => self.named_type(named),
            TypeKind::Array(array) => {
                concat([self.ty(&array.element), word("^"), self.size(&array.size)])
            }
            TypeKind::Optional(inner) => {
                // Two adjacent `?` would be lexed as `??`.
                let twice = matches!(inner.kind, TypeKind::Optional(_));
                concat([self.ty(inner), word(if twice { " ?" } else { "?" })])
            }
            TypeKind::Subrange(range) => self.subrange(range),
            TypeKind::Enum(values) => {
                let values = self.list(
                    SPACED_COMMAS,
                    values,
                    |v| v.name.span,
                    |p, value| concat([p.doc_lines(value.doc.as_ref()), p.name(&value.name)]),
                );
                concat([word("enum "), values])
            }
            TypeKind::Tuple(types) => self.list(SQUARE, types, |ty| ty.span, Self::ty),
            TypeKind::Refined(refined) => concat([word("subtype "), self.refined(refined)]),
            TypeKind::Data(all) => self.phrases(all, |p, i, constructor| {
                let bar = word(if i == 0 { "" } else { "| " });
                let name = p.name(&constructor.name);
                let fields = match &constructor.fields[..] {
                    [] => nothing(),
                    fields => concat([word(" "), p.ports(fields)]),
                };
                concat([bar, name, fields])
            }),
            TypeKind::Struct(fields) => {
                let fields = self.list(SPACED_SEMIS, fields, |f| f.span, Self::var_decl);
                concat([word("struct "), fields])
            }
            TypeKind::Broken => nothing(),
        }
    }

    /// Prints a refinement type: `{ x: int | x > 0 }`.
    pub(super) fn refined(&mut self, refined: &Refined) -> Doc {
        let name = self.name(&refined.name);
        let (base, condition) = (self.ty(&refined.base), self.expr(&refined.condition));
        concat([
            word("{ "),
            name,
            word(": "),
            base,
            word(" | "),
            condition,
            word(" }"),
        ])
    }

    fn named_type(&mut self, named: &NamedType) -> Doc {
        let args = match self.mode {
            Mode::Rpi => self.static_args(&named.statics),
            Mode::Lustre => self.type_args("<", &named.statics),
        };
        let head = concat([self.name(&named.name), args]);
        let Some(frames) = &named.frames else {
            return head;
        };
        let in_frame = text(dotted(&frames.in_frame));
        let frames = match &frames.of {
            Some(of) => concat([text(dotted(of)), word(" in "), in_frame]),
            None => in_frame,
        };
        concat([head, word("("), frames, word(")")])
    }

    /// Prints the size of an array, in parentheses unless it is plain arithmetic.
    fn size(&mut self, size: &Expr) -> Doc {
        let inner = self.expr(size);
        match is_arithmetic(size) {
            true => inner,
            false => concat([word("("), inner, word(")")]),
        }
    }

    fn subrange(&mut self, range: &Subrange) -> Doc {
        let mut bound = |bound: &Option<Expr>| match bound {
            Some(bound) => self.expr(bound),
            None => word("*"),
        };
        let (from, to) = (bound(&range.from), bound(&range.to));
        concat([word("subrange ["), from, word(", "), to, word("] of int")])
    }

    pub(super) fn unit(&self, unit: &Unit) -> Doc {
        let mut written = String::new();
        for factor in &unit.factors {
            let sign = match (written.is_empty(), factor.power < 0) {
                (true, false) => "",
                (true, true) => "1/",
                (false, false) => "*",
                (false, true) => "/",
            };
            let _ = write!(written, "{sign}{}", factor.unit.name);
            if factor.power.abs() != 1 {
                let _ = write!(written, "^{}", factor.power.abs());
            }
        }
        text(if written.is_empty() {
            "1".to_owned()
        } else {
            written
        })
    }

    /// Prints a declaration of variables: `a, b: T when c = d`.
    pub(super) fn var_decl(&mut self, var: &VarDecl) -> Doc {
        let head = if var.is_const { "const " } else { "" };
        let mut parts = vec![
            self.doc_lines(var.doc.as_ref()),
            word(head),
            text(names(&var.names)),
            word(": "),
        ];
        parts.push(self.ty(&var.ty));
        if let Some(clock) = &var.clock {
            parts.extend([word(" when "), self.clock(clock)]);
        }
        if let Some(default) = &var.default {
            parts.extend([word(" = "), self.expr(default)]);
        }
        concat(parts)
    }

    /// Prints a definition of constants: `a, b: T = e`.
    pub(super) fn const_def(&mut self, def: &ConstDef) -> Doc {
        let doc = self.doc_lines(def.doc.as_ref());
        concat([doc, self.constant(def)])
    }

    /// Prints a definition of constants without its documentation.
    fn constant(&mut self, def: &ConstDef) -> Doc {
        let mut parts = vec![text(names(&def.names))];
        if let Some(ty) = &def.ty {
            parts.extend([word(": "), self.ty(ty)]);
        }
        if let Some(value) = &def.value {
            parts.extend([word(" = "), self.expr(value)]);
        }
        concat(parts)
    }

    /// Prints a list of ports: `(a: T; b: U)`.
    pub(super) fn ports(&mut self, ports: &[VarDecl]) -> Doc {
        self.list(PORTS, ports, |port| port.span, Self::var_decl)
    }

    /// Prints static parameters with a space before them: `<<a: T; type t>>`.
    pub(super) fn static_params(&mut self, params: &[StaticParam]) -> Doc {
        match params {
            [] => nothing(),
            params if self.mode == Mode::Lustre && params.iter().all(is_bare) => {
                type_params(params)
            }
            params => {
                let list = self.list(STATIC_PARAMS, params, |p| p.span, Self::static_param);
                concat([word(" "), list])
            }
        }
    }

    fn static_param(&mut self, param: &StaticParam) -> Doc {
        let written = match &param.kind {
            StaticParamKind::Type(name, constraint) => {
                let constraint = constraint.as_ref().map_or_else(nothing, |constraint| {
                    concat([word(": "), self.name(constraint)])
                });
                concat([word("type "), self.name(name), constraint])
            }
            StaticParamKind::Value(def) => {
                // Lustre V6 requires a keyword before each static parameter.
                let head = if self.mode == Mode::Lustre {
                    "const "
                } else {
                    ""
                };
                concat([word(head), self.constant(def)])
            }
            StaticParamKind::Node(kind, signature) => {
                concat([word(kind.word()), word(" "), self.signature(signature)])
            }
        };
        concat([self.doc_lines(param.doc.as_ref()), written])
    }
}

impl Printer<'_> {
    /// Prints a name, with its source offset.
    pub(super) fn name(&self, name: &Ident) -> Doc {
        self.part(name.span, text(&*name.name))
    }
}

/// Returns whether the size of an array is plain arithmetic, which needs no parentheses.
fn is_arithmetic(size: &Expr) -> bool {
    use BinaryOp::{Add, Div, IntDiv, Mod, Mul, Sub};
    match &size.kind {
        ExprKind::Binary(binary) => {
            matches!(binary.op, Add | Sub | Mul | Div | IntDiv | Mod)
                && is_arithmetic(&binary.lhs)
                && is_arithmetic(&binary.rhs)
        }
        ExprKind::Unary(..) | ExprKind::If(_) | ExprKind::When(_) => false,
        _ => true,
    }
}

/// Returns names separated by commas: `a, b`.
pub(super) fn names(names: &[Ident]) -> String {
    let names: Vec<&str> = names.iter().map(|name| name.name.as_str()).collect();
    names.join(", ")
}

/// Returns the text of a qualified name: `a.b`.
pub(super) fn dotted(dotted: &Dotted) -> String {
    let parts: Vec<&str> = dotted.parts.iter().map(|part| part.name.as_str()).collect();
    parts.join(".")
}

/// Prints type parameters after the name of a type, or of a node of Kind 2: `<T; U>`.
pub(super) fn type_params(params: &[StaticParam]) -> Doc {
    let names = params.iter().filter_map(|param| match &param.kind {
        StaticParamKind::Type(name, _) => Some(name.name.as_str()),
        _ => None,
    });
    let names: Vec<&str> = names.collect();
    match &names[..] {
        [] => nothing(),
        all => text(format!("<{}>", all.join("; "))),
    }
}

/// Returns whether a type parameter was written as `T`, without the keyword `type`.
fn is_bare(param: &StaticParam) -> bool {
    matches!(&param.kind, StaticParamKind::Type(name, _) if name.span == param.span && !param.span.is_none())
}
