//! Dumps of expressions, calls, types and literals.

use super::sexp::Sexp;
use super::{Dumper, Parens, list_node, nodes};
use crate::ast::*;

pub(super) fn name(ident: &Ident) -> Sexp {
    Sexp::atom(ident.name.as_str())
}

pub(super) fn dotted(dotted: &Dotted) -> Sexp {
    nodes("dotted", &dotted.parts, name)
}

/// Creates the list `(tag value)`, where `one` converts the value; [`Sexp::Empty`] for `None`.
pub(super) fn option<T>(tag: &str, value: Option<&T>, one: impl Fn(&T) -> Sexp) -> Sexp {
    value.map_or(Sexp::Empty, |value| list_node(tag, [one(value)]))
}

pub(super) fn flag(tag: &str, set: bool) -> Sexp {
    if set { Sexp::atom(tag) } else { Sexp::Empty }
}

fn unit(unit: &Unit) -> Sexp {
    nodes("unit", &unit.factors, |factor| {
        list_node(&factor.unit.name, [Sexp::atom(factor.power.to_string())])
    })
}

pub(super) fn clock(clock: &Clock) -> Sexp {
    let tick = match &clock.value {
        ClockValue::True => Sexp::atom("true"),
        ClockValue::False => Sexp::atom("false"),
        ClockValue::Value(value) => name(value),
    };
    list_node("clock", [tick, name(&clock.flow)])
}

impl Dumper {
    pub(super) fn expr(&self, expr: &Expr) -> Sexp {
        match &expr.kind {
            ExprKind::Bool(value) => Sexp::atom(value.to_string()),
            ExprKind::Number(number) => Sexp::atom(number.text.as_str()),
            ExprKind::Quantity(q) => list_node(
                "quantity",
                [Sexp::atom(q.number.text.as_str()), unit(&q.unit)],
            ),
            ExprKind::Str(content) => Sexp::quoted(content),
            ExprKind::Name(name) => Sexp::atom(name.as_str()),
            ExprKind::Field(field) => {
                list_node("field", [self.expr(&field.base), name(&field.field)])
            }
            ExprKind::Index(index) => {
                list_node("index", [self.expr(&index.base), self.expr(&index.index)])
            }
            ExprKind::Slice(of) => list_node("slice", [self.expr(&of.base), self.slice(&of.slice)]),
            ExprKind::BitRange(of) => {
                let parts = [&of.base, &of.high, &of.low];
                list_node("bits", parts.map(|part| self.expr(part)))
            }
            ExprKind::Unary(op, operand) => {
                list_node("unary", [Sexp::atom(op.spelling()), self.expr(operand)])
            }
            ExprKind::Binary(b) => {
                list_node(b.op.spelling(), [self.expr(&b.lhs), self.expr(&b.rhs)])
            }
            ExprKind::When(when) => list_node("when", [self.expr(&when.value), clock(&when.clock)]),
            ExprKind::If(i) => self.conditional(i),
            ExprKind::Call(call) => self.call(call),
            ExprKind::BoolList(BoolListOp::AtMostOne, xs) => nodes("#", xs, |x| self.expr(x)),
            ExprKind::BoolList(BoolListOp::Nor, xs) => nodes("nor", xs, |x| self.expr(x)),
            ExprKind::Merge(merge) => self.merge(merge),
            ExprKind::Paren(inner) if self.parens == Parens::Drop => self.expr(inner),
            ExprKind::Paren(inner) => list_node("paren", [self.expr(inner)]),
            ExprKind::Tuple(elements) => nodes("tuple", elements, |x| self.expr(x)),
            ExprKind::Array(elements) => nodes("array", elements, |x| self.expr(x)),
            ExprKind::Quantified(of) => self.quantified(of),
            ExprKind::Ascription(of) => list_node("as", [self.expr(&of.value), self.ty(&of.ty)]),
            ExprKind::ConstructorTest(of) => {
                list_node("is", [self.expr(&of.value), name(&of.constructor)])
            }
            ExprKind::Match(of) => self.match_expr(of),
            ExprKind::EmptySet(types) => nodes("empty", types, |ty| self.static_arg(ty)),
            ExprKind::Struct(value) => self.struct_expr(value),
            ExprKind::Update(update) => self.update(update),
        }
    }

    fn slice(&self, slice: &SliceBounds) -> Sexp {
        let step = option("step", slice.step.as_ref(), |step| self.expr(step));
        list_node(
            "range",
            [self.expr(&slice.from), self.expr(&slice.to), step],
        )
    }

    fn conditional(&self, conditional: &IfExpr) -> Sexp {
        let tag = if conditional.is_static { "with" } else { "if" };
        let parts = [
            &conditional.condition,
            &conditional.then_value,
            &conditional.else_value,
        ];
        list_node(tag, parts.map(|part| self.expr(part)))
    }

    fn merge(&self, merge: &Merge) -> Sexp {
        let case = |case: &MergeCase| list_node("case", [name(&case.value), self.expr(&case.then)]);
        let cases = merge.cases.iter().map(case);
        list_node(
            "merge",
            std::iter::once(self.expr(&merge.selector)).chain(cases),
        )
    }

    fn struct_expr(&self, value: &StructExpr) -> Sexp {
        let base = option("base", value.base.as_ref(), |base| self.expr(base));
        let fields = nodes("fields", &value.fields, |f| {
            list_node(&f.field.name, [self.expr(&f.value)])
        });
        let statics = match &value.statics[..] {
            [] => Sexp::Empty,
            all => nodes("statics", all, |arg| self.static_arg(arg)),
        };
        list_node("struct", [name(&value.ty), statics, base, fields])
    }

    fn update(&self, update: &Update) -> Sexp {
        let change = |change: &Change| {
            list_node(
                "change",
                [self.path(&change.path), self.expr(&change.value)],
            )
        };
        let changes = update.changes.iter().map(change);
        list_node(
            if update.is_keyed { "keyed" } else { "update" },
            std::iter::once(self.expr(&update.base)).chain(changes),
        )
    }

    pub(super) fn path(&self, path: &[Access]) -> Sexp {
        nodes("path", path, |access| match access {
            Access::Field(field) => name(field),
            Access::Index(index) => list_node("index", [self.expr(index)]),
            Access::Slice(slice) => self.slice(slice),
        })
    }

    pub(super) fn call(&self, call: &Call) -> Sexp {
        let activation = match &call.activation {
            Activation::Always => Sexp::Empty,
            Activation::Restart { every } => list_node("restart", [self.expr(every)]),
            Activation::Activate {
                every,
                restart,
                default,
            } => {
                let restart = option("restart", restart.as_ref(), |x| self.expr(x));
                let default = option("default", default.as_ref(), |x| self.expr(x));
                list_node("activate", [self.expr(every), restart, default])
            }
        };
        list_node(
            "call",
            [self.callee(&call.callee), activation, self.args(&call.args)],
        )
    }

    pub(super) fn args(&self, args: &[Arg]) -> Sexp {
        nodes("args", args, |arg| {
            named(arg.name.as_ref(), self.expr(&arg.value))
        })
    }

    pub(super) fn callee(&self, callee: &Callee) -> Sexp {
        match &callee.statics[..] {
            [] => name(&callee.name),
            statics => nodes(&callee.name.name, statics, |arg| self.static_arg(arg)),
        }
    }

    fn static_arg(&self, arg: &StaticArg) -> Sexp {
        let value = match &arg.value {
            StaticValue::Expr(expr) => self.expr(expr),
            StaticValue::Type(ty) => list_node("type", [self.ty(ty)]),
            StaticValue::Op(StaticOp::Unary(op)) => list_node("op", [Sexp::atom(op.spelling())]),
            StaticValue::Op(StaticOp::Binary(op)) => list_node("op", [Sexp::atom(op.spelling())]),
            StaticValue::Op(StaticOp::If) => list_node("op", [Sexp::atom("if")]),
            StaticValue::Callee(callee) => list_node("node", [self.callee(callee)]),
        };
        named(arg.name.as_ref(), value)
    }

    pub(super) fn ty(&self, ty: &Type) -> Sexp {
        match &ty.kind {
            TypeKind::Bool => Sexp::atom("bool"),
            TypeKind::Int => Sexp::atom("int"),
            TypeKind::Real(None) => Sexp::atom("real"),
            TypeKind::Real(Some(of)) => list_node("real", [unit(of)]),
            TypeKind::Named(named) => self.named_type(named),
            TypeKind::Array(array) => {
                list_node("^", [self.ty(&array.element), self.expr(&array.size)])
            }
            TypeKind::Optional(inner) => list_node("?", [self.ty(inner)]),
            TypeKind::Subrange(range) => {
                let bound =
                    |bound: &Option<Expr>| bound.as_ref().map_or(Sexp::atom("*"), |e| self.expr(e));
                list_node("subrange", [bound(&range.lower), bound(&range.upper)])
            }
            TypeKind::Enum(values) => nodes("enum", values, |value| {
                list_node(
                    "value",
                    [name(&value.name), super::decl::doc(value.doc.as_ref())],
                )
            }),
            TypeKind::Tuple(types) => nodes("tuple", types, |ty| self.ty(ty)),
            TypeKind::Refinement(refined) => self.refined(refined),
            TypeKind::Datatype(all) => nodes("data", all, |constructor| {
                nodes(&constructor.name.name, &constructor.fields, |field| {
                    self.var(field)
                })
            }),
            TypeKind::Struct(fields) => nodes("struct", fields, |field| self.var(field)),
            TypeKind::Error => Sexp::atom("broken"),
        }
    }

    fn refined(&self, refined: &RefinementType) -> Sexp {
        let parts = [name(&refined.name), self.ty(&refined.base)];
        let condition = [self.expr(&refined.condition)];
        list_node("subtype", parts.into_iter().chain(condition))
    }

    fn quantified(&self, of: &Quantified) -> Sexp {
        let tag = if of.is_forall { "forall" } else { "exists" };
        let vars = nodes("vars", &of.vars, |var| self.var(var));
        list_node(tag, [vars, self.expr(&of.condition)])
    }

    fn match_expr(&self, of: &Match) -> Sexp {
        let arms = of.arms.iter().map(|arm| {
            let Pattern { name: first, parts } = &arm.pattern;
            let parts = nodes("parts", parts, pattern);
            list_node("arm", [name(first), parts, self.expr(&arm.then)])
        });
        list_node("match", [self.expr(&of.value)].into_iter().chain(arms))
    }

    fn named_type(&self, named: &NamedType) -> Sexp {
        let frames = option("frames", named.frames.as_ref(), |frames| {
            let of = frames.located.as_ref().map_or(Sexp::Empty, dotted);
            list_node("in", [of, dotted(&frames.reference)])
        });
        let statics = nodes("statics", &named.statics, |arg| self.static_arg(arg));
        match (&named.statics[..], &named.frames) {
            ([], None) => name(&named.name),
            _ => list_node("named", [name(&named.name), statics, frames]),
        }
    }
}

fn pattern(of: &Pattern) -> Sexp {
    match &of.parts[..] {
        [] => name(&of.name),
        parts => list_node(
            "of",
            [name(&of.name)]
                .into_iter()
                .chain(parts.iter().map(pattern)),
        ),
    }
}

fn named(label: Option<&Ident>, value: Sexp) -> Sexp {
    match label {
        Some(label) => list_node(":", [name(label), value]),
        None => value,
    }
}
